//! The watch over the rows set aside between the ends of a sub-step.
//!
//! A row that follows from the others in a stretch of the motion follows from them all the way, as
//! all relations but those of cams are analytic. A contour may leave its circle anywhere: rows that
//! depend on one are bounded over the sub-step, in the region of the chord and its radii.

use crate::kinematics::certificate::StepBounds;
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::compiled_mechanism::{CompiledMechanism, ContourRow};
use crate::kinematics::state::State;

/// Largest scaled residual of a row set aside between the ends of a sub-step.
const OPEN_BETWEEN: f64 = 1e-4;
/// Largest move of an unknown, in radians and characteristic lengths, in a sub-step whose row has
/// no bound, because pieces of the profile meet there. The row is then checked at both ends only.
const SHORT: f64 = 1e-3;

/// Bounds over a sub-step the rows set aside that depend on a contour. Allocates nothing.
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
    let mut rows = compiled.redundant.contour_rows.iter();
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
    row: &ContourRow,
    bounds: &mut StepBounds,
) -> Result<f64, f64> {
    let CompiledMechanism { system, plan, .. } = compiled;
    let at = &state.at;
    let mut largest_move = 0.0_f64;
    for &column in &row.columns {
        let chord = at.coordinate(column) - state.pose.q[column];
        bounds.chord[column] = chord;
        // The region contains the whole chord, seen from its end.
        bounds.region[column] = chord.abs() + bounds.deviation(column, &plan.pivots);
        let scale = system.column_scale(column, at.size());
        largest_move = largest_move.max(bounds.region[column] / scale);
    }
    let equation = &system.equations()[row.row];
    if bounds.parameters.moves(row.row) {
        let open = open_while_moving(compiled, state, row, bounds);
        for &column in &row.columns {
            bounds.region[column] = 0.0;
            bounds.chord[column] = 0.0;
        }
        return open.ok_or(largest_move);
    }
    let constraint = &equation.constraint;
    let (mut gradient, mut change) = (Gradient::new(), Gradient::new());
    constraint.gradient(at, &mut gradient);
    let region = Region::around(&bounds.region);
    let along = constraint.bend(at, &region, &bounds.chord, &mut change);
    let steepest = gradient.entries().chain(change.entries());
    let off_chord = steepest.map(|(column, slope)| {
        let deviation = bounds.deviation(column, &plan.pivots);
        slope.abs() * deviation
    });
    let off_chord: f64 = off_chord.sum();
    for &column in &row.columns {
        bounds.region[column] = 0.0;
        bounds.chord[column] = 0.0;
    }
    let open = along.map(|along| (0.125 * along + off_chord) * equation.row_scale(at));
    open.ok_or(largest_move)
}

/// Bounds a row, scaled, over a sub-step on which parameters move its numbers. Returns `None`
/// without a bound.
#[cold]
fn open_while_moving(
    compiled: &CompiledMechanism,
    state: &State,
    row: &ContourRow,
    bounds: &mut StepBounds,
) -> Option<f64> {
    let CompiledMechanism { system, plan, .. } = compiled;
    let at = &state.at;
    let equation = &system.equations()[row.row];
    let deviation = |bounds: &StepBounds, column| bounds.deviation(column, &plan.pivots);
    for &column in &row.columns {
        let ends = [state.pose.q[column], at.coordinate(column)];
        let radius = deviation(bounds, column);
        bounds.parameters.set_chord(column, ends, radius);
    }
    let mut open = 0.125 * bounds.parameters.bend(row.row, equation, at.profiles())?;
    for &column in &row.columns {
        let radius = deviation(bounds, column);
        let slope = (bounds.parameters).partial(equation, at.profiles(), column);
        open += slope.magnitude() * radius;
    }
    open.is_finite().then(|| open * equation.row_scale(at))
}
