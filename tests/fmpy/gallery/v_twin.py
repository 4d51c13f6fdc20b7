"""V-twin engine: two slider–cranks on one crank pin."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, one_turn
from .plane import body
from .taylor import Taylor

THROW, ROD = 0.033, 0.125
BORES = {"right": np.radians(45), "left": np.radians(135)}


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    pin = Taylor.polar(THROW, crank)
    motion = body("crank", 0.0, crank)
    for side, bore in BORES.items():
        # Along and across the bore; the rod brings the pin's way across back to zero.
        along, across = THROW * (crank - bore).cos(), THROW * (crank - bore).sin()
        lean = (-1 / ROD * across).asin()
        travel = along + ROD * lean.cos()
        motion |= body(f"{side}_rod", pin, bore + lean)
        motion |= body(f"{side}_piston", travel * np.exp(1j * bore), bore)
        motion[f"{side}_travel"] = travel
    return motion


CASE = Case(
    source="closed form: law of sines in each crank triangle",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(90))(time)},
    truth=truth,
)
