//! Closing a mechanism as a whole on given rows, however many there are.

use super::least_squares::LeastSquares;
use super::part::{SMALL_PART, STARTS};
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// Returns whether the mechanism is small enough for several starts and dense matrices.
pub(in crate::kinematics) fn is_small(system: &System) -> bool {
    system.unknowns() <= SMALL_PART
}

/// Closes the mechanism on these rows, from the estimates or from starts near them. Returns `None`
/// if they are satisfied; otherwise moves the bodies to the nearest pose found and returns its
/// largest scaled residual.
pub(in crate::kinematics) fn close_on(
    system: &System,
    state: &mut State,
    rows: &[usize],
    estimate: &[f64],
) -> Option<f64> {
    let starts = if is_small(system) { STARTS } else { 1 };
    close_from(system, state, rows, estimate, starts)
}

/// Closes the mechanism on these rows from the estimates alone.
pub(in crate::kinematics) fn close_near(
    system: &System,
    state: &mut State,
    rows: &[usize],
    estimate: &[f64],
) -> Option<f64> {
    close_from(system, state, rows, estimate, 1)
}

fn close_from(
    system: &System,
    state: &mut State,
    rows: &[usize],
    estimate: &[f64],
    starts: usize,
) -> Option<f64> {
    let mut part = LeastSquares::of_all(system, rows);
    let small = is_small(system);
    let mut nearest: Option<(f64, Vec<f64>)> = None;
    for attempt in 0..starts {
        let mut block_state = state.block_state(system);
        part.start(&mut block_state, estimate, attempt);
        if small {
            part.minimise_growing(&mut block_state);
        }
        let gap = part.close(&mut block_state)?;
        if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
            nearest = Some((gap, part.read(&block_state)));
        }
    }
    let (gap, q) = nearest?;
    state.at.set_pose(system.mechanism(), &q);
    Some(gap)
}
