"""Double pendulum: Lagrange's equations in its two angles, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body, point
from .taylor import Taylor

UPPER, LOWER = 0.4, 0.3


def pose(z):
    """The angles of both rods, the elbow and the end."""
    upper = z[0] - np.pi / 2
    lower = upper + z[1]
    elbow = Taylor.polar(UPPER, upper)
    return upper, lower, elbow, elbow + Taylor.polar(LOWER, lower)


def masses(z, _time):
    upper, lower, elbow, _ = pose(z)
    return [
        mass_on(1.0, UPPER**2 / 12, 0.0, upper, UPPER / 2),
        mass_on(0.6, 0.6 * LOWER**2 / 12, elbow, lower, LOWER / 2),
    ]


MOTION = free_motion(masses, start=[np.radians(80), np.radians(20)], velocity=[0.0, 0.0])


def truth(time, _drivers):
    z = MOTION(time)
    upper, lower, elbow, end = pose(z)
    return {
        **body("upper", 0.0, upper),
        **body("lower", elbow, lower),
        **point("upper.A", elbow),
        **point("lower.P", end),
        "shoulder": z[0],
        "elbow": z[1],
    }


CASE = Case(
    source="Lagrange's equations, integrated",
    drivers=lambda time: {},
    truth=truth,
    limits=LIMITS,
)
