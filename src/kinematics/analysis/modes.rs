//! Assembly modes: the poses in which a mechanism closes for the same values of its drivers.

use crate::kinematics::assembly::branches::SearchEffort;
use crate::kinematics::assembly::estimate::{distance, estimate, go_to_estimate};
use crate::kinematics::assembly::part::is_same;
use crate::kinematics::assembly::search::BranchSearch;
use crate::kinematics::assembly::turns::choose_turns;
use crate::kinematics::error::Error;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::redundancy::opened;
use crate::kinematics::state::{Pose, State};
use crate::kinematics::system::System;

/// The assembly modes of a mechanism besides the one of its pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The modes found, nearest the estimates first.
    pub others: Vec<AssemblyMode>,
    /// Number of starts of each block of which not all branches are known, on each branch of the
    /// blocks before it; zero if there is no such block.
    pub starts: usize,
    /// Whether there are no others: all blocks were assembled on every branch that closed forms
    /// give, or bounds over intervals, which leave no other.
    pub complete: bool,
}

/// One assembly mode.
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyMode {
    /// Generalized coordinates, \[m, m, rad\] for each body, then the joint unknowns. Each angle is
    /// the representative nearest its estimate.
    pub q: Vec<f64>,
    /// Scaled reciprocal condition of the Jacobian there.
    pub rcond: f64,
    /// The largest distance of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// Starting points anywhere for a block without a complete list of branches.
const STARTS_FOR_MODES: usize = 60;
/// Most modes that are listed: independent blocks multiply theirs.
const MOST_MODES: usize = 64;
/// Most work of the search; see [`BranchSearch`].
const WORK_OF_MODES: f64 = 20_000.0;

/// Finds the other assembly modes for the parameters and driver values of the pose. See
/// [`Solver::modes`](crate::kinematics::Solver::modes).
///
/// # Errors
///
/// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
pub(in crate::kinematics) fn modes(
    compiled: &mut CompiledMechanism,
    state: &mut State,
) -> Result<Modes, Error> {
    let estimate = estimate(&compiled.system, &state.pose.parameters)?;
    let home = state.pose.clone();
    state.release_crossings(compiled);
    let effort = SearchEffort::Anywhere(STARTS_FOR_MODES);
    let Closed {
        poses,
        starts,
        complete,
    } = close_all(compiled, state, &estimate, effort);
    let mut others: Vec<AssemblyMode> = Vec::new();
    for pose in poses {
        state.pose.q.copy_from_slice(&pose.q);
        state.move_to_pose(&compiled.system);
        if is_at(&compiled.system, state, &home.q) {
            continue;
        }
        others.push(AssemblyMode {
            rcond: state.rcond(compiled),
            distance: distance(&compiled.system, state, &estimate),
            q: pose.q,
        });
    }
    others.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    state.restore(compiled, &home);
    Ok(Modes {
        others,
        starts,
        complete,
    })
}

/// Finds poses at the end of `path`, in any assembly mode. See
/// [`Solver::poses`](crate::kinematics::Solver::poses).
///
/// # Errors
///
/// [`Error::NotFinite`], [`Error::NotPositive`] and [`Error::NoMotion`] for values without a
/// mechanism.
pub(in crate::kinematics) fn poses(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
) -> Result<Vec<Pose>, Error> {
    let estimate = go_to_estimate(compiled, state, path)?;
    Ok(close_all(compiled, state, &estimate, SearchEffort::Quick).poses)
}

/// The poses that a search finds.
struct Closed {
    /// Poses, no two of which are the same.
    poses: Vec<Pose>,
    /// As in [`Modes`].
    starts: usize,
    /// As in [`Modes`].
    complete: bool,
}

/// Searches for poses with the time, the parameters and the drivers of the present one.
fn close_all(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
    effort: SearchEffort,
) -> Closed {
    let mut search = BranchSearch::new(compiled, state, estimate, effort, WORK_OF_MODES);
    let mut found = Vec::new();
    while found.len() < MOST_MODES && search.next() {
        found.push(search.pose());
    }
    let complete = search.is_complete && found.len() < MOST_MODES;
    let starts = search.starts;
    let mut poses: Vec<Pose> = Vec::new();
    for q in found {
        state.pose.q.copy_from_slice(&q);
        choose_turns(&compiled.system, state, estimate);
        let is_known = |known: &Pose| is_at(&compiled.system, state, &known.q);
        if opened(compiled, state).is_none() && !poses.iter().any(is_known) {
            poses.push(state.pose.clone());
        }
    }
    Closed {
        poses,
        starts,
        complete,
    }
}

/// Returns whether the pose is the same as another, whole turns of the angles apart.
fn is_at(system: &System, state: &State, other: &[f64]) -> bool {
    let size = state.at.size();
    let mut pairs = state.pose.q.iter().zip(other).enumerate();
    pairs.all(|(column, (&a, &b))| is_same(system, size, column, a, b))
}
