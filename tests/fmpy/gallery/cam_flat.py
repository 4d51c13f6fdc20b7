"""Eccentric cam with a flat face: simple harmonic motion."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body

DISC, ECCENTRICITY = 0.040, 0.015


def truth(_time, drivers):
    u = drivers["cam_angle"]
    travel = DISC + ECCENTRICITY * u.sin()
    return body("cam", 0, u) | body("follower", 1j * travel, 0) | {"travel": travel}


CASE = Case(
    source="closed form: simple harmonic motion",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
