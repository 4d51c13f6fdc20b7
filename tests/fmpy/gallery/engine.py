"""Two-stroke engine: the slider–crank's closed form, and its forces by virtual power."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

R, L, CLEARANCE = 0.030, 0.110, 0.008
AREA, PRESSURE, EXPONENT, HEAT = 0.0025, 1e5, 1.3, 2.5
G = 9.81


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = Taylor.polar(R, u)
    phi = -(pin.y / L).asin()
    travel = pin.x + L * phi.cos()
    return (
        body("crank", 0, u) | body("rod", pin, phi) | body("piston", travel, 0) | {"travel": travel}
    )


def gas(motion):
    """The force of the gas along x."""
    stroke = HEAT * (1 - np.sign(motion["travel.velocity"])) / 2
    length = L + R + CLEARANCE - motion["travel.position"]
    return -AREA * PRESSURE * (1 + stroke) * ((2 * R + CLEARANCE) / length) ** EXPONENT


def properties(motion):
    """The effort is the virtual power of inertias, weights and gas per unit velocity of the crank;
    the cylinder bears no force along its axis; the piston's pin bears what the piston needs."""
    u = motion["crank_angle.position"]
    along = {"crank_angle": Taylor(u, np.ones_like(u), np.zeros_like(u))}
    real = {
        "crank_angle": Taylor(
            u, motion["crank_angle.velocity"], motion["crank_angle.acceleration"]
        )
    }
    unit, moving = truth(None, along), truth(None, real)
    power = np.zeros_like(u)
    for name, mass, inertia, center in [
        ("crank", 1.2, 0.0012, -0.005),
        ("rod", 0.25, 0.0004, 0.3 * L),
        ("piston", 0.20, 0.0, 0.0),
    ]:

        def centre(of, name=name, center=center):
            phi = of[f"{name}.phi"]
            return of[f"{name}.x"] + center * phi.cos(), of[f"{name}.y"] + center * phi.sin()

        (x, y), (vx, vy) = centre(moving), centre(unit)
        power = power + mass * (x.second * vx.first + (y.second + G) * vy.first)
        power = power + inertia * moving[f"{name}.phi"].second * unit[f"{name}.phi"].first
    force = gas(motion)
    effort = power - force * unit["travel"].first
    return {
        "gas": (motion["gas.effort"] - force) / np.max(np.abs(force)),
        "effort": (motion["crank_angle.effort"] - effort) / np.max(np.abs(effort)),
        "along the cylinder": motion["cylinder.fx"] / np.max(np.abs(force)),
        "piston's pin": (motion["B.fx"] - 0.20 * motion["piston.ax"] + force)
        / np.max(np.abs(force)),
    }


CASE = Case(
    source="closed form; forces by virtual power",
    drivers=lambda time: {"crank_angle": one_turn(np.radians(40))(time)},
    truth=truth,
    properties=properties,
)
