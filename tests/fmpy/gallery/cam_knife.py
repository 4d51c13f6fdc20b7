"""Cam with a knife edge: the follower's place is the contour's radius above the axle."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body

BASE, LIFT, PHASE = 0.030, 0.020, np.radians(25)


def truth(_time, drivers):
    u = drivers["cam_angle"]
    lift = BASE + LIFT / 2 * (1 - (np.pi / 2 - u - PHASE).cos())
    return body("cam", 0, u) | body("follower", 1j * lift, 0) | {"lift_now": lift}


CASE = Case(
    source="closed form: R = base + lift/2·(1 − cos θ)",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
    parameters={"phase": PHASE},
)
