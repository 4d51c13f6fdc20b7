//! The choice of the rows that are solved.

use std::collections::BTreeMap;
use std::fmt;

use super::closure::close_on_all;
use super::contradiction::explain_open;
use super::rank::{drivers_first, find_freedom, jacobian_rows, singular_position, weakest};
use super::slip::explain_misfit;
use crate::kinematics::Origin;
use crate::kinematics::assembly::estimate::go_to_estimate;
use crate::kinematics::assembly::gaps::open_joints;
use crate::kinematics::assembly::least_squares::holds;
use crate::kinematics::error::{Error, OpenJoint};
use crate::kinematics::linear::{Echelon, Row};
use crate::kinematics::newton::Limits;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::{CompiledMechanism, RedundantRows};
use crate::kinematics::state::State;
use crate::kinematics::system::structure::Structure;
use crate::kinematics::tolerances::{DEPENDENT, SINGULAR};

/// Least remainder of an accepted row. Rows are accepted in the order of declaration: what an
/// accepted one leaves of later rows may be less, and these are set aside.
const FIT: f64 = 1e-2;
/// Factor on that limit as long as too few rows are accepted.
const LESS_FIT: f64 = 0.2;
/// Least remainder of an accepted row when rows are chosen again at a later pose.
const FITTER: f64 = 0.5;
/// Least remainder of the rows of the first pose with which an assembly returns to them.
const KEPT: f64 = 1e-3;
/// Least ratio of determinants, new to old, for which the rows in use are changed.
const WORTH: f64 = 2.0;

/// A joint or constraint with equations that follow from the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Redundancy {
    /// Kind and name.
    pub origin: String,
    /// Number of its redundant equations.
    pub redundant: usize,
    /// Number of its equations.
    pub equations: usize,
}

impl fmt::Display for Redundancy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            origin,
            redundant,
            equations,
        } = self;
        let which = match (redundant, equations) {
            (1, 1) => "it follows from the others; it is".to_owned(),
            (1, _) => format!("1 of its {equations} follows from the others; it is"),
            _ if redundant == equations => {
                format!("all {equations} follow from the others; they are")
            }
            _ => format!("{redundant} of its {equations} follow from the others; they are"),
        };
        let equations = match equations {
            1 => format!("the constraint equation of {origin} is"),
            _ => format!("constraint equations of {origin} are"),
        };
        write!(f, "{equations} redundant: {which} set aside and watched")
    }
}

/// A choice among all rows at one pose.
struct Choice {
    set_aside: Vec<usize>,
    /// Least remainder of a solved row.
    weakest: f64,
}

/// The distance of rows from dependence.
struct Fitness {
    /// Least remainder of a row after elimination of those before it.
    weakest: f64,
    /// Logarithm of their determinant, which does not depend on their order.
    log_determinant: f64,
}

/// Returns the joints and constraints with redundant equations.
pub(in crate::kinematics) fn redundancies(compiled: &CompiledMechanism) -> Vec<Redundancy> {
    let equations = compiled.system.equations();
    let mut found: Vec<(Origin, usize)> = Vec::new();
    for &row in &compiled.redundant.all {
        let origin = equations[row].origin;
        match found.last_mut() {
            Some((last, count)) if *last == origin => *count += 1,
            _ => found.push((origin, 1)),
        }
    }
    let mut rows: BTreeMap<Origin, usize> = BTreeMap::new();
    for equation in equations {
        *rows.entry(equation.origin).or_default() += 1;
    }
    let describe = |(origin, redundant): (Origin, usize)| Redundancy {
        origin: origin.describe(compiled.system.mechanism()),
        redundant,
        equations: rows[&origin],
    };
    found.into_iter().map(describe).collect()
}

/// Chooses the rows to solve at the end of `path`, by numbers, and compiles the plan for them.
///
/// # Errors
///
/// [`Error::Structure`] if something is free to move or more is driven than is free,
/// [`Error::Contradiction`] and [`Error::NotAssembled`] if the mechanism does not close,
/// [`Error::Singular`] if it closes in a singular position; those of values without a mechanism.
pub(in crate::kinematics) fn choose_rows(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
) -> Result<(), Error> {
    let estimate = go_to_estimate(compiled, state, path)?;
    // If the choice fails, the rows chosen for earlier values stay.
    let nothing = Structure::of_nothing(&compiled.system);
    let before = (
        compiled.redundant.clone(),
        std::mem::replace(&mut compiled.structure, nothing),
        std::mem::take(&mut compiled.plan),
    );
    let chosen = choose_rows_near(compiled, state, &estimate);
    if chosen.is_err() {
        (compiled.redundant, compiled.structure, compiled.plan) = before;
        state.invalidate();
    }
    chosen
}

fn choose_rows_near(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Result<(), Error> {
    if let Some(gap) = close_on_all(compiled, state, estimate) {
        return Err(explain_open(compiled, state, gap, estimate));
    }
    let all = find_freedom(compiled, state).map_err(|error| {
        // Far from a pose that satisfies all rows, a rank means nothing.
        explain_misfit(compiled, state).unwrap_or(error)
    })?;
    let choice = choose_among(compiled, &jacobian_rows(compiled, state), FIT);
    let solved = compiled.system.equations().len() - choice.set_aside.len();
    if solved < compiled.system.unknowns() {
        return Err(singular_position(compiled, state));
    }
    let first = match std::mem::take(&mut compiled.redundant.first) {
        // The first rows stay the same, whatever was chosen in between.
        first if first.len() == choice.set_aside.len() => first,
        _ => choice.set_aside.clone(),
    };
    compiled.redundant = RedundantRows {
        all,
        first,
        now: choice.set_aside,
        function_rows: Vec::new(),
    };
    state.compile(compiled);
    let CompiledMechanism { system, plan, .. } = &mut *compiled;
    if plan.factorise(&mut state.block_state(system)).is_err() || plan.rcond() < SINGULAR {
        return Err(singular_position(compiled, state));
    }
    Ok(())
}

/// Assembles a mechanism with rows set aside: closes it on all rows, then corrects the solved rows
/// down to rounding. Returns the most corrections of a block.
///
/// # Errors
///
/// Those of [`choose_rows`].
pub(in crate::kinematics) fn assemble_on_all(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Result<u32, Error> {
    if let Some(gap) = close_on_all(compiled, state, estimate) {
        return Err(explain_open(compiled, state, gap, estimate));
    }
    state.accept_bodies();
    return_to_fit_rows(compiled, state)?;
    let CompiledMechanism { system, plan, .. } = &mut *compiled;
    let closed = plan.close(&mut state.block_state(system), Limits::ASSEMBLY);
    let Ok(iterations) = closed else {
        return Err(singular_position(compiled, state));
    };
    if let Some(error) = explain_misfit(compiled, state) {
        return Err(error);
    }
    state.accept_bodies();
    state.move_to_pose(&compiled.system);
    Ok(iterations)
}

/// Takes the rows of the first pose if they are fit here, otherwise rows chosen from the present
/// pose alone.
///
/// # Errors
///
/// [`Error::Singular`] if the rows all together lose rank here.
fn return_to_fit_rows(compiled: &mut CompiledMechanism, state: &mut State) -> Result<(), Error> {
    if compiled.redundant.is_empty() || !state.pose.crossings.is_empty() {
        return Ok(());
    }
    let first = compiled.redundant.first.clone();
    let rows = jacobian_rows(compiled, state);
    let set_aside = if fitness_without(compiled, &rows, &first).weakest > KEPT {
        first
    } else {
        let choice = choose_among(compiled, &rows, FITTER);
        if choice.set_aside.len() > first.len() {
            return Err(singular_position(compiled, state));
        }
        choice.set_aside
    };
    if set_aside != compiled.redundant.now {
        compiled.redundant.now = set_aside;
        state.compile(compiled);
    }
    state.move_to_pose(&compiled.system);
    Ok(())
}

/// Takes other rows if they are much farther from dependence here than those in use. Returns
/// whether it did. Allocates only in a mechanism with redundant rows.
pub(in crate::kinematics) fn change_rows(
    compiled: &mut CompiledMechanism,
    state: &mut State,
) -> bool {
    let Some(choice) = fitter_rows(compiled, state) else {
        return false;
    };
    compiled.redundant.now = choice.set_aside;
    state.compile(compiled);
    true
}

/// Returns whether no other rows are much farther from dependence here than those in use. Only then
/// may a change point of these rows be one of the mechanism.
pub(in crate::kinematics) fn are_rows_fit(compiled: &CompiledMechanism, state: &State) -> bool {
    fitter_rows(compiled, state).is_none()
}

/// Returns whether the rows all together are nearly dependent at the pose.
pub(in crate::kinematics) fn is_nearly_singular(
    compiled: &CompiledMechanism,
    state: &State,
) -> bool {
    choose_among(compiled, &jacobian_rows(compiled, state), FITTER).weakest < FIT
}

/// Returns a choice of rows that are much farther from dependence here than those in use, if these
/// are near to it. At one pose rows change at most once: the choice depends on the pose alone, and
/// is not made if it equals the rows in use.
fn fitter_rows(compiled: &CompiledMechanism, state: &State) -> Option<Choice> {
    if compiled.redundant.is_empty() || !state.pose.crossings.is_empty() {
        return None;
    }
    let now = &compiled.redundant.now;
    let rows = jacobian_rows(compiled, state);
    let here = fitness_without(compiled, &rows, now);
    if here.weakest > FITTER {
        return None;
    }
    let choice = choose_among(compiled, &rows, FITTER);
    if choice.set_aside.len() != now.len() || choice.set_aside == *now {
        return None;
    }
    // At a change point every choice of rows is nearly dependent, but some less than others.
    let there = fitness_without(compiled, &rows, &choice.set_aside);
    (there.log_determinant > here.log_determinant + WORTH.ln()).then_some(choice)
}

/// Returns the first joint or constraint whose row, set aside, is open by more than rounding.
/// Allocates nothing if there is none.
pub(in crate::kinematics) fn opened(
    compiled: &CompiledMechanism,
    state: &State,
) -> Option<OpenJoint> {
    let CompiledMechanism {
        system, redundant, ..
    } = compiled;
    let is_open = |row: &&usize| !holds(system.evaluate_row(**row, state.values(), |_, _| {}));
    let first = redundant.now.iter().find(is_open)?;
    let origin = system.equations()[*first].origin;
    let mut open = open_joints(compiled, state, &system.rows_of(&[origin]), 0.0);
    open.pop().map(|(_, joint)| joint)
}

/// Chooses among the rows of a Jacobian: the drivers', then, in the order of
/// declaration, those whose remainder exceeds `fit`; if these are too few, those with a smaller
/// remainder.
fn choose_among(compiled: &CompiledMechanism, rows: &[Row], mut fit: f64) -> Choice {
    let unknowns = compiled.system.unknowns();
    let mut echelon = Echelon::new(unknowns, rows);
    let mut set_aside = drivers_first(&compiled.system);
    loop {
        set_aside.retain(|&row| echelon.offer(row, &rows[row], fit).is_some());
        let complete = echelon.kept().len() == unknowns;
        if complete || set_aside.is_empty() || fit <= DEPENDENT {
            break;
        }
        fit = (LESS_FIT * fit).max(DEPENDENT);
    }
    set_aside.sort_unstable();
    Choice {
        set_aside,
        weakest: weakest(&echelon),
    }
}

/// Returns how far the rows of a Jacobian but these are from dependence.
fn fitness_without(compiled: &CompiledMechanism, rows: &[Row], set_aside: &[usize]) -> Fitness {
    let mut echelon = Echelon::new(compiled.system.unknowns(), rows);
    for row in drivers_first(&compiled.system) {
        if set_aside.binary_search(&row).is_err()
            && echelon.offer(row, &rows[row], DEPENDENT).is_some()
        {
            return Fitness {
                weakest: 0.0,
                log_determinant: f64::NEG_INFINITY,
            };
        }
    }
    Fitness {
        weakest: weakest(&echelon),
        log_determinant: echelon.log_determinant(),
    }
}
