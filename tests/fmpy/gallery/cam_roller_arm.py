"""Eccentric cam with a roller on an arm: a four-bar with the coupler a + r."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

DISC, ECCENTRICITY, ROLLER, ARM, BASE = 0.040, 0.015, 0.010, 0.080, 0.080


def truth(_time, drivers):
    u = drivers["cam_angle"]
    centre = Taylor.polar(ECCENTRICITY, u)
    roller = apex(centre, BASE, DISC + ROLLER, ARM, +1)
    swing = (roller - BASE).angle()
    return (
        body("cam", 0, u)
        | body("arm", BASE, swing)
        | point("arm.roller", roller)
        | {"swing": swing}
    )


CASE = Case(
    source="closed form: equivalent four-bar",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
