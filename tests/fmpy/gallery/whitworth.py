"""Whitworth quick return: the lever's direction is the crank pin's, the rod's follows."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

CRANK, ECCENTRICITY, ARM, ROD = 0.10, 0.05, 0.08, 0.25


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = 1j * ECCENTRICITY + Taylor.polar(CRANK, u)
    lever = pin.angle()
    end = Taylor.polar(-ARM, lever)
    rod = (-end.y / ROD).asin()
    ram = end.x + ROD * rod.cos()
    return (
        body("crank", 1j * ECCENTRICITY, u)
        | body("lever", 0, lever)
        | body("rod", end, rod)
        | body("ram", ram, 0)
        | point("crank.A", pin)
        | point("lever.B", end)
        | {"stroke": ram, "block": pin.length()}
    )


def properties(motion):
    """The ram turns back where the lever is level: 240° of the crank forth and 120° back."""
    u, v = motion["crank_angle.position"], motion["ram.vx"]
    moving = np.abs(motion["crank_angle.velocity"]) > 0.1
    forth = np.sin(u) > -ECCENTRICITY / CRANK
    return {"forth for 240° of the crank": ((v > 0) != forth)[moving].astype(float)}


CASE = Case(
    source="closed form: polar coordinates of the crank's pin; time ratio 2 : 1",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(60))(time)},
    truth=truth,
    properties=properties,
)
