//! The functions of intervals.

use std::f64::consts::{LN_10, PI, TAU};

use super::{Interval, UNDERFLOW};
use crate::mechanism::expression::scalar::Scalar;

/// By how many units in the last place a function of the mathematical library may be wrong, plus
/// one: the larger errors that the GNU C library's manual lists for these functions are 2.
const LIBRARY_ULPS: usize = 3;

impl Interval {
    /// The numbers for which the mathematical library may have returned `result`.
    fn of_library(result: f64) -> Self {
        let mut bounds = Self::point(result);
        for _ in 0..LIBRARY_ULPS {
            bounds.low = bounds.low.next_down();
            bounds.high = bounds.high.next_up();
        }
        bounds
    }

    /// A library function that is 0 only where it is exactly so.
    fn of_exact_zero(result: f64) -> Self {
        if result == 0.0 {
            Self::point(0.0)
        } else {
            Self::of_library(result)
        }
    }

    /// The range of a monotone function, which is 0 only where it is exactly so.
    fn monotone(self, f: fn(f64) -> f64) -> Self {
        Self::hull([self.low, self.high].map(|x| Self::of_exact_zero(f(x))))
    }

    /// Whether it may contain a number (k + `phase`) · `period`, k an integer.
    fn may_contain(self, phase: f64, period: f64) -> bool {
        // Three roundings and that of the period, each of half an epsilon.
        let count = |x: f64, slack: f64| {
            let turns = x / period;
            turns - phase + slack * 4.0 * f64::EPSILON * (turns.abs() + 1.0)
        };
        let none = count(self.high, 1.0).floor() < count(self.low, -1.0).ceil();
        !none
    }

    /// The range of a sine or cosine with crests at (k + `crest`) · 2π.
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

    /// x^`exponent` for an integer exponent.
    fn integer_power(self, exponent: f64) -> Self {
        let even = (exponent / 2.0).fract() == 0.0;
        let base = if even { self.abs() } else { self };
        if exponent < 0.0 && base.low <= 0.0 && base.high >= 0.0 {
            return Self::UNDEFINED;
        }
        Self::hull([base.low, base.high].map(|x| Self::power_of(x, exponent)))
    }

    /// x^y of two numbers.
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

impl Scalar for Interval {
    fn constant(value: f64) -> Self {
        Self::point(value)
    }

    fn ln_10() -> Self {
        Self::new(LN_10.next_down(), LN_10.next_up())
    }

    fn is_zero(self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }

    fn is_single(self) -> bool {
        self.low >= self.high
    }

    fn number(self) -> f64 {
        self.midpoint()
    }

    fn is_undefined(self) -> bool {
        self.low.is_nan() || self.high.is_nan()
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

    fn at_least(self, other: Self) -> Option<bool> {
        other.at_most(self)
    }

    fn smaller(self, other: Self) -> Self {
        if self.is_undefined() || other.is_undefined() {
            return Self::UNDEFINED;
        }
        Self::new(self.low.min(other.low), self.high.min(other.high))
    }

    fn abs_slope(self) -> Self {
        if self.low >= 0.0 {
            Self::point(1.0)
        } else if self.high <= 0.0 {
            Self::point(-1.0)
        } else {
            Self::UNDEFINED
        }
    }

    fn sign(self) -> Self {
        Self::new(Scalar::sign(self.low), Scalar::sign(self.high))
    }

    fn one_minus_square(self) -> Self {
        let one = Self::point(1.0);
        let magnitude = self.abs();
        Self::hull(
            [magnitude.low, magnitude.high]
                .map(Self::point)
                .map(|x| (one - x) * (one + x)),
        )
    }

    fn square(self) -> Self {
        let magnitude = self.abs();
        Self::hull([magnitude.low, magnitude.high].map(|x| Self::point(x) * Self::point(x)))
    }

    fn cube(self) -> Self {
        Self::hull(
            [self.low, self.high]
                .map(Self::point)
                .map(|x| x * x.square()),
        )
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
            _ if self.low > 0.0 || self.low == 0.0 && exponent.low > 0.0 => {
                // Monotone in the base for any exponent, and in the exponent for any base.
                let ends = |x| [exponent.low, exponent.high].map(|y| Self::power_of(x, y));
                Self::hull([Self::hull(ends(self.low)), Self::hull(ends(self.high))])
            }
            _ => Self::UNDEFINED,
        }
    }

    fn angle_jumps(self, x: Self) -> bool {
        let y = self;
        // The angle is continuous off the half-line y = 0, x ≤ 0, and onto it from y > 0.
        let off = x.low > 0.0 || y.low > 0.0 || y.high < 0.0;
        let onto = y.low == 0.0 && (x.high < 0.0 || x.is_zero());
        !off && !onto
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
        let ends = |y: f64| [x.low, x.high].map(|x| Self::of_exact_zero((y + 0.0).atan2(x + 0.0)));
        Self::hull([Self::hull(ends(y.low)), Self::hull(ends(y.high))])
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

    fn sin(self) -> Self {
        self.wave(f64::sin, 0.25)
    }

    fn cos(self) -> Self {
        self.wave(f64::cos, 0.0)
    }

    fn tan(self) -> Self {
        // No number is an odd multiple of π/2.
        if !self.is_single() && self.may_contain(0.5, PI) {
            return Self::UNDEFINED;
        }
        self.monotone(f64::tan)
    }

    fn asin(self) -> Self {
        self.intersection(Self::new(-1.0, 1.0)).monotone(f64::asin)
    }

    fn acos(self) -> Self {
        self.intersection(Self::new(-1.0, 1.0)).monotone(f64::acos)
    }

    fn atan(self) -> Self {
        self.monotone(f64::atan)
    }

    fn sinh(self) -> Self {
        self.monotone(f64::sinh)
    }

    fn cosh(self) -> Self {
        self.abs()
            .monotone(f64::cosh)
            .intersection(Self::new(1.0, f64::INFINITY))
    }

    fn tanh(self) -> Self {
        self.monotone(f64::tanh)
    }

    fn sqrt(self) -> Self {
        let root = |x: f64| {
            let root = x.sqrt();
            let error = if x < UNDERFLOW && x != 0.0 {
                f64::NAN
            } else {
                (-root).mul_add(root, x)
            };
            Self::of_rounded(root, error)
        };
        let domain = self.intersection(Self::new(0.0, f64::INFINITY));
        Self::hull([domain.low, domain.high].map(root))
    }

    fn exp(self) -> Self {
        Self::hull([self.low, self.high].map(|x| Self::of_library(x.exp())))
            .intersection(Self::new(0.0, f64::INFINITY))
    }

    fn ln(self) -> Self {
        self.intersection(Self::new(0.0, f64::INFINITY))
            .monotone(f64::ln)
    }

    fn log10(self) -> Self {
        self.intersection(Self::new(0.0, f64::INFINITY))
            .monotone(f64::log10)
    }

    fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            -self
        } else if self.is_undefined() {
            Self::UNDEFINED
        } else {
            Self::new(0.0, self.magnitude())
        }
    }

    fn floor(self) -> Self {
        Self::new(self.low.floor(), self.high.floor())
    }

    fn ceil(self) -> Self {
        Self::new(self.low.ceil(), self.high.ceil())
    }
}
