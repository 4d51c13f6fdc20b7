//! The nearest pose of a mechanism that does not close block by block, and the proof that it cannot
//! close, if there is one.

use super::branches::{Branches, SearchEffort};
use super::closing::close_on;
use super::gaps::open_joints;
use super::least_squares::{LARGEST_PART, Part, SMALL_PART, STARTS};
use super::search::{Nearest, NoBranch};
use crate::kinematics::block::{BlockSolver, SolveBlock};
use crate::kinematics::element::Element;
use crate::kinematics::error::{Error, OpenJoint, Proof, Verdict};
use crate::kinematics::model::Model;
use crate::kinematics::newton::MAX_ASSEMBLY_ITERATIONS;
use crate::kinematics::state::State;

/// Minimisation steps towards the nearest pose of a mechanism that does not close.
const STEPS_TO_NEAREST: usize = 200;
/// A scaled residual below this is no gap that anyone could measure: the mechanism closes, and
/// Newton–Raphson failed because the position is singular.
const CLOSED: f64 = 1e-7;
/// The quantity without a value where squares of lengths overflow.
const AN_EQUATION: &str = "an equation of the mechanism";
/// Weight of all other joints when the gap is gathered in one.
const HOLD_CLOSED: f64 = 1e4;

/// Assembles a mechanism as a whole, after the search over its blocks failed. Returns the most
/// corrections of a block.
///
/// # Errors
///
/// [`Error::NotAssembled`], or [`Error::Singular`] if it closes in a singular position.
pub(in crate::kinematics) fn search_at_once(
    model: &mut Model,
    state: &mut State,
    mut failure: NoBranch,
    estimate: &[f64],
) -> Result<u32, Error> {
    let rows: Vec<_> = (0..model.system.equations().len()).collect();
    let columns: Vec<_> = (0..model.system.unknowns()).collect();
    let nearest = failure.nearest.take();
    if columns.len() > SMALL_PART {
        return match nearest {
            Some(nearest) => Err(explain_gap(model, state, &failure, &nearest, estimate)),
            None => search_sparsely(model, state, failure, &rows, estimate),
        };
    }
    let whole = Part::new(&rows, &columns);
    if !failure.proved || nearest.is_none() {
        let closed = minimise_from_all(model, state, &whole, failure.proved, estimate);
        if let Some(iterations) = closed {
            return Ok(iterations);
        }
        failure.starts += STARTS;
    }
    Err(match nearest {
        Some(nearest) => explain_gap(model, state, &failure, &nearest, estimate),
        None => explain_failure(model, state, &failure, &whole),
    })
}

/// Minimises a mechanism of any size as a whole and closes it from there.
///
/// # Errors
///
/// Those of [`search_at_once`].
fn search_sparsely(
    model: &mut Model,
    state: &mut State,
    mut failure: NoBranch,
    rows: &[usize],
    estimate: &[f64],
) -> Result<u32, Error> {
    let gap = close_on(&model.system, state, rows, estimate);
    failure.starts += 1;
    state.accept_bodies();
    if gap.is_none()
        && let Some(iterations) = close(model, state)
    {
        return Ok(iterations);
    }
    state.move_to_pose(&model.system);
    Err(explain_pose(model, state, &failure, failure.block))
}

/// Minimises the whole from all starts and goes to the nearest pose. Unless that is `proved`
/// impossible, closes the mechanism from one of them; then returns the most corrections of a
/// block.
fn minimise_from_all(
    model: &mut Model,
    state: &mut State,
    whole: &Part,
    proved: bool,
    estimate: &[f64],
) -> Option<u32> {
    let mut nearest: Option<(f64, Vec<f64>)> = None;
    for attempt in 0..STARTS {
        let mut block_state = state.block_state(&model.system);
        whole.start(&mut block_state, estimate, attempt);
        whole.minimise_growing(&mut block_state);
        if !proved {
            state.accept_bodies();
            if let Some(iterations) = close(model, state) {
                return Some(iterations);
            }
            state.move_to_pose(&model.system);
        }
        let mut block_state = state.block_state(&model.system);
        whole.minimise(&mut block_state, None, |_| 1.0, STEPS_TO_NEAREST);
        let gap = whole.equations(&block_state).0.norm();
        if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
            state.accept_bodies();
            nearest = Some((gap, state.pose.q.clone()));
        }
    }
    if let Some((_, q)) = nearest {
        state.pose.q.copy_from_slice(&q);
    }
    state.move_to_pose(&model.system);
    None
}

/// Closes block by block by Newton–Raphson, from where the bodies are. Returns the most
/// corrections of a block; `None` leaves the pose as it was.
fn close(model: &mut Model, state: &mut State) -> Option<u32> {
    let Model { system, plan, .. } = model;
    let closed = plan.close(&mut state.block_state(system), MAX_ASSEMBLY_ITERATIONS);
    let iterations = closed.ok()?;
    state.accept_bodies();
    Some(iterations)
}

/// Explains a block in closed form that leaves the least gap, once the blocks behind it are as
/// near to closing as they come.
fn explain_gap(
    model: &mut Model,
    state: &mut State,
    failure: &NoBranch,
    nearest: &Nearest,
    estimate: &[f64],
) -> Error {
    state.pose.q.copy_from_slice(&nearest.q);
    state.move_to_pose(&model.system);
    let proof = proof(model, state, failure, nearest.block);
    let Model { system, plan, .. } = &mut *model;
    let mut block_state = state.block_state(system);
    for (index, block) in plan.blocks.iter_mut().enumerate().skip(nearest.block) {
        let mut branches = Branches::new(block, &mut block_state, estimate, SearchEffort::Near);
        let behind = index > nearest.block;
        if behind && branches.next(block, &mut block_state, estimate).is_some() {
            continue;
        }
        match block {
            BlockSolver::PinnedBody(block) => block.locate(&mut block_state),
            BlockSolver::RrrDyad(block) => block.stretch(&mut block_state, estimate),
            BlockSolver::RrpDyad(block) => block.stretch(&mut block_state, estimate),
            // The pose has no crossings where bodies are at their estimates.
            BlockSolver::InterpolatedBlock(_) => {}
            BlockSolver::CoupledBlock(block) => {
                let part = Part::new(block.rows(), block.columns());
                part.start(&mut block_state, estimate, 0);
                if part.unknowns() <= LARGEST_PART {
                    part.minimise(&mut block_state, None, |_| 1.0, STEPS_TO_NEAREST);
                }
            }
        }
    }
    state.accept_bodies();
    state.move_to_pose(&model.system);
    judge(model, state, failure, proof)
}

/// Explains the pose, which is the nearest one found, by a block that does not close.
fn explain_pose(model: &mut Model, state: &mut State, failure: &NoBranch, block: usize) -> Error {
    let proof = proof(model, state, failure, block);
    judge(model, state, failure, proof)
}

/// Judges the pose, which is the nearest one found.
fn judge(model: &mut Model, state: &mut State, failure: &NoBranch, proof: Proof) -> Error {
    let largest = state.residual(&model.system);
    if !largest.is_finite() {
        return Error::NotFinite {
            what: AN_EQUATION.to_owned(),
        };
    }
    if !failure.proved && largest <= CLOSED {
        return Error::Singular {
            rcond: state.rcond(model),
            bodies: Vec::new(),
        };
    }
    let rows: Vec<_> = (0..model.system.equations().len()).collect();
    let open = open_joints(model, state, &rows, largest);
    not_assembled(state, failure, proof, open)
}

/// Returns the proof that a block does not close, where those before it are at the pose.
fn proof(model: &Model, state: &mut State, failure: &NoBranch, block: usize) -> Proof {
    let mechanism = model.system.mechanism();
    let name = |body: usize| mechanism.bodies[body].name.clone();
    match &model.plan.blocks[block] {
        BlockSolver::RrrDyad(block) => {
            let reach = block.reach(&state.block_state(&model.system));
            let mut ends = block.ends();
            ends.sort_unstable_by_key(|(body, _)| *body);
            Proof::Reach {
                bodies: ends.map(|(body, _)| name(body)),
                points: ends.map(|(_, anchor)| mechanism.marker_path(anchor)),
                distance: reach.distance,
                span: [reach.shortest, reach.longest],
            }
        }
        BlockSolver::RrpDyad(block) => Proof::Line {
            body: name(block.body()),
        },
        block => {
            let mut bodies: Vec<_> = block.columns().iter().map(|k| k / 3).collect();
            // Joint unknowns come behind the bodies.
            bodies.retain(|&body| body < mechanism.bodies.len());
            bodies.sort_unstable();
            bodies.dedup();
            Proof::Excluded {
                bodies: bodies.into_iter().map(name).collect(),
                boxes: failure.boxes,
            }
        }
    }
}

fn not_assembled(
    state: &State,
    failure: &NoBranch,
    proof: Proof,
    open: Vec<(Element, OpenJoint)>,
) -> Error {
    let verdict = if failure.proved {
        Verdict::Impossible {
            proof: Box::new(proof),
            ways: failure.dead_ends,
        }
    } else {
        Verdict::NotFound {
            starts: failure.starts,
        }
    };
    Error::NotAssembled {
        verdict,
        open: open.into_iter().map(|(_, joint)| joint).collect(),
        nearest: state.pose.q.clone(),
    }
}

/// Explains a mechanism whose nearest pose, which is that of the state, leaves gaps.
fn explain_failure(
    model: &mut Model,
    state: &mut State,
    failure: &NoBranch,
    whole: &Part,
) -> Error {
    let (residual, jacobian) = whole.equations(&state.block_state(&model.system));
    let beyond_numbers = || Error::NotFinite {
        what: AN_EQUATION.to_owned(),
    };
    let mut numbers = residual.iter().chain(jacobian.iter());
    if !numbers.all(|x| x.is_finite()) {
        return beyond_numbers();
    }
    if !failure.proved && residual.amax() <= CLOSED {
        let singular = jacobian.singular_values();
        return Error::Singular {
            rcond: singular.min() / singular.max(),
            bodies: Vec::new(),
        };
    }
    let spread = open_joints(model, state, &whole.rows, residual.amax());
    if spread.is_empty() {
        return beyond_numbers();
    }
    let proof = proof(model, state, failure, failure.block);
    let Some((joint, q)) = gather(model, state, whole, &spread) else {
        return not_assembled(state, failure, proof, spread);
    };
    state.pose.q.copy_from_slice(&q);
    state.move_to_pose(&model.system);
    not_assembled(state, failure, proof, vec![joint])
}

/// Gathers the gap in one joint. The minimum spreads it over all joints of a loop, but people look
/// for one joint that does not meet: the one with the smallest gap, on a tie the one declared
/// last. Returns that joint, and q with the others closed.
fn gather(
    model: &Model,
    state: &mut State,
    part: &Part,
    spread: &[(Element, OpenJoint)],
) -> Option<((Element, OpenJoint), Vec<f64>)> {
    let mut best: Option<(f64, (Element, OpenJoint), Vec<f64>)> = None;
    let equations = model.system.equations();
    for (element, _) in spread {
        state.move_to_pose(&model.system);
        let weight = |row: usize| {
            if equations[row].element == *element {
                1.0
            } else {
                HOLD_CLOSED
            }
        };
        let mut block_state = state.block_state(&model.system);
        part.minimise(&mut block_state, None, weight, STEPS_TO_NEAREST);
        let largest = part.equations(&block_state).0.amax();
        if let [joint] = &open_joints(model, state, &part.rows, largest)[..]
            && joint.0 == *element
            && let gap = (joint.1.gap / state.at.size()).max(joint.1.angle)
            && best
                .as_ref()
                .is_none_or(|(smallest, ..)| gap <= smallest * (1.0 + 1e-3))
        {
            let mut q = state.pose.q.clone();
            state.at.copy_pose(&mut q);
            best = Some((gap, joint.clone(), q));
        }
    }
    state.move_to_pose(&model.system);
    best.map(|(_, joint, q)| (joint, q))
}
