//! The joints, constraints and drivers that stay open at a pose.

use super::least_squares::LeastSquares;
use crate::kinematics::constraint::Dimension;
use crate::kinematics::error::OpenJoint;
use crate::kinematics::origin::Origin;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;

/// Returns the joints, constraints and drivers of these rows with a noticeable part of the largest
/// scaled residual, at the present places of the bodies.
pub(in crate::kinematics) fn open_joints(
    compiled: &CompiledMechanism,
    state: &State,
    rows: &[usize],
    largest: f64,
) -> Vec<(Origin, OpenJoint)> {
    let system = &compiled.system;
    let least = 0.01 * largest;
    // With the size of each joint's part.
    let mut open: Vec<(f64, Origin, OpenJoint)> = Vec::new();
    for &row in rows {
        let equation = &system.equations()[row];
        let target = system.target(row, &state.targets, &state.pose.drivers);
        let error = (equation.constraint.value(&state.at) - target).abs();
        let (gap, angle) = match equation.constraint.dimension() {
            Dimension::Length => (error, 0.0),
            Dimension::Angle if error > least => (0.0, error),
            Dimension::Angle => continue,
        };
        match open.last_mut() {
            Some((_, origin, joint)) if *origin == equation.origin => {
                joint.gap = joint.gap.hypot(gap);
                joint.angle = joint.angle.max(angle);
            }
            _ => open.push((
                equation.size(&state.at),
                equation.origin,
                OpenJoint {
                    origin: String::new(),
                    gap,
                    angle,
                },
            )),
        }
    }
    let noticeable = open.into_iter().filter_map(|(size, origin, mut joint)| {
        if joint.gap <= least * size {
            joint.gap = 0.0;
        }
        (joint.gap.max(joint.angle) > 0.0).then(|| {
            joint.origin = origin.describe(system.mechanism());
            (origin, joint)
        })
    });
    noticeable.collect()
}

/// Largest scaled residual of a nearest pose that counts as closed: no one could measure it. In a
/// singular position, where Newton–Raphson fails, a minimisation comes no nearer; and where it
/// [gathers](gather) a gap, the others keep some 1e-8 of it, times the leverage of their links.
pub(in crate::kinematics) const CLOSED: f64 = 1e-7;
/// Most minimisation steps towards the nearest pose of a mechanism that does not close.
pub(in crate::kinematics) const STEPS_TO_NEAREST: usize = 200;
/// Weight of all other rows when least squares concentrates the gap in one origin. The other rows
/// stay open by about 1e-8 of the gap, below the digits of a message.
const WEIGHT_OF_OTHERS: f64 = 1e4;

/// Concentrates the gap of some rows in one origin: unweighted least squares spreads it over all
/// joints of a loop, but people look for one joint that is open. Returns the largest scaled
/// residual.
pub(in crate::kinematics) fn gather(
    compiled: &CompiledMechanism,
    state: &mut State,
    problem: &mut LeastSquares,
    origin: Origin,
) -> f64 {
    let equations = compiled.system.equations();
    let weight = |row: usize| {
        if equations[row].origin == origin {
            1.0
        } else {
            WEIGHT_OF_OTHERS
        }
    };
    let mut state = state.block_state(&compiled.system);
    problem
        .minimise(&mut state, None, weight, STEPS_TO_NEAREST)
        .largest
}
