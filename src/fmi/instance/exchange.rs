//! Model exchange for models without continuous states and event indicators.

use super::{Category, Error, Failure, Instance, Status, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, Interface, State, Version};
use crate::mechanism::show_time;

impl<M: Model> Instance<M> {
    /// `fmi2EnterEventMode`, `fmi3EnterEventMode`: commits the model's present point in model
    /// exchange. If none exists, [`new_discrete_states`](Self::new_discrete_states) ends the
    /// simulation.
    ///
    /// # Errors
    ///
    /// The state forbids the call, the time is beyond the stop time, or the model failed.
    pub fn enter_event_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterEventMode)?;
        if self.interface == Interface::CoSimulation {
            return self.enter_event();
        }
        self.commit(Call::EnterEventMode)?;
        self.model.update_discrete();
        self.course.state = State::EventMode;
        Ok(())
    }

    /// `fmi2NewDiscreteStates`, `fmi3UpdateDiscreteStates`: the model has none. Commits values that
    /// jump between two steps of co-simulation. Returns whether the simulation must end.
    ///
    /// # Errors
    ///
    /// The state forbids the call, the time is beyond the stop time, or the model failed.
    pub fn new_discrete_states(&mut self) -> Result<bool, Error> {
        self.allow(Call::NewDiscreteStates)?;
        if self.course.terminated || self.interface == Interface::CoSimulation {
            self.commit(Call::NewDiscreteStates)?;
        }
        Ok(self.course.terminated)
    }

    /// `fmi2EnterContinuousTimeMode`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterContinuousTimeMode)?;
        self.course.state = State::ContinuousTimeMode;
        Ok(())
    }

    /// `fmi2CompletedIntegratorStep`: commits the model's present point. No event follows. Returns
    /// whether the simulation must end, since no such point exists.
    ///
    /// # Errors
    ///
    /// The state forbids the call, the time is beyond the stop time, or the model failed.
    pub fn completed_integrator_step(&mut self) -> Result<bool, Error> {
        self.allow(Call::CompletedIntegratorStep)?;
        self.commit(Call::CompletedIntegratorStep)?;
        Ok(self.course.terminated)
    }

    /// Commits the model's present point. If none exists the simulation must end: the standard
    /// permits no discard here (2.1.3). Refuses a point beyond the stop time (2.1.6).
    fn commit(&mut self, call: Call) -> Result<(), Error> {
        let time = self.model.time();
        // An accepted point stays accepted at its events.
        let h = time - self.course.last_successful_time;
        if h > 0.0
            && let Some(stop) = self.passed_stop_time(time, h)
        {
            return Err(Error::Time {
                message: format!("the time {time} s is beyond the stop time {stop} s"),
            });
        }
        let phase = self.course.state.phase(self.interface);
        match self.model.commit(phase, &self.logger) {
            Ok(()) => {
                self.course.last_successful_time = self.model.time();
                self.course.terminated = false;
                Ok(())
            }
            Err(Failure::Discarded(reason)) => {
                let time = show_time(time);
                let message = format!("t = {time} s: the simulation must end: {reason}");
                match self.version {
                    Version::Fmi2 => self.logger.write(Status::Error, Category::Error, &message),
                    Version::Fmi3 => self.logger.warn(&message),
                }
                self.course.terminated = true;
                Ok(())
            }
            Err(failure) => Err(self.failed(call, failure)),
        }
    }

    /// `fmi2SetTime` \[s\]. Times beyond the stop time are legal in trials: solvers look ahead, that
    /// of FMPy among them.
    ///
    /// # Errors
    ///
    /// The time is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), Error> {
        self.allow(Call::SetTime)?;
        check_finite("time", time)?;
        self.model.set_time(time);
        Ok(())
    }

    /// Answers a function of continuous states or event indicators, for `count` values.
    ///
    /// # Errors
    ///
    /// `count` is not zero: the model has none.
    pub fn continuous(&self, call: Call, count: usize) -> Result<(), Error> {
        self.allow(call)?;
        if count == 0 {
            Ok(())
        } else {
            Err(Error::Continuous { given: count })
        }
    }
}
