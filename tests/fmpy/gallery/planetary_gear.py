"""Planetary gear: Willis' equation over four turns of the sun, one of the arm."""

from __future__ import annotations

import numpy as np

from . import Case
from .plane import body, point
from .taylor import Taylor

MODULE, SUN, PLANET = 0.002, 24, 24
RING = SUN + 2 * PLANET


def truth(_time, drivers):
    u = drivers["sun_angle"]
    arm = u * (SUN / (SUN + RING))
    planet = arm * (1 - RING / PLANET)
    pin = Taylor.polar(MODULE * (SUN + PLANET) / 2, arm)
    return (
        body("sun", 0, u)
        | body("arm", 0, arm)
        | body("planet", pin, planet)
        | point("planet.tooth", pin + Taylor.polar(MODULE * PLANET / 2, planet))
    )


CASE = Case(
    source="Willis' equation, four turns",
    drivers=lambda time: {"sun_angle": 4 * (np.pi * time - (np.pi * time).sin())},
    truth=truth,
)
