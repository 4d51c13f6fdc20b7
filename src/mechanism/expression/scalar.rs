//! What a value or a derivative can be: a plain number, or an interval that encloses it.

use std::f64::consts::LN_10;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The type of a value and of each of its derivatives: `f64`, [`Interval`](super::Interval), or
/// [`Dual`](super::Dual).
///
/// Has the arithmetic and the functions from which every function of the language and its
/// derivatives are built. Outside its domain a function is not finite.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Exactly `value`.
    fn constant(value: f64) -> Self;

    /// ln 10.
    fn ln_10() -> Self;

    /// Whether it is exactly zero.
    fn is_zero(self) -> bool;

    /// Whether it stands for one number: always so for a number.
    fn is_single(self) -> bool;

    /// The number itself, or one near the middle of an interval: decides which of several pieces
    /// of a function is in force.
    fn number(self) -> f64;

    /// Whether no statement is made about it. Never so for a number, which tells that itself by
    /// being NaN or infinite.
    fn is_undefined(self) -> bool;

    /// Whether it is at most `other`, `None` where that differs from point to point. A NaN is
    /// at most anything, so that it comes through a minimum.
    fn at_most(self, other: Self) -> Option<bool>;

    /// Whether it is at least `other`, `None` where that differs from point to point. A NaN is
    /// at least anything, so that it comes through a maximum.
    fn at_least(self, other: Self) -> Option<bool>;

    /// The smaller of two, whichever that is from point to point.
    fn smaller(self, other: Self) -> Self;

    /// The slope of the absolute value: −1 below 0, else 1.
    fn abs_slope(self) -> Self;

    /// −1, 0 or 1.
    fn sign(self) -> Self;

    /// 1 − x².
    fn one_minus_square(self) -> Self;

    /// x².
    fn square(self) -> Self;

    /// x³.
    fn cube(self) -> Self;

    /// x^`exponent`.
    fn powf(self, exponent: Self) -> Self;

    /// Whether the angle of the point (`x`, `self`) jumps, never so for a number.
    fn angle_jumps(self, x: Self) -> bool;

    /// The angle of the point (`x`, `self`).
    fn atan2(self, x: Self) -> Self;

    /// √(x² + y²).
    fn hypot(self, y: Self) -> Self;

    /// The sine.
    fn sin(self) -> Self;

    /// The cosine.
    fn cos(self) -> Self;

    /// The tangent.
    fn tan(self) -> Self;

    /// The arc sine.
    fn asin(self) -> Self;

    /// The arc cosine.
    fn acos(self) -> Self;

    /// The arc tangent.
    fn atan(self) -> Self;

    /// The hyperbolic sine.
    fn sinh(self) -> Self;

    /// The hyperbolic cosine.
    fn cosh(self) -> Self;

    /// The hyperbolic tangent.
    fn tanh(self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The exponential function.
    fn exp(self) -> Self;

    /// The natural logarithm.
    fn ln(self) -> Self;

    /// The decimal logarithm.
    fn log10(self) -> Self;

    /// The absolute value.
    fn abs(self) -> Self;

    /// The largest integer not above it.
    fn floor(self) -> Self;

    /// The smallest integer not below it.
    fn ceil(self) -> Self;
}

/// Functions that `f64` has itself.
macro_rules! own {
    ($($function:ident)*) => {
        $(fn $function(self) -> Self {
            f64::$function(self)
        })*
    };
}

impl Scalar for f64 {
    own! { sin cos tan asin acos atan sinh cosh tanh sqrt exp ln log10 abs floor ceil }

    fn constant(value: f64) -> Self {
        value
    }

    fn ln_10() -> Self {
        LN_10
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn is_single(self) -> bool {
        true
    }

    fn number(self) -> f64 {
        self
    }

    fn is_undefined(self) -> bool {
        false
    }

    fn at_most(self, other: Self) -> Option<bool> {
        Some(self <= other || self.is_nan())
    }

    fn at_least(self, other: Self) -> Option<bool> {
        Some(self >= other || self.is_nan())
    }

    fn smaller(self, other: Self) -> Self {
        self.min(other)
    }

    fn abs_slope(self) -> Self {
        if self < 0.0 { -1.0 } else { 1.0 }
    }

    fn sign(self) -> Self {
        // Unlike `signum`, 0 at 0.
        if self == 0.0 { self } else { self.signum() }
    }

    fn one_minus_square(self) -> Self {
        // Does not cancel near the ends.
        (1.0 - self) * (1.0 + self)
    }

    fn square(self) -> Self {
        self * self
    }

    fn cube(self) -> Self {
        self * self * self
    }

    fn powf(self, exponent: Self) -> Self {
        f64::powf(self, exponent)
    }

    fn angle_jumps(self, _: Self) -> bool {
        false
    }

    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }

    fn hypot(self, y: Self) -> Self {
        f64::hypot(self, y)
    }
}
