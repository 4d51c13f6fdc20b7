"""Elliptic trammel: the pen's ellipse, the circle of the bar's middle."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

SPAN, OVERHANG = 0.10, 0.06


def truth(_time, drivers):
    u = drivers["bar_angle"]
    level, upright = SPAN * u.cos(), -SPAN * u.sin()
    pen = (SPAN + OVERHANG) * u.cos() + 1j * OVERHANG * u.sin()
    return (
        body("bar", Taylor.polar(SPAN / 2, -u), u)
        | body("level_slider", level, 0)
        | body("upright_slider", 1j * upright, 0)
        | point("bar.P", pen)
        | {"radius": pen.length()}
    )


def properties(motion):
    x, y = motion["bar.P.x"], motion["bar.P.y"]
    middle = np.hypot(motion["bar.x"], motion["bar.y"])
    return {
        "the pen is on its ellipse": (x / (SPAN + OVERHANG)) ** 2 + (y / OVERHANG) ** 2 - 1,
        "the middle is on its circle": middle / (SPAN / 2) - 1,
    }


CASE = Case(
    source="exact: the pen's ellipse, the circle of the bar's middle",
    drivers=lambda time: {"bar_angle": one_turn(np.radians(30))(time)},
    truth=truth,
    properties=properties,
)
