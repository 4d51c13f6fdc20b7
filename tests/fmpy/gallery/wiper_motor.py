"""Wiper by its voltage: two circle intersections; one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import apex, body
from .taylor import Taylor

CRANK, ROD, LEFT, RIGHT, SPAN = 0.045, 0.300, 0.060, 0.055, 0.550
MOTOR = 0.30 - 0.05j
VOLTAGE, CONSTANT, RESISTANCE, RUBBER = 12.0, 1.4, 0.9, 0.6


def pose(u):
    """The pins of the crank and of both levers."""
    a = MOTOR + Taylor.polar(CRANK, u)
    left = apex(a, 0, ROD, LEFT, +1)
    return a, left, apex(left, SPAN, SPAN, RIGHT, -1)


def masses(z, _time):
    a, left, right = pose(z[0])
    return [
        mass_on(0.2, 0.006, MOTOR, z[0], 0),
        mass_on(0.15, 0.0012, a, (left - a).angle(), ROD / 2),
        mass_on(0.5, 0.015, 0, left.angle(), -0.25),
        mass_on(0.25, 0.006, left, (right - left).angle(), SPAN / 2),
        mass_on(0.45, 0.012, SPAN, (right - SPAN).angle(), -0.22),
    ]


def loads(z, _time):
    _, left, right = pose(z[0])
    shafts = [left.angle(), (right - SPAN).angle()]
    torque = CONSTANT * (VOLTAGE - CONSTANT * z[0].first) / RESISTANCE
    return [(z[0], torque)] + [(shaft, -RUBBER * shaft.first) for shaft in shafts]


MOTION = free_motion(
    masses, start=[np.radians(30)], velocity=[0.0], loads=loads, gravity=-4j
)


def truth(time, _drivers):
    (u,) = MOTION(time)
    a, left, right = pose(u)
    return (
        body("crank", MOTOR, u)
        | body("rod", a, (left - a).angle())
        | body("left", 0, left.angle())
        | body("second_rod", left, (right - left).angle())
        | body("right", SPAN, (right - SPAN).angle())
        | {"motor_angle": u}
    )


CASE = Case(
    source="two circle intersections; equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    limits=LIMITS,
)
