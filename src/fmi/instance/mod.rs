//! An instance of an FMU in safe Rust.
//!
//! Each function of the C interfaces has a method here; `abi` converts pointers only. A refused
//! call changes neither data nor state, and the instance stays usable; in FMI 3.0 it is then in
//! state `terminated` (2.3.1). The [`Model`] computes the values.
//!
//! A host sets, steps and gets in every cycle. The methods of these three calls, and what they call
//! in the model, are inlined into the C functions of both versions: as calls of their own they
//! would make the cycle of the four-bar some 4 % longer.
//!
//! | file | subject |
//! |---|---|
//! | `values` | setting and getting variables, in both versions |
//! | `derivatives` | directional and adjoint derivatives, dependencies |
//! | `fmu_state` | the FMU state |
//! | `exchange` | model exchange, in both versions |
//! | `stepping` | steps of co-simulation in FMI 2.0 |
//! | `step_mode` | steps and events of co-simulation in FMI 3.0 |

mod derivatives;
mod exchange;
mod fmu_state;
mod step_mode;
mod stepping;
mod values;

use std::sync::Arc;

pub use exchange::{CompletedStep, EventResult};
pub use fmu_state::FmuState;
pub use step_mode::{CoSimulation, StepOutcome, StepProgress};
pub use values::Reals;
pub(super) use values::check_value;

use super::error::{Error, Failure, check_finite};
use super::log::{Category, Logger, Sink};
use super::model::{Groups, Model};
use super::state::{Allowed, Call, Interface, Phase, State, Version, allowed, is_allowed};
use super::status::Status;
use super::variable::{Variable, derivatives, event_indicators, states};
use fmu_state::Lifecycle;
use step_mode::PendingStep;
use values::{Request, groups_of, is_continuous_input};

use std::path::Path;

/// An instance of an FMU: a model inside the standard's state machine.
#[derive(Debug)]
pub struct Instance<M: Model> {
    model: M,
    guid: Arc<str>,
    /// Quantity of each variable.
    quantities: Box<[M::Quantity]>,
    /// Groups of each variable's value, for those that are Reals.
    groups: Box<[Groups]>,
    /// The Reals that the host asked for last.
    request: Request,
    /// Place of each variable's time derivative.
    derivatives: Box<[Option<usize>]>,
    /// Whether each variable is an input that accepts any finite value at any time.
    continuous_inputs: Box<[bool]>,
    /// The places of the continuous states.
    states: Box<[usize]>,
    /// The places of the event indicators.
    event_indicators: Box<[usize]>,
    version: Version,
    interface: Interface,
    /// Calls that each state allows.
    allowed: &'static Allowed,
    /// Agreements with the host of an FMI 3.0 co-simulation.
    co_simulation: CoSimulation,
    /// Whether the host may use each variable in intermediate update.
    intermediate: Box<[bool]>,
    /// A step that has called back.
    pending_step: Option<PendingStep>,
    logger: Logger,
    /// Everything that an FMU state saves besides the model.
    lifecycle: Lifecycle,
    /// Whether the host holds an FMU state of the last communication point.
    state_held: bool,
}

impl<M: Model> Instance<M> {
    /// Creates an instance of the model in the folder `resources`, for a version of the standard.
    ///
    /// # Errors
    ///
    /// The resources hold no model, or one with another GUID or instantiation token.
    pub fn instantiate(
        version: Version,
        guid: &str,
        resources: &Path,
        interface: Interface,
        sink: Box<dyn Sink + Send>,
        logging_on: bool,
    ) -> Result<Self, Error> {
        let model = M::load(resources, interface)?;
        if model.guid() != guid {
            return Err(Error::Guid {
                given: guid.to_owned(),
                actual: model.guid().to_owned(),
            });
        }
        Ok(Self::of_version(version, model, sink, logging_on))
    }

    /// Creates an FMI 2.0 instance of a model.
    pub fn new(model: M, sink: Box<dyn Sink + Send>, logging_on: bool) -> Self {
        Self::of_version(Version::Fmi2, model, sink, logging_on)
    }

    /// Creates an instance of a model for a version of the standard.
    pub fn of_version(
        version: Version,
        model: M,
        sink: Box<dyn Sink + Send>,
        logging_on: bool,
    ) -> Self {
        let variables = model.variables();
        let interface = model.interface();
        let groups = |v| groups_of(version, &model, v);
        Self {
            request: Request::new(variables.len()),
            derivatives: derivatives(variables),
            quantities: variables.iter().map(|v| v.quantity).collect(),
            groups: variables.iter().map(groups).collect(),
            states: states(variables),
            event_indicators: event_indicators(variables),
            continuous_inputs: variables.iter().map(is_continuous_input).collect(),
            guid: model.guid().into(),
            version,
            interface,
            allowed: allowed(version, interface),
            co_simulation: CoSimulation::default(),
            intermediate: Box::default(),
            pending_step: None,
            logger: Logger::new(sink, logging_on, version),
            lifecycle: Lifecycle::new(model.time()),
            state_held: false,
            model,
        }
    }

    /// Returns the model.
    #[must_use]
    pub fn model(&self) -> &M {
        &self.model
    }

    /// Returns the variables in the order of their value references.
    #[must_use]
    pub fn variables(&self) -> &[Variable<M::Quantity>] {
        self.model.variables()
    }

    /// Returns the interface that the instance was created for.
    #[must_use]
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// Returns the present state.
    #[must_use]
    pub fn state(&self) -> State {
        self.lifecycle.state
    }

    /// Returns the version of the standard that the instance follows.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// Logs an error and returns the call's status. In FMI 3.0 a call that has failed ends the
    /// simulation (2.3.1).
    pub fn report(&mut self, call: &str, error: &Error) -> Status {
        // The error's status stands for the whole call.
        self.logger.take_warning();
        let status = error.status();
        let message = format!("{call}: {error}");
        if self.version == Version::Fmi3 {
            let category = match status {
                Status::Discard => Category::Discard,
                _ => Category::Error,
            };
            self.logger.write(status, category, &message);
            if status == Status::Error && self.lifecycle.state != State::Fatal {
                self.abandon_step();
                self.lifecycle.state = State::Terminated;
            }
            return status;
        }
        match error {
            // A warning has given the reason.
            Error::Model(Failure::Discarded(_)) => {
                let discarded = format!("{call}: discarded");
                self.logger.write(status, Category::Discard, &discarded);
            }
            Error::StatusKind { .. } => self.logger.write(status, Category::Discard, &message),
            Error::Range { .. } | Error::Item { .. } => self.logger.warn(&message),
            _ => self.logger.write(status, Category::Error, &message),
        }
        status
    }

    /// Returns the status of a call that has succeeded: a warning if the model has given advice in it.
    #[inline]
    pub fn succeeded(&self) -> Status {
        if self.logger.take_warning() {
            Status::Warning
        } else {
            Status::Ok
        }
    }

    /// Returns the error of a call in which the model failed. Where the standard permits no
    /// discard, the call fails. FMI 2.0: logs the reason of a discarded call.
    #[cold]
    fn failed(&self, call: Call, failure: Failure) -> Error {
        match failure {
            Failure::Discarded(reason) if call.may_discard(self.version, self.interface) => {
                if self.version == Version::Fmi2 {
                    self.logger.warn(&reason);
                }
                Failure::Discarded(reason).into()
            }
            Failure::Discarded(reason) | Failure::Failed(reason) => Failure::Failed(reason).into(),
            Failure::Event => failure.into(),
        }
    }

    /// Logs that a call was refused which cannot belong to the sequence of calls: from the logger,
    /// or from another thread.
    pub fn report_disturbance(&self, call: &str, message: &str) {
        let message = format!("{call}: {message}");
        self.logger.write(Status::Error, Category::Error, &message);
    }

    /// Marks the instance as unusable after a caught defect, and logs the defect.
    pub fn mark_fatal(&mut self, message: &str) {
        self.lifecycle.state = State::Fatal;
        self.logger.write(Status::Fatal, Category::Fatal, message);
    }

    /// Checks that the present state allows a call.
    ///
    /// # Errors
    ///
    /// [`Error::State`] if another state does, [`Error::Interface`] if none does.
    #[inline]
    pub fn allow(&self, call: Call) -> Result<(), Error> {
        if is_allowed(self.allowed, call, self.lifecycle.state) {
            Ok(())
        } else {
            Err(self.not_allowed(call))
        }
    }

    #[cold]
    fn not_allowed(&self, call: Call) -> Error {
        let (version, interface, state) = (self.version, self.interface, self.lifecycle.state);
        let allowed_in = |interface| call.allowed_in(version, interface);
        let allowed = allowed_in(interface);
        let is_known = Interface::ALL
            .into_iter()
            .any(|i| !allowed_in(i).is_empty());
        if !allowed.is_empty() {
            Error::State { state, allowed }
        } else if is_known || version == Version::Fmi2 {
            Error::Interface { interface }
        } else {
            let why = why_never(call);
            Error::NotProvided { why }
        }
    }

    /// `fmi2SetDebugLogging`: switches log categories; an empty list switches all.
    ///
    /// # Errors
    ///
    /// [`Error::LogCategory`] for an unknown name; all switches stay.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), Error> {
        self.allow(Call::SetDebugLogging)?;
        self.logger
            .switch(on, categories)
            .map_err(|name| Error::LogCategory {
                name: name.to_owned(),
            })
    }

    /// Takes the host's tolerance, with which a model that integrates works. Some hosts give zero where
    /// they have none.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        if tolerance != 0.0 {
            self.model.set_tolerance(tolerance, &self.logger);
        }
    }

    /// `fmi2SetupExperiment`: start and stop time \[s\].
    ///
    /// # Errors
    ///
    /// A time is not finite, or the stop time is before the start time.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        self.allow(Call::SetupExperiment)?;
        self.set_experiment(start, stop)
    }

    /// Sets start and stop time.
    fn set_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        check_finite("startTime", start)?;
        if let Some(stop) = stop {
            check_finite("stopTime", stop)?;
            if stop < start {
                return Err(Error::Time {
                    message: format!("the stop time {stop} s is before the start time {start} s"),
                });
            }
        }
        self.model.set_time(start);
        self.lifecycle.last_successful_time = start;
        self.lifecycle.start_time = start;
        self.lifecycle.stop_time = stop;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterInitializationMode)?;
        self.lifecycle.state = State::InitializationMode;
        Ok(())
    }

    /// `fmi3EnterInitializationMode`: start and stop time \[s\]. The tolerance has no effect.
    ///
    /// # Errors
    ///
    /// A time is not finite, or the stop time is before the start time.
    pub fn enter_initialization_mode_at(
        &mut self,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        self.allow(Call::EnterInitializationMode)?;
        self.set_experiment(start, stop)?;
        self.lifecycle.state = State::InitializationMode;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`, `fmi3ExitInitializationMode`: starts the model with the values
    /// set.
    ///
    /// # Errors
    ///
    /// The model cannot start with these values; an FMI 2.0 instance is then in state `error`.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::ExitInitializationMode)?;
        if let Err(failure) = self.model.commit(Phase::Initialization, &self.logger) {
            if self.version == Version::Fmi2 {
                self.lifecycle.state = State::Error;
            }
            return Err(self.failed(Call::ExitInitializationMode, failure));
        }
        self.model.update_discrete();
        self.lifecycle.state = match (self.interface, self.version) {
            (Interface::ModelExchange, _) => State::EventMode,
            (Interface::CoSimulation, Version::Fmi2) => State::StepComplete,
            (Interface::CoSimulation, Version::Fmi3) if self.co_simulation.event_mode_used => {
                State::EventMode
            }
            (Interface::CoSimulation, Version::Fmi3) => State::StepMode,
        };
        self.lifecycle.last_successful_time = self.model.time();
        self.log_event(|model| format!("initialized at t = {} s", model.time()));
        Ok(())
    }

    /// `fmi2Terminate`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn terminate(&mut self) -> Result<(), Error> {
        self.allow(Call::Terminate)?;
        let phase = self.lifecycle.state.phase(self.interface);
        let is_exchange = self.interface == Interface::ModelExchange && phase == Phase::Running;
        // The values of the final time are those of the inputs set last.
        if (is_exchange || phase == Phase::Event)
            && let Err(failure) = self.model.commit(phase, &self.logger)
        {
            self.logger.warn(&failure.to_string());
        }
        self.lifecycle.state = State::Terminated;
        self.log_event(|_| "terminated".to_owned());
        Ok(())
    }

    /// `fmi2Reset`: restores the state after instantiation. Log settings stay.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.allow(Call::Reset)?;
        self.model.reset();
        self.lifecycle = Lifecycle::new(self.model.time());
        self.state_held = false;
        self.logger.begin_run();
        self.log_event(|_| "reset".to_owned());
        Ok(())
    }

    fn log_event(&self, message: impl FnOnce(&M) -> String) {
        if self.logger.wants(Category::Events) {
            let message = message(&self.model);
            self.logger.write(Status::Ok, Category::Events, &message);
        }
    }
}

/// Returns why no state allows a call of FMI 3.0.
fn why_never(call: Call) -> &'static str {
    match call {
        Call::EnterConfigurationMode | Call::ExitConfigurationMode => {
            "the FMU has no structural parameters, and so no configuration mode"
        }
        Call::ActivateModelPartition => "the FMU has no clocks, and so no model partitions",
        _ => "not a function of FMI 3.0, for which this instance was made",
    }
}
