//! Redundant constraints whose numbers do not quite agree.
//!
//! A third crank a micrometre too long leaves rows that nearly depend on each other and cannot hold
//! together. Whether such a mechanism closes, and where, depends on the size of the gap by chance;
//! so the rows' dependence is judged at the nearest pose, by a rank that is as coarse as the gap.

use super::rank::{DEPENDENT, constraint_rows, jacobian_rows};
use crate::kinematics::Origin;
use crate::kinematics::assembly::gaps::{gather, open_joints};
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::error::{Error, Fit, OpenJoint, OpenPose};
use crate::kinematics::linear::Echelon;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::{System, Target};
use crate::mechanism::{BodyId, Joint, JointKind, MarkerId};

/// Largest scaled residual, beyond its rounding, of rows that agree. Until other rows are chosen it
/// grows by less than a thousand, to the limit that is watched during a motion.
pub(super) const AGREES: f64 = 1e-12;
/// Multiple of the rounding of a redundant row that rounding in the rows that are solved may make.
const ROUNDINGS: f64 = 1e3;
/// Largest scaled gap between constraints that are meant to agree.
const LARGEST: f64 = 0.03;
/// Ratio of what may be left of a nearly dependent row to the square root of the gap: next to a flat
/// pose the least gap lies that far away.
const LEFT: f64 = 4.0;
/// Most that may be left of such a row.
const MOST_LEFT: f64 = 0.2;
/// Factors in a combination of rows below this multiple of what is left come from the gap.
const TAKES_PART: f64 = 3.0;

/// Returns the error for redundant constraints that are open by more than rounding at the present
/// pose, where the mechanism is nearly closed.
pub(super) fn explain_misfit(compiled: &CompiledMechanism, state: &mut State) -> Option<Error> {
    let system = &compiled.system;
    let rows = 0..system.equations().len();
    let open = rows.map(|row| {
        let value = system.evaluate_row(row, state.values(), |_, _| {});
        (
            value.value.abs(),
            value.value.abs() - ROUNDINGS * value.rounding,
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

/// Returns the error for nearly redundant constraints; `None` if the mechanism would not be
/// redundant without the gap, or is far from closed. Its rows are open by up to `gap`, scaled, at
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

/// Returns the constraints of the dependent row that is open most, if the rank is full but for rows
/// that depend on constraints.
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
            let least = TAKES_PART * dependent.remainder.max(DEPENDENT);
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
        if matches!(equation.target, Target::Driver(_)) {
            // A driver of a mechanism that cannot move has nothing to do with the gap.
            if echelon.offer(row, &rows[row], left).is_some() {
                return None;
            }
        }
    }
    let (_, origins) = worst?;
    (echelon.kept().len() == system.unknowns()).then_some(origins)
}

/// Returns the length that would close an origin: that of a link, or of a body that two pins
/// hold. All other origins are closed at the present pose.
fn fit(system: &System, state: &State, origin: Origin) -> Option<Fit> {
    let mechanism = system.mechanism();
    let Origin::Joint(index) = origin else {
        return None;
    };
    let joint = &mechanism.joints[index];
    let point = |marker| state.at.marker(marker).point;
    let length = |from, to| (point(to) - point(from)).norm();
    match joint.kind {
        JointKind::Link { .. } => {
            let row = system.rows_of(&[origin])[0];
            Some(Fit {
                origin: origin.describe(mechanism),
                between: None,
                length: length(joint.from, joint.to),
                present: state.targets.constant(row),
            })
        }
        JointKind::Revolute => {
            // The body declared last of the two is the one that people have added.
            let ends = [(joint.to, joint.from), (joint.from, joint.to)];
            let body = |marker: MarkerId| mechanism.markers[marker.index()].body;
            let mut found: Vec<_> = ends
                .into_iter()
                .filter_map(|(own, partner)| {
                    let body = body(own)?;
                    let other = other_pin(system, body, index)?;
                    Some((body, own, partner, other))
                })
                .collect();
            found.sort_by_key(|(body, ..)| body.index());
            let (body, own, partner, other) = found.pop()?;
            let name = |marker: MarkerId| mechanism.markers[marker.index()].name.clone();
            Some(Fit {
                origin: format!("body `{}`", mechanism.bodies[body.index()].name),
                between: Some([name(other), name(own)]),
                length: length(other, partner),
                present: length(other, own),
            })
        }
        _ => None,
    }
}

/// Returns the marker of the second pin of a body that two pins hold and nothing else; `pin` is one
/// of them.
fn other_pin(system: &System, body: BodyId, pin: usize) -> Option<MarkerId> {
    let mechanism = system.mechanism();
    let on_body = |marker: MarkerId| mechanism.markers[marker.index()].body == Some(body);
    let own = |joint: &Joint| [joint.from, joint.to].into_iter().find(|&m| on_body(m));
    let unknowns = 3 * body.index()..3 * body.index() + 3;
    let equations = system.equations().iter().enumerate();
    let touching = equations.filter(|(row, _)| {
        let columns = system.incidence(*row).unknowns;
        columns.iter().any(|column| unknowns.contains(column))
    });
    let mut other = None;
    for (_, equation) in touching {
        let Origin::Joint(index) = equation.origin else {
            return None;
        };
        let joint = &mechanism.joints[index];
        if !matches!(joint.kind, JointKind::Revolute) {
            return None;
        }
        if index != pin && other.replace(index).is_some_and(|before| before != index) {
            return None;
        }
    }
    other.and_then(|index| own(&mechanism.joints[index]))
}
