//! The explanation of a mechanism that does not close on all its rows.

use super::closure::find_start;
use super::rank::{constraint_rows, find_freedom, jacobian_rows};
use super::slip::{AGREES, contradiction, explain_slip};
use crate::kinematics::Origin;
use crate::kinematics::assembly::closure::{close_near, close_on, is_small};
use crate::kinematics::assembly::gaps::{gather, open_joints};
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::assembly::nearest::{AN_EQUATION, search_at_once};
use crate::kinematics::assembly::part::STARTS;
use crate::kinematics::constraint::TurnEffect;
use crate::kinematics::error::{Error, OpenJoint, Verdict};
use crate::kinematics::linear::Echelon;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::tolerances::DEPENDENT;

/// An origin with less than this part of the largest residual has no part in the gap.
const NOTICEABLE: f64 = 1e-3;
/// Most origins of a large mechanism among which a smallest contradictory set is looked for, by
/// leaving them out one by one.
const MOST_ELEMENTS: usize = 12;

/// Returns the error for a mechanism that does not close. `gap` is its largest scaled residual.
///
/// Before: the bodies are at the nearest pose.
pub(super) fn explain_open(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    gap: f64,
    estimate: &[f64],
) -> Error {
    if !gap.is_finite() {
        return Error::NotFinite {
            what: AN_EQUATION.to_owned(),
        };
    }
    let all: Vec<_> = (0..compiled.system.equations().len()).collect();
    let slip = explain_slip(compiled, state, gap).or_else(|| {
        // The nearest pose of all may be on another branch than the estimates.
        let mut nearest = vec![0.0; compiled.system.unknowns()];
        state.at.copy_pose(&mut nearest);
        let gap = close_near(&compiled.system, state, &all, estimate)?;
        let slip = explain_slip(compiled, state, gap);
        let slip = slip.or_else(|| explain_phase(compiled, state, estimate));
        state.at.set_pose(compiled.system.mechanism(), &nearest);
        slip
    });
    if let Some(error) = slip {
        return error;
    }
    let mut open = origins_open(compiled, state, &all, gap);
    // With excess drivers the constraints close by themselves.
    let constraints = constraint_rows(&compiled.system);
    let without_drivers = close_on(&compiled.system, state, &constraints, estimate);
    if without_drivers.is_none()
        && let Err(error) = find_freedom(compiled, state)
    {
        return error;
    }
    let system = &compiled.system;
    if let Some(gap) = without_drivers {
        open = origins_open(compiled, state, &constraints, gap);
    }
    if close_on(system, state, &system.rows_of(&open), estimate).is_none() {
        open = origins_open(compiled, state, &all, 0.0);
    }
    if is_small(system) || open.len() <= MOST_ELEMENTS {
        // The origin declared first stays, where two of them can replace each other.
        for origin in open.clone().into_iter().rev() {
            let others: Vec<_> = open.iter().copied().filter(|e| *e != origin).collect();
            if close_on(system, state, &system.rows_of(&others), estimate).is_some() {
                open = others;
            }
        }
    }
    let rows = system.rows_of(&open);
    let origins = open.clone();
    // The gap is shown in one joint, the one declared last: people look for one that is open.
    let is_driver = |origin: &Origin| matches!(origin, Origin::Driver(_));
    let last = open.iter().rfind(|origin| !is_driver(origin));
    let Some(&last) = last.or(open.last()) else {
        return not_found(compiled, state, Vec::new());
    };
    let rows_of_last = system.rows_of(&[last]);
    open.retain(|origin| *origin != last);
    let others = system.rows_of(&open);
    close_on(system, state, &others, estimate);
    let contradict = depend_on(compiled, state, &rows_of_last, &others);
    close_on(system, state, &rows, estimate);
    let mut problem = LeastSquares::of_all(system, &rows);
    let gap = gather(compiled, state, &mut problem, last);
    let gathered = open_joints(compiled, state, &rows_of_last, gap);
    let gathered = gathered.into_iter().next().map(|(_, joint)| joint);
    match gathered {
        Some(open) if contradict && gap > AGREES => {
            contradiction(compiled, state, &origins, last, open)
        }
        gathered => match find_start(compiled, state, estimate) {
            // A mechanism impossible with fewer rows is impossible with all.
            Some(failure) if failure.proved => {
                let error = search_at_once(compiled, state, failure, estimate).err();
                let open = gathered.into_iter().collect();
                error.unwrap_or_else(|| not_found(compiled, state, open))
            }
            _ => not_found(compiled, state, gathered.into_iter().collect()),
        },
    }
}

/// Returns the error for the one gear, belt or rack without which all else closes, and which then
/// has no say: its phase is wrong.
fn explain_phase(
    compiled: &CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Option<Error> {
    let system = &compiled.system;
    let equations = system.equations();
    let rows = (0..equations.len())
        .filter(|&row| equations[row].constraint.turn_effect() == TurnEffect::Proportional);
    let mut wrong = rows.filter_map(|row| {
        let others: Vec<_> = (0..equations.len()).filter(|k| *k != row).collect();
        let decided = close_on(system, state, &others, estimate).is_none()
            && depend_on(compiled, state, &[row], &others);
        let (origin, open) = open_joints(compiled, state, &[row], 0.0).pop()?;
        decided.then(|| contradiction(compiled, state, &[origin], origin, open))
    });
    let first = wrong.next()?;
    wrong.next().is_none().then_some(first)
}

/// Returns the error for a mechanism without a proof, at the nearest pose found.
fn not_found(compiled: &CompiledMechanism, state: &State, open: Vec<OpenJoint>) -> Error {
    let mut nearest = vec![0.0; compiled.system.unknowns()];
    state.at.copy_pose(&mut nearest);
    Error::NotAssembled {
        verdict: Verdict::NotFound { starts: STARTS },
        open,
        fit: None,
        nearest,
    }
}

/// Returns the origins with a noticeable part of a largest residual.
fn origins_open(
    compiled: &CompiledMechanism,
    state: &State,
    rows: &[usize],
    largest: f64,
) -> Vec<Origin> {
    let system = &compiled.system;
    let rows = rows.iter().filter(|&&row| {
        let value = system.evaluate_row(row, state.values(), |_, _| {});
        value.value.abs() >= NOTICEABLE * largest
    });
    let mut origins: Vec<_> = rows.map(|&row| system.equations()[row].origin).collect();
    origins.sort_unstable();
    origins.dedup();
    origins
}

/// Returns whether some of these rows depend on the others. Such rows contradict the others; a loop
/// that is merely too short has independent rows.
///
/// Before: the mechanism is closed on the others.
fn depend_on(
    compiled: &CompiledMechanism,
    state: &State,
    rows: &[usize],
    others: &[usize],
) -> bool {
    let all = jacobian_rows(compiled, state);
    let mut echelon = Echelon::new(compiled.system.unknowns(), &all);
    for &row in others {
        echelon.offer(row, &all[row], DEPENDENT);
    }
    let offered = rows.iter();
    let left_out = offered.filter_map(|&row| echelon.offer(row, &all[row], DEPENDENT));
    left_out.count() > 0
}
