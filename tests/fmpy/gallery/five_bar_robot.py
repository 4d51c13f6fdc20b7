"""Planar five-bar robot: the motors' angles lead the tip round a circle."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, one_turn
from .plane import apex, body, point
from .taylor import Taylor

BASE, ARM, FOREARM = 0.20, 0.25, 0.35
CENTRE, RADIUS = 0.10 + 0.38j, 0.15


def drivers(time: Taylor) -> dict[str, Taylor]:
    """The angles for the tip's motion, the elbows on the outer sides."""
    tip = CENTRE + Taylor.polar(RADIUS, one_turn(np.radians(-90))(time))
    left, right = apex(0.0, tip, ARM, FOREARM, +1), apex(BASE, tip, ARM, FOREARM, -1)
    return {"left_angle": left.angle(), "right_angle": (right - BASE).angle()}


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    left = Taylor.polar(ARM, drivers["left_angle"])
    right = BASE + Taylor.polar(ARM, drivers["right_angle"])
    tip = apex(left, right, FOREARM, FOREARM, +1)
    left_forearm, right_forearm = (tip - left).angle(), (tip - right).angle()
    return {
        **body("left_arm", 0.0, drivers["left_angle"]),
        **body("right_arm", BASE, drivers["right_angle"]),
        **body("left_forearm", left, left_forearm),
        **body("right_forearm", right, right_forearm),
        **point("left_forearm.tip", tip),
        "opening": right_forearm - left_forearm,
    }


def properties(motion: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    tip = motion["left_forearm.tip.x"] + 1j * motion["left_forearm.tip.y"]
    return {"the tip on its circle": abs(tip - CENTRE) / RADIUS - 1}


CASE = Case(
    source="tip led round a circle; closed form: circle intersections",
    drivers=drivers,
    truth=truth,
    properties=properties,
)
