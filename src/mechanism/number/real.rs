//! Plain numbers.

use super::{Interval, Number, Unary, function};

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn unknown() -> Self {
        Self::NAN
    }

    fn real(self) -> f64 {
        self
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn is_single(self) -> bool {
        true
    }

    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }

    fn is_undefined(self) -> bool {
        false
    }

    fn varies(self) -> bool {
        false
    }

    fn held(self) -> Self {
        self
    }

    fn at_most(self, other: Self) -> Option<bool> {
        Some(self <= other || self.is_nan())
    }

    fn smaller(self, other: Self) -> Self {
        if self <= other || self.is_nan() {
            self
        } else {
            other
        }
    }

    #[allow(clippy::float_cmp, reason = "one value or none")]
    fn either(self, other: Self) -> Self {
        if self == other { self } else { Self::NAN }
    }

    fn range(self) -> Interval {
        Interval::point(self)
    }

    fn within(self, range: Interval) -> Option<Self> {
        range.contains(self).then_some(self)
    }

    fn joined(self, other: Self, _jump: usize) -> Self {
        self.either(other)
    }

    fn apply(self, function: Unary) -> Self {
        match function {
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Tanh => self.tanh(),
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => self.exp(),
            Unary::Ln => self.ln(),
            Unary::Log10 => self.log10(),
            Unary::Abs => self.abs(),
            // Unlike `signum`, 0 at 0.
            Unary::Sign if self == 0.0 => self,
            Unary::Sign => self.signum(),
            Unary::Floor => function::floor(self),
            Unary::Ceil => function::ceil(self),
        }
    }

    fn powf(self, exponent: Self) -> Self {
        // The powers of most formulas, without a call of the library.
        match exponent {
            0.0 => 1.0,
            1.0 => self,
            2.0 => self * self,
            _ => Self::powf(self, exponent),
        }
    }

    fn hypot(self, y: Self) -> Self {
        Self::hypot(self, y)
    }

    fn norm(self, y: Self) -> Self {
        (self * self + y * y).sqrt()
    }

    fn atan2(self, x: Self) -> Self {
        Self::atan2(self, x)
    }

    fn angle_jumps(self, _x: Self) -> bool {
        false
    }
}
