"""Crank and slotted lever: the lever's direction is the crank pin's, the link's follows."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

CRANK, DISTANCE, LEVER, LINK = 0.10, 0.20, 0.40, 0.15
HEIGHT = LEVER * (1 + np.sqrt(1 - (CRANK / DISTANCE) ** 2)) / 2


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = 1j * DISTANCE + Taylor.polar(CRANK, u)
    lever = pin.angle()
    end = Taylor.polar(LEVER, lever)
    link = ((HEIGHT - end.y) / LINK).asin()
    ram = end.x + LINK * link.cos()
    return (
        body("crank", 1j * DISTANCE, u)
        | body("lever", 0, lever)
        | body("link", end, link)
        | body("ram", ram + 1j * HEIGHT, 0)
        | point("crank.A", pin)
        | point("lever.B", end)
        | {"stroke": ram, "block": pin.length()}
    )


def properties(motion):
    """The lever turns back where the crank is square to it: 240° of the crank and 120°."""
    u, omega = motion["crank_angle.position"], motion["lever.omega"]
    moving = np.abs(motion["crank_angle.velocity"]) > 0.1
    to_the_left = np.sin(u) > -CRANK / DISTANCE
    return {"forth for 240° of the crank": ((omega > 0) != to_the_left)[moving].astype(float)}


CASE = Case(
    source="closed form: polar coordinates of the crank's pin; time ratio 2 : 1",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(30))(time)},
    truth=truth,
    properties=properties,
)
