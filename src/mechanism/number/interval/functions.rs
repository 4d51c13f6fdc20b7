//! Intervals as numbers: the range of each function.

use std::f64::consts::{PI, TAU};

use super::{Interval, UNDERFLOW};
use crate::mechanism::number::{Number, Unary, function};

/// Largest error of a function of the mathematical library in units in the last place, plus one:
/// the GNU C library's manual lists up to 2 for these functions.
const LIBRARY_ULPS: usize = 3;

const NOT_NEGATIVE: Interval = Interval {
    low: 0.0,
    high: f64::INFINITY,
};

impl Interval {
    /// Returns the numbers for which the mathematical library may have returned `result`.
    fn of_library(result: f64) -> Self {
        let mut bounds = Self::point(result);
        for _ in 0..LIBRARY_ULPS {
            bounds.low = bounds.low.next_down();
            bounds.high = bounds.high.next_up();
        }
        bounds
    }

    /// Returns the bounds of a library function that is 0 only where it is exactly so.
    fn of_exact_zero(result: f64) -> Self {
        if result == 0.0 {
            Self::point(0.0)
        } else {
            Self::of_library(result)
        }
    }

    /// Returns the hull of what `of` gives at both ends.
    fn at_ends(self, of: impl Fn(f64) -> Self) -> Self {
        Self::hull([of(self.low), of(self.high)])
    }

    /// Returns the range of a monotone function that is 0 only where it is exactly so.
    fn monotone(self, f: fn(f64) -> f64) -> Self {
        self.at_ends(|x| Self::of_exact_zero(f(x)))
    }

    /// Returns whether it may contain a number (k + `phase`) · `period`, k an integer.
    fn may_contain(self, phase: f64, period: f64) -> bool {
        // Three roundings and that of the period, each of half an epsilon.
        let count = |x: f64, slack: f64| {
            let turns = x / period;
            turns - phase + slack * 4.0 * f64::EPSILON * (turns.abs() + 1.0)
        };
        let none = count(self.high, 1.0).floor() < count(self.low, -1.0).ceil();
        !none
    }

    /// Returns the range of a sine or cosine with crests at (k + `crest`) · 2π.
    fn wave(self, f: fn(f64) -> f64, crest: f64) -> Self {
        let ends = self.monotone(f);
        if ends.is_undefined() {
            return ends;
        }
        let reaches = |phase| self.may_contain(phase, TAU);
        Self {
            low: if reaches(crest + 0.5) {
                -1.0
            } else {
                ends.low.max(-1.0)
            },
            high: if reaches(crest) {
                1.0
            } else {
                ends.high.min(1.0)
            },
        }
    }

    /// Returns the range of the square root, rounded outward only where it is inexact.
    fn root(self) -> Self {
        self.intersection(NOT_NEGATIVE).at_ends(|x| {
            let root = x.sqrt();
            let error = if x < UNDERFLOW && x != 0.0 {
                f64::NAN
            } else {
                (-root).mul_add(root, x)
            };
            Self::of_rounded(root, error)
        })
    }

    /// Returns x^`exponent` for an integer exponent.
    fn integer_power(self, exponent: f64) -> Self {
        let even = (exponent / 2.0).fract() == 0.0;
        let base = if even { self.abs() } else { self };
        if exponent < 0.0 && base.contains(0.0) {
            return Self::UNDEFINED;
        }
        base.at_ends(|x| Self::power_of(x, exponent))
    }

    /// Returns x^y of two numbers.
    fn power_of(x: f64, y: f64) -> Self {
        if x == 0.0 && y > 0.0 {
            return Self::point(0.0);
        }
        let power = Self::of_library(x.powf(y));
        if x >= 0.0 {
            Self::new(power.low.max(0.0), power.high)
        } else {
            power
        }
    }
}

impl Number for Interval {
    fn constant(value: f64) -> Self {
        Self::point(value)
    }

    fn unknown() -> Self {
        Self::new(f64::NEG_INFINITY, f64::INFINITY)
    }

    fn real(self) -> f64 {
        self.midpoint()
    }

    fn is_zero(self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }

    fn is_single(self) -> bool {
        self.low >= self.high
    }

    fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    fn is_undefined(self) -> bool {
        self.low.is_nan() || self.high.is_nan()
    }

    fn varies(self) -> bool {
        false
    }

    fn held(self) -> Self {
        self
    }

    fn at_most(self, other: Self) -> Option<bool> {
        if self.high <= other.low {
            Some(true)
        } else if self.low >= other.high {
            Some(false)
        } else {
            None
        }
    }

    fn smaller(self, other: Self) -> Self {
        if self.is_undefined() || other.is_undefined() {
            return Self::UNDEFINED;
        }
        Self::new(self.low.min(other.low), self.high.min(other.high))
    }

    fn either(self, other: Self) -> Self {
        Self::hull([self, other])
    }

    fn range(self) -> Interval {
        self
    }

    fn within(self, range: Interval) -> Option<Self> {
        let part = self.intersection(range);
        (!part.is_undefined()).then_some(part)
    }

    fn joined(self, other: Self, _jump: usize) -> Self {
        Self::hull([self, other])
    }

    fn apply(self, function: Unary) -> Self {
        let from_minus_one_to_one = || self.intersection(Self::new(-1.0, 1.0));
        match function {
            Unary::Sin => self.wave(f64::sin, 0.25),
            Unary::Cos => self.wave(f64::cos, 0.0),
            // No number is an odd multiple of π/2.
            Unary::Tan if !self.is_single() && self.may_contain(0.5, PI) => Self::UNDEFINED,
            Unary::Tan => self.monotone(f64::tan),
            Unary::Asin => from_minus_one_to_one().monotone(f64::asin),
            Unary::Acos => from_minus_one_to_one().monotone(f64::acos),
            Unary::Atan => self.monotone(f64::atan),
            Unary::Sinh => self.monotone(f64::sinh),
            Unary::Cosh => {
                let range = self.abs().monotone(f64::cosh);
                range.intersection(Self::new(1.0, f64::INFINITY))
            }
            Unary::Tanh => self.monotone(f64::tanh),
            Unary::Sqrt => self.root(),
            Unary::Exp => {
                let range = self.at_ends(|x| Self::of_library(x.exp()));
                range.intersection(NOT_NEGATIVE)
            }
            Unary::Ln => self.intersection(NOT_NEGATIVE).monotone(f64::ln),
            Unary::Log10 => self.intersection(NOT_NEGATIVE).monotone(f64::log10),
            Unary::Abs if self.low >= 0.0 => self,
            Unary::Abs if self.high <= 0.0 => -self,
            Unary::Abs if self.is_undefined() => Self::UNDEFINED,
            Unary::Abs => Self::new(0.0, self.magnitude()),
            Unary::Sign => Self::new(Number::sign(self.low), Number::sign(self.high)),
            // To rounding below an integer both it and the one before may be meant.
            Unary::Floor => Self::new(self.low.floor(), function::floor(self.high)),
            Unary::Ceil => Self::new(function::ceil(self.low), self.high.ceil()),
        }
    }

    fn powf(self, exponent: Self) -> Self {
        if self.is_undefined() || exponent.is_undefined() {
            return Self::UNDEFINED;
        }
        let integer = exponent.is_single() && exponent.low.fract() == 0.0;
        match exponent.low {
            0.0 if integer => Self::point(1.0),
            1.0 if integer => self,
            2.0 if integer => self.square(),
            _ if integer => self.integer_power(exponent.low),
            // Monotone in the base for any exponent, and in the exponent for any base.
            _ if self.low > 0.0 || self.low == 0.0 && exponent.low > 0.0 => {
                self.at_ends(|x| exponent.at_ends(|y| Self::power_of(x, y)))
            }
            _ => Self::UNDEFINED,
        }
    }

    fn hypot(self, y: Self) -> Self {
        let (x, y) = (self.abs(), y.abs());
        if x.is_undefined() || y.is_undefined() {
            return Self::UNDEFINED;
        }
        Self::hull([
            Self::of_exact_zero(x.low.hypot(y.low)),
            Self::of_exact_zero(x.high.hypot(y.high)),
        ])
    }

    fn norm(self, y: Self) -> Self {
        self.hypot(y)
    }

    fn atan2(self, x: Self) -> Self {
        let y = self;
        if y.is_undefined() || x.is_undefined() {
            return Self::UNDEFINED;
        }
        if y.angle_jumps(x) {
            let half_turn = Self::of_library(PI).high;
            return Self::new(-half_turn, half_turn);
        }
        // Along each side of the rectangle it is monotone. Adding zero takes the sign off one.
        y.at_ends(|y| x.at_ends(|x| Self::of_exact_zero((y + 0.0).atan2(x + 0.0))))
    }

    fn angle_jumps(self, x: Self) -> bool {
        let y = self;
        // The angle is continuous off the half-line y = 0, x ≤ 0, and onto it from y > 0.
        let off = x.low > 0.0 || y.low > 0.0 || y.high < 0.0;
        let onto = y.low == 0.0 && (x.high < 0.0 || x.is_zero());
        !off && !onto
    }

    fn one_minus_square(self) -> Self {
        let one = Self::point(1.0);
        self.abs()
            .at_ends(|x| (one - Self::point(x)) * (one + Self::point(x)))
    }

    fn square(self) -> Self {
        self.abs().at_ends(|x| Self::point(x) * Self::point(x))
    }

    fn cube(self) -> Self {
        self.at_ends(|x| Self::point(x) * Self::point(x).square())
    }
}
