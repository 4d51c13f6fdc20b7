"""Slider-crank without torque: it falls against the oil; closed form, one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body
from .taylor import Taylor

CRANK, ROD, OIL = 0.05, 0.15, 60.0


def pose(crank):
    """The crank's pin, the rod's angle, the stroke."""
    pin = Taylor.polar(CRANK, crank)
    across = (ROD**2 - pin.y.square()).sqrt()
    return pin, Taylor.atan2(-pin.y, across), pin.x + across


def masses(z, _time):
    pin, rod, stroke = pose(z[0])
    return [
        mass_on(1.5, 0.004, 0.0, z[0], 0),
        mass_on(0.3, 8e-4, pin, rod, 0.06),
        mass_on(0.5, 0.0, stroke, 0.0, 0),
    ]


def loads(z, _time):
    _, _, stroke = pose(z[0])
    return [(stroke, -OIL * stroke.first)]


MOTION = free_motion(masses, start=[np.radians(45)], velocity=[0.0], loads=loads)


def truth(time, _drivers):
    (crank,) = MOTION(time)
    pin, rod, stroke = pose(crank)
    still = Taylor(*(np.zeros_like(time.value) for _ in range(3)))
    return {
        **body("crank", 0.0, crank),
        **body("connecting_rod", pin, rod),
        **body("slider", stroke, still),
        "crank_angle": crank,
        "stroke": stroke,
    }


CASE = Case(
    source="right triangle; equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    limits=LIMITS,
)
