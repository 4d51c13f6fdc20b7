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
        zero = np.zeros(1)

        def evaluate(change: np.ndarray, passing: float):
            along = [
                Taylor(np.array([value]), np.array([rate]), zero)
                for value, rate in zip(z, change, strict=True)
            ]
            now = Taylor(np.array([t]), np.array([passing]), zero)
            return masses(along, now), loads(along, now)

        moving, forces = evaluate(rates, 1.0)
        matrix, right = np.zeros((count, count)), np.zeros(count)
        units = [evaluate(unit, 0.0) for unit in np.eye(count)]
        for row, (parts, coordinates) in enumerate(units):
            for (coordinate, _), (_, force) in zip(coordinates, forces, strict=True):
                right[row] += scalar(coordinate.first) * scalar(force)
            for part, body in zip(parts, moving, strict=True):
                lacking = gravity - scalar(body.centre.second)
                right[row] += body.mass * (np.conj(scalar(part.centre.first)) * lacking).real
                right[row] -= body.inertia * scalar(part.phi.first) * scalar(body.phi.second)
            for column, (others, _) in enumerate(units):
                for part, other in zip(parts, others, strict=True):
                    product = np.conj(scalar(part.centre.first)) * scalar(other.centre.first)
                    turning = scalar(part.phi.first) * scalar(other.phi.first)
                    matrix[row, column] += part.mass * product.real + part.inertia * turning
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


def scalar(value):
    """The only number of an array, or the number."""
    return np.asarray(value).reshape(-1)[0]
