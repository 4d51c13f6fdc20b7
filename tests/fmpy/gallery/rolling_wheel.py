"""Rolling wheel: the way is the angle times the radius, the rim draws a cycloid."""

from __future__ import annotations

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

RADIUS = 0.300


def truth(_time, drivers):
    phi = drivers["turn"]
    centre = 1j * RADIUS - RADIUS * phi
    return (
        body("wheel", centre, phi)
        | point("wheel.rim", centre - 1j * Taylor.polar(RADIUS, phi))
        | point("wheel.spoke", centre + Taylor.polar(RADIUS / 2, phi))
    )


CASE = Case(
    source="closed form: cycloid",
    drivers=lambda time: {"turn": one_turn(0)(time)},
    truth=truth,
)
