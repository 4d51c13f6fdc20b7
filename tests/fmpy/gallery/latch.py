"""Latch: the bolt moves as the sine of the handle's angle, from one stop to the other and back."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body, point

ARM, REACH, RETRACTED = 0.03, 0.02, np.radians(-40)
#: The bolt meets the strike plate where its sine is the reach over the arm.
STRIKE = np.arcsin(REACH / ARM)


def truth(_time, drivers):
    u = drivers["handle_angle"]
    bolt = ARM * u.sin()
    return (
        body("handle", 0, u)
        | body("bolt", bolt - 1j * ARM, 0)
        | point("bolt.tip", bolt + (3 - 1j) * ARM)
        | {"throw": bolt}
    )


CASE = Case(
    source="exact: the pure sine",
    drivers=lambda time: {
        "handle_angle": swing((STRIKE + RETRACTED) / 2, (STRIKE - RETRACTED) / 2)(time)
    },
    truth=truth,
)
