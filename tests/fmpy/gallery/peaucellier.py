"""Peaucellier–Lipkin linkage: the straight line, and everything else by inversion."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, swing
from .plane import apex, body, point
from .taylor import Taylor

ARM, SIDE, BASE = 0.25, 0.10, 0.11
POWER = ARM**2 - SIDE**2
LINE = POWER / (2 * BASE)


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    # The triangle O–K–Q is isosceles: OQ has half the crank's direction, and so has OP.
    half = 0.5 * crank
    inner = 2 * BASE * half.cos()
    outer = LINE / half.cos()
    o = Taylor.of(0.0)
    q = BASE + Taylor.polar(BASE, crank)
    height = LINE * half.sin() / half.cos()
    p = LINE + 1j * height
    a, b = apex(o, q, ARM, SIDE, +1), apex(o, q, ARM, SIDE, -1)
    return {
        **body("crank", BASE, crank),
        **body("arm_A", o, a.angle()),
        **body("arm_B", o, b.angle()),
        **body("inner_A", q, (a - q).angle()),
        **body("inner_B", q, (b - q).angle()),
        **body("outer_A", a, (p - a).angle()),
        **body("outer_B", b, (p - b).angle()),
        **point("crank.Q", q),
        **point("outer_A.P", p),
        "line": Taylor.of(LINE),
        "stroke": height,
        "inner": inner,
        "outer": outer,
    }


def properties(motion: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {
        "P on the straight line": motion["outer_A.P.x"] / LINE - 1,
        "P keeps to the line": motion["outer_A.P.vx"],
        "OQ times OP": motion["inner.position"] * motion["outer.position"] / POWER - 1,
    }


CASE = Case(
    source="exact straight line; closed form: inversion in a circle",
    drivers=lambda time: {"crank_angle": swing(0.0, np.radians(85))(time)},
    truth=truth,
    properties=properties,
)
