"""Spring-loaded follower: the equivalent slider–crank, and the force that its contact bears."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

DISC, ECCENTRICITY, ROLLER = 0.020, 0.005, 0.008
MASS, STIFFNESS, G = 0.120, 2000.0, 9.81
PLATE, TOP, FREE = 0.105, 0.05, 0.063


def truth(_time, drivers):
    u = drivers["cam_angle"]
    centre = Taylor.polar(ECCENTRICITY, u)
    lift = centre.y + ((DISC + ROLLER) ** 2 - centre.x.square()).sqrt()
    return body("cam", 0, u) | body("valve", 1j * lift, 0) | {"lift": lift}


def properties(motion):
    """The contact force points from the disc's centre to the roller's and carries valve and
    spring; by virtual power the effort is that force times dlift/du."""
    u, lift = motion["cam_angle.position"], motion["lift.position"]
    spring = STIFFNESS * (FREE - (PLATE - TOP - lift))
    needed = MASS * (motion["lift.acceleration"] + G) + spring
    x, y = ECCENTRICITY * np.cos(u), ECCENTRICITY * np.sin(u)
    slope = x + y * x / (lift - y)
    largest = np.max(np.abs(needed))
    return {
        "spring": (motion["spring.effort"] - spring) / largest,
        "along the valve": (motion["contact.fy"] - needed) / largest,
        "across the valve": (motion["contact.fx"] + needed * x / (lift - y)) / largest,
        "effort": (motion["cam_angle.effort"] - needed * slope) / (largest * ECCENTRICITY),
    }


CASE = Case(
    source="closed form: equivalent slider–crank; statics of the contact",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
    properties=properties,
)
