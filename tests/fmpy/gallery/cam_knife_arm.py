"""Cam with a knife-edge rocker: the equivalent four-bar linkage."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body
from .taylor import Taylor

DISC, ECCENTRICITY, ROCKER = 0.030, 0.012, 0.085
PIVOT = 0.085 + 0.050j


def truth(_time, drivers):
    u = drivers["cam_angle"]
    edge = apex(Taylor.polar(ECCENTRICITY, u), PIVOT, DISC, ROCKER, +1)
    swing = (edge - PIVOT).angle()
    return body("cam", 0, u) | body("rocker", PIVOT, swing) | {"swing": swing}


CASE = Case(
    source="closed form: equivalent four-bar linkage",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
