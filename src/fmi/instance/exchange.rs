//! Model exchange, for models without continuous states and event indicators.

use super::{Error, Instance, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, State};

impl<M: Model> Instance<M> {
    /// `fmi2EnterEventMode`: what the model has come to is what it goes on from.
    ///
    /// # Errors
    ///
    /// The model has no values for what was set; nothing is changed then.
    pub fn enter_event_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterEventMode)?;
        self.commit()?;
        self.state = State::EventMode;
        Ok(())
    }

    /// `fmi2NewDiscreteStates`: there are none, so that nothing is ever left to be done.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn new_discrete_states(&self) -> Result<(), Error> {
        self.allow(Call::NewDiscreteStates)
    }

    /// `fmi2EnterContinuousTimeMode`.
    ///
    /// # Errors
    ///
    /// The state does not allow it.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterContinuousTimeMode)?;
        self.state = State::ContinuousTimeMode;
        Ok(())
    }

    /// `fmi2CompletedIntegratorStep`: what the model has come to is what it goes on from. No
    /// event and no termination follows.
    ///
    /// # Errors
    ///
    /// The model has no values for what was set; nothing is changed then.
    pub fn completed_integrator_step(&mut self) -> Result<(), Error> {
        self.allow(Call::CompletedIntegratorStep)?;
        self.commit()
    }

    fn commit(&mut self) -> Result<(), Error> {
        self.model.commit(self.state.phase(), &self.logger)?;
        self.last_successful_time = self.model.time();
        Ok(())
    }

    /// `fmi2SetTime` \[s\]. A time beyond the stop time is taken: solvers look ahead.
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

    /// The functions of continuous states and event indicators: right for none of them.
    ///
    /// # Errors
    ///
    /// `count` is not zero.
    pub fn continuous(&self, call: Call, count: usize) -> Result<(), Error> {
        self.allow(call)?;
        if count == 0 {
            Ok(())
        } else {
            Err(Error::Continuous { call, given: count })
        }
    }
}
