"""Chebyshev's straight-line linkage in terms of its coupler's angle.

In parts, with the pivots at -2 and 2, the coupler's half as e = exp(i theta) and its middle P:
|P - e + 2| = |P + e - 2| = 5. So P is square to w = e - 2, and |P|² + |w|² = 25.
"""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

PART = 0.05


def truth(_time, drivers):
    theta = drivers["coupler_angle"]
    e = Taylor.polar(1, theta)
    w = e - 2
    square = w.length_squared()
    p = -1j * w * ((25 - square) / square).sqrt()
    a, b = p - e, p + e
    left, right = (a + 2).angle(), (b - 2).angle()
    return (
        body("left", -2 * PART, left)
        | body("right", 2 * PART, right)
        | body("coupler", PART * p, theta)
        | point("left.A", PART * a)
        | point("right.B", PART * b)
        | {"left_angle": left}
    )


def properties(motion):
    """The motion of the coupler is symmetric in time, so the path of P is in space.

    The first row repeats the second (inputs act one step late), whose mirror image, the turn's
    end, would be the row after the last.
    """
    x, y = motion["coupler.x"][2:] / PART, motion["coupler.y"][2:] / PART
    theta, height = motion["coupler_angle.position"], motion["coupler.y"] / PART
    middle = np.argmin(np.abs(np.cos(theta) + 1))
    too_high = height[np.cos(theta) < 0] - 4
    return {
        "the path is symmetric in x": x + x[::-1],
        "the path is symmetric in y": y - y[::-1],
        "P is at the height of 4 in the middle of the line": height[middle] - 4,
        "P keeps within 0.01 of the line": too_high - np.clip(too_high, 0, 0.01),
    }


CASE = Case(
    source="closed form: right-angled triangle over the pivots; exact symmetry of the path",
    drivers=lambda time: {"coupler_angle": one_turn(np.pi)(time)},
    truth=truth,
    properties=properties,
)
