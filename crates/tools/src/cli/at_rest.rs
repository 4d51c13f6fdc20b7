//! A mechanism with freedoms at its start.

use std::path::Path;

use super::given::conditions::Conditions;
use super::given::input::{Input, warn_of_misfits};
use super::given::signals::Signals;
use super::motion::release;
use super::told::error::Error;
use super::told::message::Message;
use biela::dynamics::{self, Equilibrium, FreeMotion, Motion, Notice, StateSpace};
use biela::kinematics::{Output, Solver};
use biela::mechanism::CoordinateKind;

/// A mechanism with freedoms, at its start with the velocities of its file, or at rest.
pub(super) struct AtRest {
    file: String,
    pub(super) motion: Motion,
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
        warn_of_misfits(&solver);
        Self::start(input.source.name(), solver, scenario.signals)
    }

    /// Begins at a solver's pose, and warns of parts that overlap there; `file` names the mechanism in
    /// messages.
    pub(super) fn start(file: &str, solver: Solver, signals: Signals) -> Result<Self, Error> {
        let mut start = Self::begin(file, solver, signals)?;
        let happenings = start.motion.happenings();
        let overlaps = happenings.filter(|notice| matches!(notice, Notice::Overlap(..)));
        overlaps.for_each(|overlap| Message::from(overlap).show());
        Ok(start)
    }

    /// Begins at a solver's pose; `file` names the mechanism in messages.
    pub(super) fn begin(file: &str, solver: Solver, signals: Signals) -> Result<Self, Error> {
        let mut motion = Motion::new(solver);
        motion.seek_forces();
        let released = release(&mut motion, &signals);
        released.map_err(|error| stopped(file, &error))?;
        if motion.free().is_none() {
            let why = dynamics::Error::NoFreedom;
            return Err(Error::Usage(format!("{file}: {why}")));
        }
        motion.take_rates();
        Ok(Self {
            file: file.to_owned(),
            motion,
            signals,
        })
    }

    /// Returns name, kind of coordinate, inertia and acceleration of each freedom \[SI\].
    pub(super) fn freedoms(&self) -> impl Iterator<Item = (&str, CoordinateKind, f64, f64)> {
        let free = self.free();
        let inertia = free.inertia();
        let freedoms = free.freedoms().iter().enumerate();
        freedoms.map(move |(k, id)| {
            let driver = &self.motion.mechanism().drivers[id.index()];
            let acceleration = free.drivers()[id.index()].second();
            (
                &*driver.name,
                driver.coordinate.kind,
                inertia[(k, k)],
                acceleration,
            )
        })
    }

    /// Returns the motion of the freedoms.
    fn free(&self) -> &FreeMotion {
        self.motion.free().expect("the freedoms were released")
    }

    /// Returns whether nothing moves and nothing begins to.
    pub(super) fn is_balanced(&self) -> bool {
        /// An acceleration of this part of gravity's is rounding \[m/s² or rad/s²\].
        const AT_REST: f64 = 1e-9;
        let free = self.free();
        free.freedoms().iter().all(|id| {
            let rates = free.drivers()[id.index()].derivatives;
            rates[0] == 0.0 && rates[1].abs() < AT_REST
        })
    }

    /// Returns whether the freedoms are good coordinates wherever the mechanism moves.
    pub(super) fn keeps_coordinates(&self) -> bool {
        dynamics::keeps_coordinates(self.motion.mechanism())
    }

    /// Moves to the stable equilibrium downhill.
    pub(super) fn balance(&mut self) -> Result<Equilibrium, Error> {
        let pose = self.motion.pose();
        let (time, held) = (pose.time, pose.drivers.clone());
        let balanced = self.motion.balance(&self.signals.part(time, &held));
        balanced.map_err(|error| stopped(&self.file, &error))
    }

    /// Finds the stable equilibria downhill from places all over the range of the freedoms.
    pub(super) fn balances(&mut self) -> Result<Vec<Equilibrium>, Error> {
        let pose = self.motion.pose();
        let (time, held) = (pose.time, pose.drivers.clone());
        let balances = self.motion.balances(&self.signals.part(time, &held));
        balances.map_err(|error| stopped(&self.file, &error))
    }

    /// Linearizes the motion at the pose.
    pub(super) fn linearize(&mut self, outputs: &[Output]) -> Result<StateSpace, Error> {
        let space = self.motion.linearize(outputs);
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
