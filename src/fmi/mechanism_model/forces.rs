//! Forces at the pose, and contacts that lift off.

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
        let solved = self.solution.solve_forces(&mut self.solver, parts);
        solved.map_err(without_value)
    }

    /// Gives the solution the inputs of forces at the present point.
    pub(super) fn set_loads(&mut self) {
        let loads = self.solution.loads.iter_mut();
        for (load, input) in loads.zip(&self.course.force_inputs) {
            *load = input.present();
        }
    }

    /// Reports each contact that begins to pull, as it would lift off.
    pub(super) fn report_contacts(&mut self, log: &Logger) {
        if self.course.lifted.is_empty() || !log.wants(Category::Warning) {
            return;
        }
        let parts = ForceParts::REACTIONS;
        // A host that reads forces learns that they do not exist.
        let solved = self.refresh_rates().and_then(|()| self.solve_forces(parts));
        if solved.is_err() {
            return;
        }
        if let Some(forces) = self.solution.forces() {
            for lift_off in self.solver.lift_offs(forces, &mut self.course.lifted) {
                log.remark(|| lift_off.to_string());
            }
        }
    }
}
