"""Rack drive: a slider–crank moves the carriage, the upper rack goes twice as far."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

CRANK, ROD, PINION = 0.060, 0.200, 0.030


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = Taylor.polar(CRANK, u)
    rod = (-1 / ROD * pin.y).asin()
    carriage = pin.x + ROD * rod.cos()
    return (
        body("crank", 0, u)
        | body("rod", pin, rod)
        | body("carriage", carriage, 0)
        | body("pinion", carriage, -1 / PINION * carriage)
        | body("rack", 2 * carriage + 1j * PINION, 0)
        | {"stroke": 2 * carriage}
    )


CASE = Case(
    source="closed form: slider–crank, doubled",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(50))(time)},
    truth=truth,
)
