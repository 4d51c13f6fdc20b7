"""Scotch yoke: the yoke moves as the cosine of the crank's angle."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

CRANK = 0.05


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = Taylor.polar(CRANK, u)
    return (
        body("crank", 0, u)
        | body("yoke", pin.x, 0)
        | point("crank.A", pin)
        | {"stroke": pin.x, "lift": pin.y}
    )


CASE = Case(
    source="exact: the pure cosine",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
