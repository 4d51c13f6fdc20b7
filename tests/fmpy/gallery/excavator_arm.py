"""Excavator arm: three triangles with a variable side and a four-bar linkage; free bodies."""

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
LOAD_ON_BUCKET, LOAD_MASS, G = 0.65 + 0.30j, 1500.0, 9.81
#: Mass, moment of inertia about the centre of mass, centre of mass in the body's frame.
MASSES = {
    "boom": (1800.0, 5200.0, 2.75 + 0.45j),
    "stick": (900.0, 950.0, 0.95 + 0.15j),
    "lever": (70.0, 2.5, LEVER / 2),
    "bucket": (750.0, 180.0, 0.55 + 0.25j),
}


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


class Demand:
    """Force on a body, or on several together, with its moment about ground's origin."""

    def __init__(self, force=0.0, moment=0.0):
        self.force, self.moment = force, moment

    def __add__(self, other):
        return Demand(self.force + other.force, self.moment + other.moment)

    def about(self, pin):
        """Returns the moment about a point."""
        return self.moment - cross(pin, self.force)


def cross(arm, force):
    return (np.conj(arm) * force).imag


def thrust(foot, head, pin, moment):
    """Returns the force of a cylinder on its head that has this moment about a pin."""
    along = (head - foot) / np.abs(head - foot)
    return moment / cross(head - pin, along), along


def properties(motion):
    """Free bodies, from the bucket to the frame: what lies beyond a pin demands a moment about it
    for its weight, its load and its acceleration, and one cylinder or rod has to give it."""
    drivers = {
        name: Taylor(*(motion[f"{name}.{order}"] for order in ("position", "velocity", "acceleration")))
        for name in ("boom_cylinder", "stick_cylinder", "bucket_cylinder")
    }
    pose = truth(None, drivers)
    origin = {name: pose[f"{name}.x"] + 1j * pose[f"{name}.y"] for name in MASSES}
    phi = {name: pose[f"{name}.phi"] for name in MASSES}

    def at(name, place):
        return (origin[name] + Taylor.polar(1, phi[name]) * place).value

    def demand(name):
        mass, inertia, center = MASSES[name]
        place = origin[name] + Taylor.polar(1, phi[name]) * center
        force = mass * (place.second + 1j * G)
        return Demand(force, cross(place.value, force) + inertia * phi[name].second)

    weight = -1j * G * LOAD_MASS
    bucket = demand("bucket") + Demand(-weight, -cross(at("bucket", LOAD_ON_BUCKET), weight))
    lever, stick, boom = demand("lever"), demand("stick"), demand("boom")

    end, ear = at("lever", LEVER), at("bucket", EAR_ON_BUCKET)
    bucket_pin, lever_pin, stick_pin = (at(name, 0) for name in ("bucket", "lever", "stick"))
    rod, along_rod = thrust(end, ear, bucket_pin, bucket.about(bucket_pin))
    moment = lever.about(lever_pin) + cross(end - lever_pin, rod * along_rod)
    foot = at("stick", BUCKET_CYLINDER_ON_STICK)
    bucket_cylinder, along = thrust(foot, end, lever_pin, moment)
    at_lever_pin = lever.force + rod * along_rod - bucket_cylinder * along

    beyond = stick + lever + bucket
    foot, head = at("boom", STICK_CYLINDER_ON_BOOM), at("stick", REAR_ON_STICK)
    stick_cylinder, along = thrust(foot, head, stick_pin, beyond.about(stick_pin))
    at_stick_pin = beyond.force - stick_cylinder * along

    beyond = beyond + boom
    head = at("boom", CYLINDER_ON_BOOM)
    boom_cylinder, along = thrust(CYLINDER_FOOT, head, 0.0, beyond.about(0.0))
    at_foot = beyond.force - boom_cylinder * along

    forces = {
        "boom_foot": at_foot,
        "stick_pin": at_stick_pin,
        "lever_pin": at_lever_pin,
        "bucket_pin": bucket.force - rod * along_rod,
        "rod": rod * along_rod,
    }
    largest = np.max(np.abs(boom_cylinder))
    efforts = {
        "boom_cylinder": boom_cylinder,
        "stick_cylinder": stick_cylinder,
        "bucket_cylinder": bucket_cylinder,
    }
    return {
        f"effort of {name}": (motion[f"{name}.effort"] - effort) / largest
        for name, effort in efforts.items()
    } | {
        f"force in {name}": (motion[f"{name}.fx"] + 1j * motion[f"{name}.fy"] - force) / largest
        for name, force in forces.items()
    }


CASE = Case(
    source="closed form: law of cosines in each cylinder's triangle, one dyad; free bodies",
    # Each cylinder through its whole range, at a pace of its own.
    drivers=lambda time: {
        "boom_cylinder": swing(2.225, 0.475)(time),
        "stick_cylinder": swing(3.225, 0.575)(2 * time),
        "bucket_cylinder": swing(2.025, 0.425)(3 * time),
    },
    truth=truth,
    properties=properties,
)
