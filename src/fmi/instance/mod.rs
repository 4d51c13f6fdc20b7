//! An instance of an FMU in safe Rust.
//!
//! Every call of the C interface that concerns an instance has its twin here; `abi` only turns
//! pointers into slices. A refused call changes neither data nor state and leaves the instance
//! usable. What the numbers mean is the [`Model`]'s business.

mod exchange;
mod fmu_state;
mod stepping;
mod values;

use std::ops::Range;
use std::sync::Arc;

pub use fmu_state::FmuState;
pub(super) use values::check_value;

use super::error::{Error, Failure, Status, check_finite};
use super::log::{Category, Logger, Sink};
use super::model::Model;
use super::resource_path;
use super::state::{Call, Interface, State};
use super::variable::{Causality, Kind, Variability, Variable};

/// An instance of an FMU: a model, and what the standard asks for around it.
#[derive(Debug)]
pub struct Instance<M: Model> {
    model: M,
    guid: Arc<str>,
    /// Those of the variables, side by side: hosts read many at a time.
    quantities: Box<[M::Quantity]>,
    /// Those that the model keeps side by side.
    row: Range<u32>,
    /// Whether each is an input that can have any finite value at any time.
    free_inputs: Box<[bool]>,
    interface: Interface,
    logger: Logger,
    state: State,
    stop_time: Option<f64>,
    last_successful_time: f64,
    /// Set by a discarded step: the host should end or go back.
    terminated: bool,
}

fn is_free_input<Q>(variable: &Variable<Q>) -> bool {
    let unlimited = matches!(
        variable.kind,
        Kind::Real {
            min: None,
            max: None,
            ..
        }
    );
    unlimited
        && variable.causality == Causality::Input
        && variable.variability == Variability::Continuous
}

impl<M: Model> Instance<M> {
    /// Makes an instance of the model in the folder that the URI `resources` names.
    ///
    /// # Errors
    ///
    /// The model cannot be read, or is not the one that `guid` names. The reason has then gone
    /// to the sink as well.
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

    /// Makes an instance of a model.
    pub fn new(model: M, sink: Box<dyn Sink + Send>, logging_on: bool) -> Self {
        let variables = model.variables().iter();
        let quantities: Box<[_]> = variables.map(|variable| variable.quantity).collect();
        let variables = model.variables().iter();
        Self {
            row: model.row(),
            free_inputs: variables.map(is_free_input).collect(),
            quantities,
            guid: model.guid().into(),
            interface: model.interface(),
            logger: Logger::new(sink, logging_on),
            state: State::Instantiated,
            stop_time: None,
            last_successful_time: model.time(),
            terminated: false,
            model,
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &M {
        &self.model
    }

    /// The variables, in the order of their value references.
    #[must_use]
    pub fn variables(&self) -> &[Variable<M::Quantity>] {
        self.model.variables()
    }

    /// For which interface the instance was made.
    #[must_use]
    pub fn interface(&self) -> Interface {
        self.interface
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
                // The warning that came before has said it all.
                Error::Model(Failure::Discarded(_)) => format!("{call}: discarded"),
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
    /// [`Error::State`] if not, [`Error::Interface`] if no state of the instance's interface
    /// does.
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

    /// `fmi2SetupExperiment`: start and stop time \[s\]. The tolerance has no effect.
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
        self.model.set_time(start);
        self.last_successful_time = start;
        self.stop_time = stop;
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

    /// `fmi2ExitInitializationMode`: starts the model with the values set.
    ///
    /// # Errors
    ///
    /// The model cannot start with them; the instance is then in the error state.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::ExitInitializationMode)?;
        if let Err(failure) = self.model.commit(self.state.phase(), &self.logger) {
            self.state = State::Error;
            return Err(failure.into());
        }
        self.state = match self.interface {
            Interface::ModelExchange => State::EventMode,
            Interface::CoSimulation => State::StepComplete,
        };
        self.last_successful_time = self.model.time();
        self.tell(|model| format!("initialized at t = {} s", model.time()));
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
        self.tell(|_| "terminated".to_owned());
        Ok(())
    }

    /// `fmi2Reset`: back to the state after instantiation, log settings apart.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.allow(Call::Reset)?;
        self.model.reset();
        self.state = State::Instantiated;
        self.last_successful_time = self.model.time();
        self.stop_time = None;
        self.terminated = false;
        self.tell(|_| "reset".to_owned());
        Ok(())
    }

    /// Gives an event to the log, if anyone listens.
    fn tell(&self, message: impl FnOnce(&M) -> String) {
        if self.logger.wants(Category::Events) {
            let message = message(&self.model);
            self.logger.write(Status::Ok, Category::Events, &message);
        }
    }
}
