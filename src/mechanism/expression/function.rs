//! The functions of the expression language, each with its first and second derivative.

use std::f64::consts::LN_10;

use super::number::{Number, Partials};

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Sqrt,
    Exp,
    Ln,
    Log10,
    Abs,
    Sign,
    Floor,
    Ceil,
}

/// A function of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    /// `atan2(y, x)`, the angle of the point (x, y).
    Atan2,
    /// `hypot(x, y)`.
    Hypot,
    /// `mod(x, y)` = x − y ⌊x/y⌋, of the sign of y.
    Mod,
    /// The smallest of two or more arguments, two at a time.
    Min,
    /// The largest of two or more arguments, two at a time.
    Max,
}

/// A function by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Unary(Unary),
    Binary(Binary),
}

/// Every function with its name.
pub(super) const FUNCTIONS: [(&str, Function); 22] = [
    ("sin", Function::Unary(Unary::Sin)),
    ("cos", Function::Unary(Unary::Cos)),
    ("tan", Function::Unary(Unary::Tan)),
    ("asin", Function::Unary(Unary::Asin)),
    ("acos", Function::Unary(Unary::Acos)),
    ("atan", Function::Unary(Unary::Atan)),
    ("atan2", Function::Binary(Binary::Atan2)),
    ("sinh", Function::Unary(Unary::Sinh)),
    ("cosh", Function::Unary(Unary::Cosh)),
    ("tanh", Function::Unary(Unary::Tanh)),
    ("sqrt", Function::Unary(Unary::Sqrt)),
    ("hypot", Function::Binary(Binary::Hypot)),
    ("exp", Function::Unary(Unary::Exp)),
    ("ln", Function::Unary(Unary::Ln)),
    ("log10", Function::Unary(Unary::Log10)),
    ("abs", Function::Unary(Unary::Abs)),
    ("sign", Function::Unary(Unary::Sign)),
    ("floor", Function::Unary(Unary::Floor)),
    ("ceil", Function::Unary(Unary::Ceil)),
    ("mod", Function::Binary(Binary::Mod)),
    ("min", Function::Binary(Binary::Min)),
    ("max", Function::Binary(Binary::Max)),
];

impl Function {
    pub(super) fn by_name(name: &str) -> Option<Self> {
        FUNCTIONS
            .iter()
            .find_map(|(known, function)| (*known == name).then_some(*function))
    }

    pub(super) fn name(self) -> &'static str {
        FUNCTIONS
            .iter()
            .find_map(|(name, function)| (*function == self).then_some(*name))
            .expect("the table lists every function")
    }
}

impl Unary {
    /// The function's value. The branch in force gives the slope where there are two: `abs` rises
    /// at 0; `sign`, `floor` and `ceil` are level everywhere.
    pub(super) fn apply<N: Number>(self, x: N) -> N {
        match self {
            Self::Sin => x.chain(f64::sin, |x| [x.cos(), -x.sin()]),
            Self::Cos => x.chain(f64::cos, |x| [-x.sin(), -x.cos()]),
            Self::Tan => x.chain(f64::tan, |x| {
                let slope = 1.0 + x.tan().powi(2);
                [slope, 2.0 * x.tan() * slope]
            }),
            Self::Asin => x.chain(f64::asin, asin_derivatives),
            Self::Acos => x.chain(f64::acos, |x| asin_derivatives(x).map(|d| -d)),
            Self::Atan => x.chain(f64::atan, |x| {
                let slope = 1.0 / (1.0 + x * x);
                [slope, -2.0 * x * slope * slope]
            }),
            Self::Sinh => x.chain(f64::sinh, |x| [x.cosh(), x.sinh()]),
            Self::Cosh => x.chain(f64::cosh, |x| [x.sinh(), x.cosh()]),
            Self::Tanh => x.chain(f64::tanh, |x| {
                // Not 1 − tanh², which cancels where the curve is flat.
                let slope = x.cosh().powi(-2);
                [slope, -2.0 * x.tanh() * slope]
            }),
            Self::Sqrt => x.chain(f64::sqrt, |x| {
                let slope = 0.5 / x.sqrt();
                [slope, -0.5 * slope / x]
            }),
            Self::Exp => x.chain(f64::exp, |x| [x.exp(), x.exp()]),
            Self::Ln => x.chain(f64::ln, |x| [1.0 / x, -1.0 / (x * x)]),
            Self::Log10 => x.chain(f64::log10, |x| {
                let slope = 1.0 / (x * LN_10);
                [slope, -slope / x]
            }),
            Self::Abs => x.chain(f64::abs, |x| [if x < 0.0 { -1.0 } else { 1.0 }, 0.0]),
            Self::Sign => x.chain(sign, |_| [0.0, 0.0]),
            Self::Floor => x.chain(f64::floor, |_| [0.0, 0.0]),
            Self::Ceil => x.chain(f64::ceil, |_| [0.0, 0.0]),
        }
    }
}

impl Binary {
    /// Whether it takes more than two arguments too.
    pub(super) fn is_variadic(self) -> bool {
        matches!(self, Self::Min | Self::Max)
    }

    /// The function's value. `min`, `max` and `mod` take their slope from the branch in force;
    /// at a tie of `min` and `max` that is the first argument's.
    pub(super) fn apply<N: Number>(self, x: N, y: N) -> N {
        match self {
            Self::Atan2 => x.chain2(y, f64::atan2, |y, x| {
                // Here the first argument is the ordinate. Divided by r once at a time, lest r²
                // leave the range of numbers.
                let r = x.hypot(y);
                let (cos, sin) = (x / r, y / r);
                Partials {
                    x: cos / r,
                    y: -sin / r,
                    xx: -2.0 * sin * cos / r / r,
                    xy: (sin * sin - cos * cos) / r / r,
                    yy: 2.0 * sin * cos / r / r,
                }
            }),
            Self::Hypot => x.chain2(y, f64::hypot, |x, y| {
                let r = x.hypot(y);
                let (cos, sin) = (x / r, y / r);
                Partials {
                    x: cos,
                    y: sin,
                    xx: sin * sin / r,
                    xy: -sin * cos / r,
                    yy: cos * cos / r,
                }
            }),
            Self::Mod => x - y * N::constant((x.value() / y.value()).floor()),
            // A comparison with a NaN is false: written so that it comes through.
            Self::Min if x.value() <= y.value() || x.value().is_nan() => x,
            Self::Max if x.value() >= y.value() || x.value().is_nan() => x,
            Self::Min | Self::Max => y,
        }
    }
}

/// x^y. Where y does not vary this is right for any x that has a power, negative and zero too:
/// x² has the derivatives 0 and 2 at 0. A varying exponent needs x > 0.
pub(super) fn power<N: Number>(x: N, y: N) -> N {
    x.chain2(y, f64::powf, |x, y| {
        // A factor of zero ends the derivatives of a polynomial, before a negative power of zero
        // can make 0 · ∞ of them.
        let falling = |factor: f64, exponent: f64| {
            if factor == 0.0 {
                0.0
            } else {
                factor * x.powf(exponent)
            }
        };
        let value = x.powf(y);
        let (ln, value_ln) = if x == 0.0 && y > 0.0 {
            (0.0, 0.0) // the limit of x^y ln x
        } else {
            (x.ln(), value * x.ln())
        };
        Partials {
            x: falling(y, y - 1.0),
            y: value_ln,
            xx: falling(y * (y - 1.0), y - 2.0),
            xy: x.powf(y - 1.0) * (1.0 + y * ln),
            yy: value_ln * ln,
        }
    })
}

/// d/dx and d²/dx² of the arc sine.
fn asin_derivatives(x: f64) -> [f64; 2] {
    // Not 1 − x², which cancels near the ends.
    let slope = 1.0 / ((1.0 - x) * (1.0 + x)).sqrt();
    [slope, x * slope * slope * slope]
}

/// −1, 0 or 1; unlike `f64::signum`, 0 at 0.
fn sign(x: f64) -> f64 {
    if x == 0.0 { x } else { x.signum() }
}
