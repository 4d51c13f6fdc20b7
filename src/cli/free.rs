//! A mechanism with freedoms at its start.

use std::path::Path;

use super::conditions::Conditions;
use super::error::Error;
use super::input::Input;
use super::signals::Signals;
use crate::dynamics::{self, FreeMotion, StateSpace};
use crate::kinematics::{Output, Solution, Solver};

/// A mechanism with freedoms, at its start with the velocities of its file, or at rest.
pub(super) struct AtRest {
    file: String,
    pub(super) solver: Solver,
    solution: Solution,
    free: FreeMotion,
    signals: Signals,
}

impl AtRest {
    /// Reads and assembles a mechanism.
    pub(super) fn read(file: &Path, conditions: &Conditions) -> Result<Self, Error> {
        let input = Input::read(file)?;
        let mechanism = &input.mechanism;
        let start = mechanism.simulation.start;
        let scenario = conditions.scenario(mechanism, start, None)?;
        let solver = scenario.solver(input.assemble()?);
        let mut solver = solver.map_err(|error| input.error_at(start, &error))?;
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        let name = input.source.name().to_owned();
        let stopped = |error: dynamics::Error| stopped(&name, &error);
        let free = FreeMotion::new(&solver, mechanism.simulation.tolerance).map_err(stopped)?;
        let Some(mut free) = free else {
            return Err(Error::Usage(format!(
                "{name}: the mechanism has no freedom: all that moves is driven"
            )));
        };
        let held = solver.pose().drivers.clone();
        let part = scenario.signals.part(start, &held);
        free.start(&mut solver, &part).map_err(stopped)?;
        solution.driver_rates.copy_from_slice(free.drivers());
        Ok(Self {
            file: name,
            solver,
            solution,
            free,
            signals: scenario.signals,
        })
    }

    /// Moves to the stable equilibrium downhill.
    pub(super) fn balance(&mut self) -> Result<(), Error> {
        let held = self.solver.pose().drivers.clone();
        let part = self.signals.part(self.solver.pose().time, &held);
        let balanced = (self.free).balance(&mut self.solver, &mut self.solution, &part);
        balanced.map_err(|error| stopped(&self.file, &error))
    }

    /// Linearizes the motion at the pose.
    pub(super) fn linearize(&mut self, outputs: &[Output]) -> Result<StateSpace, Error> {
        let space = (self.free).linearize(&mut self.solver, &mut self.solution, outputs);
        space.map_err(|error| stopped(&self.file, &error))
    }
}

/// Returns the error of a free motion.
fn stopped(file: &str, error: &dynamics::Error) -> Error {
    Error::Stopped {
        file: file.to_owned(),
        why: error.to_string(),
    }
}
