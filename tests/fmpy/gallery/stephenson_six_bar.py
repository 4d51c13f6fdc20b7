"""Stephenson's six-bar linkage with a dwell."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, one_turn
from .plane import apex, body, point
from .taylor import Taylor

CRANK, COUPLER, ROCKER, BASE, LINK, OUTPUT = 0.040, 0.100, 0.100, 0.080, 0.107, 0.100
O6 = 0.0775 + 0.1152j
C_ON_COUPLER = COUPLER * np.exp(1j * np.radians(60))


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    o4, o6 = Taylor.of(BASE), Taylor.of(O6)
    a = Taylor.polar(CRANK, crank)
    b = apex(a, o4, COUPLER, ROCKER, +1)
    coupler = (b - a).angle()
    c = a + Taylor.polar(C_ON_COUPLER, coupler)
    e = apex(o6, c, OUTPUT, LINK, +1)
    link, output = (e - c).angle(), (e - o6).angle()
    return {
        **body("crank", 0.0, crank),
        **body("coupler", a, coupler),
        **body("rocker", o4, (b - o4).angle()),
        **body("link", c, link),
        **body("output", o6, output),
        **point("coupler.C", c),
        "output_angle": output,
        "transmission": output - link,
    }


CASE = Case(
    source="closed form: two dyads",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(90))(time)},
    truth=truth,
)
