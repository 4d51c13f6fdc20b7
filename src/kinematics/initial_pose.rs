//! The first pose, from the estimates in the file (Eq. 3.6.9) or by continuous motion from a known
//! pose.

use super::assembly::estimate::{distance, go_to_estimate};
use super::assembly::nearest::search_at_once;
use super::assembly::search::search;
use super::assembly::turns::choose_turns;
use super::continuation::{PathTracker, Progress};
use super::error::Error;
use super::model::Model;
use super::newton::SINGULAR;
use super::path::Path;
use super::redundancy::{assemble_on_all, choose_rows};
use super::singular::settle;
use super::state::{Pose, State};

/// The method that found the first pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Continuous motion: the assembly mode is that of the pose at the start.
    Continuous(Progress),
    /// Assembly from the estimates, because the motion was blocked; possibly another assembly mode.
    Reassembled(Assembly),
}

impl Start {
    /// Returns the warning of a start that may be in another assembly mode than the file's pose.
    #[must_use]
    pub fn warning(&self) -> Option<&'static str> {
        match self {
            Self::Continuous(_) => None,
            Self::Reassembled(_) => Some(
                "no continuous motion leads from the file's own pose to these values: assembled \
                 there from the estimates, possibly in another assembly mode",
            ),
        }
    }
}

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
/// Those of [`Solver::assemble`](super::Solver::assemble).
pub(super) fn assemble(
    model: &mut Model,
    state: &mut State,
    path: &Path,
) -> Result<Assembly, Error> {
    match assemble_rows(model, state, path, !model.redundant.is_empty()) {
        // The rows may be redundant for these numbers.
        Err(Error::Singular { .. }) => {
            choose_rows(model, state, path)?;
            assemble_rows(model, state, path, true)
        }
        assembled => assembled,
    }
}

/// Assembles with the rows chosen so far; `on_all` closes the redundant ones, too.
fn assemble_rows(
    model: &mut Model,
    state: &mut State,
    path: &Path,
    on_all: bool,
) -> Result<Assembly, Error> {
    let estimate = go_to_estimate(model, state, path)?;
    let iterations = if on_all {
        assemble_on_all(model, state, &estimate)?
    } else {
        match search(model, state, &estimate) {
            Ok(iterations) => iterations,
            Err(failure) => search_at_once(model, state, failure, &estimate)?,
        }
    };
    choose_turns(&model.system, state, &estimate);
    // The search may have chosen pivots, at poses that belong to no motion.
    model
        .plan
        .reset_pivots(&model.system, &state.at, &state.targets);
    state.refresh(model)?;
    let rcond = model.plan.rcond();
    if rcond < SINGULAR {
        return Err(Error::Singular {
            rcond,
            bodies: Vec::new(),
        });
    }
    settle(model, state);
    Ok(Assembly {
        iterations,
        distance: distance(&model.system, state, &estimate),
    })
}

/// Finds the pose at the end of `path`: tracks the path from `home`, which is at its start, or
/// assembles at its end if the motion is blocked.
///
/// # Errors
///
/// Those of [`assemble`].
pub(super) fn start(
    model: &mut Model,
    state: &mut State,
    tracker: &mut PathTracker,
    home: &Pose,
    path: &Path,
) -> Result<Start, Error> {
    state.restore(model, home);
    match tracker.track(model, state, path, false) {
        Ok(progress) => Ok(Start::Continuous(progress)),
        Err(_) => assemble(model, state, path).map(Start::Reassembled),
    }
}
