"""Bonnet hinge: with the bonnet's angle known, its rear pin is where two circles meet."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import apex, body, point
from .taylor import Taylor

REAR, FRONT = 0.200, 0.220
PIVOT, PROP = 0.150 + 0.030j, -0.200 - 0.050j
SECOND_PIN, EDGE, REAR_EDGE, CENTER = 0.080 + 0.030j, 1.10 - 0.10j, -0.15 + 0.05j, 0.50
ON_LINK = 0.16
MASS, INERTIA, G = 16.0, 1.9, 9.81
FORCE, FULL, RATE = 600.0, 0.34, 900.0


def geometry(u: Taylor):
    """The rear pin, the turn of the bonnet, and the gas spring from the car to the rear link."""
    turn = Taylor.polar(1, u)
    pin = apex(0, PIVOT - turn * SECOND_PIN, REAR, FRONT, +1)
    return pin, turn, pin * (ON_LINK / REAR) - PROP


def truth(_time, drivers):
    u = drivers["opening"]
    pin, turn, gas = geometry(u)
    return (
        body("rear_link", 0, pin.angle())
        | body("front_link", PIVOT, (pin + turn * SECOND_PIN - PIVOT).angle())
        | body("bonnet", pin, u)
        | point("bonnet.edge", pin + turn * EDGE)
        | point("bonnet.rear_edge", pin + turn * REAR_EDGE)
        | {"gas_length": gas.length()}
    )


def properties(motion):
    """Virtual work: the hand's torque is what weight, inertia and gas spring ask for per radian."""
    pin, turn, gas = geometry(Taylor.time(motion["opening.position"]))
    centre, length = pin + turn * CENTER, gas.length()
    omega, alpha = motion["opening.velocity"], motion["opening.acceleration"]
    needed = MASS * (centre.first * alpha + centre.second * omega**2 + 1j * G)
    force = FORCE + RATE * (FULL - length.value)
    effort = INERTIA * alpha + (np.conj(centre.first) * needed).real - force * length.first
    return {
        "gas spring": (motion["gas_spring.effort"] - force) / FORCE,
        "effort": (motion["opening.effort"] - effort) / (MASS * G),
    }


CASE = Case(
    source="closed form: intersection of two circles; virtual work",
    drivers=lambda time: {"opening": swing(np.radians(22.5), np.radians(20))(time)},
    truth=truth,
    properties=properties,
)
