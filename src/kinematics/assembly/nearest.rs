//! The nearest pose of a mechanism that does not close block by block, and the proof that it cannot
//! close, if there is one.

use std::collections::BTreeSet;

use super::branches::{Branches, SearchEffort};
use super::closure::{close_on, is_small};
use super::fit::{fit, reach};
use super::gaps::{CLOSED, STEPS_TO_NEAREST, gather, open_joints};
use super::least_squares::LeastSquares;
use super::part::{LARGEST_PART, STARTS};
use super::search::{Nearest, NoBranch};
use crate::kinematics::error::{Error, Fit, OpenJoint, Proof, Verdict};
use crate::kinematics::newton::Limits;
use crate::kinematics::origin::Origin;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;

/// The quantity without a value where squares of lengths overflow.
pub(in crate::kinematics) const AN_EQUATION: &str = "an equation of the mechanism";

/// Assembles a mechanism as a whole, after the search over its blocks failed. Returns the most
/// corrections of a block.
///
/// # Errors
///
/// [`Error::NotAssembled`], or [`Error::Singular`] if it closes in a singular position.
pub(in crate::kinematics) fn search_at_once(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    mut failure: NoBranch,
    estimate: &[f64],
) -> Result<u32, Error> {
    let rows: Vec<_> = (0..compiled.system.equations().len()).collect();
    let nearest = failure.nearest.take();
    if !is_small(&compiled.system) {
        return match nearest {
            Some(nearest) => Err(explain_gap(compiled, state, &failure, &nearest, estimate)),
            None => search_sparsely(compiled, state, failure, &rows, estimate),
        };
    }
    let mut whole = LeastSquares::of_all(&compiled.system, &rows);
    if !failure.proved || nearest.is_none() {
        let closed = minimise_from_all(compiled, state, &mut whole, failure.proved, estimate);
        if let Some(iterations) = closed {
            return Ok(iterations);
        }
        failure.starts += STARTS;
    }
    Err(match nearest {
        Some(nearest) => explain_gap(compiled, state, &failure, &nearest, estimate),
        None => {
            let proof = proof(compiled, state, &failure, failure.block);
            judge(compiled, state, &failure, proof, Some(&mut whole))
        }
    })
}

/// Minimises a mechanism of any size as a whole and closes it from there.
///
/// # Errors
///
/// Those of [`search_at_once`].
fn search_sparsely(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    mut failure: NoBranch,
    rows: &[usize],
    estimate: &[f64],
) -> Result<u32, Error> {
    let gap = close_on(&compiled.system, state, rows, estimate);
    failure.starts += 1;
    state.accept_bodies();
    if gap.is_none()
        && let Some(iterations) = close(compiled, state)
    {
        return Ok(iterations);
    }
    state.move_to_pose(&compiled.system);
    let proof = proof(compiled, state, &failure, failure.block);
    Err(judge(compiled, state, &failure, proof, None))
}

/// Minimises the whole from all starts and goes to the nearest pose. Unless that is `proved`
/// impossible, closes the mechanism from one of them; then returns the most corrections of a
/// block.
fn minimise_from_all(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    whole: &mut LeastSquares,
    proved: bool,
    estimate: &[f64],
) -> Option<u32> {
    let mut nearest: Option<(f64, Vec<f64>)> = None;
    for attempt in 0..STARTS {
        let mut block_state = state.block_state(&compiled.system);
        whole.start(&mut block_state, estimate, attempt);
        whole.minimise_growing(&mut block_state);
        if !proved {
            state.accept_bodies();
            if let Some(iterations) = close(compiled, state) {
                return Some(iterations);
            }
            state.move_to_pose(&compiled.system);
        }
        let mut block_state = state.block_state(&compiled.system);
        let found = whole.minimise(&mut block_state, None, |_| 1.0, STEPS_TO_NEAREST);
        let gap = found.cost;
        if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
            state.accept_bodies();
            nearest = Some((gap, state.pose.q.clone()));
        }
    }
    if let Some((_, q)) = nearest {
        state.pose.q.copy_from_slice(&q);
    }
    state.move_to_pose(&compiled.system);
    None
}

/// Closes block by block by Newton–Raphson, from where the bodies are. Returns the most
/// corrections of a block; `None` leaves the pose as it was.
fn close(compiled: &mut CompiledMechanism, state: &mut State) -> Option<u32> {
    let CompiledMechanism { system, plan, .. } = compiled;
    let closed = plan.close(&mut state.block_state(system), Limits::ASSEMBLY);
    let iterations = closed.ok()?;
    state.accept_bodies();
    Some(iterations)
}

/// Explains a block in closed form that leaves the least gap, once the blocks behind it are as
/// near to closing as they come.
fn explain_gap(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    failure: &NoBranch,
    nearest: &Nearest,
    estimate: &[f64],
) -> Error {
    state.pose.q.copy_from_slice(&nearest.q);
    state.move_to_pose(&compiled.system);
    let proof = proof(compiled, state, failure, nearest.block);
    let CompiledMechanism { system, plan, .. } = &mut *compiled;
    let mut block_state = state.block_state(system);
    for (index, block) in plan.blocks.iter_mut().enumerate().skip(nearest.block) {
        let block = &mut **block;
        if index > nearest.block {
            let effort = SearchEffort::AnyTurn;
            let mut branches = Branches::new(block, &mut block_state, estimate, effort);
            if branches.next(block, &mut block_state, estimate).is_some() {
                continue;
            }
        }
        block.stretch(&mut block_state, estimate);
        if !block.is_closed_form() {
            let mut part = LeastSquares::new(system, block.rows(), block.columns());
            part.start(&mut block_state, estimate, 0);
            if part.columns.len() <= LARGEST_PART {
                part.minimise(&mut block_state, None, |_| 1.0, STEPS_TO_NEAREST);
            }
        }
    }
    state.accept_bodies();
    state.move_to_pose(&compiled.system);
    judge(compiled, state, failure, proof, None)
}

/// Judges the pose, which is the nearest one found. Gathers its gap in one joint by `whole`, if that
/// is given.
fn judge(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    failure: &NoBranch,
    proof: Proof,
    whole: Option<&mut LeastSquares>,
) -> Error {
    let beyond_numbers = || Error::NotFinite {
        what: AN_EQUATION.to_owned(),
    };
    let largest = state.residual(&compiled.system);
    if !largest.is_finite() {
        return beyond_numbers();
    }
    if !failure.proved && largest <= CLOSED {
        return Error::Singular {
            rcond: match whole {
                Some(whole) => state.dense_rcond(&compiled.system, &whole.rows, &whole.columns),
                None => state.rcond(compiled),
            },
            bodies: Vec::new(),
            aside: None,
        };
    }
    let rows: Vec<_> = (0..compiled.system.equations().len()).collect();
    let mut open = open_joints(compiled, state, &rows, largest);
    if open.is_empty() {
        return beyond_numbers();
    }
    let in_one = whole.and_then(|whole| gather_in_one(compiled, state, whole, &open));
    if let Some((joint, q)) = in_one {
        state.pose.q.copy_from_slice(&q);
        state.move_to_pose(&compiled.system);
        open = vec![joint];
    }
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
    let fit = match &open[..] {
        [(origin, joint)] => reach(&compiled.system, state, *origin, joint.gap),
        _ => None,
    };
    let fit = fit.or_else(|| find_length(compiled, state, &open));
    Error::NotAssembled {
        verdict,
        fit: fit.map(Box::new),
        open: open.into_iter().map(|(_, joint)| joint).collect(),
        nearest: state.pose.q.clone(),
    }
}

/// Returns the proof that a block does not close, where those before it are at the pose.
fn proof(
    compiled: &CompiledMechanism,
    state: &mut State,
    failure: &NoBranch,
    block: usize,
) -> Proof {
    let mechanism = compiled.system.mechanism();
    let block = &compiled.plan.blocks[block];
    let closed_form = block.proof(&state.block_state(&compiled.system));
    closed_form.unwrap_or_else(|| {
        let columns = block.columns().iter();
        let bodies: BTreeSet<_> = columns.map(|k| k / 3).collect();
        // Joint unknowns come behind the bodies.
        let bodies = bodies.into_iter().filter_map(|k| mechanism.bodies.get(k));
        Proof::Excluded {
            bodies: bodies.map(|body| body.name.clone()).collect(),
            boxes: failure.boxes,
        }
    })
}

/// Returns the length of a link, a rope or a body between two pins that has to change least for the
/// mechanism to close. Returns `None` for a large mechanism, and if a driver asks for too much.
fn find_length(
    compiled: &CompiledMechanism,
    state: &mut State,
    open: &[(Origin, OpenJoint)],
) -> Option<Fit> {
    /// Most joints that are tried: each costs a minimisation.
    const MOST_JOINTS: usize = 12;
    let CompiledMechanism { system, .. } = compiled;
    let joints = &system.mechanism().joints;
    let is_driver = |(origin, _): &(Origin, OpenJoint)| matches!(origin, Origin::Driver(_));
    if !is_small(system) || joints.len() > MOST_JOINTS || open.iter().any(is_driver) {
        return None;
    }
    let rows: Vec<_> = (0..system.equations().len()).collect();
    let mut problem = LeastSquares::of_all(system, &rows);
    let mut best: Option<(f64, Fit)> = None;
    for origin in (0..joints.len()).map(Origin::Joint) {
        state.move_to_pose(system);
        // Without a length of its own the gap is not worth a minimisation.
        if fit(system, state, origin).is_none() {
            continue;
        }
        let largest = gather(compiled, state, &mut problem, origin);
        if let [(only, joint)] = &open_joints(compiled, state, &rows, largest)[..]
            && *only == origin
            && let Some(fit) = reach(system, state, origin, joint.gap)
            && best.as_ref().is_none_or(|(least, _)| joint.gap < *least)
        {
            best = Some((joint.gap, fit));
        }
    }
    state.move_to_pose(system);
    best.map(|(_, fit)| fit)
}

/// Gathers the gap in one joint: the one with the smallest gap, on a tie the one declared last.
/// Returns that joint, and q with the others closed.
fn gather_in_one(
    compiled: &CompiledMechanism,
    state: &mut State,
    problem: &mut LeastSquares,
    spread: &[(Origin, OpenJoint)],
) -> Option<((Origin, OpenJoint), Vec<f64>)> {
    let mut best: Option<(f64, (Origin, OpenJoint), Vec<f64>)> = None;
    for (origin, _) in spread {
        let first = &compiled.system.equations()[compiled.system.rows_of(&[*origin])[0]];
        state.move_to_pose(&compiled.system);
        let largest = gather(compiled, state, problem, *origin);
        if let [joint] = &open_joints(compiled, state, &problem.rows, largest)[..]
            && joint.0 == *origin
            && let gap = (joint.1.gap / first.size(&state.at)).max(joint.1.angle)
            && best
                .as_ref()
                .is_none_or(|(smallest, ..)| gap <= smallest * (1.0 + 1e-3))
        {
            let mut q = state.pose.q.clone();
            state.at.copy_pose(&mut q);
            best = Some((gap, joint.clone(), q));
        }
    }
    state.move_to_pose(&compiled.system);
    best.map(|(_, joint, q)| (joint, q))
}
