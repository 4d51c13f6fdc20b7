//! The warning of a singular position.

use std::fmt;

use super::lines::{NEARBY, all_that_moves, find_lines};
use super::near::{LARGEST_BLOCK, NEAR, block_jacobian};
use crate::kinematics::alignment::Alignment;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;

/// A mechanism that has come near a singular position.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// Scaled reciprocal condition.
    pub rcond: f64,
    /// Kind and name of the bodies and connections in `geometry`.
    pub bodies: Vec<String>,
    /// The lines that all but meet, in words.
    pub geometry: String,
}

/// A reciprocal condition below this is worth a warning: links are in line to less than a tenth
/// of a degree, and their driver moves some thousand times as slowly as they do.
const WARNED: f64 = 1e-3;
/// Above this the mechanism is away again, and the next approach is another one.
const AWAY_AGAIN: f64 = 1e-2;

impl fmt::Display for Approach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "near a singular position, with a reciprocal condition of {:.1e}: {}",
            self.rcond, self.geometry
        )
    }
}

/// Returns the approach to a singular position, if the mechanism has come near one since `near`
/// was last false; `near` is true from then on until the mechanism is away again. Next to a change
/// point that is crossed there is no warning. Away from singular positions it costs a comparison.
pub(in crate::kinematics) fn approach(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    near: &mut bool,
) -> Option<Approach> {
    if !state.pose.crossings.is_empty() || (!*near && state.regularity >= NEAR) {
        return None;
    }
    let rcond = state.rcond(compiled);
    if rcond > AWAY_AGAIN {
        *near = false;
    }
    if *near || rcond >= WARNED {
        return None;
    }
    *near = true;
    let alignment = weakest_alignment(compiled, state);
    let mechanism = compiled.system.mechanism();
    Some(Approach {
        rcond,
        bodies: alignment.names(mechanism),
        geometry: alignment.describe(mechanism, "all but "),
    })
}

/// Returns the lines that all but meet in the block that is nearest to a singular position, for the
/// motion of its weakest direction; of a large block all that it moves.
fn weakest_alignment(compiled: &mut CompiledMechanism, state: &State) -> Alignment {
    let mut weakest = (f64::INFINITY, 0);
    for (index, block) in compiled.plan.blocks.iter_mut().enumerate() {
        let rcond = block.rcond();
        if rcond < weakest.0 {
            weakest = (rcond, index);
        }
    }
    let Some(block) = compiled.plan.blocks.get(weakest.1) else {
        return Alignment::default();
    };
    let columns = block.columns();
    if columns.len() <= LARGEST_BLOCK {
        let svd = block_jacobian(compiled, state, weakest.1).svd(false, true);
        if let Some(right) = svd.v_t {
            let least = right.row(right.nrows() - 1);
            let largest = least.amax();
            let free: Vec<f64> = least.iter().map(|value| value / largest).collect();
            return find_lines(compiled, &state.at, (columns, &free), NEARBY);
        }
    }
    all_that_moves(compiled, &state.at, (columns, &vec![1.0; columns.len()]))
}
