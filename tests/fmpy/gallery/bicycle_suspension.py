"""Bicycle suspension: an arcsine for the swingarm, one circle intersection for the rocker."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import apex, body, point
from .taylor import Taylor

ARM, ROD, ROCKER, SHOCK = 0.430, 0.180, 0.100, 0.070
PIVOT, EYE, LUG = 0.02 + 0.21j, 0.22 + 0.10j, 0.16 - 0.06j
FREE, STIFFNESS, DAMPING = 0.265, 60000.0, 1500.0


def geometry(u: Taylor):
    """Angles of swingarm and rocker, and the shock from the frame to the rocker."""
    swingarm = np.pi - (u / ARM).asin()
    rocker = (apex(Taylor.polar(1, swingarm) * LUG, PIVOT, ROD, ROCKER, +1) - PIVOT).angle()
    lever = Taylor.polar(1, rocker) * (SHOCK * np.exp(-1j * np.radians(110)))
    return swingarm, rocker, PIVOT + lever - EYE


def truth(_time, drivers):
    swingarm, rocker, shock = geometry(drivers["travel"])
    return (
        body("swingarm", 0, swingarm)
        | body("rocker", PIVOT, rocker)
        | point("swingarm.axle", Taylor.polar(ARM, swingarm))
        | {"shock_length": shock.length()}
    )


def properties(motion):
    """Virtual work: wheel force times travel is what the shock takes up; their ratio is the
    leverage."""
    length = geometry(Taylor.time(motion["travel.position"]))[2].length()
    force = STIFFNESS * (FREE - length.value)
    force = force - DAMPING * length.first * motion["travel.velocity"]
    largest = np.max(np.abs(force))
    return {
        "shock": (motion["shock.effort"] - force) / largest,
        "wheel force": (motion["travel.effort"] + force * length.first) / largest,
    }


CASE = Case(
    source="closed form: arcsine, one circle intersection; virtual work",
    drivers=lambda time: {"travel": swing(0.005, 0.07)(time)},
    truth=truth,
    properties=properties,
)
