"""Vectors in the plane, and markers and bodies where they stand."""

from __future__ import annotations

from typing import Any, NamedTuple

from .digits import mp


class Vector(NamedTuple):
    """Vector in the plane."""

    x: Any
    y: Any

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y)

    def __sub__(self, other):
        return Vector(self.x - other.x, self.y - other.y)

    def __matmul__(self, other):
        return self.x * other.x + self.y * other.y

    def __mul__(self, factor):
        return Vector(self.x * factor, self.y * factor)

    def turned(self):
        """Returns the vector turned by 90°."""
        return Vector(-self.y, self.x)

    def in_axes(self, axis):
        """Returns the components along a unit vector and along that vector turned by 90°."""
        return Vector(axis @ self, axis.turned() @ self)

    def from_axes(self, axis):
        """Returns the vector whose components along such axes these are."""
        return axis * self.x + axis.turned() * self.y

    def length(self):
        """Returns the length, an analytic function of the components."""
        return mp.sqrt(self @ self)


def direction(angle):
    """Returns the unit vector at an angle [rad] from the x-axis."""
    return Vector(mp.cos(angle), mp.sin(angle))


class Frame(NamedTuple):
    """Marker or body where it stands: its point, the angle of its x-axis, and that axis."""

    point: Vector
    angle: Any
    axis: Vector

    def place(self, marker: Frame) -> Frame:
        """Returns the frame of a marker that is given in this frame."""
        return Frame(
            self.point + marker.point.from_axes(self.axis),
            self.angle + marker.angle,
            marker.axis.from_axes(self.axis),
        )

    def local(self, point: Vector) -> Vector:
        """Returns a point's coordinates on the axes of this frame."""
        return (point - self.point).in_axes(self.axis)


def frame(x, y, angle) -> Frame:
    """Returns the frame with this origin and angle."""
    return Frame(Vector(x, y), angle, direction(angle))


GROUND = frame(mp.zero, mp.zero, mp.zero)
