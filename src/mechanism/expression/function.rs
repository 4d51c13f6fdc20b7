//! The constants and functions of the expression language by name.

use std::f64::consts::PI;

use super::Operation;
use crate::mechanism::number::{Number, Unary};

/// Constants of the language. All but `pi` convert a number to SI units.
pub(in crate::mechanism) const CONSTANTS: [(&str, f64); 6] = [
    ("pi", PI),
    ("deg", PI / 180.0),
    ("rpm", PI / 30.0),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("inch", 0.0254),
];

/// Returns the value of a constant.
pub fn constant(name: &str) -> Option<f64> {
    let known = CONSTANTS.iter().find(|(constant, _)| *constant == name);
    known.map(|(_, value)| *value)
}

/// Function of two arguments.
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

/// Name by which an equation calls the law of its coupling.
pub(super) const LAW: &str = "law";

/// All functions with their names.
pub(super) const FUNCTIONS: [(&str, Operation); 22] = [
    ("sin", Operation::Unary(Unary::Sin)),
    ("cos", Operation::Unary(Unary::Cos)),
    ("tan", Operation::Unary(Unary::Tan)),
    ("asin", Operation::Unary(Unary::Asin)),
    ("acos", Operation::Unary(Unary::Acos)),
    ("atan", Operation::Unary(Unary::Atan)),
    ("atan2", Operation::Binary(Binary::Atan2)),
    ("sinh", Operation::Unary(Unary::Sinh)),
    ("cosh", Operation::Unary(Unary::Cosh)),
    ("tanh", Operation::Unary(Unary::Tanh)),
    ("sqrt", Operation::Unary(Unary::Sqrt)),
    ("hypot", Operation::Binary(Binary::Hypot)),
    ("exp", Operation::Unary(Unary::Exp)),
    ("ln", Operation::Unary(Unary::Ln)),
    ("log10", Operation::Unary(Unary::Log10)),
    ("abs", Operation::Unary(Unary::Abs)),
    ("sign", Operation::Unary(Unary::Sign)),
    ("floor", Operation::Unary(Unary::Floor)),
    ("ceil", Operation::Unary(Unary::Ceil)),
    ("mod", Operation::Binary(Binary::Mod)),
    ("min", Operation::Binary(Binary::Min)),
    ("max", Operation::Binary(Binary::Max)),
];

/// Returns the names of all functions.
pub(super) fn function_names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, _)| *name)
}

/// Returns the function called `name`.
pub(super) fn function(name: &str) -> Option<Operation> {
    let known = FUNCTIONS.iter().find(|(function, _)| *function == name);
    known.map(|(_, function)| *function)
}

impl Binary {
    /// Returns the function of x and y. `min`, `max` and `mod` have the derivatives of the piece
    /// in force; at a tie of `min` and `max` that is the first argument.
    pub(super) fn apply<N: Number>(self, x: N, y: N) -> N {
        match self {
            Self::Atan2 => x.atan2(y),
            Self::Hypot => x.hypot(y),
            Self::Mod => {
                let rest = x - y * (x / y).floor();
                // Below a multiple of y by rounding.
                if rest.is_single() && rest.real() * y.real() < 0.0 {
                    rest - N::constant(rest.real())
                } else {
                    rest
                }
            }
            Self::Min => x.smaller(y),
            Self::Max => x.larger(y),
        }
    }
}
