"""Planar 3-RPR platform: the platform's motion is chosen, the legs' lengths follow.

The other way round there is no closed form: three lengths belong to up to six poses.
"""

from __future__ import annotations

import numpy as np

from . import Case, Truth, one_turn
from .plane import body
from .taylor import Taylor

FRAME, PLATFORM = 0.40, 0.12
CORNERS = np.exp(1j * np.radians([-150, -30, 90]))
DURATION, STEPS = 2.0, 720


def pose(time: Taylor) -> tuple[Taylor, Taylor]:
    """The platform's centre, once round an ellipse, and its angle, twice to and fro meanwhile."""
    turn = one_turn(0.0)(time)
    return 0.15 * turn.cos() + 0.10j * turn.sin(), np.radians(60) + 0.4 * (2 * turn).sin()


def legs(time: Taylor) -> list[Taylor]:
    """From the frame's pivots to the platform's."""
    centre, phi = pose(time)
    return [centre + Taylor.polar(PLATFORM * corner, phi) - FRAME * corner for corner in CORNERS]


def drivers(time: Taylor) -> dict[str, Taylor]:
    return {f"length_{i}": leg.length() for i, leg in enumerate(legs(time), start=1)}


def sent(given: dict[str, Taylor]) -> Taylor:
    """The times, among those at which inputs are sent, to which these lengths belong."""
    time = Taylor.time(np.linspace(0, DURATION, STEPS + 1))
    apart = sum(
        abs(given[name].value[:, np.newaxis] - lengths.value)
        for name, lengths in drivers(time).items()
    )
    return Taylor.time(time.value[np.argmin(apart, axis=1)])


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    # A value held over a step belongs to the time at which it was sent.
    time = sent(drivers)
    centre, phi = pose(time)
    motion = body("platform", centre, phi) | {"rotation": phi}
    for i, (corner, leg) in enumerate(zip(CORNERS, legs(time), strict=True), start=1):
        motion |= body(f"leg_{i}", FRAME * corner, leg.angle())
    return motion


CASE = Case(
    source="platform led along a chosen motion; inputs by inverse kinematics",
    drivers=drivers,
    truth=truth,
    duration=DURATION,
    steps=STEPS,
)
