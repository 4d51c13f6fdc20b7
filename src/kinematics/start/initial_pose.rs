//! The first pose, from the estimates in the file (Eq. 3.6.9).

use crate::kinematics::assembly::estimate::{distance, go_to_estimate};
use crate::kinematics::assembly::nearest::search_at_once;
use crate::kinematics::assembly::search::search;
use crate::kinematics::assembly::turns::choose_turns;
use crate::kinematics::error::Error;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::redundancy::{assemble_on_all, choose_rows};
use crate::kinematics::singular::settle;
use crate::kinematics::state::State;
use crate::kinematics::tolerances::SINGULAR;

/// The outcome of an assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembly {
    /// Newton corrections after the minimisation.
    pub iterations: u32,
    /// The largest distance of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// Finds the pose at the end of `path` near the file's estimates.
///
/// # Errors
///
/// Those of [`Solver::assemble`](crate::kinematics::Solver::assemble).
pub(in crate::kinematics) fn assemble(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
) -> Result<Assembly, Error> {
    match assemble_rows(compiled, state, path, !compiled.redundant.is_empty()) {
        // The rows may be redundant for these numbers.
        Err(Error::Singular { .. }) => {
            choose_rows(compiled, state, path)?;
            assemble_rows(compiled, state, path, true)
        }
        assembled => assembled,
    }
}

/// Assembles with the rows chosen so far; `on_all` closes the redundant ones, too.
fn assemble_rows(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
    on_all: bool,
) -> Result<Assembly, Error> {
    let estimate = go_to_estimate(compiled, state, path)?;
    let iterations = if on_all {
        assemble_on_all(compiled, state, &estimate)?
    } else {
        match search(compiled, state, &estimate) {
            Ok(iterations) => iterations,
            Err(failure) => search_at_once(compiled, state, failure, &estimate)?,
        }
    };
    choose_turns(&compiled.system, state, &estimate);
    // The search may have chosen pivots, at poses that belong to no motion.
    compiled
        .plan
        .reset_pivots(&compiled.system, &state.at, &state.targets);
    state.refresh(compiled)?;
    let rcond = compiled.plan.rcond();
    if rcond < SINGULAR {
        return Err(Error::Singular {
            rcond,
            bodies: Vec::new(),
            aside: None,
        });
    }
    settle(compiled, state);
    Ok(Assembly {
        iterations,
        distance: distance(&compiled.system, state, &estimate),
    })
}
