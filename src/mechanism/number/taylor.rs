//! Numbers with derivatives.

use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::{Interval, Number, Unary};

/// A value with its first N derivatives with respect to one variable, N from 1 to 3: a truncated
/// Taylor series.
///
/// Arithmetic and functions differentiate by the rules of Leibniz and Faà di Bruno. Value and
/// derivatives are numbers of type S, so that Taylor numbers nest.
///
/// ```
/// use biela::mechanism::{Dual, Jet, Taylor};
///
/// let t = Jet::variable(3.0);
/// assert_eq!(t * t, Jet::new(9.0, [6.0, 2.0]));
///
/// // x³ at x = 2, whose slope and curvature change by 12 and 6 per unit of x.
/// let x = Taylor::<Dual, 2>::variable(Dual::variable(2.0));
/// assert_eq!((x * x * x).first(), Dual::new(12.0, [12.0]));
/// assert_eq!((x * x * x).second(), Dual::new(12.0, [6.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor<S, const N: usize> {
    /// The value.
    pub value: S,
    /// The derivatives of order 1 to N.
    pub derivatives: [S; N],
}

impl<S, const N: usize> Taylor<S, N> {
    /// Makes a number with these derivatives of order 1 to N.
    pub const fn new(value: S, derivatives: [S; N]) -> Self {
        Self { value, derivatives }
    }
}

impl Taylor<f64, 2> {
    /// Returns the motion a time `tau` later whose acceleration stays as it is: a parabola, or a line
    /// where it is zero.
    #[inline]
    #[must_use]
    pub fn after(self, tau: f64) -> Self {
        let [first, second] = self.derivatives;
        Self::new(
            self.value + tau * (first + 0.5 * tau * second),
            [first + tau * second, second],
        )
    }
}

impl<S: Number, const N: usize> Taylor<S, N> {
    /// Makes a number that does not vary.
    #[must_use]
    pub fn fixed(value: S) -> Self {
        Self::new(value, [S::constant(0.0); N])
    }

    /// Makes the plain number `value`, which does not vary.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::fixed(S::constant(value))
    }

    /// Makes a linear function of the variable, here with this `value` and this `slope`.
    #[must_use]
    pub fn linear(value: S, slope: S) -> Self {
        let mut linear = Self::fixed(value);
        linear.derivatives[0] = slope;
        linear
    }

    /// Makes the variable itself at `value`: its first derivative is 1.
    #[must_use]
    pub fn variable(value: S) -> Self {
        Self::linear(value, S::constant(1.0))
    }

    /// Makes a number whose derivatives are not known.
    fn undecided(value: S) -> Self {
        Self::new(value, [S::unknown(); N])
    }

    /// Makes a continuous number with a corner: only its first derivative has bounds.
    fn cornered(value: S, first: S) -> Self {
        let mut number = Self::undecided(value);
        number.derivatives[0] = first;
        number
    }

    /// Makes the number whose derivative of each order is `of` that order.
    fn by_order(of: impl Fn(usize) -> S) -> Self {
        Self::new(of(0), array::from_fn(|k| of(k + 1)))
    }

    /// Returns the derivative of order `k`, the value for order 0.
    fn order(&self, k: usize) -> S {
        if k == 0 {
            self.value
        } else {
            self.derivatives[k - 1]
        }
    }

    /// Returns the first derivative.
    #[must_use]
    pub fn first(&self) -> S {
        self.derivatives[0]
    }

    /// Returns the second derivative.
    #[must_use]
    pub fn second(&self) -> S {
        const { assert!(N >= 2, "this number has no second derivative") };
        self.derivatives[1]
    }

    /// Returns the third derivative.
    #[must_use]
    pub fn third(&self) -> S {
        const { assert!(N >= 3, "this number has no third derivative") };
        self.derivatives[2]
    }

    /// Returns f(x) by the chain rule, where f has this `value` and gives \[f′, f″, f‴\] at x.
    ///
    /// A derivative of x that is zero cancels its term even where f is infinitely steep: √a has
    /// no slope at a = 0, but does not vary if a does not.
    #[must_use]
    pub fn chain(self, value: S, derivatives: impl FnOnce(S) -> [S; 3]) -> Self {
        const { assert!(N <= 3, "functions have three derivatives") };
        if !self.varies() {
            return Self::fixed(value);
        }
        let [f_1, f_2, f_3] = derivatives(self.value);
        // The value may be that of the part of an interval within the domain only.
        if f_1.is_undefined() {
            return Self::undecided(f_1);
        }
        let x = |k| self.order(k);
        Self::by_order(|k| match k {
            0 => value,
            1 => term(f_1, x(1)),
            2 => term(f_1, x(2)) + term(f_2, x(1).square()),
            _ => term(f_1, x(3)) + term(f_2, x(1) * x(2)) * 3.0 + term(f_3, x(1).cube()),
        })
    }

    /// Returns the polar coordinates of the point (`x`, `y`), whose values are `r` and `angle`.
    ///
    /// The derivatives come from the point's motion along and across the radius: velocity
    /// (r′, r φ′), acceleration (r″ − r φ′², r φ″ + 2 r′ φ′), and the derivative of that.
    fn polar(x: Self, y: Self, r: S, angle: S) -> [Self; 2] {
        let mut radius = Self::fixed(r);
        let mut phi = Self::fixed(angle);
        if !x.varies() && !y.varies() {
            return [radius, phi];
        }
        let (cos, sin) = (x.value / r, y.value / r);
        for k in 1..=N {
            let along = |k| cos * x.order(k) + sin * y.order(k);
            let across = |k| cos * y.order(k) - sin * x.order(k);
            let (r_, phi_) = (|k| radius.order(k), |k| phi.order(k));
            let (r_k, r_phi_k) = match k {
                1 => (along(1), across(1)),
                2 => (
                    along(2) + r * phi_(1).square(),
                    across(2) - r_(1) * phi_(1) * 2.0,
                ),
                _ => (
                    along(3) + (across(2) - r_(1) * phi_(1)) * phi_(1) * 3.0,
                    across(3) - along(2) * phi_(1) - r_(1) * phi_(2) * 3.0 - r_(2) * phi_(1) * 2.0,
                ),
            };
            radius.derivatives[k - 1] = r_k;
            phi.derivatives[k - 1] = r_phi_k / r;
        }
        [radius, phi]
    }
}

/// Returns a term of the chain rule, zero where `derivative` is.
fn term<S: Number>(slope: S, derivative: S) -> S {
    if derivative.is_zero() {
        S::constant(0.0)
    } else {
        slope * derivative
    }
}

/// Returns `factor` · x^`exponent`. A factor of zero ends the derivatives of a polynomial, before
/// a negative power of zero can make 0 · ∞ of them.
fn falling<S: Number>(factor: S, x: S, exponent: S) -> S {
    if factor.is_zero() {
        S::constant(0.0)
    } else {
        factor * x.powf(exponent)
    }
}

impl<S: Number, const N: usize> Number for Taylor<S, N> {
    fn constant(value: f64) -> Self {
        Self::constant(value)
    }

    fn unknown() -> Self {
        Self::undecided(S::unknown())
    }

    fn real(self) -> f64 {
        self.value.real()
    }

    fn is_zero(self) -> bool {
        self.value.is_zero() && !self.varies()
    }

    fn is_single(self) -> bool {
        self.value.is_single()
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.derivatives.iter().all(|k| k.is_finite())
    }

    fn is_undefined(self) -> bool {
        self.value.is_undefined()
    }

    fn varies(self) -> bool {
        !self.derivatives.iter().all(|k| k.is_zero())
    }

    fn held(self) -> Self {
        Self::fixed(self.value)
    }

    fn at_most(self, other: Self) -> Option<bool> {
        self.value.at_most(other.value)
    }

    fn smaller(self, other: Self) -> Self {
        let value = || self.value.smaller(other.value);
        match self.at_most(other) {
            Some(true) => self,
            Some(false) => other,
            None if self.varies() || other.varies() => {
                Self::cornered(value(), self.first().either(other.first()))
            }
            None => Self::fixed(value()),
        }
    }

    fn either(self, other: Self) -> Self {
        Self::undecided(self.value.either(other.value))
    }

    fn range(self) -> Interval {
        self.value.range()
    }

    fn within(self, range: Interval) -> Option<Self> {
        Some(Self::new(self.value.within(range)?, self.derivatives))
    }

    fn joined(self, other: Self, jump: usize) -> Self {
        Self::by_order(|k| match jump.checked_sub(k) {
            Some(jump) => self.order(k).joined(other.order(k), jump),
            None => S::unknown(),
        })
    }

    fn apply(self, function: Unary) -> Self {
        let value = self.value.apply(function);
        if function.is_step() && value.is_single() {
            return Self::fixed(value);
        }
        self.chain(value, |x| function.derivatives(x, value))
    }

    fn powf(self, exponent: Self) -> Self {
        let (x, y) = (self.value, exponent.value);
        let value = x.powf(y);
        // At zero x^y and its derivatives by y, x^y (ln x)^k, vanish for any y > 0.
        let at_zero = x.is_single() && x.real() == 0.0 && y.real() > 0.0;
        if exponent.varies() && !at_zero {
            return (exponent * self.ln()).chain(value, |_| [value; 3]);
        }
        self.chain(value, |x| {
            let [y_1, y_2, y_3] = [1.0, 2.0, 3.0].map(|k| y - S::constant(k));
            let slope = falling(y, x, y_1);
            // The value has bounds within the domain only.
            if slope.is_undefined() && !value.is_undefined() {
                return [S::unknown(); 3];
            }
            [
                slope,
                falling(y * y_1, x, y_2),
                falling(y * y_1 * y_2, x, y_3),
            ]
        })
    }

    fn hypot(self, y: Self) -> Self {
        let r = self.value.hypot(y.value);
        if (self.value / r).is_undefined() && (self.varies() || y.varies()) {
            // The radius changes by no more than the point, which passes the origin.
            let speed = self.first().hypot(y.first());
            return Self::cornered(r, speed.either(-speed));
        }
        // The angle's derivatives are needed, its value is not.
        let [r, _] = Self::polar(self, y, r, S::constant(0.0));
        r
    }

    fn norm(self, y: Self) -> Self {
        let [r, _] = Self::polar(self, y, self.value.norm(y.value), S::constant(0.0));
        r
    }

    fn atan2(self, x: Self) -> Self {
        let angle = self.value.atan2(x.value);
        if self.angle_jumps(x) && (self.varies() || x.varies()) {
            return Self::undecided(angle);
        }
        let [_, angle] = Self::polar(x, self, x.value.hypot(self.value), angle);
        angle
    }

    fn angle_jumps(self, x: Self) -> bool {
        self.value.angle_jumps(x.value)
    }
}

impl<S: Number, const N: usize> Neg for Taylor<S, N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self::by_order(|k| -self.order(k))
    }
}

impl<S: Number, const N: usize> Add for Taylor<S, N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::by_order(|k| self.order(k) + other.order(k))
    }
}

impl<S: Number, const N: usize> Sub for Taylor<S, N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::by_order(|k| self.order(k) - other.order(k))
    }
}

impl<S: Number, const N: usize> Mul for Taylor<S, N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (x, y) = (|k| self.order(k), |k| other.order(k));
        // Most factors are parameters and numbers.
        if !other.varies() {
            return Self::by_order(|k| x(k) * y(0));
        }
        if !self.varies() {
            return Self::by_order(|k| x(0) * y(k));
        }
        Self::by_order(|k| match k {
            0 => x(0) * y(0),
            1 => x(1) * y(0) + x(0) * y(1),
            2 => x(2) * y(0) + x(1) * y(1) * 2.0 + x(0) * y(2),
            _ => x(3) * y(0) + (x(2) * y(1) + x(1) * y(2)) * 3.0 + x(0) * y(3),
        })
    }
}

impl<S: Number, const N: usize> Mul<f64> for Taylor<S, N> {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        Self::by_order(|k| self.order(k) * other)
    }
}

impl<S: Number, const N: usize> Div for Taylor<S, N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // From x = q y: x‴ = q‴y + 3 q″y′ + 3 q′y″ + q y‴, likewise for the lower orders.
        let (x, y) = (self, |k| other.order(k));
        if !other.varies() {
            return Self::by_order(|k| x.order(k) / y(0));
        }
        let mut quotient = Self::fixed(x.value / y(0));
        for k in 1..=N {
            let q = |k| quotient.order(k);
            let rest = match k {
                1 => x.order(1) - q(0) * y(1),
                2 => x.order(2) - q(1) * y(1) * 2.0 - q(0) * y(2),
                _ => x.order(3) - (q(2) * y(1) + q(1) * y(2)) * 3.0 - q(0) * y(3),
            };
            quotient.derivatives[k - 1] = rest / y(0);
        }
        quotient
    }
}

impl<S: Number, const N: usize> AddAssign for Taylor<S, N> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Number, const N: usize> SubAssign for Taylor<S, N> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
