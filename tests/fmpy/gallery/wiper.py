"""Windscreen wiper: two four-bar linkages, one behind the other."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

CRANK, ROD, LEFT, RIGHT, SPAN = 0.045, 0.300, 0.060, 0.055, 0.550
LEFT_BLADE, RIGHT_BLADE = 0.550, 0.480
MOTOR = 0.30 - 0.05j


def truth(_time, drivers):
    u = drivers["motor_angle"]
    a = MOTOR + Taylor.polar(CRANK, u)
    left_pin = apex(a, 0, ROD, LEFT, +1)
    right_pin = apex(left_pin, SPAN, SPAN, RIGHT, -1)
    left, right = left_pin.angle(), (right_pin - SPAN).angle()
    return (
        body("crank", MOTOR, u)
        | body("rod", a, (left_pin - a).angle())
        | body("left", 0, left)
        | body("second_rod", left_pin, (right_pin - left_pin).angle())
        | body("right", SPAN, right)
        | point("left.tip", -left_pin * (LEFT_BLADE / LEFT))
        | point("right.tip", SPAN - (right_pin - SPAN) * (RIGHT_BLADE / RIGHT))
        | {"lag": right - left}
    )


CASE = Case(
    source="closed form: two circle intersections",
    drivers=lambda time: {"motor_angle": one_turn(np.radians(30))(time)},
    truth=truth,
)
