"""Andrews' squeezing mechanism as published: Lagrange's equation in the motor's angle, integrated.

The truth, to which the FMU is held all the way, is itself held to the published end.
"""

from __future__ import annotations

import numpy as np

from . import Case
from .andrews import ANGLES, DURATION, END, START, solve
from .free import LIMITS, free_motion, mass_on

TORQUE, STIFFNESS, FREE = 0.033, 4530.0, 0.07785

#: The published end has nine right digits: it misses its own energy balance by 2e-10 J.
PUBLISHED = 2e-9


def masses(z, _time):
    outputs, _ = solve(z[0])

    def of(name, mass, inertia, centre):
        origin = outputs[f"{name}.x"] + 1j * outputs[f"{name}.y"]
        return mass_on(mass, inertia, origin, outputs[f"{name}.phi"], centre)

    return [
        of("K1", 0.04325, 2.194e-6, 0.00092),
        of("K2", 0.00365, 4.410e-7, -0.0115),
        of("K3", 0.02373, 5.255e-6, 0.01043 - 0.01874j),
        of("K4", 0.00706, 5.667e-7, -0.00579j),
        of("K5", 0.07050, 1.169e-5, 0.02308 + 0.00916j),
        of("K6", 0.00706, 5.667e-7, 0.00579),
        of("K7", 0.05498, 1.912e-5, -0.00449 - 0.01228j),
    ]


def loads(z, _time):
    outputs, _ = solve(z[0])
    spring = outputs["spring"]
    return [(z[0], np.array([TORQUE])), (spring, -STIFFNESS * (spring.value - FREE))]


MOTION = free_motion(masses, start=[START.value[0]], velocity=[0.0], loads=loads, gravity=0.0)


def truth(time, _drivers):
    (beta,) = MOTION(time)
    outputs, angles = solve(beta)
    found = [angles[name].value[-1] for name in ANGLES]
    np.testing.assert_allclose(found, END.value, rtol=0, atol=PUBLISHED * END.value[0])
    return outputs | {"beta": beta}


CASE = Case(
    source="published figures at the end; Lagrange's equation, integrated",
    drivers=lambda time: {},
    truth=truth,
    duration=DURATION,
    limits=LIMITS,
)
