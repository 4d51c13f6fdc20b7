"""Drag link: coupler and follower are a triangle on the crank's pin and the fixed pivot."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

BASE, CRANK, COUPLER, FOLLOWER = 0.04, 0.10, 0.09, 0.11


def truth(_time, drivers):
    u = drivers["crank_angle"]
    a = Taylor.polar(CRANK, u)
    b = apex(a, BASE, COUPLER, FOLLOWER, +1)
    coupler, follower = (b - a).angle(), (b - BASE).angle()
    return (
        body("crank", 0, u)
        | body("coupler", a, coupler)
        | body("follower", BASE, follower)
        | point("coupler.B", b)
        | {"lead": follower - u, "transmission": follower - coupler}
    )


CASE = Case(
    source="closed form: intersection of two circles",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(90))(time)},
    truth=truth,
)
