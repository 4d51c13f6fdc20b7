//! The constants and functions of the expression language by name.

use std::f64::consts::PI;

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
pub(crate) fn constant(name: &str) -> Option<f64> {
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

/// A function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Unary(Unary),
    Binary(Binary),
}

/// All functions with their names.
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

/// Returns the names of all functions.
pub(in crate::mechanism) fn function_names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, _)| *name)
}

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

impl Binary {
    /// Whether it takes more than two arguments too.
    pub(super) fn is_variadic(self) -> bool {
        matches!(self, Self::Min | Self::Max)
    }

    /// Returns the function of x and y. `min`, `max` and `mod` have the derivatives of the piece
    /// in force; at a tie of `min` and `max` that is the first argument.
    pub(super) fn apply<N: Number>(self, x: N, y: N) -> N {
        match self {
            Self::Atan2 => x.atan2(y),
            Self::Hypot => x.hypot(y),
            Self::Mod => x - y * (x / y).floor(),
            Self::Min => x.smaller(y),
            Self::Max => x.larger(y),
        }
    }
}
