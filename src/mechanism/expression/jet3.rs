//! Numbers with three derivatives, exact or enclosed.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::function::Unary;
use super::interval::Interval;
use super::number::{Number, falling, term};
use super::scalar::Scalar;

/// A value with its first three derivatives with respect to one variable, as numbers or as
/// intervals that enclose them.
///
/// ```
/// use biela::mechanism::Jet3;
///
/// let x = Jet3::variable(2.0);
/// let cube = Jet3 { value: 8.0, first: 12.0, second: 12.0, third: 6.0 };
/// assert_eq!(x * x * x, cube);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet3<S = f64> {
    /// The value.
    pub value: S,
    /// The first derivative.
    pub first: S,
    /// The second derivative.
    pub second: S,
    /// The third derivative.
    pub third: S,
}

impl<S: Scalar> Jet3<S> {
    /// The variable itself at `value`: derivatives 1, 0 and 0.
    #[must_use]
    pub fn variable(value: S) -> Self {
        Self {
            first: S::constant(1.0),
            ..Self::fixed(value)
        }
    }

    /// The polar coordinates of the point (`x`, `y`), whose angle has the value `angle`.
    ///
    /// The derivatives come from the motion of the point seen along the radius and across it:
    /// velocity (r′, r φ′), acceleration (r″ − r φ′², r φ″ + 2 r′ φ′), and the derivative of that.
    fn polar(x: Self, y: Self, angle: S) -> [Self; 2] {
        let r = x.value.hypot(y.value);
        if !x.varies() && !y.varies() {
            return [Self::fixed(r), Self::fixed(angle)];
        }
        let (cos, sin) = (x.value / r, y.value / r);
        let along = |x: S, y: S| cos * x + sin * y;
        let across = |x: S, y: S| cos * y - sin * x;
        let (along_2, across_2) = (along(x.second, y.second), across(x.second, y.second));
        let r_1 = along(x.first, y.first);
        let phi_1 = across(x.first, y.first) / r;
        let r_2 = along_2 + r * phi_1.square();
        let phi_2 = (across_2 - r_1 * phi_1 * 2.0) / r;
        let r_3 = along(x.third, y.third) + (across_2 - r_1 * phi_1) * phi_1 * 3.0;
        let phi_3 =
            (across(x.third, y.third) - along_2 * phi_1 - r_1 * phi_2 * 3.0 - r_2 * phi_1 * 2.0)
                / r;
        [
            Self {
                value: r,
                first: r_1,
                second: r_2,
                third: r_3,
            },
            Self {
                value: angle,
                first: phi_1,
                second: phi_2,
                third: phi_3,
            },
        ]
    }
}

impl Jet3<Interval> {
    /// Whether all bounds are finite.
    pub(super) fn is_finite(self) -> bool {
        [self.value, self.first, self.second, self.third]
            .iter()
            .all(|interval| interval.is_finite())
    }

    /// What encloses both.
    pub(in crate::mechanism) fn hull(self, other: Self) -> Self {
        Self {
            value: Interval::hull([self.value, other.value]),
            first: Interval::hull([self.first, other.first]),
            second: Interval::hull([self.second, other.second]),
            third: Interval::hull([self.third, other.third]),
        }
    }

    /// Narrower bounds for what holds in a range of the variable: Taylor's theorem from what
    /// holds `there`, in a point of the range that the whole of it lies within `offset` of, with
    /// the third derivative in the remainder.
    pub(super) fn narrowed(self, there: Self, offset: Interval) -> Self {
        let half_square = offset.square() * 0.5;
        let second = there.second + self.third * offset;
        let first = there.first + there.second * offset + self.third * half_square;
        let value = there.value
            + there.first * offset
            + there.second * half_square
            + self.third * offset.cube() / Interval::point(6.0);
        Self {
            value: self.value.intersection(value),
            first: self.first.intersection(first),
            second: self.second.intersection(second),
            third: self.third,
        }
    }
}

impl<S: Scalar> Number for Jet3<S> {
    type Scalar = S;

    fn fixed(value: S) -> Self {
        let zero = S::constant(0.0);
        Self {
            value,
            first: zero,
            second: zero,
            third: zero,
        }
    }

    fn undecided(value: S) -> Self {
        let unknown = S::constant(f64::NAN);
        Self {
            value,
            first: unknown,
            second: unknown,
            third: unknown,
        }
    }

    fn value(self) -> S {
        self.value
    }

    fn varies(self) -> bool {
        !(self.first.is_zero() && self.second.is_zero() && self.third.is_zero())
    }

    fn chain(self, f: impl Fn(S) -> S, derivatives: impl Fn(S) -> [S; 3]) -> Self {
        let value = f(self.value);
        if !self.varies() {
            return Self::fixed(value);
        }
        let [f_1, f_2, f_3] = derivatives(self.value);
        // An interval's value may be that of the part within the domain only.
        if f_1.is_undefined() {
            return Self::undecided(f_1);
        }
        Self {
            value,
            first: term(f_1, self.first),
            second: term(f_1, self.second) + term(f_2, self.first.square()),
            third: term(f_1, self.third)
                + term(f_2, self.first * self.second) * 3.0
                + term(f_3, self.first.cube()),
        }
    }

    fn hypot(self, y: Self) -> Self {
        // Of the angle only the derivatives are wanted.
        let [r, _] = Self::polar(self, y, S::constant(0.0));
        r
    }

    fn atan2(self, x: Self) -> Self {
        let angle = self.value.atan2(x.value);
        if self.value.angle_jumps(x.value) && (self.varies() || x.varies()) {
            return Self::undecided(angle);
        }
        let [_, angle] = Self::polar(x, self, angle);
        angle
    }

    fn power(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        if exponent.varies() {
            return (exponent * Unary::Ln.apply(self)).chain(|_| value, |_| [value; 3]);
        }
        self.chain(
            |_| value,
            |x| {
                let one = S::constant(1.0);
                let y = exponent.value;
                let [y_1, y_2, y_3] = [1.0, 2.0, 3.0].map(|k| y - one * k);
                [
                    falling(y, x, y_1),
                    falling(y * y_1, x, y_2),
                    falling(y * y_1 * y_2, x, y_3),
                ]
            },
        )
    }
}

impl<S: Scalar> Add for Jet3<S> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
            third: self.third + other.third,
        }
    }
}

impl<S: Scalar> Sub for Jet3<S> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            first: self.first - other.first,
            second: self.second - other.second,
            third: self.third - other.third,
        }
    }
}

impl<S: Scalar> Mul for Jet3<S> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (x, y) = (self, other);
        Self {
            value: x.value * y.value,
            first: x.first * y.value + x.value * y.first,
            second: x.second * y.value + x.first * y.first * 2.0 + x.value * y.second,
            third: x.third * y.value
                + (x.second * y.first + x.first * y.second) * 3.0
                + x.value * y.third,
        }
    }
}

impl<S: Scalar> Div for Jet3<S> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // From x = q y: x‴ = q‴y + 3 q″y′ + 3 q′y″ + q y‴, and so below.
        let (x, y) = (self, other);
        let value = x.value / y.value;
        let first = (x.first - value * y.first) / y.value;
        let second = (x.second - first * y.first * 2.0 - value * y.second) / y.value;
        let third =
            (x.third - (second * y.first + first * y.second) * 3.0 - value * y.third) / y.value;
        Self {
            value,
            first,
            second,
            third,
        }
    }
}

impl<S: Scalar> Neg for Jet3<S> {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            first: -self.first,
            second: -self.second,
            third: -self.third,
        }
    }
}
