//! Assembly modes: all the branches in which a mechanism closes for the same values of its drivers.

use crate::kinematics::assembly::branches::{Branches, SearchEffort};
use crate::kinematics::assembly::estimate::{distance, estimate};
use crate::kinematics::assembly::least_squares::is_same;
use crate::kinematics::assembly::turns::choose_turns;
use crate::kinematics::error::Error;
use crate::kinematics::model::Model;
use crate::kinematics::redundancy::opened;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// The branches in which a mechanism closes besides the one in which it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// Those found, nearest the estimates first.
    pub others: Vec<Mode>,
    /// From how many starts each part was assembled of which not all branches are known, for each way
    /// of the parts before it; zero if there is no such part.
    pub starts: usize,
    /// Whether there are no others: all parts were assembled in every way that closed forms give
    /// them, or bounds over intervals, which leave no other.
    pub complete: bool,
}

/// One way in which a mechanism closes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Generalized coordinates, \[m, m, rad\] for each body, then the joints' own unknowns. Each
    /// angle is the representative nearest its estimate.
    pub q: Vec<f64>,
    /// Scaled reciprocal condition of the Jacobian there.
    pub rcond: f64,
    /// The largest move of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// From so many starts a part is assembled of which not all branches are known.
const STARTS: usize = 60;
/// So many modes are listed at the most: independent parts multiply theirs.
const MOST_MODES: usize = 64;
/// So many times blocks are put in another way at the most.
const MOST_STEPS: usize = 20_000;

/// Finds the other branches in which the mechanism closes with the parameters and driver values
/// of the present pose: goes through both branches of each dyad and slide, through those of other
/// parts of few angles that bounds over intervals find, which are all there are, and through
/// those that minimisation finds for the rest from several starts, which are always the same.
/// The solver stays where it is.
///
/// # Errors
///
/// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
pub(in crate::kinematics) fn modes(model: &mut Model, state: &mut State) -> Result<Modes, Error> {
    let estimate = estimate(&model.system, &state.pose.parameters)?;
    let home = state.pose.clone();
    state.release_crossings(model);
    let mut modes = Modes {
        others: Vec::new(),
        starts: 0,
        complete: true,
    };
    for q in close_on_all_branches(model, state, &estimate, &mut modes) {
        state.pose.q.copy_from_slice(&q);
        choose_turns(&model.system, state, &estimate);
        if opened(model, state).is_some() {
            continue;
        }
        let known = std::iter::once(&home.q).chain(modes.others.iter().map(|mode| &mode.q));
        if known
            .into_iter()
            .any(|known| is_at(&model.system, state, known))
        {
            continue;
        }
        modes.others.push(Mode {
            rcond: state.rcond(model),
            distance: distance(&model.system, state, &estimate),
            q: state.pose.q.clone(),
        });
    }
    let others = &mut modes.others;
    others.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    state.restore(model, &home);
    Ok(modes)
}

/// q of each mode; notes in `modes` how they were looked for.
fn close_on_all_branches(
    model: &mut Model,
    state: &mut State,
    estimate: &[f64],
    modes: &mut Modes,
) -> Vec<Vec<f64>> {
    let Model { system, plan, .. } = model;
    let unknowns = system.unknowns();
    let mut work = state.block_state(system);
    let blocks = &mut plan.blocks;
    let mut levels: Vec<Branches> = Vec::with_capacity(blocks.len());
    let mut poses = Vec::new();
    let most_steps = MOST_STEPS + 2 * blocks.len();
    for _ in 0..most_steps {
        // Forward while blocks close, back to the last one that has another way.
        if let Some(block) = blocks.get(levels.len()) {
            let effort = SearchEffort::Anywhere(STARTS);
            levels.push(Branches::new(block, &mut work, estimate, effort));
        } else {
            let mut q = vec![0.0; unknowns];
            work.at.copy_pose(&mut q);
            poses.push(q);
            if poses.len() >= MOST_MODES {
                break;
            }
        }
        while let Some((branches, block)) = levels.len().checked_sub(1).and_then(|last| {
            let branches = levels.get_mut(last)?;
            Some((branches, &mut blocks[last]))
        }) {
            if branches.next(block, &mut work, estimate).is_some() {
                break;
            }
            if !branches.is_complete() {
                modes.complete = false;
                modes.starts = modes.starts.max(branches.starts);
            }
            levels.pop();
        }
        if levels.is_empty() {
            return poses;
        }
    }
    modes.complete = false;
    poses
}

/// Whether the pose is the same as another, whole turns of the angles apart.
fn is_at(system: &System, state: &State, other: &[f64]) -> bool {
    let size = state.at.size();
    let mut pairs = state.pose.q.iter().zip(other).enumerate();
    pairs.all(|(column, (&a, &b))| is_same(system, size, column, a, b))
}
