"""Bounds of the rounding of motions and gradients that are computed in double precision."""

from __future__ import annotations

import numpy as np

from .motion import Pose

FACTOR = 8
"""Roundings in units of machine precision times condition. At a distance δ from a dead point the
condition grows as 1/δ, the derivative of an acceleration by a parameter as δ^-5: an error of δ
counts five times there."""


class Rounding:
    """Sizes in a pose, from which bounds of rounding follow.

    Lengths are divided by the size of the mechanism, so that lengths and angles have one measure.
    Positions are solved to machine precision times the condition of the Jacobian. Velocities,
    accelerations and gradients solve linear systems with this Jacobian, whose right sides use the
    solutions before: these count with the rate of the motion, once for each derivative by time.
    The error of the positions turns the Jacobian, as much as the motion itself does over such a
    way: relative to the rates by q̈/q̇², which next to a dead point grows as 1/δ.
    """

    def __init__(self, pose: Pose, motion, units: list[str]):
        self.length = size(pose)
        self.scale = np.array([self.length if unit == "m" else 1.0 for unit in units])
        self.error = FACTOR * np.finfo(float).eps * condition(pose, self.length)
        _, velocity, acceleration = self.largest(motion)
        self.rate = max(velocity, np.sqrt(acceleration))
        self.bend = 1 + acceleration / velocity**2

    def largest(self, rows):
        """Returns the largest number of each row, in the measure of lengths and angles."""
        return np.abs(rows.astype(float) / self.scale).max(axis=1)

    def of_motion(self):
        """Returns bounds of the errors of positions, velocities and accelerations."""
        sizes = np.array([1, self.rate, self.rate**2])
        return self.error * np.outer(sizes * [1, self.bend, self.bend], self.scale)

    def of_gradient(self, gradient, value: float, unit: str | None):
        """Returns bounds of the errors of their derivatives by a parameter."""
        step = {"m": self.length, "rad": 1.0}.get(unit, abs(value) or 1.0)
        sizes, below = [], 1 / step
        for largest in self.largest(gradient):
            below = largest + below
            sizes.append(below)
            below = self.rate * below
        return self.error * self.bend * np.outer(sizes, self.scale)


def size(pose: Pose) -> float:
    """Returns the largest coordinate of all bodies and of markers on theirs [m]."""
    markers = [coordinate for _, at in pose.mechanism.markers.values() for coordinate in at.point]
    placed = pose.mechanism.place(pose.q)
    bodies = [coordinate for body in placed.bodies.values() for coordinate in body.point]
    return float(max(map(abs, markers + bodies)))


def condition(pose: Pose, length: float) -> float:
    """Returns the condition number of the Jacobian, for coordinates and rows of one measure."""
    bodies = len(pose.mechanism.bodies)
    contacts = len(pose.q) - 3 * bodies
    scaled = pose.jacobian * ([length, length, 1.0] * bodies + [1.0] * contacts)
    return np.linalg.cond(scaled / np.abs(scaled).max(axis=1, keepdims=True))
