//! Numbers: plain, enclosed by bounds, and with derivatives.
//!
//! | type | meaning |
//! |---|---|
//! | `f64` | a plain number |
//! | [`Interval`] | bounds that enclose a number |
//! | [`Taylor<S, N>`](Taylor) | a number of type S with its first N derivatives, each of type S |
//! | [`Dual`], [`Jet`], [`Jet3`] | Taylor numbers with one, two and three derivatives |
//!
//! Expressions, curves and the relations of the kinematics are written once, on any [`Number`].
//! A function is stated once for each base, `f64` and [`Interval`], and its derivatives once for
//! all: a Taylor number is a number, so that derivatives with respect to different variables nest.

mod enclosure;
mod function;
mod interval;
mod real;
mod taylor;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

pub(super) use enclosure::{enclose, expand};
pub(super) use function::Unary;
pub use interval::Interval;
pub use taylor::Taylor;

/// A number with its derivative along one direction.
pub type Dual = Taylor<f64, 1>;

/// A number with two derivatives, most often with respect to time: a motion's value, velocity and
/// acceleration.
pub type Jet = Taylor<f64, 2>;

/// A number with three derivatives.
pub type Jet3<S = f64> = Taylor<S, 3>;

/// Declares the functions of one argument as methods.
macro_rules! by_name {
    ($($name:ident $function:ident),*) => {
        $(
            #[doc = concat!("Returns `", stringify!($name), "` of this number.")]
            fn $name(self) -> Self {
                self.apply(Unary::$function)
            }
        )*
    };
}

/// A number on which expressions, curves and relations can be evaluated.
///
/// Outside the domain of a function the result is not finite.
pub trait Number:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// Returns exactly `value`, which does not vary.
    fn constant(value: f64) -> Self;

    /// Returns a number about which nothing is known. It is not finite.
    fn unknown() -> Self;

    /// Returns the plain number, or one near the middle of an interval: it decides which piece of
    /// a function defined by pieces is in force.
    fn real(self) -> f64;

    /// Returns whether it is exactly zero and does not vary.
    fn is_zero(self) -> bool;

    /// Returns whether the value is a single number: always true but for intervals.
    fn is_single(self) -> bool;

    /// Returns whether value and derivatives are finite.
    fn is_finite(self) -> bool;

    /// Returns whether the value is outside a function's domain. Always false for plain numbers,
    /// where NaN itself says so.
    fn is_undefined(self) -> bool;

    /// Returns whether a derivative is not zero: always false for plain numbers and intervals.
    fn varies(self) -> bool;

    /// Returns the value as a number that stays as it is; a change along a direction stays.
    #[must_use]
    fn held(self) -> Self;

    /// Returns whether the value is at most that of `other`; `None` if that differs from point to
    /// point. NaN is at most any number, so that a minimum keeps it.
    fn at_most(self, other: Self) -> Option<bool>;

    /// Returns the smaller number, point by point; the first at a tie.
    fn smaller(self, other: Self) -> Self;

    /// Returns bounds of a number that is this one or `other`, whichever it is at a point.
    /// Derivatives are not known, as it may jump from one to the other.
    fn either(self, other: Self) -> Self;

    /// Returns bounds of the value, which are equal for a plain number.
    fn range(self) -> Interval;

    /// Returns the number where its value is in a range; `None` if it is in no point.
    fn within(self, range: Interval) -> Option<Self>;

    /// Returns bounds of a function that is this number in some points and `other` in the rest. The
    /// derivative of order `jump` is the first that may jump: those of higher order are not known.
    fn joined(self, other: Self, jump: usize) -> Self;

    /// Returns `function` of this number.
    fn apply(self, function: Unary) -> Self;

    /// Returns x^`exponent`. An exponent that does not vary may belong to any x that has a power,
    /// negative or zero: x² has the derivatives 0 and 2 at 0. A varying exponent needs x > 0.
    fn powf(self, exponent: Self) -> Self;

    /// Returns √(x² + y²) without overflow of the squares.
    fn hypot(self, y: Self) -> Self;

    /// Returns √(x² + y²), the length of a vector of moderate size.
    fn norm(self, y: Self) -> Self;

    /// Returns the angle of the point (`x`, `self`) \[rad\].
    fn atan2(self, x: Self) -> Self;

    /// Returns whether the angle of the point (`x`, `self`) jumps within the two intervals.
    fn angle_jumps(self, x: Self) -> bool;

    /// Returns the larger number, point by point; the first at a tie.
    fn larger(self, other: Self) -> Self {
        -(-self).smaller(-other)
    }

    /// Returns 1 − x² without cancellation near x = ±1.
    fn one_minus_square(self) -> Self {
        let one = Self::constant(1.0);
        (one - self) * (one + self)
    }

    /// Returns x².
    fn square(self) -> Self {
        self * self
    }

    /// Returns x³.
    fn cube(self) -> Self {
        self * self * self
    }

    by_name! {
        sin Sin, cos Cos, tan Tan, asin Asin, acos Acos, atan Atan, sinh Sinh, cosh Cosh,
        tanh Tanh, sqrt Sqrt, exp Exp, ln Ln, log10 Log10, abs Abs, sign Sign, floor Floor,
        ceil Ceil
    }
}
