"""Truths of free motions: Lagrange's equations in minimal coordinates, integrated by SciPy.

A truth gives the places of all masses as functions of the coordinates and of time; the equations
follow by the derivatives of these. At a tolerance of 1e-13 SciPy's DOP853 is far nearer to the
exact motion than the FMU at its default tolerance of 1e-8.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from .taylor import Taylor

#: The FMU's tolerance; accelerations are as exact as the states that they follow from.
LIMITS = (1e-8, 1e-8, 1e-8)
#: SciPy's own tolerance.
TOLERANCE = 1e-13
GRAVITY = -9.81j


class Mass(NamedTuple):
    """A body: its mass, its inertia about the centre of mass, the place of that, its angle."""

    mass: float
    inertia: float
    centre: Taylor
    phi: Taylor


def mass_on(mass: float, inertia: float, origin, phi, centre: complex) -> Mass:
    """A body with its frame at `origin`, turned by `phi`, and its centre of mass in that frame."""
    return Mass(mass, inertia, origin + Taylor.polar(centre, phi), Taylor.of(phi))


#: Coordinates along which forces act, with the forces.
Loads = list[tuple[Taylor, np.ndarray]]
Masses = Callable[[list[Taylor], Taylor], list[Mass]]


def free_motion(
    masses: Masses,
    start: list[float],
    velocity: list[float],
    loads: Callable[[list[Taylor], Taylor], Loads] = lambda z, t: [],
    gravity: complex = GRAVITY,
) -> Callable[[Taylor], list[Taylor]]:
    """Returns the coordinates as functions of time, from these values and velocities at 0 s."""
    count = len(start)

    def accelerations(t: float, z: np.ndarray, rates: np.ndarray) -> np.ndarray:
        # One evaluation: the motion, then each coordinate alone. Adding zeros spreads constants.
        columns = count + 1
        changes = np.column_stack([rates, np.eye(count)])
        zero = np.zeros(columns)
        along = [
            Taylor(np.full(columns, value), change, zero)
            for value, change in zip(z, changes, strict=True)
        ]
        now = Taylor(np.full(columns, t), np.eye(columns)[0], zero)

        matrix, right = np.zeros((count, count)), np.zeros(count)
        for body in masses(along, now):
            moving, turning = (body.centre.first + zero)[1:], (body.phi.first + zero)[1:]
            lacking = gravity - (body.centre.second + zero)[0]
            right += body.mass * (moving.conj() * lacking).real
            right -= body.inertia * turning * (body.phi.second + zero)[0]
            matrix += body.mass * np.outer(moving.conj(), moving).real
            matrix += body.inertia * np.outer(turning, turning)
        for coordinate, force in loads(along, now):
            right += (coordinate.first + zero)[1:] * (force + zero)[0]
        return np.linalg.solve(matrix, right)

    def rates_of(t: float, x: np.ndarray) -> np.ndarray:
        return np.concatenate([x[count:], accelerations(t, x[:count], x[count:])])

    known: dict[bytes, list[Taylor]] = {}

    def motion(time: Taylor) -> list[Taylor]:
        key = time.value.tobytes()
        if key not in known:
            known[key] = integrated(time)
        return known[key]

    def integrated(time: Taylor) -> list[Taylor]:
        solution = solve_ivp(
            rates_of,
            (0.0, time.value[-1]),
            [*start, *velocity],
            method="DOP853",
            t_eval=time.value,
            rtol=TOLERANCE,
            atol=TOLERANCE,
        )
        z, rates = solution.y[:count], solution.y[count:]
        second = np.array([
            accelerations(t, z[:, k], rates[:, k]) for k, t in enumerate(time.value)
        ]).T
        return [Taylor(*orders) for orders in zip(z, rates, second, strict=True)]

    return motion
