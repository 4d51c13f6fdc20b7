"""Hart's inversor: the straight line, and everything else by inversion."""

from __future__ import annotations

import numpy as np

from . import Case, Truth, swing
from .plane import apex, body, point
from .taylor import Taylor

LONG, SHORT, BASE = 0.30, 0.20, 0.07
POWER = (LONG**2 - SHORT**2) / 4
LINE = POWER / (2 * BASE)


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    crank = drivers["crank_angle"]
    # The triangle O–K–P is isosceles: OP has half the crank's direction, and so has OQ.
    half = 0.5 * crank
    o = Taylor.of(0.0)
    p = BASE + Taylor.polar(BASE, crank)
    height = LINE * half.sin() / half.cos()
    q = LINE + 1j * height
    # O, P, Q are the middles of A–D, C–D, A–B.
    d = apex(o, p, SHORT / 2, LONG / 2, +1)
    a, c = -d, 2 * p - d
    b = 2 * q - a
    # This bar swings through 180° on either side of -90°: its angle is taken from there.
    short_bc = ((c - b) * 1j).angle() - np.pi / 2
    return {
        **body("crank", BASE, crank),
        **body("short_AD", o, d.angle()),
        **body("long_AB", q, (b - a).angle()),
        **body("long_CD", p, (d - c).angle()),
        **body("short_BC", 0.5 * (b + c), short_bc),
        **point("long_CD.P", p),
        **point("long_AB.Q", q),
        "line": Taylor.of(LINE),
        "stroke": height,
        "OP": 2 * BASE * half.cos(),
        "OQ": LINE / half.cos(),
    }


def properties(motion: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {
        "Q on the straight line": motion["long_AB.Q.x"] / LINE - 1,
        "Q keeps to the line": motion["long_AB.Q.vx"],
        "OP times OQ": motion["OP.position"] * motion["OQ.position"] / POWER - 1,
    }


CASE = Case(
    source="exact straight line; closed form: inversion in a circle",
    drivers=lambda time: {"crank_angle": swing(0.0, np.radians(120))(time)},
    truth=truth,
    properties=properties,
)
