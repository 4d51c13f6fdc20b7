"""Engine that runs by its gas: the slider-crank's closed form, one equation, integrated."""

import numpy as np

from . import Case
from .free import LIMITS, free_motion, mass_on
from .plane import body
from .taylor import Taylor

R, L, CLEARANCE = 0.030, 0.110, 0.008
AREA, PRESSURE, EXPONENT, HEAT, BURNING = 0.0025, 1e5, 1.3, 2.5, 0.3
RESISTANCE = 0.2


def pose(crank):
    """The crank's pin, the rod's angle, the travel."""
    pin = Taylor.polar(R, crank)
    phi = -(pin.y / L).asin()
    return pin, phi, pin.x + L * phi.cos()


def masses(z, _time):
    pin, rod, travel = pose(z[0])
    return [
        mass_on(3.0, 0.06, 0.0, z[0], -0.002),
        mass_on(0.25, 0.0004, pin, rod, 0.3 * L),
        mass_on(0.20, 0.0, travel, 0.0, 0),
    ]


def gas(travel, velocity):
    """The force of the gas along x."""
    burnt = (1 - np.tanh(velocity / BURNING)) / 2
    compression = (2 * R + CLEARANCE) / (L + R + CLEARANCE - travel)
    return -AREA * PRESSURE * (1 + HEAT * burnt) * compression**EXPONENT


def loads(z, _time):
    _, _, travel = pose(z[0])
    return [(z[0], -RESISTANCE * z[0].first), (travel, gas(travel.value, travel.first))]


MOTION = free_motion(masses, start=[np.radians(40)], velocity=[600 * np.pi / 30], loads=loads)


def truth(time, _drivers):
    (crank,) = MOTION(time)
    pin, rod, travel = pose(crank)
    still = Taylor(*(np.zeros_like(time.value) for _ in range(3)))
    return {
        **body("crank", 0.0, crank),
        **body("rod", pin, rod),
        **body("piston", travel, still),
        "crank_angle": crank,
        "travel": travel,
    }


def properties(motion):
    """The effort of the gas; the cylinder bears no force along its axis."""
    force = gas(motion["travel.position"], motion["travel.velocity"])
    size = np.max(np.abs(force))
    return {
        "gas": (motion["gas.effort"] - force) / size,
        "along the cylinder": motion["cylinder.fx"] / size,
    }


CASE = Case(
    source="closed form of the slider–crank; equation of motion, integrated",
    drivers=lambda time: {},
    truth=truth,
    duration=1.0,
    limits=LIMITS,
    properties=properties,
)
