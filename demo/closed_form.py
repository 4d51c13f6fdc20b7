"""Exact motion of the five shipped mechanisms, from trigonometry alone.

Nothing here iterates. Positions come from the law of cosines or the law of sines, rates from
differentiating those closed forms by hand. The results carry the FMU's variable names, so that
`FourBar().motion(u, rate, acceleration)["rocker.alpha"]` can be laid over the FMU's output
`rocker.alpha`.

Conventions
    * A planar vector is a complex number x + iy. A vector of fixed length that turns with the
      angle theta is p = r exp(i theta), so that p' = i omega p and p'' = (i alpha - omega^2) p.
    * The driver value `u` and its `rate` and `acceleration` are numbers or arrays of one shape;
      so are the parameters. Every result has the shape they broadcast to.
    * Angles are in radians. A body's `phi` is the one nearest the estimate in the mechanism file
      and continuous from there: a crank adds up its turns as its driver does, a body that only
      oscillates keeps to one range. Each class says for which parameters that holds.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np

Results = dict[str, np.ndarray]


@dataclass(frozen=True)
class Vector:
    """A planar vector with its first and second derivative in time, as complex numbers."""

    value: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray

    def __add__(self, other: Vector) -> Vector:
        return Vector(
            self.value + other.value,
            self.rate + other.rate,
            self.acceleration + other.acceleration,
        )

    def __mul__(self, factor) -> Vector:
        """Times a constant; a complex one turns and stretches."""
        return Vector(self.value * factor, self.rate * factor, self.acceleration * factor)


@dataclass(frozen=True)
class Scalar:
    """An angle or a length with its first and second derivative in time."""

    value: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray

    def __add__(self, constant) -> Scalar:
        return Scalar(self.value + constant, self.rate, self.acceleration)

    def __sub__(self, other: Scalar) -> Scalar:
        return Scalar(
            self.value - other.value,
            self.rate - other.rate,
            self.acceleration - other.acceleration,
        )


def fixed(point) -> Vector:
    """A vector that does not move."""
    return Vector(point + 0j, 0j, 0j)


def turning(length, angle: Scalar) -> Vector:
    """A vector of constant length in the direction `angle`."""
    p = length * np.exp(1j * angle.value)
    return Vector(
        p,
        1j * angle.rate * p,
        (1j * angle.acceleration - angle.rate**2) * p,
    )


def polar(vector: Vector, direction) -> tuple[Scalar, Scalar]:
    """Length and direction of a vector whose direction angle is known already.

    With d = l exp(i psi):
        d'  exp(-i psi) = l' + i l psi'
        d'' exp(-i psi) = l'' - l psi'^2 + i (2 l' psi' + l psi'')
    """
    turn_back = np.exp(-1j * direction)
    first = vector.rate * turn_back
    second = vector.acceleration * turn_back

    length = np.abs(vector.value)
    turn_rate = first.imag / length
    return (
        Scalar(length, first.real, second.real + length * turn_rate**2),
        Scalar(direction, turn_rate, (second.imag - 2 * first.real * turn_rate) / length),
    )


def angle_between(a, b, opposite):
    """Angle in (0, pi) between the sides `a` and `b` of a triangle, from its three sides.

    The law of cosines 2 a b cos(angle) = a^2 + b^2 - opposite^2 together with Heron's formula
    2 a b sin(angle) = 4 area. The arc tangent of the two keeps its accuracy where the arc cosine
    loses it, close to 0 and pi.
    """
    four_area = np.sqrt(
        (a + b + opposite) * (b + opposite - a) * (a + opposite - b) * (a + b - opposite)
    )
    # 2 a b cos = (a - o)(a + o) + b^2: the difference of squares as a product rounds less.
    return np.arctan2(four_area, (a - opposite) * (a + opposite) + b * b)


def dot(a, b):
    """Scalar product of two planar vectors."""
    return (a * np.conj(b)).real


def cross(a, b):
    """z-component of the vector product a x b."""
    return (np.conj(a) * b).imag


class ClosedForm:
    """Common part of the five: turns vectors and angles into named results."""

    driver: ClassVar[str]
    """Name of the driver."""

    start: ClassVar[float]
    """The driver's start value in the mechanism file."""

    bodies: ClassVar[tuple[str, ...]]
    """Names of the bodies, in file order."""

    @classmethod
    def parameter_names(cls) -> list[str]:
        return [field.name for field in fields(cls)]

    def motion(self, u, rate=0.0, acceleration=0.0) -> Results:
        """Position, velocity and acceleration of everything, at driver value `u`.

        Arguments: value, first and second time derivative of the driver [rad or m, per s, per s²].
        """
        u, rate, acceleration = np.broadcast_arrays(*np.atleast_1d(u, rate, acceleration))
        results: Results = {}
        self._solve(Scalar(u, rate, acceleration), results)
        parameters = (getattr(self, name) for name in self.parameter_names())
        shape = np.broadcast_shapes(u.shape, *(np.shape(value) for value in parameters))
        return {
            name: np.broadcast_to(value, shape).astype(float) for name, value in results.items()
        }

    def _solve(self, u: Scalar, results: Results) -> None:
        raise NotImplementedError

    @staticmethod
    def _body(results: Results, name: str, origin: Vector, phi: Scalar) -> None:
        ClosedForm._point(results, name, origin)
        results[f"{name}.phi"] = phi.value
        results[f"{name}.omega"] = phi.rate
        results[f"{name}.alpha"] = phi.acceleration

    @staticmethod
    def _point(results: Results, name: str, point: Vector) -> None:
        for vector, x, y in (
            (point.value, "x", "y"),
            (point.rate, "vx", "vy"),
            (point.acceleration, "ax", "ay"),
        ):
            results[f"{name}.{x}"] = np.real(vector)
            results[f"{name}.{y}"] = np.imag(vector)

    @staticmethod
    def _measure(results: Results, name: str, measure: Scalar) -> None:
        results[f"{name}.position"] = measure.value
        results[f"{name}.velocity"] = measure.rate
        results[f"{name}.acceleration"] = measure.acceleration


@dataclass(frozen=True)
class Pendulum(ClosedForm):
    """A rod on a pivot at the origin; the driver is its angle from hanging straight down.

    The rod's frame sits at its middle with the x-axis from the pivot to the tip, so
    phi = u - 90°, the origin is at half the length and the tip P at the whole.
    """

    length: float = 0.5

    driver = "swing_angle"
    start = np.radians(30)
    bodies = ("rod",)

    def _solve(self, u: Scalar, results: Results) -> None:
        phi = u + -np.pi / 2
        # exp(i (u - pi/2)) = -i exp(i u): the quarter turn costs no rounding this way.
        tip = turning(self.length, u) * -1j
        self._body(results, "rod", tip * 0.5, phi)
        self._point(results, "rod.P", tip)


@dataclass(frozen=True)
class SliderCrank(ClosedForm):
    """Crank pin A on a circle about the origin, slider pin B on the line y = offset.

    The rod from A to B has the angle phi with

        rod_length sin(phi) = offset - crank_length sin(u),

    |phi| < 90°: the slider stays on the side of larger x. Its rates follow by differentiating
    this once and twice. The rod's frame sits at its middle. The crank turns fully and phi
    oscillates while rod_length > crank_length + |offset|.
    """

    crank_length: float = 0.05
    rod_length: float = 0.15
    offset: float = 0.01

    driver = "crank_angle"
    start = np.radians(45)
    bodies = ("crank", "connecting_rod", "slider")

    def _solve(self, u: Scalar, results: Results) -> None:
        pin = turning(self.crank_length, u)
        rise = self.offset - pin.value.imag  # rod_length sin(phi)
        reach = np.sqrt((self.rod_length - rise) * (self.rod_length + rise))  # rod_length cos(phi)
        rate = -pin.rate.imag / reach
        phi = Scalar(
            np.arctan2(rise, reach),
            rate,
            (rise * rate**2 - pin.acceleration.imag) / reach,
        )
        rod = turning(self.rod_length, phi)
        end = pin + rod
        stroke = Scalar(end.value.real, end.rate.real, end.acceleration.real)
        # The guide holds the slider's y and its angle exactly.
        slider = Vector(stroke.value + 1j * self.offset, stroke.rate, stroke.acceleration)

        self._body(results, "crank", fixed(0), u)
        self._body(results, "connecting_rod", pin + rod * 0.5, phi)
        self._body(results, "slider", slider, Scalar(0.0, 0.0, 0.0))
        self._measure(results, "stroke", stroke)


@dataclass(frozen=True)
class FourBar(ClosedForm):
    """Crank O2–A, coupler A–B, rocker O4–B, fixed pivots O2 = 0 and O4 = (base, 0).

    Coupler and rocker are a dyad on A and O4: with d = O4 - A the triangle A, O4, B has the
    sides coupler_length, rocker_length and |d|, and B lies to the left of the way from A to O4:

        coupler.phi = arg d + (angle at A)
        rocker.phi  = arg d + 180° - (angle at O4)

    The closure A + C = O4 + D, C and D being coupler and rocker as vectors, gives the rates when
    it is differentiated and its scalar products with D and C are taken, which remove one of the
    two unknowns each:

        A' + i omega_C C = i omega_D D
        A'' + (i alpha_C - omega_C^2) C = (i alpha_D - omega_D^2) D

    The crank turns fully and the two others oscillate while crank_length is the shortest length
    and, with the longest, no longer than the other two together.
    """

    crank_length: float = 0.10
    coupler_length: float = 0.25
    rocker_length: float = 0.30
    base: float = 0.40

    driver = "crank_angle"
    start = np.radians(60)
    bodies = ("crank", "coupler", "rocker")

    def _solve(self, u: Scalar, results: Results) -> None:
        pin = turning(self.crank_length, u)
        to_pivot = self.base - pin.value
        distance = np.abs(to_pivot)
        # crank_length < base keeps this direction within ±90°, away from the cut of the angle.
        direction = np.angle(to_pivot)
        at_pin = angle_between(self.coupler_length, distance, self.rocker_length)
        at_pivot = angle_between(self.rocker_length, distance, self.coupler_length)
        coupler_phi = direction + at_pin
        rocker_phi = direction + np.pi - at_pivot

        c = self.coupler_length * np.exp(1j * coupler_phi)
        d = self.rocker_length * np.exp(1j * rocker_phi)
        sine = cross(d, c)  # coupler_length rocker_length sin(coupler_phi - rocker_phi)
        coupler_omega = dot(pin.rate, d) / sine
        rocker_omega = dot(pin.rate, c) / sine
        remainder = pin.acceleration - coupler_omega**2 * c + rocker_omega**2 * d
        coupler = Scalar(coupler_phi, coupler_omega, dot(remainder, d) / sine)
        rocker = Scalar(rocker_phi, rocker_omega, dot(remainder, c) / sine)

        unit = turning(1.0, coupler)
        self._body(results, "crank", fixed(0), u)
        self._body(results, "coupler", pin, coupler)
        self._body(results, "rocker", fixed(self.base), rocker)
        self._point(results, "coupler.P", pin + unit * (self.coupler_length / 2 + 0.05j))
        self._measure(results, "transmission", rocker - coupler)


@dataclass(frozen=True)
class Tlv(ClosedForm):
    """Triangle O–C–A with fixed base O–C, an arm O–A and a telescopic side C–A of length u.

    The law of cosines u^2 = base^2 + arm_length^2 - 2 base arm_length cos(theta) gives the arm's
    angle theta in (0°, 180°), and differentiated once and twice its rates:

        u u' = base arm_length sin(theta) theta'
        u'^2 + u u'' = base arm_length (sin(theta) theta'' + cos(theta) theta'^2)

    Barrel and rod point from C to A. The triangle closes while
    |base - arm_length| < u < base + arm_length.
    """

    base: float = 0.40
    arm_length: float = 0.25

    driver = "side_length"
    start = 0.35
    bodies = ("arm", "barrel", "rod")

    def _solve(self, u: Scalar, results: Results) -> None:
        theta = angle_between(self.arm_length, self.base, u.value)
        product = self.base * self.arm_length
        slope = product * np.sin(theta)
        omega = u.value * u.rate / slope
        alpha = (u.rate**2 + u.value * u.acceleration - product * np.cos(theta) * omega**2) / slope
        arm = Scalar(theta, omega, alpha)

        pin = turning(self.arm_length, arm)
        direction = np.pi - angle_between(self.base, u.value, self.arm_length)
        _, side = polar(pin + fixed(-self.base), direction)

        self._body(results, "arm", fixed(0), arm)
        self._body(results, "barrel", fixed(self.base), side)
        self._body(results, "rod", pin, side)
        self._measure(results, "arm_angle", arm)


@dataclass(frozen=True)
class TlvCrank(ClosedForm):
    """The triangle of `Tlv`, driven by the arm's angle.

    The side C–A is d = arm_length exp(i u) - base; its length and direction and their rates are
    those of a vector in polar coordinates. The arm turns fully and the side, which always points
    to smaller x, oscillates about 180° while arm_length < base.
    """

    base: float = 0.40
    arm_length: float = 0.25

    driver = "arm_angle"
    start = np.radians(60)
    bodies = ("arm", "barrel", "rod")

    def _solve(self, u: Scalar, results: Results) -> None:
        pin = turning(self.arm_length, u)
        side = pin + fixed(-self.base)
        # The reversed side stays within ±90°, away from the cut of the angle.
        length, direction = polar(side, np.pi + np.angle(-side.value))

        self._body(results, "arm", fixed(0), u)
        self._body(results, "barrel", fixed(self.base), direction)
        self._body(results, "rod", pin, direction)
        self._measure(results, "side_length", length)


CLOSED_FORMS: dict[str, type[ClosedForm]] = {
    "pendulum": Pendulum,
    "slider_crank": SliderCrank,
    "four_bar": FourBar,
    "tlv": Tlv,
    "tlv_crank": TlvCrank,
}
"""The closed form of each shipped mechanism, by the mechanism's name."""


_KINDS = {
    ("position", "m"): ("x", "y"),
    ("position", "rad"): ("phi",),
    ("velocity", "m"): ("vx", "vy"),
    ("velocity", "rad"): ("omega",),
    ("acceleration", "m"): ("ax", "ay"),
    ("acceleration", "rad"): ("alpha",),
}
_KIND_OF_SUFFIX = {suffix: kind for kind, suffixes in _KINDS.items() for suffix in suffixes}
_LENGTH_MEASURES = {"stroke", "side_length"}


def kind_of(name: str) -> tuple[str, str]:
    """What an output is: ("position" | "velocity" | "acceleration", "m" | "rad")."""
    owner, _, suffix = name.rpartition(".")
    if suffix in _KIND_OF_SUFFIX:
        return _KIND_OF_SUFFIX[suffix]
    return suffix, "m" if owner in _LENGTH_MEASURES else "rad"


def largest_errors(actual, expected: Results) -> dict[str, float]:
    """Largest error of positions, velocities and accelerations, each relative to its kind.

    `actual[name]` must exist for every name in `expected`. An error in metres is divided by the
    largest magnitude that any output of the same kind (a length, an angle, or a rate of one of
    them) reaches over the motion; a kind that stays zero is compared absolutely.
    """
    size: dict[tuple[str, str], float] = {}
    error: dict[tuple[str, str], float] = {}
    for name, values in expected.items():
        kind = kind_of(name)
        size[kind] = max(size.get(kind, 0.0), float(np.max(np.abs(values))))
        # Written so that a value that is not a number counts as infinitely wrong.
        difference = np.abs(np.asarray(actual[name]) - values)
        worst = float(np.max(np.where(np.isfinite(difference), difference, np.inf)))
        error[kind] = max(error.get(kind, 0.0), worst)

    largest = {"position": 0.0, "velocity": 0.0, "acceleration": 0.0}
    for (order, unit), value in error.items():
        relative = value / (size[order, unit] or 1.0)
        largest[order] = max(largest[order], relative)
    return largest
