//! Mechanisms as FMUs: a [`Model`] of a [`Mechanism`] and its [`Solver`].
//!
//! This is the only part of `fmi` that knows of mechanisms.

mod derivatives;
mod description;
mod guid;
mod inputs;
mod motion;
mod resource;
mod state;
mod variables;

use std::ops::Range;
use std::path::Path as FilePath;
use std::sync::Arc;

pub use description::describe;
pub use guid::guid;
pub use resource::{RESOURCE, write_fmu};
pub use state::MechanismState;
pub use variables::{Order, Quantity, TABLE_VERSION, variables};

use super::codec::{Codec, Unreadable};
use super::error::Failure;
use super::log::Logger;
use super::model::Model;
use super::state::{Interface, Phase};
use super::variable::Variable;
use crate::kinematics::{self, Path, Pose, Progress, Rates, Solver};
use crate::mechanism::{DriverSource, Jet, Mechanism};
use inputs::{DriverInput, Extrapolation, RateSource};

/// What the host has set, apart from the drivers' inputs.
#[derive(Clone, Debug, PartialEq)]
struct Settings {
    parameters: Vec<f64>,
    rates: RateSource,
    extrapolation: Extrapolation,
}

/// What the solver's pose and rates are worth, from nothing to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Freshness {
    /// Values were set since: the pose has to be found anew.
    Stale,
    /// The pose belongs to the values set; the rates of q have to be found.
    Pose,
    /// Pose and rates belong to the values set.
    Rates,
}

/// A mechanism at the values that a host has set.
#[derive(Debug)]
pub struct MechanismModel {
    mechanism: Arc<Mechanism>,
    guid: String,
    interface: Interface,
    variables: Vec<Variable<Quantity>>,
    solver: Solver,
    /// The file's own pose at its own values.
    own_home: Arc<Pose>,
    /// From where initialization starts: the own home, or that of an FMU state, which the same
    /// library built for another machine may have found with other rounding.
    home: Arc<Pose>,
    settings: Settings,
    /// One a driver; that of a prescribed motion is without use.
    inputs: Vec<DriverInput>,
    /// The pose that is gone on from: in co-simulation that of the last communication point.
    committed: Pose,
    /// Whether the solver stands at the committed pose.
    at_committed: bool,
    /// Rates of all drivers that the outputs belong to; `value` is without use.
    driver_rates: Vec<Jet>,
    /// Those of the committed pose.
    committed_rates: Vec<Jet>,
    rates: Rates,
    /// The value references of what the bodies among the outputs have, nine variables each.
    row: Range<u32>,
    /// Their values where rates are fresh: position, velocity and acceleration of each.
    coordinates: Vec<f64>,
    freshness: Freshness,
    path: Path,
    progress: Progress,
    time: f64,
    /// Whether the host has been warned of the singular position that the mechanism is near.
    near_singular: bool,
}

impl MechanismModel {
    /// The model of a mechanism, assembled from its own estimates and values.
    ///
    /// # Errors
    ///
    /// It does not assemble.
    pub fn new(mechanism: Arc<Mechanism>, interface: Interface) -> Result<Self, kinematics::Error> {
        let path = Path::new(&mechanism);
        let mut solver = Solver::new(Arc::clone(&mechanism))?;
        solver.assemble(&path)?;
        let home = Arc::new(solver.pose().clone());
        let variables = variables(&mechanism);
        Ok(Self {
            guid: guid(&mechanism),
            interface,
            row: row(&variables),
            variables,
            settings: Settings::new(&mechanism),
            inputs: start_inputs(&mechanism),
            committed: Pose::clone(&home),
            at_committed: true,
            driver_rates: vec![Jet::constant(0.0); mechanism.drivers.len()],
            committed_rates: vec![Jet::constant(0.0); mechanism.drivers.len()],
            rates: Rates::new(home.q.len()),
            coordinates: vec![0.0; 9 * mechanism.outputs.bodies.len()],
            freshness: Freshness::Stale,
            path,
            progress: Progress::default(),
            time: home.time,
            near_singular: false,
            own_home: Arc::clone(&home),
            home,
            solver,
            mechanism,
        })
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }
}

impl Model for MechanismModel {
    type Quantity = Quantity;
    type State = MechanismState;

    fn load(resources: &FilePath, interface: Interface) -> Result<Self, Failure> {
        let mechanism = Arc::new(resource::read(resources)?);
        Self::new(mechanism, interface).map_err(failed)
    }

    fn guid(&self) -> &str {
        &self.guid
    }

    fn interface(&self) -> Interface {
        self.interface
    }

    fn variables(&self) -> &[Variable<Quantity>] {
        &self.variables
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn set_time(&mut self, time: f64) {
        self.time = time;
        self.freshness = Freshness::Stale;
    }

    fn reset(&mut self) {
        self.home = Arc::clone(&self.own_home);
        self.settings = Settings::new(&self.mechanism);
        self.inputs = start_inputs(&self.mechanism);
        self.committed.clone_from(&self.home);
        self.solver.restore(&self.home);
        self.at_committed = true;
        self.driver_rates.fill(Jet::constant(0.0));
        self.committed_rates.fill(Jet::constant(0.0));
        self.freshness = Freshness::Stale;
        self.progress = Progress::default();
        self.time = self.home.time;
        self.near_singular = false;
    }

    fn set_reals(&mut self, values: impl Iterator<Item = (Quantity, f64)>) {
        let mut parameters_changed = false;
        for (quantity, value) in values {
            match quantity {
                Quantity::Input(driver, order) => self.inputs[driver.index()].set(order, value),
                Quantity::Parameter(parameter) => {
                    self.settings.parameters[parameter.index()] = value;
                    parameters_changed = true;
                }
                _ => unreachable!("inputs and parameters are all that can be set"),
            }
            self.freshness = Freshness::Stale;
        }
        if parameters_changed {
            self.mechanism
                .derive_parameters(&mut self.settings.parameters);
        }
    }

    fn set_integers(&mut self, values: impl Iterator<Item = (Quantity, i32)>) {
        for (quantity, value) in values {
            let item = value as usize - 1;
            match quantity {
                Quantity::RateSource => self.settings.rates = RateSource::ALL[item],
                Quantity::Extrapolation => self.settings.extrapolation = Extrapolation::ALL[item],
                _ => unreachable!("the two choices are all that can be set"),
            }
            self.freshness = Freshness::Stale;
        }
    }

    fn set_input_derivatives(&mut self, derivatives: impl Iterator<Item = (Quantity, usize, f64)>) {
        for (quantity, order, value) in derivatives {
            if let Quantity::Input(driver, input) = quantity {
                self.inputs[driver.index()].set_derivative(input, order, value);
            }
            self.freshness = Freshness::Stale;
        }
    }

    /// Coordinates of bodies and their rates are what most hosts ask for.
    fn row(&self) -> Range<u32> {
        self.row.clone()
    }

    #[inline]
    fn row_values(
        &mut self,
        places: Range<usize>,
        phase: Phase,
        log: &Logger,
    ) -> Result<&[f64], Failure> {
        // What is longer has rates in it.
        if places.len() <= 3 && places.clone().all(|place| place % 9 < 3) {
            self.refresh_pose(phase, log)?;
            for place in places.clone() {
                let body = self.mechanism.outputs.bodies[place / 9].index();
                self.coordinates[place] = self.solver.pose().q[3 * body + place % 9];
            }
        } else {
            self.refresh_rates(phase, log)?;
        }
        Ok(&self.coordinates[places])
    }

    fn make_ready(
        &mut self,
        quantity: Quantity,
        phase: Phase,
        log: &Logger,
    ) -> Result<(), Failure> {
        match (quantity, quantity.order()) {
            (_, Some(Order::Velocity | Order::Acceleration)) => self.refresh_rates(phase, log),
            (_, Some(Order::Position))
            | (
                Quantity::Residual | Quantity::Rcond | Quantity::Iterations | Quantity::Substeps,
                None,
            ) => self.refresh_pose(phase, log),
            _ => Ok(()),
        }
    }

    #[inline]
    fn real(&mut self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Input(driver, order) => self.inputs[driver.index()].get(order),
            Quantity::Parameter(parameter) => self.settings.parameters[parameter.index()],
            Quantity::Time => self.time,
            Quantity::Residual => self.solver.residual(),
            Quantity::Rcond => self.solver.rcond(),
            output => output.read(&self.solver, &self.rates, &self.driver_rates),
        }
    }

    fn integer(&mut self, quantity: Quantity) -> i32 {
        let count = match quantity {
            Quantity::RateSource => return self.settings.rates as i32,
            Quantity::Extrapolation => return self.settings.extrapolation as i32,
            Quantity::Iterations => self.progress.iterations,
            Quantity::Substeps => self.progress.substeps,
            _ => unreachable!("all other variables are Reals"),
        };
        i32::try_from(count).unwrap_or(i32::MAX)
    }

    fn time_derivative(&self, quantity: Quantity, order: u32) -> Option<Quantity> {
        quantity.derivative(order as usize)
    }

    fn directional_derivatives(
        &mut self,
        unknowns: &[Quantity],
        knowns: &[(Quantity, f64)],
        phase: Phase,
        log: &Logger,
    ) -> Result<Vec<f64>, Failure> {
        self.derivatives_along(unknowns, knowns, phase, log)
    }

    fn commit(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        self.commit_values(phase, log)
    }

    fn step(&mut self, size: f64, end: f64, log: &Logger) -> Result<(), Failure> {
        self.take_step(size, end, log)
    }

    fn save(&mut self) -> MechanismState {
        self.saved()
    }

    fn restore(&mut self, state: &MechanismState) {
        self.go_back_to(state);
    }

    fn walk(state: &mut MechanismState, codec: &mut impl Codec) -> Result<(), Unreadable> {
        state.walk(codec)
    }

    fn check(&mut self, state: &mut MechanismState) -> Result<(), String> {
        self.check_state(state)
    }
}

impl Settings {
    fn new(mechanism: &Mechanism) -> Self {
        Self {
            parameters: mechanism.default_parameters(),
            rates: RateSource::Auto,
            extrapolation: Extrapolation::Hold,
        }
    }

    /// The value of a quantity that is a parameter of the mechanism.
    fn parameter(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Parameter(parameter) => Some(self.parameters[parameter.index()]),
            _ => None,
        }
    }
}

/// The value references of what the bodies among the outputs have, which stand together.
fn row(variables: &[Variable<Quantity>]) -> Range<u32> {
    let of_body = |variable: &Variable<_>| matches!(variable.quantity, Quantity::Body(..));
    let first = variables.iter().position(of_body).unwrap_or(0);
    let count = variables
        .iter()
        .filter(|variable| of_body(variable))
        .count();
    first as u32..(first + count) as u32
}

fn start_inputs(mechanism: &Mechanism) -> Vec<DriverInput> {
    mechanism
        .drivers
        .iter()
        .map(|driver| match driver.source {
            DriverSource::Input { start } => DriverInput::new(start),
            DriverSource::Motion(_) => DriverInput::new(0.0),
        })
        .collect()
}

/// What the kinematics cannot do is an error.
fn failed(error: kinematics::Error) -> Failure {
    Failure::Failed(error.to_string())
}
