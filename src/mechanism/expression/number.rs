//! What an expression can be evaluated on: plain numbers, and numbers with two derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::Scalar;

/// A number that expressions can be evaluated on.
///
/// Besides arithmetic it needs the chain rule, from which the functions of one argument follow,
/// and the few functions that are smooth in two.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The type of its value and of each of its derivatives.
    type Scalar: Scalar;

    /// A number that does not vary.
    fn fixed(value: Self::Scalar) -> Self;

    /// A number whose derivatives are not known.
    fn undecided(value: Self::Scalar) -> Self;

    /// Its value, without derivatives.
    fn value(self) -> Self::Scalar;

    /// Whether it has a derivative that is not zero; never so for a plain number.
    fn varies(self) -> bool;

    /// f(x), where `derivatives` gives \[f′, f″, f‴\] at x.
    fn chain(
        self,
        f: impl Fn(Self::Scalar) -> Self::Scalar,
        derivatives: impl Fn(Self::Scalar) -> [Self::Scalar; 3],
    ) -> Self;

    /// √(x² + y²).
    fn hypot(self, y: Self) -> Self;

    /// The angle of the point (`x`, `self`).
    fn atan2(self, x: Self) -> Self;

    /// x^`exponent`. Where the exponent does not vary this is right for any x that has a power,
    /// negative and zero too: x² has the derivatives 0 and 2 at 0. A varying exponent needs x > 0.
    fn power(self, exponent: Self) -> Self;

    /// The number `value`, which does not vary.
    fn constant(value: f64) -> Self {
        Self::fixed(Self::Scalar::constant(value))
    }
}

impl Number for f64 {
    type Scalar = f64;

    fn fixed(value: f64) -> Self {
        value
    }

    fn undecided(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn varies(self) -> bool {
        false
    }

    fn chain(self, f: impl Fn(f64) -> f64, _: impl Fn(f64) -> [f64; 3]) -> Self {
        f(self)
    }

    fn hypot(self, y: Self) -> Self {
        f64::hypot(self, y)
    }

    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }

    fn power(self, exponent: Self) -> Self {
        self.powf(exponent)
    }
}

/// The partial derivatives of a function of x and y, up to second order.
struct Partials {
    /// ∂f/∂x.
    x: f64,
    /// ∂f/∂y.
    y: f64,
    /// ∂²f/∂x².
    xx: f64,
    /// ∂²f/∂x∂y.
    xy: f64,
    /// ∂²f/∂y².
    yy: f64,
}

/// A value with its first and second derivative with respect to one variable, most often time.
///
/// ```
/// use biela::mechanism::Jet;
///
/// let t = Jet::variable(3.0);
/// assert_eq!(t * t, Jet { value: 9.0, first: 6.0, second: 2.0 });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// The first derivative.
    pub first: f64,
    /// The second derivative.
    pub second: f64,
}

impl Jet {
    /// A number that does not vary: both derivatives are zero.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self {
            value,
            first: 0.0,
            second: 0.0,
        }
    }

    /// The variable itself at `value`: derivatives 1 and 0.
    #[must_use]
    pub fn variable(value: f64) -> Self {
        Self {
            value,
            first: 1.0,
            second: 0.0,
        }
    }

    /// Whether the value and both derivatives are finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.value.is_finite() && self.first.is_finite() && self.second.is_finite()
    }
}

/// One term of the chain rule. A derivative of zero makes it vanish even where the outer
/// function's slope is infinite: √a has no slope at a = 0, but does not vary if a does not.
pub(super) fn term<S: Scalar>(slope: S, derivative: S) -> S {
    if derivative.is_zero() {
        S::constant(0.0)
    } else {
        slope * derivative
    }
}

/// `factor` · x^`exponent`. A factor of zero ends the derivatives of a polynomial, before a
/// negative power of zero can make 0 · ∞ of them.
pub(super) fn falling<S: Scalar>(factor: S, x: S, exponent: S) -> S {
    if factor.is_zero() {
        S::constant(0.0)
    } else {
        factor * x.powf(exponent)
    }
}

impl Jet {
    /// f(x, y) of that value, with its partial derivatives.
    fn compose(self, y: Self, value: f64, d: &Partials) -> Self {
        let x = self;
        Self {
            value,
            first: term(d.x, x.first) + term(d.y, y.first),
            second: term(d.x, x.second)
                + term(d.y, y.second)
                + term(d.xx, x.first * x.first)
                + term(2.0 * d.xy, x.first * y.first)
                + term(d.yy, y.first * y.first),
        }
    }
}

impl Number for Jet {
    type Scalar = f64;

    fn fixed(value: f64) -> Self {
        Jet::constant(value)
    }

    fn undecided(value: f64) -> Self {
        Self {
            value,
            first: f64::NAN,
            second: f64::NAN,
        }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn varies(self) -> bool {
        self.first != 0.0 || self.second != 0.0
    }

    fn chain(self, f: impl Fn(f64) -> f64, derivatives: impl Fn(f64) -> [f64; 3]) -> Self {
        let [f_x, f_xx, _] = derivatives(self.value);
        Self {
            value: f(self.value),
            first: term(f_x, self.first),
            second: term(f_x, self.second) + term(f_xx, self.first * self.first),
        }
    }

    fn hypot(self, y: Self) -> Self {
        let r = self.value.hypot(y.value);
        let (cos, sin) = (self.value / r, y.value / r);
        let partials = Partials {
            x: cos,
            y: sin,
            xx: sin * sin / r,
            xy: -sin * cos / r,
            yy: cos * cos / r,
        };
        self.compose(y, r, &partials)
    }

    fn atan2(self, x: Self) -> Self {
        // Here the first argument is the ordinate. Divided by r once at a time, lest r² leave
        // the range of numbers.
        let r = self.value.hypot(x.value);
        let (cos, sin) = (x.value / r, self.value / r);
        let partials = Partials {
            x: cos / r,
            y: -sin / r,
            xx: -2.0 * sin * cos / r / r,
            xy: (sin * sin - cos * cos) / r / r,
            yy: 2.0 * sin * cos / r / r,
        };
        self.compose(x, self.value.atan2(x.value), &partials)
    }

    fn power(self, exponent: Self) -> Self {
        let (x, y) = (self.value, exponent.value);
        let value = x.powf(y);
        let (ln, value_ln) = if x == 0.0 && y > 0.0 {
            (0.0, 0.0) // the limit of x^y ln x
        } else {
            (x.ln(), value * x.ln())
        };
        let partials = Partials {
            x: falling(y, x, y - 1.0),
            y: value_ln,
            xx: falling(y * (y - 1.0), x, y - 2.0),
            xy: x.powf(y - 1.0) * (1.0 + y * ln),
            yy: value_ln * ln,
        };
        self.compose(exponent, value, &partials)
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            first: self.first - other.first,
            second: self.second - other.second,
        }
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value
                + 2.0 * self.first * other.first
                + self.value * other.second,
        }
    }
}

impl Div for Jet {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // From x = q y: x′ = q′y + q y′ and x″ = q″y + 2 q′y′ + q y″.
        let value = self.value / other.value;
        let first = (self.first - value * other.first) / other.value;
        let second = (self.second - 2.0 * first * other.first - value * other.second) / other.value;
        Self {
            value,
            first,
            second,
        }
    }
}

impl Neg for Jet {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            first: -self.first,
            second: -self.second,
        }
    }
}
