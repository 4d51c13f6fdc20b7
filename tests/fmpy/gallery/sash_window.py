"""Sash window: tangents and arcs of the cord, the counterweight straight below its pulley."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body
from .taylor import Taylor

LENGTH, RADIUS = 2.10, 0.040
FIRST, SECOND = 0.07 + 1.60j, 0.30 + 1.60j
SASH, WEIGHT, G = 10.0, 9.5, 9.81


def geometry(lift: Taylor):
    """The length and direction of the cord at the sash, and the height of the counterweight."""
    way = FIRST - 1j * lift
    distance = way.length()
    tangent = (distance.square() - RADIUS**2).sqrt()
    # The pulley is on the right of the cord: seen from the sash the cord passes on its left.
    direction = way.angle() + (RADIUS / distance).asin()
    # To the right along the line between the pulleys, then down.
    arcs = RADIUS * (direction + np.pi / 2)
    return direction, SECOND.imag - (LENGTH - tangent - arcs - (SECOND - FIRST).real)


def truth(_time, drivers):
    lift = drivers["lift"]
    _, height = geometry(lift)
    return (
        body("sash", 1j * lift, 0)
        | body("weight", SECOND.real + RADIUS + 1j * height, 0)
        | {"height": height}
    )


def properties(motion):
    """The counterweight hangs on the cord; the hand lifts what the cord leaves of the sash."""
    lift = Taylor(*(motion[f"lift.{o}"] for o in ("position", "velocity", "acceleration")))
    direction, height = geometry(lift)
    tension = WEIGHT * (height.second + G)
    effort = SASH * (lift.second + G) - tension * np.sin(direction.value)
    return {
        "tension": (motion["cord.tension"] - tension) / (WEIGHT * G),
        "effort": (motion["lift.effort"] - effort) / (WEIGHT * G),
    }


CASE = Case(
    source="closed form: tangent and arcs; equilibrium",
    drivers=lambda time: {"lift": swing(0.85, 0.35)(time)},
    truth=truth,
    properties=properties,
)
