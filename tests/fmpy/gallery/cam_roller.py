"""Eccentric cam with a roller: a slider–crank with the connecting rod a + r."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

DISC, ECCENTRICITY, ROLLER, OFFSET = 0.040, 0.015, 0.010, 0.008


def truth(_time, drivers):
    u = drivers["cam_angle"]
    centre = Taylor.polar(ECCENTRICITY, u)
    rod = DISC + ROLLER
    travel = centre.y + (rod**2 - (OFFSET - centre.x).square()).sqrt()
    return body("cam", 0, u) | body("follower", OFFSET + 1j * travel, 0) | {"travel": travel}


CASE = Case(
    source="closed form: equivalent slider–crank",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(60))(time)},
    truth=truth,
)
