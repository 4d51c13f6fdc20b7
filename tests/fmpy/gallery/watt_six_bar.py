"""Watt's six-bar linkage."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, one_turn
from .plane import apex, body, point
from .taylor import Taylor

CRANK, COUPLER, ROCKER, BASE = 0.10, 0.25, 0.30, 0.40
UPPER, LOWER = 0.22, 0.20
C_ON_COUPLER = COUPLER + 0.16 - 0.04j
D_ON_ROCKER = ROCKER + 0.12 + 0.04j


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    o4 = Taylor.of(BASE)
    a = Taylor.polar(CRANK, crank)
    b = apex(a, o4, COUPLER, ROCKER, +1)
    coupler, rocker = (b - a).angle(), (b - o4).angle()
    c = a + Taylor.polar(C_ON_COUPLER, coupler)
    d = o4 + Taylor.polar(D_ON_ROCKER, rocker)
    e = apex(d, c, LOWER, UPPER, +1)
    upper, lower = (e - c).angle(), (e - d).angle()
    return {
        **body("crank", 0.0, crank),
        **body("coupler", a, coupler),
        **body("rocker", o4, rocker),
        **body("upper", c, upper),
        **body("lower", d, lower),
        **point("upper.E", e),
        "transmission_B": rocker - coupler,
        "transmission_E": upper - lower,
    }


CASE = Case(
    source="closed form: two dyads",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(60))(time)},
    truth=truth,
)
