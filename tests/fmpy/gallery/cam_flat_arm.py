"""Eccentric cam with a flat-faced lever: its face stays a radius from the disc's centre."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

DISC, ECCENTRICITY, LEVER, BASE = 0.030, 0.012, 0.120, 0.090


def truth(_time, drivers):
    u = drivers["cam_angle"]
    to_centre = Taylor.polar(ECCENTRICITY, u) - BASE
    swing = to_centre.angle() - (DISC / to_centre.length()).asin()
    # The direction starts near 180° and may be taken for one near -180°.
    swing = swing - 2 * np.pi * np.round((swing.value.flat[0] - np.pi) / (2 * np.pi))
    return (
        body("cam", 0, u)
        | body("lever", BASE, swing)
        | point("lever.end", BASE + Taylor.polar(LEVER, swing))
        | {"swing": swing}
    )


CASE = Case(
    source="closed form: tangent from the pivot to the disc",
    drivers=lambda time: {"cam_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
