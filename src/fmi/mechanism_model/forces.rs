//! Forces at the pose, and contacts that lift off.

use super::{MechanismModel, without_value};
use crate::fmi::error::Failure;
use crate::fmi::log::{Category, Logger};
use crate::fmi::state::Phase;
use crate::kinematics::{Direction, Error};
use crate::kinematics::{ForceParts, ForceQuantity, ForceSensitivity, Forces, KnownMotion, Solver};

/// Forces with the inputs on which they depend.
#[derive(Debug)]
pub(super) struct ModelForces {
    forces: Forces,
    inputs: Vec<f64>,
}

impl ModelForces {
    /// Makes the storage.
    pub(super) fn new(solver: &Solver) -> Self {
        let forces = solver.forces();
        Self {
            inputs: vec![0.0; forces.inputs()],
            forces,
        }
    }

    /// Returns the number of inputs.
    pub(super) fn inputs(&self) -> usize {
        self.inputs.len()
    }

    /// Returns the number of contacts.
    pub(super) fn contacts(&self) -> usize {
        self.forces.contacts()
    }

    pub(super) fn value(&self, quantity: ForceQuantity) -> f64 {
        self.forces.value(quantity)
    }
}

impl MechanismModel {
    /// Solves forces for the values set. Allocates nothing, unless other rows have become redundant.
    ///
    /// # Errors
    ///
    /// The pose, its rates or its forces do not exist.
    pub(super) fn refresh_forces(
        &mut self,
        parts: ForceParts,
        phase: Phase,
        log: &Logger,
    ) -> Result<(), Failure> {
        self.refresh_rates(phase, log)?;
        let Some((solver, forces, motion)) = self.forces_to_solve() else {
            return Ok(());
        };
        let solved = solver.solve_forces(motion, parts, forces);
        solved.map_err(without_value)
    }

    /// Returns the solver, the forces, and the motion for which they are sought; `None` without
    /// dynamics. The rates are up to date.
    fn forces_to_solve(&mut self) -> Option<(&mut Solver, &mut Forces, KnownMotion<'_>)> {
        let ModelForces { forces, inputs } = self.forces.as_deref_mut()?;
        for (now, input) in inputs.iter_mut().zip(&self.course.force_inputs) {
            *now = input.present();
        }
        let motion = KnownMotion {
            rates: &self.rates,
            driver_rates: &self.driver_rates,
            inputs,
        };
        Some((&mut self.solver, forces, motion))
    }

    /// Returns the derivatives of forces along a direction, along which the inputs of forces change
    /// by `changes`; the rates are up to date.
    ///
    /// # Errors
    ///
    /// The forces do not exist.
    pub(super) fn force_derivatives(
        &mut self,
        direction: &Direction,
        changes: &[f64],
    ) -> Result<Option<ForceSensitivity>, Error> {
        let Some((solver, forces, motion)) = self.forces_to_solve() else {
            return Ok(None);
        };
        let along = solver.force_sensitivity(motion, direction, changes, forces);
        along.map(Some)
    }

    /// Reports each contact that begins to pull, as it would lift off.
    pub(super) fn report_contacts(&mut self, log: &Logger) {
        if self.course.lifted.is_empty() || !log.wants(Category::Warning) {
            return;
        }
        let parts = ForceParts {
            efforts: false,
            reactions: true,
        };
        // Forces that do not exist are told to a host that reads them.
        if self.refresh_forces(parts, Phase::Running, log).is_err() {
            return;
        }
        let Some(ModelForces { forces, .. }) = self.forces.as_deref() else {
            return;
        };
        for lift_off in self.solver.lift_offs(forces, &mut self.course.lifted) {
            log.advise(|| lift_off.to_string());
        }
    }
}
