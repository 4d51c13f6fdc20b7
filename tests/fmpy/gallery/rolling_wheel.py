"""Rolling wheel: the angle is the way divided by the radius, the rim draws a cycloid."""

from __future__ import annotations

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

RADIUS = 0.300


def truth(_time, drivers):
    u = drivers["travel"]
    centre = u + 1j * RADIUS
    phi = -1 / RADIUS * u
    return (
        body("wheel", centre, phi)
        | point("wheel.rim", centre - 1j * Taylor.polar(RADIUS, phi))
        | point("wheel.spoke", centre + Taylor.polar(RADIUS / 2, phi))
    )


CASE = Case(
    source="closed form: cycloid",
    drivers=lambda time: {"travel": RADIUS * one_turn(0)(time)},
    truth=truth,
)
