//! Numbers that know how they change along a direction.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::Scalar;

/// A number with its derivative along one direction in the space of whatever it depends on.
///
/// As the [`Scalar`] of a [`Jet3`](super::Jet3) it gives derivatives in two ways at once: those
/// with respect to time, each with its own derivative along the direction.
///
/// ```
/// use biela::mechanism::{Dual, Jet3};
///
/// // x³ at x = 2, whose slope and curvature change by 12 and 6 as x changes by 1.
/// let x = Jet3::variable(Dual { value: 2.0, along: 1.0 });
/// assert_eq!((x * x * x).first, Dual { value: 12.0, along: 12.0 });
/// assert_eq!((x * x * x).second, Dual { value: 12.0, along: 6.0 });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivative along the direction.
    pub along: f64,
}

impl Dual {
    /// f(x) of that value, whose slope is `slope`.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            along: part(slope, self.along),
        }
    }

    /// A function of two numbers of that value, with its partial derivatives.
    fn compose(self, y: Self, value: f64, [by_x, by_y]: [f64; 2]) -> Self {
        Self {
            value,
            along: part(by_x, self.along) + part(by_y, y.along),
        }
    }
}

/// One term of the chain rule: what does not change contributes nothing, however steep.
fn part(slope: f64, along: f64) -> f64 {
    if along == 0.0 { 0.0 } else { slope * along }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Self { value, along: 0.0 }
    }

    fn ln_10() -> Self {
        Self::constant(f64::ln_10())
    }

    fn is_zero(self) -> bool {
        self.value == 0.0 && self.along == 0.0
    }

    fn is_single(self) -> bool {
        true
    }

    fn number(self) -> f64 {
        self.value
    }

    fn is_undefined(self) -> bool {
        false
    }

    fn at_most(self, other: Self) -> Option<bool> {
        self.value.at_most(other.value)
    }

    fn at_least(self, other: Self) -> Option<bool> {
        self.value.at_least(other.value)
    }

    fn smaller(self, other: Self) -> Self {
        if self.value <= other.value || other.value.is_nan() {
            self
        } else {
            other
        }
    }

    fn abs_slope(self) -> Self {
        Self::constant(self.value.abs_slope())
    }

    fn sign(self) -> Self {
        Self::constant(self.value.sign())
    }

    fn one_minus_square(self) -> Self {
        self.chain(self.value.one_minus_square(), -2.0 * self.value)
    }

    fn square(self) -> Self {
        self.chain(self.value.square(), 2.0 * self.value)
    }

    fn cube(self) -> Self {
        self.chain(self.value.cube(), 3.0 * self.value * self.value)
    }

    fn powf(self, exponent: Self) -> Self {
        let (x, y) = (self.value, exponent.value);
        let value = x.powf(y);
        let by_x = if y == 0.0 { 0.0 } else { y * x.powf(y - 1.0) };
        // The limit of x^y ln x.
        let by_y = if x == 0.0 && y > 0.0 {
            0.0
        } else {
            value * x.ln()
        };
        self.compose(exponent, value, [by_x, by_y])
    }

    fn angle_jumps(self, _: Self) -> bool {
        false
    }

    fn atan2(self, x: Self) -> Self {
        let r = self.value.hypot(x.value);
        let (cos, sin) = (x.value / r, self.value / r);
        self.compose(x, self.value.atan2(x.value), [cos / r, -sin / r])
    }

    fn hypot(self, y: Self) -> Self {
        let r = self.value.hypot(y.value);
        self.compose(y, r, [self.value / r, y.value / r])
    }

    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos)
    }

    fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(cos, -sin)
    }

    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, 1.0 + tan * tan)
    }

    fn asin(self) -> Self {
        let slope = 1.0 / self.value.one_minus_square().sqrt();
        self.chain(self.value.asin(), slope)
    }

    fn acos(self) -> Self {
        let slope = -1.0 / self.value.one_minus_square().sqrt();
        self.chain(self.value.acos(), slope)
    }

    fn atan(self) -> Self {
        self.chain(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }

    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }

    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }

    fn tanh(self) -> Self {
        self.chain(self.value.tanh(), self.value.cosh().powi(-2))
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    fn log10(self) -> Self {
        self.chain(self.value.log10(), 1.0 / (self.value * f64::ln_10()))
    }

    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.abs_slope())
    }

    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }

    fn ceil(self) -> Self {
        Self::constant(self.value.ceil())
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            along: self.along + other.along,
        }
    }
}

impl Sub for Dual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            along: self.along - other.along,
        }
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        self.compose(other, value, [other.value, self.value])
    }
}

impl Mul<f64> for Dual {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl Div for Dual {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.compose(other, value, [1.0 / other.value, -value / other.value])
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            along: -self.along,
        }
    }
}
