"""Groove cam: the groove's centre goes round, and the roller keeps its distance from it."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

RADIUS, ECCENTRICITY, OFFSET = 0.060, 0.022, 0.010
MASS, INERTIA, G = 0.3, 0.002, 9.81


def travel_of(angle: Taylor) -> Taylor:
    aside = OFFSET - ECCENTRICITY * angle.cos()
    return ECCENTRICITY * angle.sin() + (RADIUS**2 - aside.square()).sqrt()


def truth(_time, drivers):
    angle = drivers["cam_angle"]
    travel = travel_of(angle)
    return body("cam", 0, angle) | body("slide", OFFSET + 1j * travel, 0) | {"travel": travel}


def properties(motion):
    """Virtual work, and the force along the line from the groove's centre to the roller."""
    orders = ("position", "velocity", "acceleration")
    angle = Taylor(*(motion[f"cam_angle.{order}"] for order in orders))
    travel = travel_of(angle)
    lift = MASS * (travel.second + G)
    slope = travel_of(Taylor.time(angle.value)).first
    centre = ECCENTRICITY * np.exp(1j * angle.value)
    normal = (OFFSET + 1j * travel.value - centre) / RADIUS
    return {
        "effort": (motion["cam_angle.effort"] - INERTIA * angle.second - lift * slope)
        / (MASS * G * RADIUS),
        "fx": (motion["groove.fx"] - lift * normal.real / normal.imag) / (MASS * G),
        "fy": (motion["groove.fy"] - lift) / (MASS * G),
    }


CASE = Case(
    source="closed form: slider-crank; virtual work",
    drivers=lambda time: {"cam_angle": one_turn(np.pi / 3)(time)},
    truth=truth,
    properties=properties,
)
