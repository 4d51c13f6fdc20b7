//! The state that kernels work on, and the sub-step that they take.

use crate::kinematics::certificate::Tubes;
use crate::kinematics::configuration::Configuration;
use crate::kinematics::path::Rates;
use crate::kinematics::system::{System, Targets};

/// What kernels read and change: the mechanism at the pose that is being found.
pub(in crate::kinematics) struct Work<'a> {
    pub(in crate::kinematics) system: &'a System,
    pub(in crate::kinematics) targets: &'a Targets,
    /// The values u of all drivers.
    pub(in crate::kinematics) drivers: &'a [f64],
    pub(in crate::kinematics) at: &'a mut Configuration,
    /// Rates of q along some motion of the drivers.
    pub(in crate::kinematics) flow: &'a mut Rates,
}

/// How far a sub-step goes along the flow: q + q′ · first + q″ · second.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Advance {
    pub(in crate::kinematics) first: f64,
    pub(in crate::kinematics) second: f64,
}

/// One sub-step: what leads to its end, and what is known of the way there.
pub(in crate::kinematics) struct Substep<'a> {
    pub(in crate::kinematics) advance: Advance,
    /// q where it starts.
    pub(in crate::kinematics) from: &'a [f64],
    pub(in crate::kinematics) tubes: &'a mut Tubes,
}

impl Advance {
    /// Where the unknown q\[column\] is expected to go.
    #[inline]
    pub(in crate::kinematics) fn predict(self, column: usize, q: f64, flow: &Rates) -> f64 {
        q + (self.first * flow.velocity()[column] + self.second * flow.acceleration()[column])
    }
}
