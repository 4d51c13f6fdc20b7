//! The watch over the rows set aside between the ends of a sub-step.
//!
//! A row that follows from the others in a stretch of the motion follows from them all the way, as
//! the relations of pins, guides, links and wheels are analytic, and too smooth to part unseen and
//! meet again. A function that the file gives may do so anywhere: a contour, a curve, an equation with
//! a bump of a hundredth of a radian, which is zero to rounding outside. Rows that depend on one are
//! bounded over the sub-step, in the region of the chord and its radii: at both ends they hold, and
//! between them they are open by no more than their deviation from the chord.

use crate::kinematics::certificate::StepBounds;
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::Watched;
use crate::kinematics::plan::compiled_mechanism::{CompiledMechanism, FunctionRow};
use crate::kinematics::state::State;

/// Largest scaled residual of a row set aside between the ends of a sub-step.
///
/// A bound shrinks as the square of the sub-step, not down to the 1e-9 that the ends must hold.
/// Halved, sub-steps over an equation with the second derivative 1 are a 50th of a radian long instead
/// of a 35th. Doubled, a contradiction of 2e-4 rad may pass unseen within a sub-step.
const OPEN_BETWEEN: f64 = 1e-4;
/// Largest move of an unknown, in radians and characteristic lengths, in a sub-step whose row has
/// no bound, because pieces of the function meet there. The row is then checked at both ends only.
const SHORT: f64 = 1e-3;

/// Bounds over a sub-step the rows set aside that depend on a function of the file. Allocates nothing.
///
/// Before: the mechanism is at the end of the sub-step, and all blocks have written their bounds.
///
/// # Errors
///
/// [`Rejected`] where such a row may be open.
pub(in crate::kinematics) fn watch_between(
    compiled: &CompiledMechanism,
    state: &State,
    bounds: &mut StepBounds,
) -> Result<(), Rejected> {
    let mut rows = compiled.redundant.function_rows.iter();
    rows.try_for_each(|row| {
        let step_ratio = match open_between(compiled, state, row, bounds) {
            Ok(open) => open / OPEN_BETWEEN,
            Err(largest_move) if largest_move <= SHORT => {
                bounds.checked = true;
                0.0
            }
            Err(_) => f64::INFINITY,
        };
        bounds.require(step_ratio)
    })
}

/// Bounds a row over a sub-step, scaled.
///
/// # Errors
///
/// The largest move of the row's unknowns, in radians and characteristic lengths, if it has no
/// bound.
fn open_between(
    compiled: &CompiledMechanism,
    state: &State,
    row: &FunctionRow,
    bounds: &mut StepBounds,
) -> Result<f64, f64> {
    let CompiledMechanism { system, plan, .. } = compiled;
    let at = &state.at;
    let equation = &system.equations()[row.row];
    let watched = Watched {
        relation: &*equation.constraint,
        columns: &row.columns,
        at,
        from: &state.pose.q,
        pivots: &plan.pivots,
    };
    let open = if bounds.parameters.moves(row.row) {
        let (target, largest_jump) = bounds.parameters.change_of(row.row);
        let open = watched.deviation_while_moving(bounds, largest_jump);
        open.map(|open| open + 0.125 * target.second)
    } else {
        watched.deviation(bounds)
    };
    match open.filter(|open| open.is_finite()) {
        Some(open) => Ok(open * equation.row_scale(at)),
        None => {
            let scale = |column| system.column_scale(column, at.size());
            Err(watched.largest_move(bounds, scale))
        }
    }
}
