"""Cam given by points: the closed cubic spline through them, from its conditions as one matrix."""

from __future__ import annotations

import numpy as np
from harness import mechanism_file

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

TURN = 2 * np.pi


def spline(angles, radii):
    """Coefficients of the cubics, highest power first: value, slope and second derivative meet at
    each point, the last with the first."""
    count = len(angles)
    widths = np.diff(np.append(angles, angles[0] + TURN))
    matrix, side = np.zeros((4 * count, 4 * count)), np.zeros(4 * count)
    for k, h in enumerate(widths):
        mine, following = 4 * k, 4 * ((k + 1) % count)
        matrix[mine, mine + 3] = 1
        side[mine] = radii[k]
        ends = ([h**3, h**2, h, 1], [3 * h**2, 2 * h, 1, 0], [6 * h, 2, 0, 0])
        starts = ([0, 0, 0, 1], [0, 0, 1, 0], [0, 2, 0, 0])
        for row, (end, start) in enumerate(zip(ends, starts, strict=True), start=1):
            matrix[mine + row, mine : mine + 4] += end
            matrix[mine + row, following : following + 4] -= start
    return np.linalg.solve(matrix, side).reshape(count, 4)


def truth(_time, drivers):
    u = drivers["cam_angle"]
    points = np.loadtxt(mechanism_file("cam_points").with_suffix(".csv"), delimiter=",", skiprows=3)
    angles, radii = np.radians(points[:, 0]), points[:, 1] / 1000
    theta = np.pi / 2 - u
    turned = theta - TURN * np.floor(theta.value / TURN)
    segment = np.searchsorted(angles, turned.value, side="right") - 1
    a, b, c, d = spline(angles, radii)[segment].T
    x = turned - angles[segment]
    lift = d + x * (c + x * (b + x * a))
    return body("cam", 0, u) | body("follower", 1j * lift, 0) | {"lift": lift}


CASE = Case(
    source="closed cubic spline by its conditions",
    drivers=lambda time: {"cam_angle": one_turn(0.0)(time)},
    truth=truth,
)
