//! Model exchange for models without continuous states and event indicators.

use super::{Error, Instance, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, State};

impl<M: Model> Instance<M> {
    /// `fmi2EnterEventMode`: commits the model's present point.
    ///
    /// # Errors
    ///
    /// The model does not exist for the values set; nothing changes.
    pub fn enter_event_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterEventMode)?;
        self.commit()?;
        self.state = State::EventMode;
        Ok(())
    }

    /// `fmi2NewDiscreteStates`: the model has none.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn new_discrete_states(&self) -> Result<(), Error> {
        self.allow(Call::NewDiscreteStates)
    }

    /// `fmi2EnterContinuousTimeMode`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterContinuousTimeMode)?;
        self.state = State::ContinuousTimeMode;
        Ok(())
    }

    /// `fmi2CompletedIntegratorStep`: commits the model's present point. Neither an event nor the
    /// end of the simulation follows.
    ///
    /// # Errors
    ///
    /// The model does not exist for the values set; nothing changes.
    pub fn completed_integrator_step(&mut self) -> Result<(), Error> {
        self.allow(Call::CompletedIntegratorStep)?;
        self.commit()
    }

    fn commit(&mut self) -> Result<(), Error> {
        self.model.commit(self.state.phase(), &self.logger)?;
        self.last_successful_time = self.model.time();
        Ok(())
    }

    /// `fmi2SetTime` \[s\]. Times beyond the stop time are legal: solvers look ahead.
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

    /// A function of continuous states or event indicators, for `count` values.
    ///
    /// # Errors
    ///
    /// `count` is not zero: the model has none.
    pub fn continuous(&self, call: Call, count: usize) -> Result<(), Error> {
        self.allow(call)?;
        if count == 0 {
            Ok(())
        } else {
            Err(Error::Continuous { call, given: count })
        }
    }
}
