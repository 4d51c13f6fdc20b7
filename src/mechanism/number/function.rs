//! The functions of one argument, each with its first three derivatives.

use super::Number;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unary {
    /// The sine.
    Sin,
    /// The cosine.
    Cos,
    /// The tangent.
    Tan,
    /// The arc sine.
    Asin,
    /// The arc cosine.
    Acos,
    /// The arc tangent.
    Atan,
    /// The hyperbolic sine.
    Sinh,
    /// The hyperbolic cosine.
    Cosh,
    /// The hyperbolic tangent.
    Tanh,
    /// The square root.
    Sqrt,
    /// The exponential function.
    Exp,
    /// The natural logarithm.
    Ln,
    /// The decimal logarithm.
    Log10,
    /// The absolute value.
    Abs,
    /// −1, 0 or 1.
    Sign,
    /// The largest integer not above the argument, which counts as whole to rounding.
    Floor,
    /// The smallest integer not below the argument, likewise.
    Ceil,
}

/// Distance from an integer at which a number counts as this integer, in units of one, or of the
/// integer where that is more.
///
/// A count in a formula is whole to the rounding of some operations: `10*t` and `t/0.1` at t = 0.3, or
/// a sum of angles over a turn. Halved, parts of a sum that jump together at `x - 20*pi`
/// may do so on two sides of one number. Doubled, a number 7e-15 below an integer counts as whole.
const WHOLE: f64 = 16.0 * f64::EPSILON;

/// Returns the largest integer not above x, or the next one if x is that to rounding.
pub(super) fn floor(x: f64) -> f64 {
    let above = x.ceil();
    if above - x <= WHOLE * above.abs().max(1.0) {
        above
    } else {
        x.floor()
    }
}

/// Returns the smallest integer not below x, or the one before if x is that to rounding.
pub(super) fn ceil(x: f64) -> f64 {
    -floor(-x)
}

impl Unary {
    /// Returns whether the function is constant between its jumps.
    pub(super) fn is_step(self) -> bool {
        matches!(self, Self::Sign | Self::Floor | Self::Ceil)
    }

    /// Returns f′, f″ and f‴ at x from x and f(x), those of the piece in force: `abs` rises at 0.
    /// At a possible corner of f the bounds of f′ hold on both sides; derivatives of an f that may be
    /// infinitely steep within its domain are unknown.
    pub(super) fn derivatives<S: Number>(self, x: S, value: S) -> [S; 3] {
        let [zero, one, two] = [0.0, 1.0, 2.0].map(S::constant);
        match self {
            Self::Sin => {
                let cos = x.cos();
                [cos, -value, -cos]
            }
            Self::Cos => {
                let sin = x.sin();
                [-sin, -value, sin]
            }
            Self::Tan => {
                let square = value.square();
                let slope = one + square;
                let third = slope * 2.0 * (one + square * 3.0);
                [slope, value * 2.0 * slope, third]
            }
            Self::Asin => {
                let square = x.one_minus_square();
                let slope = one / square.sqrt();
                if slope.is_undefined() && zero.at_most(square) == Some(true) {
                    return [S::unknown(); 3];
                }
                let third = slope.cube() * (one + (x * slope).square() * 3.0);
                [slope, x * slope * slope * slope, third]
            }
            Self::Acos => Self::Asin
                .derivatives(x, value)
                .map(|derivative| -derivative),
            Self::Atan => {
                let square = x.square();
                let slope = one / (one + square);
                let third = (square * 6.0 - two) * slope.cube();
                [slope, x * -2.0 * slope * slope, third]
            }
            Self::Sinh => {
                let cosh = x.cosh();
                [cosh, value, cosh]
            }
            Self::Cosh => {
                let sinh = x.sinh();
                [sinh, value, sinh]
            }
            Self::Tanh => {
                // Not 1 − tanh², which cancels where the curve is flat.
                let slope = one / x.cosh().square();
                let third = slope * (value.square() * 6.0 - two);
                [slope, value * -2.0 * slope, third]
            }
            Self::Sqrt => {
                let slope = S::constant(0.5) / value;
                if slope.is_undefined() && zero.at_most(x) == Some(true) {
                    return [S::unknown(); 3];
                }
                let second = slope * -0.5 / x;
                [slope, second, second * -1.5 / x]
            }
            Self::Exp => [value; 3],
            Self::Ln => [one / x, -one / x.square(), two / x.cube()],
            Self::Log10 => {
                let slope = one / (x * S::constant(10.0).ln());
                [slope, -slope / x, slope * 2.0 / x.square()]
            }
            Self::Abs => match zero.at_most(x) {
                Some(true) => [one, zero, zero],
                Some(false) => [-one, zero, zero],
                None => [one.either(-one), S::unknown(), S::unknown()],
            },
            // Across a jump.
            Self::Sign | Self::Floor | Self::Ceil => [S::unknown(); 3],
        }
    }
}
