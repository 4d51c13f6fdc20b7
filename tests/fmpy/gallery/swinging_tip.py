"""Arm that swings on a driven crank: its one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body, point
from .taylor import Taylor

CRANK, ARM, DAMPING = 0.20, 0.35, 0.004


def pose(swing, time):
    """The crank's motion, its angle, its pin and the arm's angle."""
    motion = 0.6 * (4.0 * time).sin()
    crank = motion - np.pi / 2
    return motion, crank, Taylor.polar(CRANK, crank), crank + swing


def masses(z, time):
    _, crank, pin, arm = pose(z[0], time)
    return [mass_on(1.0, 0.01, 0.0, crank, 0.1), mass_on(0.4, 0.004, pin, arm, 0.2)]


MOTION = free_motion(
    masses,
    start=[np.radians(20)],
    velocity=[1.0],
    loads=lambda z, _: [(z[0], -DAMPING * z[0].first)],
)


def truth(time, _drivers):
    (swing,) = MOTION(time)
    motion, crank, pin, arm = pose(swing, time)
    return {
        **body("crank", 0.0, crank),
        **body("arm", pin, arm),
        **point("arm.tip", pin + Taylor.polar(ARM, arm)),
        "crank_angle": motion,
        "swing": swing,
    }


CASE = Case(
    source="equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    duration=4.0,
    limits=LIMITS,
)
