//! Redundant constraints whose numbers do not quite agree.
//!
//! Example: a parallelogram with a third crank that is a micrometre too long. Its rows nearly
//! depend on each other and have no common solution. Whether an assembly closes it, and where, is
//! chance. Therefore the rank is computed at the nearest pose, with a tolerance that grows with the
//! gap.

use super::rank::{constraint_rows, jacobian_rows};
use crate::kinematics::Origin;
use crate::kinematics::assembly::fit::fit;
use crate::kinematics::assembly::gaps::{gather, open_joints};
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::error::{Error, OpenJoint, OpenPose};
use crate::kinematics::linear::Echelon;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::EquationTarget;
use crate::kinematics::tolerances::DEPENDENT;

/// Largest scaled residual, less its rounding, of rows that agree. A motion multiplies the residual
/// by less than a thousand before other rows are chosen: it stays below the 1e-9 at which the
/// tracker rejects a step.
pub(super) const AGREES: f64 = 1e-12;
/// Largest residual of a redundant row that counts as rounding, in multiples of the row's own
/// rounding error: the solved rows add theirs.
const REDUNDANT_ROUNDINGS: f64 = 1e3;
/// Largest scaled gap between constraints that are meant to agree.
const LARGEST: f64 = 0.03;
/// Ratio of the largest remainder of a nearly dependent row to the square root of the gap: next to
/// a flat pose, the pose of least gap is about that root away, and remainders grow with the
/// distance.
const LEFT: f64 = 4.0;
/// Largest remainder of such a row, whatever the gap.
const MOST_LEFT: f64 = 0.2;
/// Ratio of a coefficient in a combination of rows to the remainder of the combination. Smaller
/// coefficients are attributed to the gap.
const ABOVE_REMAINDER: f64 = 3.0;

/// Returns the error for redundant constraints that are open by more than rounding.
///
/// Before: the mechanism is nearly closed at the present pose.
pub(super) fn explain_misfit(compiled: &CompiledMechanism, state: &mut State) -> Option<Error> {
    let system = &compiled.system;
    let rows = 0..system.equations().len();
    let open = rows.map(|row| {
        let value = system.evaluate_row(row, state.values(), |_, _| {});
        (
            value.value.abs(),
            value.value.abs() - REDUNDANT_ROUNDINGS * value.rounding,
        )
    });
    let (gap, excess) = open.fold((0.0_f64, 0.0_f64), |(gap, excess), row| {
        (gap.max(row.0), excess.max(row.1))
    });
    if excess > AGREES {
        explain_slip(compiled, state, gap)
    } else {
        None
    }
}

/// Returns the error for nearly redundant constraints. Returns `None` if the mechanism is not
/// redundant, even without the gap, or is far from closed. `gap` is the largest scaled residual at
/// the present pose.
pub(super) fn explain_slip(
    compiled: &CompiledMechanism,
    state: &mut State,
    gap: f64,
) -> Option<Error> {
    let origins = nearly_dependent(compiled, state, gap)?;
    let last = *origins.last()?;
    let all: Vec<_> = (0..compiled.system.equations().len()).collect();
    let mut problem = LeastSquares::of_all(&compiled.system, &all);
    let gathered = gather(compiled, state, &mut problem, last);
    let rows = compiled.system.rows_of(&[last]);
    let open = open_joints(compiled, state, &rows, gathered);
    let (_, open) = open.into_iter().next()?;
    Some(contradiction(compiled, state, &origins, last, open))
}

/// Returns the error for origins that contradict each other; `last` is open, all others are
/// closed.
pub(super) fn contradiction(
    compiled: &CompiledMechanism,
    state: &State,
    origins: &[Origin],
    last: Origin,
    open: OpenJoint,
) -> Error {
    let mechanism = compiled.system.mechanism();
    let names = origins.iter().map(|origin| origin.describe(mechanism));
    let mut q = vec![0.0; compiled.system.unknowns()];
    state.at.copy_pose(&mut q);
    Error::Contradiction {
        origins: names.collect(),
        open,
        fit: fit(&compiled.system, state, last).map(Box::new),
        nearest: Box::new(OpenPose { open: last, q }),
    }
}

/// Returns the origins of the dependent row with the largest gap and of the rows that it depends
/// on. Returns `None` if a motion is free or a driver depends on other rows.
fn nearly_dependent(compiled: &CompiledMechanism, state: &State, gap: f64) -> Option<Vec<Origin>> {
    if gap.is_nan() || gap > LARGEST {
        return None;
    }
    let system = &compiled.system;
    let equations = system.equations();
    let left = (LEFT * gap.sqrt()).clamp(DEPENDENT, MOST_LEFT);
    let rows = jacobian_rows(compiled, state);
    let residual = |row: usize| system.evaluate_row(row, state.values(), |_, _| {}).value;
    let mut echelon = Echelon::new(system.unknowns(), &rows);
    let mut worst: Option<(f64, Vec<Origin>)> = None;
    for row in constraint_rows(system) {
        let Some(dependent) = echelon.offer(row, &rows[row], left) else {
            continue;
        };
        let combination = echelon.combination(&dependent, 0.0);
        let parts = combination.iter();
        let (sum, total) = parts.fold((residual(row), 1.0), |(sum, total), (other, factor)| {
            (sum - factor * residual(*other), total + factor.abs())
        });
        let miss = sum.abs() / total;
        if worst.as_ref().is_none_or(|(most, _)| miss > *most) {
            let least = ABOVE_REMAINDER * dependent.remainder.max(DEPENDENT);
            let others = combination.into_iter();
            let others = others.filter(|(_, factor)| factor.abs() > least);
            let mut origins: Vec<_> = others.map(|(other, _)| equations[other].origin).collect();
            origins.push(equations[row].origin);
            origins.sort_unstable();
            origins.dedup();
            worst = Some((miss, origins));
        }
    }
    for (row, equation) in equations.iter().enumerate() {
        if matches!(equation.target, EquationTarget::Driver(_)) {
            // The mechanism cannot move as the driver asks: the gap is not the cause.
            if echelon.offer(row, &rows[row], left).is_some() {
                return None;
            }
        }
    }
    let (_, origins) = worst?;
    (echelon.kept().len() == system.unknowns()).then_some(origins)
}
