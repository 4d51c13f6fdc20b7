//! The balance of energy of a step.
//!
//! The integrator controls the errors of values and velocities in the coordinates in use. Where these are
//! no good, as at a dead point, small errors in them are large ones of the motion, which the energy shows:
//! it depends on no coordinates.

use super::equations::Equations;
use super::error::Error;
use crate::kinematics::Solver;
use crate::mechanism::Jet;

/// Tolerances within which that of the motion counts here. Next to a change point forces and inertia
/// follow from polynomials with errors of 1e-9; a motion that creeps to a dead point loses a ten-thousandth
/// in a step, whatever its tolerance.
const COUNTS: [f64; 2] = [1e-9, 1e-4];
/// Roundings in the sum of the energies of all bodies.
const SUM_ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Equations {
    /// Checks that the energy has changed by the work done from the accepted point to the present one, up
    /// to the tolerance: a smooth step misses by a hundredth of it at most, as the integrator aims at a
    /// thousandth and the work is integrated beside. The tolerance is relative to the kinetic energy and,
    /// for slow motions, to that of all bodies at the natural speed, the mechanism's size or a radian per
    /// second. While drivers move the work is theirs, and no error control looks after it: a step may skip
    /// much of it. So may a step of the stiff method, with the work of what it damps: there the change may
    /// be off by all the work.
    ///
    /// # Errors
    ///
    /// [`Error::Energy`].
    pub(super) fn balance(
        &self,
        solver: &Solver,
        tolerance: f64,
        is_stiff: bool,
    ) -> Result<(), Error> {
        let Self {
            point, accepted, ..
        } = self;
        let definitions = solver.mechanism().drivers.iter();
        let ends = accepted.drivers.iter().zip(&point.drivers);
        let is_driven = definitions.zip(ends).any(|(driver, (from, to))| {
            let held = Jet::constant(from.value);
            !driver.is_free() && (*from != held || *to != held)
        });
        if is_driven {
            return Ok(());
        }
        let [straight, turning] = self.motion().at_unit_speeds;
        let natural = straight * solver.size().powi(2) + turning;
        let kinetic = accepted.kinetic_energy.max(point.kinetic_energy);
        let [before, now] = [accepted.energy, point.energy];
        let work = point.work - accepted.work;
        let change = now - before - work;
        let tolerated = tolerance.clamp(COUNTS[0], COUNTS[1]) * (kinetic + natural);
        let rounding =
            SUM_ROUNDING * (before.abs() + now.abs() + accepted.work.abs() + point.work.abs());
        let skipped = if is_stiff { work.abs() } else { 0.0 };
        // False for NaN too.
        if change.abs() <= tolerated + rounding + skipped {
            return Ok(());
        }
        Err(Error::Energy {
            time: solver.pose().time,
            change,
            kinetic,
        })
    }
}
