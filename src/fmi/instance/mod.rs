//! A co-simulation slave in safe Rust.
//!
//! Every call of the C interface that concerns an instance has its twin here; `abi` only turns
//! pointers into slices. A refused call changes neither data nor state and leaves the instance
//! usable.

mod fmu_state;
mod motion;
mod values;

use std::sync::Arc;

pub use fmu_state::{FmuState, StateError};

use super::inputs::{DriverInput, Extrapolation, RateSource};
use super::log::{Category, Logger, Sink};
use super::package::RESOURCE;
use super::state::{Call, State};
use super::variables::{Quantity, Variables};
use super::{UriError, resource_path};
use crate::kinematics::{self, Path, Pose, Progress, Rates, Solver};
use crate::mechanism::{Diagnostic, DriverSource, Jet, Mechanism, Severity, Source};

/// How a call ended, in the order of `fmi2Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// All well.
    Ok = 0,
    /// All well, and something to say.
    Warning = 1,
    /// Not possible from here; the host may go on another way.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// A defect: the instance is lost.
    Fatal = 4,
}

/// Why a call was refused or failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The call is not allowed in the present state.
    #[error("{} is not allowed in state {state}; it is allowed in {}", call.name(), states(call.allowed_in()))]
    State {
        /// The call.
        call: Call,
        /// The present state.
        state: State,
    },
    /// No variable has this value reference.
    #[error("there is no variable with value reference {value_reference}; the last one is {last}")]
    ValueReference {
        /// The value reference.
        value_reference: u32,
        /// The highest one there is.
        last: usize,
    },
    /// The variable has another type.
    #[error("`{name}` is {actual}, not {expected}")]
    Type {
        /// The variable.
        name: String,
        /// Its type.
        actual: &'static str,
        /// The type of the call.
        expected: &'static str,
    },
    /// The variable cannot be set, or not now.
    #[error("`{name}` cannot be set: it is {why}")]
    NotSettable {
        /// The variable.
        name: String,
        /// Why.
        why: &'static str,
    },
    /// NaN or infinity.
    #[error("`{name}` cannot be set to {value}: not a finite number")]
    NotFinite {
        /// The variable or argument.
        name: String,
        /// The value.
        value: f64,
    },
    /// Outside `min` and `max`.
    #[error("`{name}` cannot be set to {value}: expected {}", range(*.min, *.max))]
    Range {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// Smallest permitted value.
        min: Option<f64>,
        /// Largest permitted value.
        max: Option<f64>,
    },
    /// Not an item of the enumeration.
    #[error("`{name}` cannot be set to {value}: expected 1 to {count}")]
    Item {
        /// The variable.
        name: String,
        /// The value.
        value: i32,
        /// The number of items.
        count: usize,
    },
    /// An order of derivative that inputs do not have.
    #[error("`{name}`: input derivatives of order {order} are not known; expected 1 or 2")]
    DerivativeOrder {
        /// The variable.
        name: String,
        /// The order.
        order: i32,
    },
    /// Only outputs have output derivatives.
    #[error("`{name}` is no output, and only outputs have output derivatives")]
    NotOutput {
        /// The variable.
        name: String,
    },
    /// An order of derivative that nothing has.
    #[error("`{name}`: an output derivative cannot be of order {order}; expected 1 or 2")]
    OutputDerivativeOrder {
        /// The output.
        name: String,
        /// The order.
        order: i32,
    },
    /// A derivative that this output does not have.
    #[error(
        "`{name}` has no derivative of order {order}: velocities have the first, positions \
             the second as well"
    )]
    NoOutputDerivative {
        /// The output.
        name: String,
        /// The order.
        order: i32,
    },
    /// A kind of status that a status function does not tell.
    #[error("status kind {kind} is not told by this function, or not while no step is pending")]
    StatusKind {
        /// The number of the kind.
        kind: i64,
    },
    /// A communication point, step size or stop time that makes no sense.
    #[error("{message}")]
    Time {
        /// What is wrong and what would be right.
        message: String,
    },
    /// A name that is no log category.
    #[error("there is no log category `{name}`; expected {}", categories())]
    LogCategory {
        /// The name.
        name: String,
    },
    /// The kinematics failed.
    #[error(transparent)]
    Kinematics(#[from] kinematics::Error),
    /// No continuous motion leads from the last communication point to the values set.
    #[error("{message}")]
    DeadPoint {
        /// Which drivers, their values and limits.
        message: String,
    },
    /// The resource location is no folder of this machine.
    #[error(transparent)]
    Uri(#[from] UriError),
    /// The mechanism file is missing or cannot be read.
    #[error("cannot read the mechanism `{path}`: {reason}")]
    Resource {
        /// The file.
        path: String,
        /// Why.
        reason: String,
    },
    /// The mechanism file has errors.
    #[error("{}", diagnostics.join("; "))]
    Mechanism {
        /// One line an error.
        diagnostics: Vec<String>,
    },
    /// Bytes or a state that are none of this FMU.
    #[error(transparent)]
    FmuState(#[from] StateError),
    /// The mechanism is not the one that the model description was made from.
    #[error(
        "the GUID `{given}` is not that of the mechanism in the FMU's resources, `{actual}`: the \
         model description and the resources do not belong together"
    )]
    Guid {
        /// What the host gave.
        given: String,
        /// That of the mechanism.
        actual: String,
    },
}

impl Error {
    /// The status that a call returns with this error.
    #[must_use]
    pub fn status(&self) -> Status {
        match self {
            Self::DeadPoint { .. } | Self::NoOutputDerivative { .. } | Self::StatusKind { .. } => {
                Status::Discard
            }
            _ => Status::Error,
        }
    }
}

fn states(states: &[State]) -> String {
    let names: Vec<_> = states.iter().map(State::to_string).collect();
    names.join(", ")
}

fn categories() -> String {
    Category::ALL
        .map(|(category, _)| category.name())
        .join(", ")
}

fn range(min: Option<f64>, max: Option<f64>) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("{min} to {max}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => "any number".to_owned(),
    }
}

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

/// A co-simulation slave.
#[derive(Debug)]
pub struct Instance {
    mechanism: Arc<Mechanism>,
    guid: Arc<str>,
    variables: Variables,
    logger: Logger,
    state: State,
    solver: Solver,
    /// The file's own pose at its own values.
    own_home: Arc<Pose>,
    /// From where initialization starts: the own home, or that of an FMU state, which the same
    /// library built for another machine may have found with other rounding.
    home: Arc<Pose>,
    settings: Settings,
    /// One a driver; that of a prescribed motion is without use.
    inputs: Vec<DriverInput>,
    /// The pose at the last communication point.
    committed: Pose,
    /// Whether the solver stands at the committed pose.
    at_committed: bool,
    /// Rates of all drivers that the outputs belong to; `value` is without use.
    driver_rates: Vec<Jet>,
    /// Those at the last communication point.
    committed_rates: Vec<Jet>,
    rates: Rates,
    /// q of the bodies, then its rates, where these are fresh: side by side for who reads many.
    coordinates: Vec<f64>,
    freshness: Freshness,
    path: Path,
    progress: Progress,
    time: f64,
    stop_time: Option<f64>,
    last_successful_time: f64,
    /// Set by a discarded step: the host should end or go back.
    terminated: bool,
    /// Whether the host has been warned of the singular position that the mechanism is near.
    near_singular: bool,
}

impl Instance {
    /// Makes an instance from the mechanism in the folder that `resources` names.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be read, is not the one that `guid` names, or does not assemble. The
    /// reason has then gone to the sink as well.
    pub fn instantiate(
        guid: &str,
        resources: &str,
        sink: Box<dyn Sink + Send>,
        logging_on: bool,
    ) -> Result<Self, Error> {
        let logger = Logger::new(sink, logging_on);
        let solver = read_mechanism(guid, resources).and_then(assembled);
        match solver {
            Ok(solver) => Ok(Self::at_home(solver, logger)),
            Err(error) => {
                let message = format!("fmi2Instantiate: {error}");
                logger.write(Status::Error, Category::Error, &message);
                Err(error)
            }
        }
    }

    /// Makes an instance of a mechanism without going through a file.
    ///
    /// # Errors
    ///
    /// The mechanism does not assemble from its own estimates and values.
    pub fn new(
        mechanism: Arc<Mechanism>,
        sink: Box<dyn Sink + Send>,
        logging_on: bool,
    ) -> Result<Self, Error> {
        Ok(Self::at_home(
            assembled(mechanism)?,
            Logger::new(sink, logging_on),
        ))
    }

    /// An instance whose solver stands at the file's own pose.
    fn at_home(solver: Solver, logger: Logger) -> Self {
        let mechanism = Arc::clone(solver.mechanism());
        let home = Arc::new(solver.pose().clone());
        Self {
            guid: super::guid(&mechanism).into(),
            variables: Variables::new(&mechanism),
            logger,
            state: State::Instantiated,
            settings: Settings::new(&mechanism),
            inputs: start_inputs(&mechanism),
            committed: Pose::clone(&home),
            at_committed: true,
            driver_rates: vec![Jet::constant(0.0); mechanism.drivers.len()],
            committed_rates: vec![Jet::constant(0.0); mechanism.drivers.len()],
            rates: Rates::new(home.q.len()),
            coordinates: vec![0.0; 9 * mechanism.bodies.len()],
            freshness: Freshness::Stale,
            path: Path::new(&mechanism),
            progress: Progress::default(),
            time: home.time,
            stop_time: None,
            last_successful_time: home.time,
            terminated: false,
            near_singular: false,
            own_home: Arc::clone(&home),
            home,
            solver,
            mechanism,
        }
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// The table of variables.
    #[must_use]
    pub fn variables(&self) -> &Variables {
        &self.variables
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Gives an error to the host's logger and turns it into the call's status.
    pub fn report(&self, call: &str, error: &Error) -> Status {
        let status = error.status();
        let category = match status {
            Status::Discard => Category::Discard,
            _ => Category::Error,
        };
        if self.logger.wants(category) {
            let message = match error {
                // The warning that precedes a dead point has said it all.
                Error::DeadPoint { .. } => format!("{call}: discarded"),
                _ => format!("{call}: {error}"),
            };
            self.logger.write(status, category, &message);
        }
        status
    }

    /// Tells the host's logger of an argument that is no use at all.
    pub fn report_argument(&self, call: &str, message: &str) -> Status {
        let message = format!("{call}: {message}");
        self.logger.write(Status::Error, Category::Error, &message);
        Status::Error
    }

    /// Marks the instance as lost after a caught defect.
    pub fn lose(&mut self, what: &str) {
        self.state = State::Fatal;
        self.logger.write(Status::Fatal, Category::Fatal, what);
    }

    /// Whether the present state allows a call.
    ///
    /// # Errors
    ///
    /// [`Error::State`] if not.
    pub fn allow(&self, call: Call) -> Result<(), Error> {
        if call.allowed_in().contains(&self.state) {
            Ok(())
        } else {
            Err(Error::State {
                call,
                state: self.state,
            })
        }
    }

    /// `fmi2SetDebugLogging`: switches log categories; none named means all.
    ///
    /// # Errors
    ///
    /// [`Error::LogCategory`] for a name that is none; nothing is switched then.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), Error> {
        self.allow(Call::SetDebugLogging)?;
        self.logger
            .switch(on, categories)
            .map_err(|name| Error::LogCategory {
                name: name.to_owned(),
            })
    }

    /// `fmi2SetupExperiment`: start and stop time \[s\]. The tolerance has no effect: every
    /// solution is exact to rounding.
    ///
    /// # Errors
    ///
    /// A time is not finite, or the stop time is before the start.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        self.allow(Call::SetupExperiment)?;
        check_finite("startTime", start)?;
        if let Some(stop) = stop {
            check_finite("stopTime", stop)?;
            if stop < start {
                return Err(Error::Time {
                    message: format!("the stop time {stop} s is before the start time {start} s"),
                });
            }
        }
        self.time = start;
        self.last_successful_time = start;
        self.stop_time = stop;
        self.freshness = Freshness::Stale;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterInitializationMode)?;
        self.state = State::InitializationMode;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`: finds the pose for the values set.
    ///
    /// # Errors
    ///
    /// The mechanism does not exist for these values; the instance is then in the error state.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::ExitInitializationMode)?;
        if let Err(error) = self.refresh_pose() {
            self.state = State::Error;
            return Err(error);
        }
        self.commit();
        self.state = State::StepComplete;
        let redundancies = self.solver.redundancies().into_iter();
        let redundancies = redundancies.map(|redundancy| redundancy.to_string());
        let misfits = self.solver.misfits().into_iter();
        for warning in redundancies.chain(misfits.map(|misfit| misfit.to_string())) {
            self.logger
                .write(Status::Warning, Category::Warning, &warning);
        }
        if self.logger.wants(Category::Events) {
            let message = format!(
                "initialized at t = {} s; residual {:.1e}",
                self.time,
                self.solver.residual()
            );
            self.logger.write(Status::Ok, Category::Events, &message);
        }
        Ok(())
    }

    /// `fmi2Terminate`.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn terminate(&mut self) -> Result<(), Error> {
        self.allow(Call::Terminate)?;
        self.state = State::Terminated;
        self.logger
            .write(Status::Ok, Category::Events, "terminated");
        Ok(())
    }

    /// `fmi2Reset`: back to the state after instantiation, log settings apart.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.allow(Call::Reset)?;
        self.state = State::Instantiated;
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
        self.last_successful_time = self.home.time;
        self.stop_time = None;
        self.terminated = false;
        self.near_singular = false;
        self.logger.write(Status::Ok, Category::Events, "reset");
        Ok(())
    }

    /// `fmi2GetStatus` of `fmi2DoStepStatus`: how the last step ended.
    #[must_use]
    pub fn step_status(&self) -> Status {
        if self.terminated {
            Status::Discard
        } else {
            Status::Ok
        }
    }

    /// `fmi2GetRealStatus` of `fmi2LastSuccessfulTime` \[s\].
    #[must_use]
    pub fn last_successful_time(&self) -> f64 {
        self.last_successful_time
    }

    /// `fmi2GetBooleanStatus` of `fmi2Terminated`: whether a step was discarded for good.
    #[must_use]
    pub fn is_terminated(&self) -> bool {
        self.terminated
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

fn read_mechanism(guid: &str, resources: &str) -> Result<Arc<Mechanism>, Error> {
    let path = resource_path(resources)?.join(RESOURCE);
    let unreadable = |reason: String| Error::Resource {
        path: path.display().to_string(),
        reason,
    };
    let source = Source::open(RESOURCE, &path).map_err(|error| unreadable(error.to_string()))?;
    let (mechanism, _) = Mechanism::parse(&source).map_err(|diagnostics| Error::Mechanism {
        diagnostics: diagnostics
            .iter()
            .filter(|diagnostic| diagnostic.severity == Severity::Error)
            .map(|diagnostic: &Diagnostic| diagnostic.one_line(&source))
            .collect(),
    })?;
    let actual = super::guid(&mechanism);
    if guid != actual {
        return Err(Error::Guid {
            given: guid.to_owned(),
            actual,
        });
    }
    Ok(Arc::new(mechanism))
}

fn assembled(mechanism: Arc<Mechanism>) -> Result<Solver, Error> {
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism)?;
    solver.assemble(&path)?;
    Ok(solver)
}

fn check_finite(name: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(Error::NotFinite {
            name: name.to_owned(),
            value,
        })
    }
}
