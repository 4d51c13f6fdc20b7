"""Toggle press: the knee is a triangle on the crank's pin and the frame's pivot."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

CRANK, ROD, LINK = 0.05, 0.45, 0.20
WORK_DEPTH, STIFFNESS = 0.38, 4e6
PIVOT = -CRANK - ROD - 1j * LINK


def truth(_time, drivers):
    u = drivers["crank_angle"]
    a = PIVOT + Taylor.polar(CRANK, u)
    knee = apex(a, 0, ROD, LINK, -1)
    upper = knee.angle()
    # The triangle of the two links over the guide is isosceles.
    lower = -np.pi - upper
    depth = -2 * knee.y
    return (
        body("crank", PIVOT, u)
        | body("rod", a, (knee - a).angle())
        | body("upper_link", 0, upper)
        | body("lower_link", knee, lower)
        | body("ram", -1j * depth, 0)
        | point("rod.K", knee)
        | {"depth": depth, "knee": lower - upper}
    )


def properties(motion):
    """At the crank angle 0, here after one half of the turn, the ram stands to third order.

    Virtual work: the crank's torque does what the ram does on the work, and the mechanical
    advantage is the velocity of the crank's pin by that of the ram. It is infinite at the dead
    points, so that its reciprocal is compared."""
    u = motion["crank_angle.position"]
    lowest = np.argmin(np.abs(u - 2 * np.pi))
    omega = motion["crank_angle.velocity"][lowest]
    depth = truth(None, {"crank_angle": Taylor.time(u)})["depth"]
    force = STIFFNESS * np.maximum(depth.value - WORK_DEPTH, 0)
    largest = STIFFNESS * (2 * LINK - WORK_DEPTH)
    # The rod has a pin at each end and no load between: its force is along it.
    lever = CRANK * np.abs(np.sin(motion["rod.phi"] - u))
    with np.errstate(divide="ignore"):
        reciprocal = 1 / motion["advantage"]
    return {
        "the ram is at its lowest": motion["ram.y"][lowest] / (2 * LINK) + 1,
        "with no velocity": motion["ram.vy"][lowest] / (omega * LINK),
        "and no acceleration": motion["ram.ay"][lowest] / (omega**2 * LINK),
        "work": (motion["work.effort"] + force) / largest,
        "effort": (motion["crank_angle.effort"] - force * depth.first) / (largest * CRANK),
        "pin force": (motion["pin_force"] * lever - np.abs(motion["crank_angle.effort"]))
        / (largest * CRANK),
        "advantage": reciprocal - depth.first / CRANK,
    }


CASE = Case(
    source="closed form: intersection of two circles; exact dwell of the ram; virtual work",
    drivers=lambda time: {"crank_angle": one_turn(np.pi)(time)},
    truth=truth,
    properties=properties,
)
