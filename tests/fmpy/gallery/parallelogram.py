"""Parallelogram: the coupler does not turn, each of its points runs on a circle."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body, point
from .taylor import Taylor

CRANK, BASE, RISE = 0.10, 0.20, 0.05


def truth(_time, drivers):
    u = drivers["crank_angle"]
    a = Taylor.polar(CRANK, u)
    return (
        body("crank", 0, u)
        | body("coupler", a, 0)
        | body("follower", BASE, u)
        | point("coupler.P", a + (BASE / 2 + 1j * RISE))
        | {"tilt": Taylor.of(0.0)}
    )


CASE = Case(
    source="exact: the coupler does not turn",
    # Between its change points at 0° and 180°, which are refused.
    drivers=lambda time: {"crank_angle": swing(np.radians(90), np.radians(70))(time)},
    truth=truth,
)
