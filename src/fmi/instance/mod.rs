//! An instance of an FMU in safe Rust.
//!
//! Each function of the C interface has a method here; `abi` converts pointers only. A refused
//! call changes neither data nor state, and the instance stays usable. The [`Model`] computes the
//! values.

mod exchange;
mod fmu_state;
mod stepping;
mod values;

use std::sync::Arc;

pub use fmu_state::FmuState;
pub use values::Reals;
pub(super) use values::check_value;

use super::error::{Error, Failure, check_finite};
use super::log::{Category, Logger, Sink};
use super::model::{Groups, Model};
use super::resource_path;
use super::state::{Call, Interface, State};
use super::status::Status;
use super::variable::{Variable, derivatives};
use values::{groups_of, is_continuous_input};

/// An instance of an FMU: a model inside the standard's state machine.
#[derive(Debug)]
pub struct Instance<M: Model> {
    model: M,
    guid: Arc<str>,
    /// Quantity of each variable.
    quantities: Box<[M::Quantity]>,
    /// Groups of each variable's value, for those that are Reals.
    groups: Box<[Groups]>,
    /// Value reference of each variable's time derivative.
    derivatives: Box<[Option<u32>]>,
    /// Whether each variable is an input that accepts any finite value at any time.
    continuous_inputs: Box<[bool]>,
    interface: Interface,
    logger: Logger,
    state: State,
    stop_time: Option<f64>,
    last_successful_time: f64,
    /// Whether the last step was discarded.
    discarded: bool,
    /// Whether the simulation must end, or go on from another state.
    terminated: bool,
    /// Whether the host holds an FMU state of the last communication point.
    state_held: bool,
}

impl<M: Model> Instance<M> {
    /// Creates an instance of the model in the folder of the URI `resources`.
    ///
    /// # Errors
    ///
    /// The resources hold no model, or one with another GUID. The sink has received the reason.
    pub fn instantiate(
        guid: &str,
        resources: &str,
        interface: Interface,
        sink: Box<dyn Sink + Send>,
        logging_on: bool,
    ) -> Result<Self, Error> {
        let load = || {
            let model = M::load(&resource_path(resources)?, interface)?;
            if model.guid() == guid {
                return Ok(model);
            }
            Err(Error::Guid {
                given: guid.to_owned(),
                actual: model.guid().to_owned(),
            })
        };
        match load() {
            Ok(model) => Ok(Self::new(model, sink, logging_on)),
            Err(error) => {
                let message = format!("fmi2Instantiate: {error}");
                sink.write(Status::Error, Category::Error, &message);
                Err(error)
            }
        }
    }

    /// Creates an instance of a model.
    pub fn new(model: M, sink: Box<dyn Sink + Send>, logging_on: bool) -> Self {
        let variables = model.variables();
        Self {
            derivatives: derivatives(variables),

            quantities: variables.iter().map(|v| v.quantity).collect(),
            groups: variables.iter().map(|v| groups_of(&model, v)).collect(),
            continuous_inputs: variables.iter().map(is_continuous_input).collect(),
            guid: model.guid().into(),
            interface: model.interface(),
            logger: Logger::new(sink, logging_on),
            state: State::Instantiated,
            stop_time: None,
            last_successful_time: model.time(),
            discarded: false,
            terminated: false,
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
        self.state
    }

    /// Logs an error and returns the call's status.
    pub fn report(&self, call: &str, error: &Error) -> Status {
        let status = error.status();
        match error {
            // A warning has given the reason.
            Error::Model(Failure::Discarded(_)) => {
                let message = format!("{call}: discarded");
                self.logger.write(status, Category::Discard, &message);
            }
            Error::StatusKind { .. } => {
                let message = format!("{call}: {error}");
                self.logger.write(status, Category::Discard, &message);
            }
            Error::Range { .. } | Error::Item { .. } => {
                self.logger.warn_of_discard(&format!("{call}: {error}"));
            }
            _ => {
                let message = format!("{call}: {error}");
                self.logger.write(status, Category::Error, &message);
            }
        }
        status
    }

    /// Returns the error of a call in which the model failed. Logs the reason of a discarded call;
    /// where the standard permits no discard, the call fails.
    #[cold]
    fn failed(&self, call: Call, failure: Failure) -> Error {
        match failure {
            Failure::Discarded(reason) if call.may_discard(self.interface) => {
                self.logger.warn_of_discard(&reason);
                Failure::Discarded(reason).into()
            }
            Failure::Discarded(reason) | Failure::Failed(reason) => Failure::Failed(reason).into(),
        }
    }

    /// Logs that an argument is unusable, and returns the call's status.
    pub fn report_argument(&self, call: &str, message: &str) -> Status {
        let message = format!("{call}: {message}");
        self.logger.write(Status::Error, Category::Error, &message);
        Status::Error
    }

    /// Marks the instance as unusable after a caught defect, and logs the defect.
    pub fn mark_fatal(&mut self, message: &str) {
        self.state = State::Fatal;
        self.logger.write(Status::Fatal, Category::Fatal, message);
    }

    /// Checks that the present state allows a call.
    ///
    /// # Errors
    ///
    /// [`Error::State`] if another state does, [`Error::Interface`] if none does.
    #[inline]
    pub fn allow(&self, call: Call) -> Result<(), Error> {
        let (interface, state) = (self.interface, self.state);
        if call.is_allowed_in(interface, state) {
            Ok(())
        } else if call.allowed_in(interface).is_empty() {
            Err(Error::Interface { call, interface })
        } else {
            Err(Error::State {
                call,
                interface,
                state,
            })
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

    /// `fmi2SetupExperiment`: start and stop time \[s\]. The tolerance has no effect.
    ///
    /// # Errors
    ///
    /// A time is not finite, or the stop time is before the start time.
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
        self.model.set_time(start);
        self.last_successful_time = start;
        self.stop_time = stop;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterInitializationMode)?;
        self.state = State::InitializationMode;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`: starts the model with the values set.
    ///
    /// # Errors
    ///
    /// The model cannot start with these values; the instance is then in state `error`.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::ExitInitializationMode)?;
        if let Err(failure) = self.model.commit(self.state.phase(), &self.logger) {
            self.state = State::Error;
            return Err(self.failed(Call::ExitInitializationMode, failure));
        }
        self.model.update_discrete();
        self.state = match self.interface {
            Interface::ModelExchange => State::EventMode,
            Interface::CoSimulation => State::StepComplete,
        };
        self.last_successful_time = self.model.time();
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
        self.state = State::Terminated;
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
        self.state = State::Instantiated;
        self.last_successful_time = self.model.time();
        self.stop_time = None;
        self.discarded = false;
        self.terminated = false;
        self.state_held = false;
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
