//! Bounds of an expression over ranges in which pieces of it meet.
//!
//! Each piece between which `min`, `max`, `abs`, `mod` and the like switch is
//! taken over the whole range in turn; where more than a few switch, the hull of both pieces stands
//! for those of the rest. The hull of all choices bounds value and derivatives on both sides of the
//! switch; whether the pieces join smoothly is not examined here.

use super::function::Binary;
use super::{Expression, MAX_STACK, Operation};
use crate::mechanism::ParameterId;
use crate::mechanism::number::{Interval, Jet3, Number, Unary};

/// Most switches of an expression in one range whose pieces are taken in turn, as each doubles the
/// work.
const MOST_SWITCHES: u32 = 6;
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
            let stack = [Jet3::constant(0.0); MAX_STACK];
            run_pieces(
                &self.program,
                (stack, 0),
                &parameter,
                variable,
                MOST_SWITCHES,
            )
        });
        let first = parts.next().flatten();
        parts.fold(first, |hull, part| Some(hull?.hull(part?)))
    }
}

/// Runs the rest of a program on a stack of some height. Returns the hull of the results for both
/// pieces of each of the first `switches` operations that switch.
fn run_pieces(
    program: &[Operation],
    (mut stack, mut height): ([Jet3<Interval>; MAX_STACK], usize),
    parameter: &impl Fn(ParameterId) -> Jet3<Interval>,
    variable: Jet3<Interval>,
    switches: u32,
) -> Option<Jet3<Interval>> {
    for (index, operation) in program.iter().enumerate() {
        let first = height - operation.arity();
        if let Some(pieces) = operation.switch(&stack[first..height]) {
            let Some(switches) = switches.checked_sub(1) else {
                let [one, other] = pieces;
                stack[first] = one.hull(other);
                height = first + 1;
                continue;
            };
            let [one, other] = pieces.map(|piece| {
                stack[first] = piece;
                let rest = &program[index + 1..];
                run_pieces(rest, (stack, first + 1), parameter, variable, switches)
            });
            return Some(one?.hull(other?));
        }
        operation.apply(&mut stack, &mut height, parameter, &|_| variable);
    }
    let [first, second, _] = stack[0].derivatives;
    let needed = [stack[0].value, first, second];
    let is_finite = needed.iter().all(|bound| bound.is_finite());
    is_finite.then_some(stack[0])
}

impl Operation {
    /// Returns both pieces of an operation that switches in the range of its operands; `None` if
    /// it does not, or between more than two pieces. The value of a piece is bounded to where it is
    /// in force.
    fn switch(self, operands: &[Jet3<Interval>]) -> Option<[Jet3<Interval>; 2]> {
        match (self, operands) {
            (Self::Binary(Binary::Min), &[x, y]) => {
                is_undecided(x, y).then(|| [below(x, y.value.high), below(y, x.value.high)])
            }
            (Self::Binary(Binary::Max), &[x, y]) => {
                is_undecided(x, y).then(|| [above(x, y.value.low), above(y, x.value.low)])
            }
            (Self::Unary(Unary::Abs), &[x]) => {
                let zero = Jet3::constant(0.0);
                is_undecided(x, zero).then(|| [above(x, 0.0), above(-x, 0.0)])
            }
            (Self::Unary(step @ (Unary::Sign | Unary::Floor | Unary::Ceil)), &[x]) => {
                steps(x.value.apply(step))
            }
            (Self::Binary(Binary::Mod), &[x, y]) => {
                let pieces = steps((x / y).value.floor())?;
                Some(pieces.map(|whole| x - y * whole))
            }
            _ => None,
        }
    }
}

/// Returns whether the larger of two numbers changes in the range.
fn is_undecided(x: Jet3<Interval>, y: Jet3<Interval>) -> bool {
    !x.is_undefined() && !y.is_undefined() && x.at_most(y).is_none()
}

/// Returns a piece that is in force where it is at most `high`.
fn below(piece: Jet3<Interval>, high: f64) -> Jet3<Interval> {
    let value = Interval::new(piece.value.low, piece.value.high.min(high));
    Jet3::new(value, piece.derivatives)
}

/// Returns a piece that is in force where it is at least `low`.
fn above(piece: Jet3<Interval>, low: f64) -> Jet3<Interval> {
    let value = Interval::new(piece.value.low.max(low), piece.value.high);
    Jet3::new(value, piece.derivatives)
}

/// Returns the two values of a step function that jumps once in the range: from one integer to the
/// next, or from −1 to 1.
fn steps(range: Interval) -> Option<[Jet3<Interval>; 2]> {
    // Both ends are integers.
    let jump = range.high - range.low;
    let once = (0.5..1.5).contains(&jump) || range == Interval::new(-1.0, 1.0);
    once.then(|| [range.low, range.high].map(Jet3::constant))
}
