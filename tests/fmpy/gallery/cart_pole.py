"""Cart with a pole that falls: Lagrange's equations in travel and lean, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body, point
from .taylor import Taylor

CART, POLE, LENGTH, FRICTION = 1.0, 0.2, 0.6, 0.1


def masses(z, _time):
    travel, phi = z[0], z[1] + np.pi / 2
    return [
        mass_on(CART, 0.0, travel, 0.0, 0),
        mass_on(POLE, POLE * LENGTH**2 / 12, travel, phi, LENGTH / 2),
    ]


MOTION = free_motion(
    masses,
    start=[0.0, np.radians(-10)],
    velocity=[0.0, 0.0],
    loads=lambda z, _: [(z[0], -FRICTION * z[0].first)],
)


def truth(time, _drivers):
    travel, lean = MOTION(time)
    phi = lean + np.pi / 2
    still = Taylor(*(np.zeros_like(time.value) for _ in range(3)))
    return {
        **body("cart", travel, still),
        **body("pole", travel, phi),
        **point("pole.tip", travel + Taylor.polar(LENGTH, phi)),
        "travel": travel,
        "lean": lean,
    }


CASE = Case(
    source="Lagrange's equations, integrated",
    drivers=lambda time: {},
    truth=truth,
    duration=4.0,
    limits=LIMITS,
)
