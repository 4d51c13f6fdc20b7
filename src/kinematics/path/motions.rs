//! The prescribed motions of a mechanism, with parameter values in force.

use crate::mechanism::{DriverId, Interval, Jet, Jet3, Mechanism, MotionInForce, ParameterId};

/// The motions of all drivers that have one.
#[derive(Clone, Debug)]
pub(in crate::kinematics) struct Motions {
    /// One per driver, `None` for an input.
    in_force: Vec<Option<MotionInForce>>,
}

impl Motions {
    /// Makes the motions; parameter values are still to be set.
    pub(in crate::kinematics) fn new(mechanism: &Mechanism) -> Self {
        let parameters = mechanism.parameters.len();
        let drivers = mechanism.drivers.iter();
        Self {
            in_force: drivers
                .map(|driver| Some(MotionInForce::new(driver.motion()?, parameters)))
                .collect(),
        }
    }

    /// Sets parameter values, with their derivatives with respect to the variable along which the
    /// motions are evaluated. Allocates nothing.
    pub(in crate::kinematics) fn set_parameters(&mut self, parameter: impl Fn(ParameterId) -> Jet) {
        for motion in self.in_force.iter_mut().flatten() {
            motion.set_parameters(&parameter);
        }
    }

    /// Returns a driver's prescribed value at time `t`; not a number for an input.
    pub(in crate::kinematics) fn evaluate(&self, driver: DriverId, t: Jet) -> Jet {
        self.in_force[driver.index()]
            .as_ref()
            .map_or(Jet::constant(f64::NAN), |motion| motion.evaluate(t))
    }

    /// Returns an upper bound of a driver's |d²u/dt²| over a stretch of time; see
    /// [`MotionInForce::curvature`].
    pub(in crate::kinematics) fn curvature(
        &self,
        driver: DriverId,
        from: f64,
        to: f64,
    ) -> Option<f64> {
        self.in_force[driver.index()]
            .as_ref()
            .and_then(|motion| motion.curvature(from, to))
    }

    /// Encloses a driver's value; see [`MotionInForce::enclose`].
    pub(in crate::kinematics) fn enclose(
        &self,
        driver: DriverId,
        t: Jet3<Interval>,
        parameter: &impl Fn(ParameterId) -> Jet3<Interval>,
    ) -> Option<Jet3<Interval>> {
        self.in_force[driver.index()]
            .as_ref()
            .and_then(|motion| motion.enclose(t, parameter))
    }

    /// Encloses a driver's value where parts of its motion jump together; see
    /// [`MotionInForce::enclose_joined`].
    pub(in crate::kinematics) fn enclose_joined(
        &self,
        driver: DriverId,
        t: Jet3<Interval>,
    ) -> Option<Jet3<Interval>> {
        self.in_force[driver.index()]
            .as_ref()
            .and_then(|motion| motion.enclose_joined(t))
    }

    /// Returns the first corner of a motion in a range of time, as the times before and after it; see
    /// [`MotionInForce::corner`].
    pub(in crate::kinematics) fn corner(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        let motions = self.in_force.iter().flatten();
        let corners = motions.filter_map(|motion| motion.corner(from, to));
        corners.min_by(|a, b| a[1].total_cmp(&b[1]))
    }

    /// Returns the next time after `t` at which a motion given by a table begins another piece.
    pub(in crate::kinematics) fn next_point(&self, t: f64) -> f64 {
        let motions = self.in_force.iter().flatten();
        motions
            .map(|motion| motion.next_point(t))
            .fold(f64::INFINITY, f64::min)
    }
}
