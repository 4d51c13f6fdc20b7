//! Numbers with two derivatives along a motion, for truths that share no code with biela.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taylor {
    pub(super) value: f64,
    pub(super) first: f64,
    pub(super) second: f64,
}

impl Taylor {
    pub(super) const fn new(value: f64, first: f64, second: f64) -> Self {
        Self {
            value,
            first,
            second,
        }
    }

    /// f(self) for a function with these derivatives at the value.
    fn chain(self, f: f64, df: f64, ddf: f64) -> Self {
        let second = ddf * self.first * self.first + df * self.second;
        Self::new(f, df * self.first, second)
    }

    pub(super) fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos, -sin)
    }

    pub(super) fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(cos, -sin, -cos)
    }

    pub(super) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }

    pub(super) fn acos(self) -> Self {
        let sine = (1.0 - self.value * self.value).sqrt();
        self.chain(self.value.acos(), -1.0 / sine, -self.value / sine.powi(3))
    }

    pub(super) fn hypot(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }

    /// Angle of the point (x, self).
    pub(super) fn atan2(self, x: Self) -> Self {
        let square = x * x + self * self;
        // The rate (x ẏ − y ẋ)/r² and its derivative.
        let turning = x.value * self.first - self.value * x.first;
        let turning_rate = x.value * self.second - self.value * x.second;
        let first = turning / square.value;
        let second = turning_rate / square.value - first * square.first / square.value;
        Self::new(self.value.atan2(x.value), first, second)
    }
}

impl From<f64> for Taylor {
    fn from(value: f64) -> Self {
        Self::new(value, 0.0, 0.0)
    }
}

impl Neg for Taylor {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.value, -self.first, -self.second)
    }
}

impl Add for Taylor {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self::new(
            self.value + o.value,
            self.first + o.first,
            self.second + o.second,
        )
    }
}

impl Sub for Taylor {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Taylor {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        Self::new(
            self.value * o.value,
            self.first * o.value + self.value * o.first,
            self.second * o.value + 2.0 * self.first * o.first + self.value * o.second,
        )
    }
}

impl Div for Taylor {
    type Output = Self;

    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.value;
        self * o.chain(inverse, -inverse * inverse, 2.0 * inverse.powi(3))
    }
}

macro_rules! with_numbers {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait<f64> for Taylor {
            type Output = Self;

            fn $method(self, other: f64) -> Self {
                $trait::$method(self, Self::from(other))
            }
        }

        impl $trait<Taylor> for f64 {
            type Output = Taylor;

            fn $method(self, other: Taylor) -> Taylor {
                $trait::$method(Taylor::from(self), other)
            }
        }
    )*};
}

with_numbers!(Add add, Sub sub, Mul mul, Div div);
