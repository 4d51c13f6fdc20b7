"""Geared five-bar: the second crank turns back at half the speed, the links close a triangle."""

from __future__ import annotations

import numpy as np

from . import Case
from .plane import apex, body, point
from .taylor import Taylor

BASE, FIRST, SECOND, LINK, PHASE = 0.12, 0.04, 0.03, 0.13, np.radians(120)
START = np.radians(40)


def drivers(time):
    """Two turns, after which the mechanism is where it was."""
    return {"crank_angle": START + 2 * (np.pi * time - (np.pi * time).sin())}


def truth(_time, drivers):
    u = drivers["crank_angle"]
    second = PHASE - 0.5 * u
    a, b = Taylor.polar(FIRST, u), BASE + Taylor.polar(SECOND, second)
    c = apex(a, b, LINK, LINK, +1)
    return (
        body("first_crank", 0, u)
        | body("second_crank", BASE, second)
        | body("left_link", a, (c - a).angle())
        | body("right_link", b, (c - b).angle())
        | point("left_link.C", c)
    )


CASE = Case(
    source="closed form: gear ratio −1/2, circle intersection",
    drivers=drivers,
    truth=truth,
)
