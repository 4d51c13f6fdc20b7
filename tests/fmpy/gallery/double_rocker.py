"""Double rocker driven at its coupler: seen from the head, the coupler is a crank."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import apex, body, point
from .taylor import Taylor

HEAD, COUPLER, STAY, BASE = 0.035, 0.015, 0.030, 0.040


def truth(_time, drivers):
    u = drivers["worm_angle"]
    # In the head's frame: its pivot at 0, the coupler's end, and the other pivot beyond both.
    end = HEAD + Taylor.polar(COUPLER, u)
    pivot = apex(0, end, BASE, STAY, -1)
    head = -pivot.angle()
    a = Taylor.polar(HEAD, head)
    b = end * Taylor.polar(1, head)
    return (
        body("head", 0, head)
        | body("coupler", a, head + u)
        | body("stay", BASE, (b - BASE).angle())
        | point("coupler.B", b)
        | {"swing": head}
    )


CASE = Case(
    source="closed form: intersection of two circles, seen from the head",
    drivers=lambda time: {"worm_angle": one_turn(np.radians(-70))(time)},
    truth=truth,
)
