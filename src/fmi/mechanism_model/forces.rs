//! Forces at the pose.

use super::{MechanismModel, without_value};
use crate::fmi::error::Failure;
use crate::fmi::log::{Category, Logger};
use crate::kinematics::ForceParts;

impl MechanismModel {
    /// Solves forces at the pose for its rates, which are up to date. Allocates nothing, unless other
    /// rows have become redundant.
    ///
    /// # Errors
    ///
    /// The forces do not exist.
    pub(super) fn solve_forces(&mut self, parts: ForceParts) -> Result<(), Failure> {
        self.set_loads();
        self.motion.solve_forces(parts).map_err(without_value)
    }

    /// Gives the solution the inputs of forces at the present point.
    pub(super) fn set_loads(&mut self) {
        let loads = self.motion.solution.loads.iter_mut();
        for (load, input) in loads.zip(&self.course.force_inputs) {
            *load = input.present();
        }
    }

    /// Solves what tells whether contacts pull, for a host that wants to know.
    pub(super) fn solve_contacts(&mut self, log: &Logger) {
        if log.wants(Category::Warning) && self.motion.contacts() > 0 {
            // A host that reads forces learns that they do not exist.
            let _ = self
                .refresh_rates()
                .and_then(|()| self.solve_forces(ForceParts::REACTIONS));
        }
    }
}
