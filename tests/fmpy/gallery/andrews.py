"""Andrews' squeezing mechanism: the published motion, and a closed form for the way there.

The motor turns from the published initial pose to the published final one, with the published
velocity and acceleration at both ends. The closed form, to which the FMU is held all the way, is
itself held to the published figures at the ends.
"""

from __future__ import annotations

import numpy as np

from . import Case, Truth
from .plane import apex, body, point
from .taylor import Taylor

RR, D, SS, E, ZT, ZF, U = 0.007, 0.028, 0.035, 0.020, 0.040, 0.020, 0.040
A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
D_ON_K3 = 0.02 - 0.018j

DURATION = 0.03
ANGLES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
#: Test Set for Initial Value Problem Solvers, problem "andrews": the initial values, and the
#: reference solution at 0.03 s; angles, velocities, accelerations.
START = Taylor(
    np.array([
        -0.0617138900142764496358948458001,
        0.0,
        0.455279819163070380255912382449,
        0.222668390165885884674473185609,
        0.487364979543842550225598953530,
        -0.222668390165885884674473185609,
        1.23054744454982119249735015568,
    ]),
    np.zeros(7),
    np.array([14222.4439199541138705911625887, -10666.8329399655854029433719415, 0, 0, 0, 0, 0]),
)  # fmt: skip
END = Taylor(
    np.array([
        15.81077119629904,
        -15.75637105984298,
        0.04082224013073101,
        -0.5347301163226948,
        0.5244099658805304,
        0.5347301163226948,
        1.048080741042263,
    ]),
    np.array([
        1139.920302151208,
        -1424.379294994111,
        11.03291221937134,
        19.29337464421385,
        0.5735699284790808,
        -19.29337464421385,
        0.3231791658026955,
    ]),
    np.array([
        -24631.76316945196,
        51850.37701610329,
        324102.5686413781,
        566749.3645176213,
        16743.62929479361,
        -566749.3645176222,
        9826.520791458422,
    ]),
)  # fmt: skip

#: How well the published figures fit each other, relative to the largest: the reference solution
#: meets the closure of the loops to rounding, its first and second derivative less well.
PRECISION = {"value": 2e-15, "first": 3e-11, "second": 2e-7}


def motor(time: Taylor) -> Taylor:
    """The polynomial of fifth degree between the two ends' angles, velocities, accelerations."""
    scale = DURATION ** np.arange(3)
    a0, a1, a2 = scale * [START.value[0], START.first[0], START.second[0]]
    b0, b1, b2 = scale * [END.value[0], END.first[0], END.second[0]]
    # Rest for the last three terms, after start value, velocity and acceleration.
    r0, r1, r2 = b0 - a0 - a1 - a2 / 2, b1 - a1 - a2, b2 - a2
    coefficients = (
        6 * r0 - 3 * r1 + r2 / 2, -15 * r0 + 7 * r1 - r2, 10 * r0 - 4 * r1 + r2 / 2, a2 / 2, a1, a0
    )  # fmt: skip
    s = time / DURATION
    beta = Taylor.of(0.0)
    for coefficient in coefficients:
        beta = beta * s + coefficient
    return beta


def solve(beta: Taylor) -> tuple[Truth, dict[str, Taylor]]:
    """Returns the true outputs, and the angles as published, at this angle of the motor."""
    f = Taylor.polar(RR, beta)
    e = apex(f, B, D, SS, +1)
    g = apex(e, A, E, ZT, -1)
    h = apex(e, A, ZF, U, +1)
    k2, k3, k4, k5, k6, k7 = (
        vector.angle()
        for vector in (f - e, 1j * (e - B), -1j * (g - e), g - A, e - h, 1j * (h - A))
    )
    measures = {"Theta": k2 - beta, "Phi": k4 - k5, "Omega": k6 - k7}
    outputs = {
        **body("K1", 0.0, beta),
        **body("K2", f, k2),
        **body("K3", B, k3),
        **body("K4", g, k4),
        **body("K5", A, k5),
        **body("K6", h, k6),
        **body("K7", A, k7),
        **point("K2.E", e),
        **measures,
        "spring": (B + Taylor.polar(D_ON_K3, k3) - C).length(),
    }
    return outputs, measures | {"beta": beta, "gamma": k3, "delta": k5, "epsilon": k7}


def truth(time: Taylor, drivers: dict[str, Taylor]) -> Truth:
    for published in (START, END):
        _, angles = solve(Taylor(published.value[0], published.first[0], published.second[0]))
        for order, precision in PRECISION.items():
            figures = getattr(published, order)
            found = [getattr(angles[name], order) for name in ANGLES]
            size = np.max(np.abs(figures))
            np.testing.assert_allclose(found, figures, rtol=0, atol=precision * size)
    return solve(drivers["beta"])[0]


CASE = Case(
    source="published figures at the ends; closed form: three circle intersections",
    drivers=lambda time: {"beta": motor(time)},
    truth=truth,
    duration=DURATION,
)
