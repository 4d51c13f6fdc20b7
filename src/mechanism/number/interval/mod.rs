//! Intervals with bounds rounded outward.

mod functions;

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::Number;

/// The real numbers from `low` to `high`, both included.
///
/// Arithmetic and functions enclose: for any numbers in the operands the exact result lies in the
/// resulting interval. Sums, products, quotients and square roots that are exact stay so; all else
/// is rounded outward. Where a result is not defined for all numbers in the operands, both bounds
/// are NaN.
///
/// ```
/// use biela::mechanism::Interval;
///
/// let x = Interval::new(-1.0, 2.0);
/// assert_eq!(x + x, Interval::new(-2.0, 4.0));
/// assert_eq!(x * x, Interval::new(-2.0, 4.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
}

/// The rounding error of a product or quotient below this magnitude may itself be too small for a
/// number: f64's smallest normal number over its relative precision, and a margin.
const UNDERFLOW: f64 = 1e-290;

impl Interval {
    const UNDEFINED: Self = Self {
        low: f64::NAN,
        high: f64::NAN,
    };

    const ONE: Self = Self {
        low: 1.0,
        high: 1.0,
    };

    /// Makes the interval from `low` to `high`, undefined if one is NaN or `low` is larger.
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high {
            Self { low, high }
        } else {
            Self::UNDEFINED
        }
    }

    /// Makes the interval that contains only `value`.
    #[must_use]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Returns a number in the interval, near its middle.
    #[must_use]
    pub fn midpoint(self) -> f64 {
        self.low.midpoint(self.high)
    }

    /// Returns the largest absolute value in it.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// Returns whether `value` lies in it.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Returns the numbers in both intervals.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        if self.is_undefined() || other.is_undefined() {
            return Self::UNDEFINED;
        }
        Self::new(self.low.max(other.low), self.high.min(other.high))
    }

    /// Returns the smallest interval that contains all of `bounds`, undefined if one of them is.
    pub(super) fn hull<const N: usize>(bounds: [Self; N]) -> Self {
        let mut hull = bounds[0];
        for bound in bounds {
            if bound.is_undefined() {
                return Self::UNDEFINED;
            }
            hull.low = hull.low.min(bound.low);
            hull.high = hull.high.max(bound.high);
        }
        hull
    }

    /// Returns the exact result of which `rounded` is the nearest number, between neighbours.
    /// `error` is the exact result less `rounded`; only its sign matters, NaN is unknown.
    fn of_rounded(rounded: f64, error: f64) -> Self {
        // An infinite result may stand for a finite one; its neighbour bounds that.
        Self {
            low: if error >= 0.0 {
                rounded
            } else {
                rounded.next_down()
            },
            high: if error <= 0.0 {
                rounded
            } else {
                rounded.next_up()
            },
        }
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |x: f64, y: f64| {
            // Knuth's two-sum: x + y = sum + error exactly.
            let sum = x + y;
            let of_y = sum - x;
            Self::of_rounded(sum, (x - (sum - of_y)) + (y - of_y))
        };
        Self::new(
            sum(self.low, other.low).low,
            sum(self.high, other.high).high,
        )
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = |x: f64, y: f64| {
            let product = x * y;
            let error = if x == 0.0 || y == 0.0 {
                0.0
            } else if product.abs() < UNDERFLOW {
                f64::NAN
            } else {
                x.mul_add(y, -product)
            };
            Self::of_rounded(product, error)
        };
        // With known signs, two of the four products of ends are the bounds.
        let (x, y) = (self, other);
        if y == Self::ONE {
            return x;
        }
        let ends = |low: [f64; 2], high: [f64; 2]| {
            Self::new(product(low[0], low[1]).low, product(high[0], high[1]).high)
        };
        if x.low >= 0.0 {
            let lowest = if y.low >= 0.0 { x.low } else { x.high };
            let highest = if y.high >= 0.0 { x.high } else { x.low };
            ends([lowest, y.low], [highest, y.high])
        } else if x.high <= 0.0 {
            let lowest = if y.high >= 0.0 { x.low } else { x.high };
            let highest = if y.low >= 0.0 { x.high } else { x.low };
            ends([lowest, y.high], [highest, y.low])
        } else if y.low >= 0.0 {
            ends([x.low, y.high], [x.high, y.high])
        } else if y.high <= 0.0 {
            ends([x.high, y.low], [x.low, y.low])
        } else {
            Self::hull([
                ends([x.low, y.high], [x.low, y.low]),
                ends([x.high, y.low], [x.high, y.high]),
            ])
        }
    }
}

impl Mul<f64> for Interval {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self * Self::point(other)
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::UNDEFINED;
        }
        let quotient = |x: f64, y: f64| {
            let quotient = x / y;
            let error = if x == 0.0 {
                0.0
            } else if quotient.abs() < UNDERFLOW || x.abs() < UNDERFLOW {
                f64::NAN
            } else {
                (-quotient).mul_add(y, x) * y.signum()
            };
            Self::of_rounded(quotient, error)
        };
        Self::hull([
            quotient(self.low, other.low),
            quotient(self.low, other.high),
            quotient(self.high, other.low),
            quotient(self.high, other.high),
        ])
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl AddAssign for Interval {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Interval {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
