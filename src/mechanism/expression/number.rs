//! What an expression can be evaluated on: plain numbers, and numbers with two derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that expressions can be evaluated on.
///
/// Besides arithmetic it needs the chain rule, from which all functions of the language follow.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A number that does not vary.
    fn constant(value: f64) -> Self;

    /// Its value, without derivatives.
    fn value(self) -> f64;

    /// f(x), where `derivatives` gives \[f′, f″\] at x.
    fn chain(self, f: impl Fn(f64) -> f64, derivatives: impl Fn(f64) -> [f64; 2]) -> Self;

    /// f(x, y), where `derivatives` gives the partial derivatives of first and second order.
    fn chain2(
        self,
        y: Self,
        f: impl Fn(f64, f64) -> f64,
        derivatives: impl Fn(f64, f64) -> Partials,
    ) -> Self;
}

/// The partial derivatives of a function of x and y, up to second order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partials {
    /// ∂f/∂x.
    pub x: f64,
    /// ∂f/∂y.
    pub y: f64,
    /// ∂²f/∂x².
    pub xx: f64,
    /// ∂²f/∂x∂y.
    pub xy: f64,
    /// ∂²f/∂y².
    pub yy: f64,
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn chain(self, f: impl Fn(f64) -> f64, _: impl Fn(f64) -> [f64; 2]) -> Self {
        f(self)
    }

    fn chain2(
        self,
        y: Self,
        f: impl Fn(f64, f64) -> f64,
        _: impl Fn(f64, f64) -> Partials,
    ) -> Self {
        f(self, y)
    }
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
fn term(slope: f64, derivative: f64) -> f64 {
    if derivative == 0.0 {
        0.0
    } else {
        slope * derivative
    }
}

impl Number for Jet {
    fn constant(value: f64) -> Self {
        Jet::constant(value)
    }

    fn value(self) -> f64 {
        self.value
    }

    fn chain(self, f: impl Fn(f64) -> f64, derivatives: impl Fn(f64) -> [f64; 2]) -> Self {
        let [f_x, f_xx] = derivatives(self.value);
        Self {
            value: f(self.value),
            first: term(f_x, self.first),
            second: term(f_x, self.second) + term(f_xx, self.first * self.first),
        }
    }

    fn chain2(
        self,
        y: Self,
        f: impl Fn(f64, f64) -> f64,
        derivatives: impl Fn(f64, f64) -> Partials,
    ) -> Self {
        let x = self;
        let d = derivatives(x.value, y.value);
        Self {
            value: f(x.value, y.value),
            first: term(d.x, x.first) + term(d.y, y.first),
            second: term(d.x, x.second)
                + term(d.y, y.second)
                + term(d.xx, x.first * x.first)
                + term(2.0 * d.xy, x.first * y.first)
                + term(d.yy, y.first * y.first),
        }
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
