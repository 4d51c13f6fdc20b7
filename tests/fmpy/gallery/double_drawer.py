"""Drawer with double extension: the rail goes half the way; moments at the slides."""

from __future__ import annotations

from . import Case, swing
from .plane import body

DEPTH, HEIGHT = 0.500, 0.160
DRAWER, RAIL, G = 18.0, 1.6, 9.81


def truth(_time, drivers):
    u = drivers["travel"]
    return body("rail", u / 2, 0) | body("drawer", u, 0) | {"rail_travel": u / 2}


def properties(motion):
    """The cable pulls the rail along; each slide bears the weights in front of it."""
    u, a = motion["travel.position"], motion["travel.acceleration"]
    weight = DRAWER * G
    at_drawer = weight * DEPTH / 2 - DRAWER * a * 0.2 * HEIGHT
    at_rail = at_drawer + weight * u / 2 + RAIL * G * 0.45 * DEPTH
    return {
        "effort": (motion["travel.effort"] - (DRAWER + RAIL / 4) * a) / weight,
        "inertia": motion["travel.inertia"] / (DRAWER + RAIL / 4) - 1,
        "cable at the rail": (motion["cable.rail_travel.effort"] - RAIL * a / 2) / weight,
        "cable at the drawer": (motion["cable.travel.effort"] + RAIL * a / 4) / weight,
        "slide": (motion["slide.fy"] - weight) / weight,
        "moment at the slide": (motion["slide.torque"] - at_drawer) / (weight * DEPTH),
        "cabinet": (motion["cabinet.fy"] - weight - RAIL * G) / weight,
        "moment at the cabinet": (motion["cabinet.torque"] - at_rail) / (weight * DEPTH),
    }


CASE = Case(
    source="closed form: half the way; statics of the slides",
    drivers=lambda time: {"travel": swing(DEPTH / 2, DEPTH / 2)(time)},
    truth=truth,
    properties=properties,
)
