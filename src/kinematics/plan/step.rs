//! The mechanism that block solvers work on, and the sub-step that they take.

use crate::kinematics::certificate::{Pivots, StepBounds};
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::path::Rates;
use crate::kinematics::system::{System, Targets, Values};

/// The mechanism at the pose that is being found: block solvers read it and move its bodies.
pub(in crate::kinematics) struct BlockState<'a> {
    pub(in crate::kinematics) system: &'a System,
    pub(in crate::kinematics) targets: &'a Targets,
    /// The values u of all drivers.
    pub(in crate::kinematics) drivers: &'a [f64],
    pub(in crate::kinematics) at: &'a mut Configuration,
    /// Rates of q along some motion of the drivers.
    pub(in crate::kinematics) tangent: &'a mut Rates,
}

/// A step along the tangent of the motion: q + q′ · first + q″ · second.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Extrapolation {
    pub(in crate::kinematics) first: f64,
    pub(in crate::kinematics) second: f64,
}

/// One sub-step: the prediction of its end, and the bounds of the motion to that end.
pub(in crate::kinematics) struct Step<'a> {
    pub(in crate::kinematics) extrapolation: Extrapolation,
    /// q at the start.
    pub(in crate::kinematics) from: &'a [f64],
    pub(in crate::kinematics) pivots: &'a Pivots,
    pub(in crate::kinematics) bounds: &'a mut StepBounds,
}

impl Extrapolation {
    /// Returns the predicted value of q\[column\], which is `q` at the start.
    #[inline]
    pub(in crate::kinematics) fn predict(self, column: usize, q: f64, tangent: &Rates) -> f64 {
        q + (self.first * tangent.velocity()[column] + self.second * tangent.acceleration()[column])
    }
}

impl Step<'_> {
    /// Returns the largest deviation of q\[column\] from its chord, once a block has bounded it.
    pub(in crate::kinematics) fn deviation(&self, column: usize) -> f64 {
        self.bounds.deviation(column, self.pivots)
    }
}

impl BlockState<'_> {
    /// Returns the numbers in the equations.
    #[inline]
    pub(in crate::kinematics) fn values(&self) -> Values<'_> {
        Values {
            at: self.at,
            targets: self.targets,
            drivers: self.drivers,
        }
    }
}
