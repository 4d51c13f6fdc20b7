"""Wedge press: the ram's lift is the wedge's feed by the slope, friction that of three contacts."""

from __future__ import annotations

import numpy as np

from . import Case
from .plane import body

ANGLE, FRICTION, LOAD = np.radians(10), 0.12, 5e3
WEDGE, RAM, G = 6.0, 4.0, 9.81
GUIDE, SHANK, SLOPE = 0.12, 0.1, (0.09, 0.005)


def feed(time):
    return {"feed": 0.04 * (2.3 * time).sin() - 0.01}


def truth(_time, drivers):
    u = drivers["feed"]
    tip = SLOPE[1] + (SLOPE[0] + u) * np.tan(ANGLE)
    return body("wedge", u, 0) | body("ram", 1j * tip, 0) | {"lift": tip + SHANK - GUIDE}


def properties(motion):
    """The forces at wedge and ram, with the friction against the motion."""
    friction = FRICTION * np.sign(motion["feed.velocity"])
    acceleration = motion["feed.acceleration"]
    sine, cosine = np.sin(ANGLE), np.cos(ANGLE)
    # The slope's force on the ram along x and y, per unit of its normal force.
    across, along = sine + friction * cosine, cosine - friction * sine
    borne = LOAD + RAM * (G + np.tan(ANGLE) * acceleration)
    normal = borne / (along - friction * np.abs(across))
    pressed = WEDGE * G + normal * along
    effort = normal * across + friction * pressed + WEDGE * acceleration
    return {
        "effort": (motion["feed.effort"] - effort) / LOAD,
        "friction on the bed": (motion["on_bed.effort"] + friction * pressed) / LOAD,
        "friction on the guide": (motion["on_guide.effort"] + friction * normal * np.abs(across))
        / LOAD,
        "friction on the slope": (np.abs(motion["on_slope.effort"]) - np.abs(friction) * normal)
        / LOAD,
    }


CASE = Case(
    source="closed form: a slope; three friction forces",
    drivers=feed,
    truth=truth,
    properties=properties,
)
