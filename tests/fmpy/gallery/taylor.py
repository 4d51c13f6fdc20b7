"""Numbers with their first and second derivative in time: truths are written as positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Taylor:
    """A value with its first and second derivative; arrays of one shape, or numbers.

    The values may be complex: a planar vector is x + iy, and what holds for real numbers holds
    for them. Functions that make no sense for complex numbers say so.
    """

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray

    # Let numpy hand `array * Taylor` over to this class.
    __array_ufunc__ = None

    @staticmethod
    def time(t) -> Taylor:
        """Time itself."""
        t = np.asarray(t, dtype=float)
        return Taylor(t, np.ones_like(t), np.zeros_like(t))

    @staticmethod
    def of(value) -> Taylor:
        """A constant, or what is a Taylor already."""
        return value if isinstance(value, Taylor) else Taylor(value, 0.0, 0.0)

    def chain(self, f, f1, f2) -> Taylor:
        """A function of this, given its value and its first two derivatives here."""
        return Taylor(f, f1 * self.first, f2 * self.first**2 + f1 * self.second)

    # -----------------------------------------------------------------------------------------
    # Arithmetic

    def __add__(self, other) -> Taylor:
        other = Taylor.of(other)
        return Taylor(
            self.value + other.value, self.first + other.first, self.second + other.second
        )

    __radd__ = __add__

    def __neg__(self) -> Taylor:
        return Taylor(-self.value, -self.first, -self.second)

    def __sub__(self, other) -> Taylor:
        return self + -Taylor.of(other)

    def __rsub__(self, other) -> Taylor:
        return Taylor.of(other) + -self

    def __mul__(self, other) -> Taylor:
        other = Taylor.of(other)
        return Taylor(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    __rmul__ = __mul__

    def __truediv__(self, other) -> Taylor:
        return self * Taylor.of(other).reciprocal()

    def __rtruediv__(self, other) -> Taylor:
        return Taylor.of(other) * self.reciprocal()

    def reciprocal(self) -> Taylor:
        """1 / self."""
        r = 1 / self.value
        return self.chain(r, -(r**2), 2 * r**3)

    def square(self) -> Taylor:
        """self²."""
        return self * self

    # -----------------------------------------------------------------------------------------
    # Functions of a real number

    def sqrt(self) -> Taylor:
        """The square root."""
        root = np.sqrt(self.value)
        return self.chain(root, 0.5 / root, -0.25 / root**3)

    def sin(self) -> Taylor:
        """The sine."""
        s, c = np.sin(self.value), np.cos(self.value)
        return self.chain(s, c, -s)

    def cos(self) -> Taylor:
        """The cosine."""
        s, c = np.sin(self.value), np.cos(self.value)
        return self.chain(c, -s, -c)

    def asin(self) -> Taylor:
        """The arc sine."""
        root = np.sqrt((1 - self.value) * (1 + self.value))
        return self.chain(np.arcsin(self.value), 1 / root, self.value / root**3)

    def acos(self) -> Taylor:
        """The arc cosine."""
        return np.pi / 2 - self.asin()

    @staticmethod
    def hypot(x, y) -> Taylor:
        """√(x² + y²)."""
        x, y = Taylor.of(x), Taylor.of(y)
        return (x.square() + y.square()).sqrt()

    @staticmethod
    def atan2(y, x) -> Taylor:
        """The direction of (x, y), continuous along the samples; the first in (-π, π]."""
        y, x = Taylor.of(y), Taylor.of(x)
        angle = np.arctan2(y.value, x.value)
        if np.ndim(angle):
            angle = np.unwrap(angle)
        # psi' = (x y' - y x') / r², differentiated once more.
        square = x.value**2 + y.value**2
        cross = x.value * y.first - y.value * x.first
        first = cross / square
        growth = 2 * (x.value * x.first + y.value * y.first)
        cross_rate = x.value * y.second - y.value * x.second
        return Taylor(angle, first, (cross_rate - first * growth) / square)

    # -----------------------------------------------------------------------------------------
    # Planar vectors as complex numbers

    @staticmethod
    def polar(length, angle) -> Taylor:
        """The vector of this length in this direction, length · exp(i angle)."""
        angle = Taylor.of(angle)
        unit = np.exp(1j * np.asarray(angle.value))
        return length * angle.chain(unit, 1j * unit, -unit)

    @property
    def x(self) -> Taylor:
        """The real part."""
        return Taylor(np.real(self.value), np.real(self.first), np.real(self.second))

    @property
    def y(self) -> Taylor:
        """The imaginary part."""
        return Taylor(np.imag(self.value), np.imag(self.first), np.imag(self.second))

    def conjugate(self) -> Taylor:
        """The vector mirrored at the x-axis."""
        return Taylor(np.conj(self.value), np.conj(self.first), np.conj(self.second))

    def length_squared(self) -> Taylor:
        """The square of a vector's length."""
        return self.x.square() + self.y.square()

    def length(self) -> Taylor:
        """A vector's length."""
        return Taylor.hypot(self.x, self.y)

    def angle(self) -> Taylor:
        """A vector's direction, continuous along the samples; the first in (-π, π]."""
        return Taylor.atan2(self.y, self.x)
