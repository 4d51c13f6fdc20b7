"""Five-bar linkage with two free cranks: circle intersection, Lagrange's equations, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import apex, body, point
from .taylor import Taylor

BASE, LEFT, RIGHT, LINK = 0.30, 0.12, 0.10, 0.30
STIFFNESS, FRICTION = 60.0, 0.01


def pose(z):
    """The pins of the cranks, the pin between the links, the angles of the links."""
    a = Taylor.polar(LEFT, z[0])
    b = BASE + Taylor.polar(RIGHT, z[1])
    c = apex(a, b, LINK, LINK, +1)
    return a, b, c, (c - a).angle(), (c - b).angle()


def masses(z, _time):
    a, b, _, left_link, right_link = pose(z)
    return [
        mass_on(0.8, 0.002, 0.0, z[0], LEFT / 2 + 0.01j),
        mass_on(0.6, 0.0015, BASE, z[1], RIGHT / 2),
        mass_on(0.3, 0.3 * LINK**2 / 12, a, left_link, LINK / 2),
        mass_on(0.3, 0.3 * LINK**2 / 12, b, right_link, LINK / 2),
    ]


def loads(z, _time):
    a, b, *_ = pose(z)
    length = (b - a).length()
    return [
        (length, -STIFFNESS * (length.value - BASE)),
        (z[0], -FRICTION * z[0].first),
        (z[1], -FRICTION * z[1].first),
    ]


MOTION = free_motion(
    masses, start=[np.radians(100), np.radians(60)], velocity=[0.0, 0.0], loads=loads
)


def truth(time, _drivers):
    z = MOTION(time)
    a, b, c, left_link, right_link = pose(z)
    return {
        **body("left_crank", 0.0, z[0]),
        **body("right_crank", BASE, z[1]),
        **body("left_link", a, left_link),
        **body("right_link", b, right_link),
        **point("left_link.C", c),
        "left_angle": z[0],
        "right_angle": z[1],
        "opening": right_link - left_link,
    }


CASE = Case(
    source="circle intersection; Lagrange's equations, integrated",
    drivers=lambda time: {},
    truth=truth,
    limits=LIMITS,
)
