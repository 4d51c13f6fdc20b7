"""Four-bar linkage moved by its weight: closed-form positions, one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import apex, body, point
from .taylor import Taylor

CRANK, COUPLER, ROCKER, BASE = 0.10, 0.25, 0.30, 0.40
FRICTION = 0.02


def pose(crank):
    """The crank's pin, the coupler's angle and the rocker's."""
    pin = Taylor.polar(CRANK, crank)
    top = apex(pin, BASE, COUPLER, ROCKER, +1)
    return pin, (top - pin).angle(), (top - BASE).angle()


def masses(z, _time):
    pin, coupler, rocker = pose(z[0])
    return [
        mass_on(2.0, 0.008, 0.0, z[0], 0),
        mass_on(0.5, 0.003, pin, coupler, 0.12 + 0.02j),
        mass_on(0.8, 0.006, BASE, rocker, 0.15),
    ]


def loads(z, _time):
    _, _, rocker = pose(z[0])
    return [(rocker, -FRICTION * rocker.first)]


MOTION = free_motion(masses, start=[np.radians(60)], velocity=[12.0], loads=loads)


def truth(time, _drivers):
    (crank,) = MOTION(time)
    pin, coupler, rocker = pose(crank)
    return {
        **body("crank", 0.0, crank),
        **body("coupler", pin, coupler),
        **body("rocker", BASE, rocker),
        **point("coupler.P", pin + Taylor.polar(COUPLER / 2 + 0.05j, coupler)),
        "crank_angle": crank,
    }


CASE = Case(
    source="circle intersection; equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    limits=LIMITS,
)
