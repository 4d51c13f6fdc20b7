"""Pantograph: the pen's path is the tracer's, enlarged."""

from __future__ import annotations

import numpy as np

from . import Case
from .plane import apex, body, point
from .taylor import Taylor

BAR, RATIO = 0.36, 3
SHORT = BAR / RATIO


def drivers(time):
    """The tracer follows a figure of eight on its side."""
    angle = np.pi * time
    return {"tracer_x": 0.14 + 0.07 * angle.cos(), "tracer_y": 0.05 * (2 * angle).sin()}


def truth(_time, drivers):
    p = drivers["tracer_x"] + 1j * drivers["tracer_y"]
    a = apex(0, p, SHORT, SHORT, +1)
    fixed, pen = a.angle(), (p - a).angle()
    return (
        body("fixed_bar", 0, fixed)
        | body("pen_bar", RATIO * a, pen)
        | body("tracer_bar", a, pen)
        | body("side_bar", p, fixed)
        | point("tracer_bar.P", p)
        | point("pen_bar.Q", RATIO * p)
        | {"spread": fixed - pen}
    )


def properties(motion):
    return {
        f"the pen's {axis} is enlarged exactly": (
            motion[f"pen_bar.Q.{axis}"] - RATIO * motion[f"tracer_bar.P.{axis}"]
        )
        / BAR
        for axis in ("x", "y")
    }


CASE = Case(
    source="exact similarity of the two paths; closed form: intersection of two circles",
    drivers=drivers,
    truth=truth,
    properties=properties,
)
