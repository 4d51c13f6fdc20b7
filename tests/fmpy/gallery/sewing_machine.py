"""Sewing machine: a slider-crank with an offset, and a four-bar linkage on the same shaft."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

CRANK, ROD, LEVER, LEAD, LINK = 0.014, 0.045, 0.010, np.radians(50), 0.028
WAY, PIVOT = 0.002, -0.030 + 0.020j
TO_LINK, EYE, POINT = 0.030, 0.065 + 0.010j, -0.060j


def truth(_time, drivers):
    u = drivers["shaft_angle"]
    a = Taylor.polar(CRANK, u)
    aside = WAY - a.x
    down = (ROD**2 - aside.square()).sqrt()
    needle = WAY + 1j * (a.y - down)
    b = Taylor.polar(LEVER, u + LEAD)
    d = apex(b, PIVOT, TO_LINK, LINK, -1)
    take_up = (d - b).angle()
    return (
        body("shaft", 0, u)
        | body("rod", a, (needle - a).angle())
        | body("needle", needle, 0)
        | body("take_up", b, take_up)
        | point("needle.point", needle + POINT)
        | point("take_up.eye", b + Taylor.polar(1, take_up) * EYE)
        | {"depth": down - a.y}
    )


CASE = Case(
    source="closed form: offset slider-crank, one circle intersection",
    drivers=lambda time: {"shaft_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
