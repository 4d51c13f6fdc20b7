"""Parts of closed forms of planar linkages; vectors are complex, x + iy."""

from __future__ import annotations

from .taylor import Taylor


def apex(a, b, from_a, from_b, side: int) -> Taylor:
    """The point at the distance `from_a` from a and `from_b` from b: two circles' intersection.

    `side` is +1 for the one to the left of the way from a to b, -1 for the one to the right.
    Heron's product keeps its accuracy where the triangle is flat, unlike a difference of squares.
    """
    d = Taylor.of(b) - a
    square = d.length_squared()
    outer, inner = (from_a + from_b) ** 2, (from_a - from_b) ** 2
    four_areas = ((outer - square) * (square - inner)).sqrt()
    along = square + (from_a - from_b) * (from_a + from_b)
    return a + d * (along + 1j * side * four_areas) / (2 * square)


def point(name: str, at) -> dict[str, Taylor]:
    """Returns the coordinates of a point by their names."""
    at = Taylor.of(at)
    return {f"{name}.x": at.x, f"{name}.y": at.y}


def body(name: str, origin, phi) -> dict[str, Taylor]:
    """Returns the pose of a body by its names."""
    return point(name, origin) | {f"{name}.phi": Taylor.of(phi)}
