"""Pendulum that swings by its weight: its one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body, point
from .taylor import Taylor

LENGTH, MASS = 0.5, 1.2


def centre(swing):
    return Taylor.polar(LENGTH / 2, swing - np.pi / 2)


MOTION = free_motion(
    lambda z, _: [mass_on(MASS, MASS * LENGTH**2 / 12, centre(z[0]), z[0] - np.pi / 2, 0)],
    start=[np.radians(120)],
    velocity=[0.0],
)


def truth(time, _drivers):
    (swing,) = MOTION(time)
    at = centre(swing)
    return body("rod", at, swing - np.pi / 2) | point("rod.P", at * 2) | {"swing": swing}


CASE = Case(
    source="equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    duration=4.0,
    limits=LIMITS,
)
