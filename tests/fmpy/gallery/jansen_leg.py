"""Theo Jansen's leg."""

from __future__ import annotations

from . import Case, Truth, one_turn
from .plane import apex, body, point
from .taylor import Taylor

A, B, C, D, E, F = 0.0380, 0.0415, 0.0393, 0.0401, 0.0558, 0.0394
G, H, I, J, K, L, M = 0.0367, 0.0657, 0.0490, 0.0500, 0.0619, 0.0078, 0.0150


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    pivot = Taylor.of(-A - 1j * L)
    pin = Taylor.polar(M, crank)
    upper = apex(pivot, pin, B, J, +1)
    lower = apex(pin, pivot, K, C, +1)
    left = apex(pivot, upper, D, E, +1)
    knee = apex(lower, left, G, F, +1)
    toe = apex(lower, knee, I, H, +1)
    return {
        **body("crank", 0.0, crank),
        **body("upper_rod", pin, (upper - pin).angle()),
        **body("lower_rod", pin, (lower - pin).angle()),
        **body("shoulder", pivot, (upper - pivot).angle()),
        **body("lower_bar", pivot, (lower - pivot).angle()),
        **body("tendon", left, (knee - left).angle()),
        **body("foot", lower, (knee - lower).angle()),
        **point("foot.toe", toe),
        "stride": toe.x,
        "height": toe.y,
    }


CASE = Case(
    source="closed form: five circle intersections",
    drivers=lambda time: {"crank_angle": one_turn(0.0)(time)},
    truth=truth,
)
