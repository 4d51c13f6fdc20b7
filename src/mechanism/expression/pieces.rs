//! Bounds of an expression over ranges in which pieces of it meet.
//!
//! Each piece between which `min`, `max`, `abs`, `mod` and the like switch is taken over the whole
//! range in turn; where more than a few switch, the hull of both pieces stands for those of the rest. The hull of all choices bounds value and derivatives on both sides of the
//! switch; whether the pieces join smoothly is not examined here.

use super::called::Function;
use super::function::Binary;
use super::{Expression, MAX_STACK, Operation, Values, Variable};
use crate::mechanism::ParameterId;
use crate::mechanism::number::{Interval, Jet3, Number, Taylor, Unary};

/// Most switches of an expression in one range whose pieces are taken in turn, as each doubles the
/// work.
pub(in crate::mechanism) const MOST_SWITCHES: u32 = 6;
/// Number of parts of a range: the excess of the bounds is proportional to their width.
const PARTS: u32 = 8;

impl Expression {
    /// Encloses the value and its first three derivatives on each piece over a range of the
    /// variable, for the given parameters. At a switch the derivatives are those of both sides.
    ///
    /// `None` where a piece has no finite second derivative or no value, or pieces jump by more
    /// than one step. Third derivatives may be infinite. Allocates nothing.
    pub fn enclose_pieces(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
        variable: Interval,
    ) -> Option<Jet3<Interval>> {
        let parameter = |id| Jet3::constant(parameter(id));
        let width = (variable.high - variable.low) / f64::from(PARTS);
        let end = |part: u32| {
            if part == PARTS {
                variable.high
            } else {
                (variable.low + f64::from(part) * width).min(variable.high)
            }
        };
        let mut parts = (0..PARTS).map(|part| {
            let variable = Jet3::variable(Interval::new(end(part), end(part + 1)));
            self.hull_of_pieces(&(&parameter, &|_| variable), Some(MOST_SWITCHES))
        });
        let first = parts.next().flatten();
        parts.fold(first, |hull, part| Some(hull?.hull(part?)))
    }

    /// Returns the places of the coordinates on which `floor`, `ceil`, `sign` and `mod` depend, which
    /// jump; ascending.
    #[must_use]
    pub fn jumping_coordinates(&self) -> Vec<usize> {
        let mut stack: Vec<Vec<usize>> = Vec::new();
        let mut jumping = Vec::new();
        for operation in &self.program {
            let operands = stack.split_off(stack.len() - operation.arity());
            let mut places = operands.concat();
            if let Operation::Variable(Variable::Coordinate(place)) = operation {
                places.push(*place);
            }
            if matches!(
                operation,
                Operation::Unary(Unary::Sign | Unary::Floor | Unary::Ceil)
                    | Operation::Binary(Binary::Mod)
            ) {
                jumping.extend_from_slice(&places);
            }
            stack.push(places);
        }
        jumping.sort_unstable();
        jumping.dedup();
        jumping
    }

    /// Encloses the result for these numbers on each piece that may be in force, and its slope on all
    /// sides of a switch. Further derivatives are unknown, as the slope may jump there. `None` without
    /// bounds. Allocates nothing.
    pub(crate) fn enclose_all_pieces(
        &self,
        values: &impl Values<Jet3<Interval>>,
    ) -> Option<Jet3<Interval>> {
        let pieces = self.hull_of_pieces(values, Some(MOST_SWITCHES))?;
        let unknown = Interval::unknown();
        Some(Jet3::new(pieces.value, [pieces.first(), unknown, unknown]))
    }

    /// Encloses the result for these numbers on each piece that may be in force, of the first
    /// `switches` that meet in turn. `None` where a piece has no bounds, pieces jump by more than
    /// one step, or pieces meet without any `switches`. Allocates nothing.
    pub(in crate::mechanism) fn hull_of_pieces<N: Piece>(
        &self,
        values: &impl Values<N>,
        switches: Option<u32>,
    ) -> Option<N> {
        let stack = [N::constant(0.0); MAX_STACK];
        run_pieces(
            (&self.program, self.functions.list()),
            (stack, 0),
            values,
            switches,
        )
    }
}

/// An enclosed number with derivatives, on one of the pieces of an expression.
pub(in crate::mechanism) trait Piece: Number {
    /// Returns the number with another range of its value.
    fn with_range(self, range: Interval) -> Self;

    /// Returns the bounds of both, order by order.
    fn hull(self, other: Self) -> Self;

    /// Returns whether the derivatives that are needed have bounds.
    fn is_bounded(&self) -> bool;
}

impl Piece for Jet3<Interval> {
    fn with_range(self, range: Interval) -> Self {
        Self::new(range, self.derivatives)
    }

    fn hull(self, other: Self) -> Self {
        Self::hull(self, other)
    }

    fn is_bounded(&self) -> bool {
        let [first, second, _] = self.derivatives;
        let needed = [self.value, first, second];
        needed.iter().all(|bound| bound.is_finite())
    }
}

/// A number along a sub-step, with its derivative with respect to the variable.
impl Piece for Taylor<Jet3<Interval>, 1> {
    fn with_range(self, range: Interval) -> Self {
        Self::new(self.value.with_range(range), self.derivatives)
    }

    fn hull(self, other: Self) -> Self {
        let slope = self.first().hull(other.first());
        Self::new(self.value.hull(other.value), [slope])
    }

    fn is_bounded(&self) -> bool {
        let slope = self.first();
        self.value.value.is_finite() && slope.value.is_finite()
    }
}

/// Runs the rest of a program on a stack of some height. Returns the hull of the results for both
/// pieces of each of the first `switches` operations that switch.
fn run_pieces<N: Piece>(
    (program, functions): (&[Operation], &[Function]),
    (mut stack, mut height): ([N; MAX_STACK], usize),
    values: &impl Values<N>,
    switches: Option<u32>,
) -> Option<N> {
    for (index, operation) in program.iter().enumerate() {
        let first = height - operation.arity();
        if let Some(pieces) = operation.switch(&stack[first..height]) {
            let Some(switches) = switches?.checked_sub(1) else {
                let [one, other] = pieces;
                stack[first] = one.hull(other);
                height = first + 1;
                continue;
            };
            let [one, other] = pieces.map(|piece| {
                stack[first] = piece;
                let rest = &program[index + 1..];
                let state = (stack, first + 1);
                run_pieces((rest, functions), state, values, Some(switches))
            });
            return Some(one?.hull(other?));
        }
        operation.apply(&mut stack, &mut height, functions, values);
    }
    stack[0].is_bounded().then_some(stack[0])
}

impl Operation {
    /// Returns both pieces of an operation that switches in the range of its operands; `None` if
    /// it does not, or between more than two pieces. The value of a piece is bounded to where it is
    /// in force.
    fn switch<N: Piece>(self, operands: &[N]) -> Option<[N; 2]> {
        match (self, operands) {
            (Self::Binary(Binary::Min), &[x, y]) => {
                is_undecided(x, y).then(|| [below(x, y.range().high), below(y, x.range().high)])
            }
            (Self::Binary(Binary::Max), &[x, y]) => {
                is_undecided(x, y).then(|| [above(x, y.range().low), above(y, x.range().low)])
            }
            (Self::Unary(Unary::Abs), &[x]) => {
                let zero = N::constant(0.0);
                is_undecided(x, zero).then(|| [above(x, 0.0), above(-x, 0.0)])
            }
            (Self::Unary(step @ (Unary::Sign | Unary::Floor | Unary::Ceil)), &[x]) => {
                steps(x.range().apply(step))
            }
            (Self::Binary(Binary::Mod), &[x, y]) => {
                let pieces = steps::<N>((x / y).range().floor())?;
                Some(pieces.map(|whole| x - y * whole))
            }
            _ => None,
        }
    }
}

/// Returns whether the larger of two numbers changes in the range.
fn is_undecided<N: Piece>(x: N, y: N) -> bool {
    !x.is_undefined() && !y.is_undefined() && x.at_most(y).is_none()
}

/// Returns a piece that is in force where it is at most `high`.
fn below<N: Piece>(piece: N, high: f64) -> N {
    let range = piece.range();
    piece.with_range(Interval::new(range.low, range.high.min(high)))
}

/// Returns a piece that is in force where it is at least `low`.
fn above<N: Piece>(piece: N, low: f64) -> N {
    let range = piece.range();
    piece.with_range(Interval::new(range.low.max(low), range.high))
}

/// Returns the two values of a step function that jumps once in the range: from one integer to the
/// next, or from −1 to 1.
fn steps<N: Piece>(range: Interval) -> Option<[N; 2]> {
    // Both ends are integers.
    let jump = range.high - range.low;
    let once = (0.5..1.5).contains(&jump) || range == Interval::new(-1.0, 1.0);
    once.then(|| [range.low, range.high].map(N::constant))
}
