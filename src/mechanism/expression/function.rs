//! The functions of the expression language, each with its first three derivatives.

use super::number::Number;
use super::scalar::Scalar;

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
        let [zero, one] = [0.0, 1.0].map(N::Scalar::constant);
        match self {
            Self::Sin => x.chain(Scalar::sin, |x| [x.cos(), -x.sin(), -x.cos()]),
            Self::Cos => x.chain(Scalar::cos, |x| [-x.sin(), -x.cos(), x.sin()]),
            Self::Tan => x.chain(Scalar::tan, |x| {
                let square = x.tan().square();
                let slope = one + square;
                [
                    slope,
                    x.tan() * 2.0 * slope,
                    slope * 2.0 * (one + square * 3.0),
                ]
            }),
            Self::Asin => x.chain(Scalar::asin, asin_derivatives),
            Self::Acos => x.chain(Scalar::acos, |x| asin_derivatives(x).map(|d| -d)),
            Self::Atan => x.chain(Scalar::atan, |x| {
                let square = x.square();
                let slope = one / (one + square);
                [
                    slope,
                    x * -2.0 * slope * slope,
                    (square * 6.0 - one * 2.0) * slope.cube(),
                ]
            }),
            Self::Sinh => x.chain(Scalar::sinh, |x| [x.cosh(), x.sinh(), x.cosh()]),
            Self::Cosh => x.chain(Scalar::cosh, |x| [x.sinh(), x.cosh(), x.sinh()]),
            Self::Tanh => x.chain(Scalar::tanh, |x| {
                // Not 1 − tanh², which cancels where the curve is flat.
                let slope = one / x.cosh().square();
                let tanh = x.tanh();
                [
                    slope,
                    tanh * -2.0 * slope,
                    slope * (tanh.square() * 6.0 - one * 2.0),
                ]
            }),
            Self::Sqrt => x.chain(Scalar::sqrt, |x| {
                let slope = one * 0.5 / x.sqrt();
                let second = slope * -0.5 / x;
                [slope, second, second * -1.5 / x]
            }),
            Self::Exp => x.chain(Scalar::exp, |x| [x.exp(); 3]),
            Self::Ln => x.chain(Scalar::ln, |x| {
                [one / x, -one / x.square(), one * 2.0 / x.cube()]
            }),
            Self::Log10 => x.chain(Scalar::log10, |x| {
                let slope = one / (x * N::Scalar::ln_10());
                [slope, -slope / x, slope * 2.0 / x.square()]
            }),
            Self::Abs => {
                let slope = x.value().abs_slope();
                if slope.is_undefined() && x.varies() {
                    N::undecided(x.value().abs())
                } else {
                    x.chain(Scalar::abs, |_| [slope, zero, zero])
                }
            }
            Self::Sign => level(x, Scalar::sign),
            Self::Floor => level(x, Scalar::floor),
            Self::Ceil => level(x, Scalar::ceil),
        }
    }
}

/// A function that is level between its jumps.
fn level<N: Number>(x: N, f: impl Fn(N::Scalar) -> N::Scalar) -> N {
    let value = f(x.value());
    if value.is_single() || !x.varies() {
        N::fixed(value)
    } else {
        N::undecided(value)
    }
}

/// `x` or `y`, as `first` says, or `value` where that differs from point to point.
fn either<N: Number>(x: N, y: N, first: Option<bool>, value: impl FnOnce() -> N::Scalar) -> N {
    match first {
        Some(true) => x,
        Some(false) => y,
        None if x.varies() || y.varies() => N::undecided(value()),
        None => N::fixed(value()),
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
        let (x_value, y_value) = (x.value(), y.value());
        match self {
            Self::Atan2 => N::atan2(x, y),
            Self::Hypot => N::hypot(x, y),
            Self::Mod => x - y * level(x / y, Scalar::floor),
            Self::Min => either(x, y, x_value.at_most(y_value), || x_value.smaller(y_value)),
            Self::Max => either(x, y, x_value.at_least(y_value), || {
                -(-x_value).smaller(-y_value)
            }),
        }
    }
}

/// The derivatives of the arc sine.
fn asin_derivatives<S: Scalar>(x: S) -> [S; 3] {
    let one = S::constant(1.0);
    let slope = one / x.one_minus_square().sqrt();
    [
        slope,
        x * slope * slope * slope,
        slope.cube() * (one + (x * slope).square() * 3.0),
    ]
}
