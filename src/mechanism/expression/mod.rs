//! Numbers written as expressions over the parameters: parsed once, evaluated often.
//!
//! The language is small: numbers (`1`, `.5`, `2.`, `1e-3`), `+ - * / ^` and parentheses, the
//! constants `pi deg mm cm`, parameters, the functions `sin cos tan asin acos atan atan2 sinh
//! cosh tanh sqrt hypot exp ln log10 abs sign floor ceil mod min max`, and time `t` in a motion.
//! Powers bind tighter than a sign and associate to the right: `-x^2` is `-(x^2)` and `2^3^2` is
//! `2^9`.

mod display;
mod function;
mod number;
mod parse;
mod token;

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use function::{Binary, Unary};

pub use number::{Jet, Number, Partials};
pub use parse::ExpressionError;
pub(super) use parse::Scope;

use super::ParameterId;

/// The constants of the language; `deg`, `mm` and `cm` bring a number to SI units.
pub(super) const CONSTANTS: [(&str, f64); 4] =
    [("pi", PI), ("deg", PI / 180.0), ("mm", 1e-3), ("cm", 1e-2)];

/// The names of all functions.
pub(super) fn function_names() -> impl Iterator<Item = &'static str> {
    function::FUNCTIONS.iter().map(|(name, _)| *name)
}

/// The sine, on any kind of number.
pub(super) fn sin<N: Number>(x: N) -> N {
    Unary::Sin.apply(x)
}

/// The cosine, on any kind of number.
pub(super) fn cos<N: Number>(x: N) -> N {
    Unary::Cos.apply(x)
}

/// Operands that may wait for their operator at one time: what evaluation keeps on the stack.
/// Far more than anyone writes by hand.
const MAX_STACK: usize = 32;

/// A number as a function of the parameters, and in a motion of time.
///
/// Kept as a flat postfix program with constant parts computed, so that evaluation neither
/// allocates nor recurs.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Leaves one operand; never more than [`MAX_STACK`] wait, which the parser has checked.
    program: Box<[Operation]>,
    /// The parameters used, ascending, each once.
    parameters: Box<[ParameterId]>,
}

/// A step of the program. Operands come off a stack, the result goes onto it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Number(f64),
    Parameter(ParameterId),
    Time,
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Unary(Unary),
    Binary(Binary),
}

impl Operation {
    /// How many operands it takes.
    fn arity(self) -> usize {
        match self {
            Self::Number(_) | Self::Parameter(_) | Self::Time => 0,
            Self::Negate | Self::Unary(_) => 1,
            Self::Add
            | Self::Subtract
            | Self::Multiply
            | Self::Divide
            | Self::Power
            | Self::Binary(_) => 2,
        }
    }

    /// Takes its operands from the top of `stack` and leaves the result there.
    fn apply<N: Number>(
        self,
        stack: &mut [N; MAX_STACK],
        height: &mut usize,
        parameter: &impl Fn(ParameterId) -> N,
        t: N,
    ) {
        let first = *height - self.arity();
        let result = match self {
            Self::Number(value) => N::constant(value),
            Self::Parameter(id) => parameter(id),
            Self::Time => t,
            Self::Negate => -stack[first],
            Self::Add => stack[first] + stack[first + 1],
            Self::Subtract => stack[first] - stack[first + 1],
            Self::Multiply => stack[first] * stack[first + 1],
            Self::Divide => stack[first] / stack[first + 1],
            Self::Power => function::power(stack[first], stack[first + 1]),
            Self::Unary(function) => function.apply(stack[first]),
            Self::Binary(function) => function.apply(stack[first], stack[first + 1]),
        };
        stack[first] = result;
        *height = first + 1;
    }
}

impl Expression {
    /// An expression that is a plain number.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::new(vec![Operation::Number(value)])
    }

    fn new(program: Vec<Operation>) -> Self {
        let mut parameters: Vec<ParameterId> = program
            .iter()
            .filter_map(|operation| match operation {
                Operation::Parameter(id) => Some(*id),
                _ => None,
            })
            .collect();
        parameters.sort_unstable();
        parameters.dedup();
        Self {
            program: program.into(),
            parameters: parameters.into(),
        }
    }

    /// The value for the given parameters and time, on plain numbers or on [`Jet`]s.
    ///
    /// Outside the domain of a function the result is not finite. Allocates nothing.
    pub fn evaluate<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, t: N) -> N {
        match *self.program {
            // Most numbers of a mechanism are one of these two.
            [Operation::Number(value)] => N::constant(value),
            [Operation::Parameter(id)] => parameter(id),
            _ => run(&self.program, parameter, t),
        }
    }

    /// The parameters that it uses, ascending, each once.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterId> {
        self.parameters.iter().copied()
    }

    /// Whether it uses time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        self.program.contains(&Operation::Time)
    }

    /// Its value if it uses neither parameters nor time.
    #[must_use]
    pub fn literal(&self) -> Option<f64> {
        match *self.program {
            [Operation::Number(value)] => Some(value),
            _ => None,
        }
    }
}

/// Runs a program that leaves one operand and never has more than [`MAX_STACK`] waiting.
fn run<N: Number>(program: &[Operation], parameter: &impl Fn(ParameterId) -> N, t: N) -> N {
    let mut stack = [N::constant(0.0); MAX_STACK];
    let mut height = 0;
    for operation in program {
        operation.apply(&mut stack, &mut height, parameter, t);
    }
    stack[0]
}
