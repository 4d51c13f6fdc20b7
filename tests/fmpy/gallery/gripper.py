"""Gripper: the tips move on circles, and are nearest to the part and to each other."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body, point
from .taylor import Taylor

HALF_BASE, FINGER, PART = 0.030, 0.008, 0.012
PART_AT = 0.125j
TIP = -0.005 + 0.120j
#: The jaws hold the part where a tip is at the sum of both radii from its centre.
REACH, TO_PART = abs(TIP), abs(PART_AT + HALF_BASE)
INSIDE = (REACH**2 + TO_PART**2 - (FINGER + PART) ** 2) / (2 * REACH * TO_PART)
GRIP = np.angle(PART_AT + HALF_BASE) + np.arccos(INSIDE) - np.angle(TIP)
OPEN = np.radians(20)


def truth(_time, drivers):
    phi = drivers["opening"]
    tip = -HALF_BASE + Taylor.polar(REACH, np.angle(TIP) + phi)
    return (
        body("left_jaw", -HALF_BASE, phi)
        | body("right_jaw", HALF_BASE, -phi)
        | point("left_jaw.tip", tip)
        | point("right_jaw.tip", -1 * tip.x + 1j * tip.y)
        | {
            "air": (tip - PART_AT).length_squared().sqrt() - (FINGER + PART),
            "gap": -2 * tip.x - 2 * FINGER,
        }
    )


CASE = Case(
    source="closed form: tips on circles",
    drivers=lambda time: {"opening": swing((GRIP + OPEN) / 2, (OPEN - GRIP) / 2)(time)},
    truth=truth,
)
