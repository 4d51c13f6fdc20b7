"""Excavator arm: three triangles with a variable side and a four-bar linkage."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, swing
from .plane import apex, body, point
from .taylor import Taylor

BOOM, STICK, BUCKET, LEVER, ROD = 5.70, 2.90, 1.45, 0.55, 0.55
CYLINDER_FOOT = 0.70 - 0.45j
CYLINDER_ON_BOOM = 2.40 + 0.55j
STICK_CYLINDER_ON_BOOM = 2.70 + 0.95j
REAR_ON_STICK = -0.75 + 0.25j
BUCKET_CYLINDER_ON_STICK = 0.50 + 0.50j
LEVER_ON_STICK = STICK - 0.42
EAR_ON_BUCKET = -0.34 + 0.29j


def opening(pin_1: complex, pin_2: complex, cylinder: Taylor) -> Taylor:
    """Angle at the origin between a cylinder's two pins, by the law of cosines."""
    a, b = abs(pin_1), abs(pin_2)
    return ((a**2 + b**2 - cylinder.square()) / (2 * a * b)).acos()


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    # From the frame to the boom to the stick to the lever.
    lug, foot = CYLINDER_ON_BOOM, CYLINDER_FOOT
    boom_phi = np.angle(foot / lug) + opening(foot, lug, drivers["boom_cylinder"])
    rear, front = REAR_ON_STICK, STICK_CYLINDER_ON_BOOM - BOOM
    stick_on_boom = np.angle(front / rear) - opening(front, rear, drivers["stick_cylinder"])
    seat, end = BUCKET_CYLINDER_ON_STICK - LEVER_ON_STICK, LEVER
    lever_on_stick = np.angle(seat) - opening(seat, end, drivers["bucket_cylinder"])

    # The four-bar linkage, in the stick's frame.
    lever_end = LEVER_ON_STICK + Taylor.polar(LEVER, lever_on_stick)
    ear = apex(lever_end, STICK, ROD, abs(EAR_ON_BUCKET), +1)
    bucket_on_stick = ((ear - STICK) / EAR_ON_BUCKET).angle()

    stick_phi = boom_phi + stick_on_boom
    bucket_phi = stick_phi + bucket_on_stick
    stick_pin = Taylor.polar(BOOM, boom_phi)
    bucket_pin = stick_pin + Taylor.polar(STICK, stick_phi)
    lever_pin = stick_pin + Taylor.polar(LEVER_ON_STICK, stick_phi)
    teeth = bucket_pin + Taylor.polar(BUCKET, bucket_phi)
    return {
        **body("boom", 0.0, boom_phi),
        **body("stick", stick_pin, stick_phi),
        **body("lever", lever_pin, stick_phi + lever_on_stick),
        **body("bucket", bucket_pin, bucket_phi),
        **point("bucket.teeth", teeth),
        "stick_angle": stick_on_boom,
        "bucket_angle": bucket_on_stick,
        "reach": teeth.x,
        "height": teeth.y,
    }


CASE = Case(
    source="closed form: law of cosines in each cylinder's triangle, one dyad",
    # Each cylinder through its whole range, at a pace of its own.
    drivers=lambda time: {
        "boom_cylinder": swing(2.225, 0.475)(time),
        "stick_cylinder": swing(3.225, 0.575)(2 * time),
        "bucket_cylinder": swing(2.025, 0.425)(3 * time),
    },
    truth=truth,
)
