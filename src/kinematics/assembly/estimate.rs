//! The estimates of the bodies' poses, and the distance of a pose from them.

use super::turns::fix_turns;
use crate::kinematics::error::Error;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// The distance of a body from its estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Distance of its origin \[m\].
    pub length: f64,
    /// Difference of its angle \[rad\].
    pub angle: f64,
}

/// Takes all values from the end of `path`, and puts the bodies at their estimates. Returns the
/// estimates.
///
/// # Errors
///
/// [`Error::NotFinite`], [`Error::NotPositive`] and [`Error::NoMotion`] for values without a
/// mechanism.
pub(in crate::kinematics) fn go_to_estimate(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
) -> Result<Vec<f64>, Error> {
    state.release_crossings(compiled);
    state.set_parameters(compiled, &path.to)?;
    let system = &compiled.system;
    let drivers = path.drivers_at_end(system.mechanism());
    state.pose.time = path.time(1.0);
    system.check_drivers(&drivers)?;
    state.pose.drivers.copy_from_slice(&drivers);
    let estimate = estimate(system, &state.pose.parameters)?;
    state.pose.q.copy_from_slice(&estimate);
    state.move_to_pose(system);
    fix_turns(system, state);
    Ok(estimate)
}

/// Returns q⁰, with these parameter values.
///
/// # Errors
///
/// [`Error::NotFinite`] for an estimate without a value.
pub(in crate::kinematics) fn estimate(
    system: &System,
    parameters: &[f64],
) -> Result<Vec<f64>, Error> {
    let bodies = &system.mechanism().bodies;
    let mut estimate = vec![0.0; system.unknowns()];
    for (body, q) in bodies.iter().zip(estimate.chunks_exact_mut(3)) {
        for (q, expression) in q.iter_mut().zip(&body.estimate) {
            *q = expression.value(parameters);
            if !q.is_finite() {
                return Err(Error::NotFinite {
                    what: format!("the estimate of body `{}`", body.name),
                });
            }
        }
    }
    Ok(estimate)
}

/// Returns the distance of each body from its estimate at a pose.
pub(in crate::kinematics) fn moves<'a>(
    system: &System,
    q: &'a [f64],
    estimate: &'a [f64],
) -> impl Iterator<Item = Move> + use<'a> {
    let bodies = system.mechanism().bodies.len();
    let poses = q[..3 * bodies].chunks_exact(3);
    let moved = poses.zip(estimate.chunks_exact(3));
    moved.map(|(q, guess)| Move {
        length: (q[0] - guess[0]).hypot(q[1] - guess[1]),
        angle: (q[2] - guess[2]).abs(),
    })
}

/// Returns the largest distance of a body from its estimate at the pose, in radians and
/// characteristic lengths.
pub(in crate::kinematics) fn distance(system: &System, state: &State, estimate: &[f64]) -> f64 {
    let size = state.at.size();
    let moves = moves(system, &state.pose.q, estimate);
    let scaled = moves.enumerate().map(|(body, moved)| {
        let scale = system.column_scale(3 * body, size);
        (moved.length / scale).max(moved.angle)
    });
    scaled.fold(0.0, f64::max)
}
