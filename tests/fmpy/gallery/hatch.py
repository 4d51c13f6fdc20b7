"""Hatch with a gas spring: one body on a hinge, its forces in closed form."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body, point
from .taylor import Taylor

P, Q, CENTER, EDGE = -0.05 - 0.42j, 0.14 - 0.02j, 0.52 + 0.05j, 0.95
MASS, INERTIA, G = 18.0, 1.6, 9.81
FORCE, FULL, VOLUME, DAMPING = 400.0, 0.50, 0.60, 60.0


def truth(_time, drivers):
    u = drivers["opening"]
    turn = Taylor.polar(1, u)
    length = (turn * Q - P).length_squared().sqrt()
    return body("hatch", 0, u) | point("hatch.edge", turn * EDGE) | {"gas_length": length}


def properties(motion):
    """Moments about the hinge; the hinge bears the rest of the force."""
    u = motion["opening.position"]
    turn = np.exp(1j * u)
    arm, span = turn * Q, turn * Q - P
    length = np.abs(span)
    force = FORCE * (VOLUME / (VOLUME - FULL + length)) ** 1.2
    force = force - DAMPING * motion["gas_length.velocity"]
    push = force * span / length
    centre = turn * CENTER
    omega, alpha = motion["opening.velocity"], motion["opening.acceleration"]
    needed = MASS * ((1j * alpha - omega**2) * centre + 1j * G)

    def moment(at, force):
        return (np.conj(at) * force).imag

    effort = INERTIA * alpha + moment(centre, needed) - moment(arm, push)
    hinge = needed - push
    largest = MASS * G
    return {
        "gas spring": (motion["gas_spring.effort"] - force) / FORCE,
        "effort": (motion["opening.effort"] - effort) / largest,
        "inertia": motion["opening.inertia"] / (INERTIA + MASS * abs(CENTER) ** 2) - 1,
        "hinge along x": (motion["hinge.fx"] - hinge.real) / FORCE,
        "hinge along y": (motion["hinge.fy"] - hinge.imag) / FORCE,
    }


CASE = Case(
    source="closed form; moments about the hinge",
    drivers=lambda time: {"opening": swing(np.radians(-27), np.radians(50))(time)},
    truth=truth,
    properties=properties,
)
