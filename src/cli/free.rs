//! A mechanism with freedoms at its start.

use std::path::Path;

use super::conditions::Conditions;
use super::error::Error;
use super::input::Input;
use super::message::Message;
use super::signals::Signals;
use crate::dynamics::{self, Equilibrium, FreeMotion, StateSpace};
use crate::kinematics::{Output, Solution, Solver};
use crate::mechanism::CoordinateKind;

/// Lets the freedoms of a mechanism, if it has some, move by the forces from the solver's pose on.
pub(super) fn release(
    solver: &mut Solver,
    signals: &Signals,
) -> Result<Option<FreeMotion>, dynamics::Error> {
    let tolerance = solver.mechanism().simulation.tolerance;
    let mut free = FreeMotion::new(solver, tolerance)?;
    if let Some(free) = &mut free {
        let held = solver.pose().drivers.clone();
        let part = signals.part(solver.pose().time, &held);
        free.start(solver, &part)?;
    }
    Ok(free)
}

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
        let solver = solver.map_err(|error| input.error_at(start, &error))?;
        Self::start(input.source.name(), solver, scenario.signals)
    }

    /// Begins at a solver's pose, and warns of parts that overlap there; `file` names the mechanism in
    /// messages.
    pub(super) fn start(file: &str, mut solver: Solver, signals: Signals) -> Result<Self, Error> {
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        let stopped = |error: dynamics::Error| stopped(file, &error);
        let Some(mut free) = release(&mut solver, &signals).map_err(stopped)? else {
            return Err(Error::Usage(format!(
                "{file}: the mechanism has no freedom: all that moves is driven"
            )));
        };
        for overlap in free.overlaps() {
            Message::Warning(overlap.describe(solver.mechanism())).show();
        }
        free.tell(&mut solution);
        Ok(Self {
            file: file.to_owned(),
            solver,
            solution,
            free,
            signals,
        })
    }

    /// Returns name, kind of coordinate, inertia and acceleration of each freedom \[SI\].
    pub(super) fn freedoms(&self) -> impl Iterator<Item = (&str, CoordinateKind, f64, f64)> {
        let inertia = self.free.inertia();
        let freedoms = self.free.freedoms().iter().enumerate();
        freedoms.map(move |(k, id)| {
            let driver = &self.solver.mechanism().drivers[id.index()];
            let acceleration = self.free.drivers()[id.index()].second();
            (
                &*driver.name,
                driver.coordinate.kind,
                inertia[(k, k)],
                acceleration,
            )
        })
    }

    /// Returns whether nothing moves and nothing begins to.
    pub(super) fn is_balanced(&self) -> bool {
        /// An acceleration of this part of gravity's is rounding \[m/s² or rad/s²\].
        const AT_REST: f64 = 1e-9;
        let mut freedoms = self.free.freedoms().iter();
        freedoms.all(|id| {
            let rates = self.free.drivers()[id.index()].derivatives;
            rates[0] == 0.0 && rates[1].abs() < AT_REST
        })
    }

    /// Returns whether the freedoms are good coordinates wherever the mechanism moves.
    pub(super) fn keeps_coordinates(&self) -> bool {
        dynamics::keeps_coordinates(self.solver.mechanism())
    }

    /// Moves to the stable equilibrium downhill.
    pub(super) fn balance(&mut self) -> Result<Equilibrium, Error> {
        let held = self.solver.pose().drivers.clone();
        let part = self.signals.part(self.solver.pose().time, &held);
        let balanced = (self.free).balance(&mut self.solver, &mut self.solution, &part);
        balanced.map_err(|error| stopped(&self.file, &error))
    }

    /// Finds the stable equilibria downhill from places all over the range of the freedoms.
    pub(super) fn balances(&mut self) -> Result<Vec<Equilibrium>, Error> {
        let held = self.solver.pose().drivers.clone();
        let part = self.signals.part(self.solver.pose().time, &held);
        let balances = (self.free).balances(&mut self.solver, &mut self.solution, &part);
        balances.map_err(|error| stopped(&self.file, &error))
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
