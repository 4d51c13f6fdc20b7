"""Screw jack: the lift is the pitch times the turns, the work at the handle is that of the load."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body

PITCH, LOWEST, PIVOT = 0.006, 0.200, 0.06
LOAD, HEAD, INERTIA, G = 20e3, 40.0, 0.04, 9.81
PER_RADIAN = PITCH / (2 * np.pi)


def truth(_time, drivers):
    u = drivers["turn"]
    lift = LOWEST + PER_RADIAN * u
    return body("handle", 1j * PIVOT, u) | body("head", 1j * lift, 0) | {"lift": lift}


def properties(motion):
    """The thread bears load, weight and inertia of the head; the handle does its work."""
    alpha = motion["turn.acceleration"]
    borne = LOAD + HEAD * (G + PER_RADIAN * alpha)
    torque = PER_RADIAN * LOAD
    return {
        "effort": (motion["turn.effort"] - INERTIA * alpha - PER_RADIAN * borne) / torque,
        "inertia": motion["turn.inertia"] / (INERTIA + HEAD * PER_RADIAN**2) - 1,
        "thread": (motion["thread.effort"] - borne) / LOAD,
        "thread along the lift": (motion["thread.lift.effort"] - borne) / LOAD,
        "thread along the turn": (motion["thread.turn.effort"] + PER_RADIAN * borne) / torque,
    }


CASE = Case(
    source="closed form: pitch by turns, ten turns; virtual work",
    drivers=lambda time: {"turn": 10 * one_turn(0)(time)},
    truth=truth,
    properties=properties,
)
