//! Dimension of an expression, as far as the units of its parameters tell it.

use super::Operation;
use super::function::Binary;
use crate::mechanism::number::Unary;
use crate::mechanism::{Dimension, Span};

/// Dimension of an operand, `None` if it is not known: that of a parameter without a unit, of a
/// variable, of a power that is no whole number.
type Known = Option<Dimension>;

/// Operands of different dimensions that are added or compared.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::mechanism) struct Clash {
    /// Place of the operation in the text.
    pub(in crate::mechanism) span: Span,
    /// Dimensions of the two operands.
    pub(in crate::mechanism) dimensions: [Dimension; 2],
}

/// Dimensions of the operands that wait for their operator while an expression is parsed.
///
/// A plain number has the dimension 1, which agrees with every other: `0.1` may be a length.
pub(super) struct Dimensions<'a> {
    /// Dimension of each parameter.
    parameters: &'a [Known],
    waiting: Vec<Known>,
    /// First clash.
    pub(super) clash: Option<Clash>,
}

impl<'a> Dimensions<'a> {
    pub(super) fn new(parameters: &'a [Known]) -> Self {
        Self {
            parameters,
            waiting: Vec::new(),
            clash: None,
        }
    }

    /// Returns the dimension of the whole expression.
    pub(super) fn result(&self) -> Known {
        self.waiting.last().copied().flatten()
    }

    /// Gives the operand parsed last the dimension of a constant of the language.
    pub(super) fn set_constant(&mut self, name: &str) {
        let dimension = match name {
            "deg" => Dimension::ANGLE,
            "rpm" => Dimension::ANGULAR_VELOCITY,
            "mm" | "cm" | "inch" => Dimension::LENGTH,
            _ => Dimension::ONE,
        };
        self.set(dimension);
    }

    /// Gives the operand parsed last a dimension.
    pub(super) fn set(&mut self, dimension: Dimension) {
        self.replace(Some(dimension));
    }

    /// Gives the operand parsed last a dimension, or none that is known.
    pub(super) fn replace(&mut self, dimension: Known) {
        if let Some(last) = self.waiting.last_mut() {
            *last = dimension;
        }
    }

    /// Replaces the operands of an operation at `span` by its result. `exponent` is that of a power
    /// with a constant exponent.
    pub(super) fn apply(&mut self, operation: Operation, span: &Span, exponent: Option<f64>) {
        let first = self.waiting.len() - operation.arity();
        let operands = self.waiting.split_off(first);
        let result = match (operation, operands.as_slice()) {
            (Operation::Parameter(id), _) => self.parameters.get(id.index()).copied().flatten(),
            (Operation::Number(_), _) => Some(Dimension::ONE),
            (Operation::Multiply, [Some(a), Some(b)]) => a.times(*b),
            (Operation::Divide, [Some(a), Some(b)]) => {
                b.to_power(-1.0).and_then(|inverse| a.times(inverse))
            }
            (Operation::Power, [Some(base), _]) => match exponent {
                _ if *base == Dimension::ONE => Some(Dimension::ONE),
                Some(exponent) => base.to_power(exponent),
                None => None,
            },
            (Operation::Negate | Operation::Unary(Unary::Abs), [a]) => *a,
            (Operation::Unary(Unary::Floor | Unary::Ceil), [a]) => *a,
            (Operation::Unary(Unary::Sqrt), [Some(a)]) => a.to_power(0.5),
            (Operation::Unary(Unary::Asin | Unary::Acos | Unary::Atan), _) => {
                Some(Dimension::ANGLE)
            }
            (Operation::Unary(Unary::Sqrt), _) => None,
            (Operation::Unary(_), _) => Some(Dimension::ONE),
            (Operation::Binary(function), [a, b]) => {
                let together = self.together(*a, *b, span);
                if function == Binary::Atan2 {
                    Some(Dimension::ANGLE)
                } else {
                    together
                }
            }
            (Operation::Add | Operation::Subtract, [a, b]) => self.together(*a, *b, span),
            _ => None,
        };
        self.waiting.push(result);
    }

    /// Returns the dimension of a sum or of the smaller of two values; notes a clash.
    fn together(&mut self, a: Known, b: Known, span: &Span) -> Known {
        let (a, b) = (a?, b?);
        if !a.agrees_with(b) {
            self.clash.get_or_insert(Clash {
                span: span.clone(),
                dimensions: [a, b],
            });
            return None;
        }
        Some(if a == Dimension::ONE { b } else { a })
    }
}
