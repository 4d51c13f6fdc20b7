//! Expressions that are linear in coordinates.

use super::{Expression, MAX_STACK, Operation, Variable, run};

/// A sum of multiples of coordinates and of a number, each of which the parameters give.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearForm {
    /// Factor of each coordinate.
    pub factors: Vec<Expression>,
    /// The number.
    pub rest: Expression,
}

/// A part of a program: `None` for zero.
type Part = Option<Vec<Operation>>;

/// An operand as a linear form: the rest, then the factors.
#[derive(Clone)]
struct Operand(Vec<Part>);

impl Expression {
    /// Returns the expression as a linear form in `count` coordinates; `None` if it is none, or is
    /// too long.
    #[must_use]
    pub fn linear_form(&self, count: usize) -> Option<LinearForm> {
        let mut stack: Vec<Operand> = Vec::new();
        for &operation in &self.program {
            let operands = stack.split_off(stack.len() - operation.arity());
            stack.push(linear(operation, &operands, count)?);
        }
        let expression = |part: Part| {
            let expression = part.map_or_else(
                || Self::constant(0.0),
                |program| Self::new(program, &self.functions),
            );
            (expression.height <= MAX_STACK).then_some(expression)
        };
        let Operand(parts) = stack.pop()?;
        let mut parts = parts.into_iter().map(expression);
        Some(LinearForm {
            rest: parts.next()??,
            factors: parts.collect::<Option<_>>()?,
        })
    }
}

/// Returns the result of an operation, `None` if it is not linear.
fn linear(operation: Operation, operands: &[Operand], count: usize) -> Option<Operand> {
    let place = match operation {
        Operation::Variable(Variable::Coordinate(place)) => place + 1,
        _ => 0,
    };
    match (operation, operands) {
        (Operation::Number(_) | Operation::Parameter(_) | Operation::Variable(_), _) => {
            let mut parts = vec![None; count + 1];
            let operation = match place {
                0 => operation,
                _ => Operation::Number(1.0),
            };
            parts[place] = Some(vec![operation]);
            Some(Operand(parts))
        }
        (Operation::Negate, [a]) => Some(a.map(|part| applied(Operation::Negate, &[part]))),
        (Operation::Add | Operation::Subtract, [a, b]) => {
            let pairs = a.0.iter().zip(&b.0);
            let sum = |(a, b): (&Part, &Part)| match (a, b) {
                (Some(a), Some(b)) => Some(applied(operation, &[a, b])),
                (None, Some(b)) if operation == Operation::Subtract => {
                    Some(applied(Operation::Negate, &[b]))
                }
                (a, b) => a.as_ref().or(b.as_ref()).cloned(),
            };
            Some(Operand(pairs.map(sum).collect()))
        }
        (Operation::Multiply, [a, b]) if a.is_fixed() => {
            Some(b.map(|part| product(&a.rest(), part)))
        }
        (Operation::Multiply | Operation::Divide, [a, b]) if b.is_fixed() => {
            Some(a.map(|part| match operation {
                Operation::Multiply => product(part, &b.rest()),
                _ => applied(operation, &[part, &b.rest()]),
            }))
        }
        // No coordinate is in the argument of another function.
        (_, operands) if operands.iter().all(Operand::is_fixed) => {
            let rests: Vec<_> = operands.iter().map(Operand::rest).collect();
            let rests: Vec<_> = rests.iter().map(Vec::as_slice).collect();
            let mut parts = vec![None; count + 1];
            parts[0] = Some(applied(operation, &rests));
            Some(Operand(parts))
        }
        _ => None,
    }
}

impl Operand {
    /// Returns whether no coordinate is in it.
    fn is_fixed(&self) -> bool {
        self.0[1..].iter().all(Option::is_none)
    }

    /// Returns the program of its rest.
    fn rest(&self) -> Vec<Operation> {
        let rest = self.0[0].clone();
        rest.unwrap_or_else(|| vec![Operation::Number(0.0)])
    }

    fn map(&self, of: impl Fn(&[Operation]) -> Vec<Operation>) -> Self {
        let parts = self.0.iter();
        Self(parts.map(|part| part.as_deref().map(&of)).collect())
    }
}

/// Returns the program of a product, in which a factor of one is left out.
fn product(a: &[Operation], b: &[Operation]) -> Vec<Operation> {
    const ONE: [Operation; 1] = [Operation::Number(1.0)];
    match (a, b) {
        (one, other) | (other, one) if *one == ONE => other.to_vec(),
        _ => applied(Operation::Multiply, &[a, b]),
    }
}

/// Returns the program of an operation, computed if its operands are numbers.
fn applied(operation: Operation, operands: &[&[Operation]]) -> Vec<Operation> {
    let mut program = operands.concat();
    program.push(operation);
    let is_number = |operand: &&[Operation]| matches!(operand, [Operation::Number(_)]);
    // A law and a function are no numbers of the program.
    let is_called = matches!(operation, Operation::Law | Operation::Call(..));
    if !is_called && operands.iter().all(is_number) {
        let value = run::<f64, 3>(&program, &[], &(&|_| f64::NAN, &|_| f64::NAN));
        return vec![Operation::Number(value)];
    }
    program
}
