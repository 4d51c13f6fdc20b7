//! Model exchange.

use super::{Category, Error, Failure, Instance, Status, check_finite};
use crate::fmi::model::{Model, StateChange};
use crate::fmi::state::{Call, Interface, State, Version};
use crate::mechanism::show_time;

/// A model's answer at an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EventResult {
    /// The simulation must end, since the point does not exist.
    pub must_end: bool,
    /// The effect on the continuous states.
    pub states: StateChange,
}

/// A model's answer at the end of an integrator's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompletedStep {
    /// An event follows.
    pub has_event: bool,
    /// The simulation must end, since the point does not exist.
    pub must_end: bool,
}

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
        self.lifecycle.state = State::EventMode;
        Ok(())
    }

    /// `fmi2NewDiscreteStates`, `fmi3UpdateDiscreteStates`: none needs another update. Commits values that
    /// jump between two steps of co-simulation; lets the continuous states jump in model exchange.
    ///
    /// # Errors
    ///
    /// The state forbids the call, the time is beyond the stop time, or the model failed.
    pub fn new_discrete_states(&mut self) -> Result<EventResult, Error> {
        self.allow(Call::NewDiscreteStates)?;
        let is_hosted = self.interface == Interface::ModelExchange;
        if self.lifecycle.terminated || !is_hosted || !self.states.is_empty() {
            self.commit(Call::NewDiscreteStates)?;
        }
        let must_end = self.lifecycle.terminated;
        let changed = if is_hosted && !must_end {
            self.model.change_states(&self.logger)
        } else {
            Ok(StateChange::None)
        };
        let states = changed.map_err(|failure| self.failed(Call::NewDiscreteStates, failure))?;
        Ok(EventResult { must_end, states })
    }

    /// `fmi2EnterContinuousTimeMode`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterContinuousTimeMode)?;
        self.lifecycle.state = State::ContinuousTimeMode;
        Ok(())
    }

    /// `fmi2CompletedIntegratorStep`, `fmi3CompletedIntegratorStep`: commits the model's present point.
    ///
    /// # Errors
    ///
    /// The state forbids the call, the time is beyond the stop time, or the model failed.
    pub fn completed_integrator_step(&mut self) -> Result<CompletedStep, Error> {
        self.allow(Call::CompletedIntegratorStep)?;
        self.commit(Call::CompletedIntegratorStep)?;
        let must_end = self.lifecycle.terminated;
        Ok(CompletedStep {
            has_event: !must_end && self.model.wants_event(),
            must_end,
        })
    }

    /// Commits the model's present point. If none exists the simulation must end: the standard
    /// permits no discard here (2.1.3). Refuses a point beyond the stop time (2.1.6).
    fn commit(&mut self, call: Call) -> Result<(), Error> {
        let time = self.model.time();
        // An accepted point stays accepted at its events.
        let h = time - self.lifecycle.last_successful_time;
        if h > 0.0
            && let Some(stop) = self.passed_stop_time(time, h)
        {
            return Err(Error::Time {
                message: format!("the time {time} s is beyond the stop time {stop} s"),
            });
        }
        let phase = self.lifecycle.state.phase(self.interface);
        match self.model.commit(phase, &self.logger) {
            Ok(()) => {
                self.lifecycle.last_successful_time = self.model.time();
                self.lifecycle.terminated = false;
                Ok(())
            }
            Err(Failure::Discarded(reason)) => {
                let time = show_time(time);
                let message = format!("t = {time} s: the simulation must end: {reason}");
                match self.version {
                    Version::Fmi2 => self.logger.write(Status::Error, Category::Error, &message),
                    Version::Fmi3 => self.logger.warn(&message),
                }
                self.lifecycle.terminated = true;
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

    /// `fmi3GetNumberOfEventIndicators`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn number_of_event_indicators(&self) -> Result<usize, Error> {
        self.allow(Call::GetNumberOfEventIndicators)?;
        Ok(self.event_indicators.len())
    }

    /// `fmi2GetEventIndicators`, `fmi3GetEventIndicators`: returns the values of all event indicators,
    /// for a host that asks for `count`.
    ///
    /// # Errors
    ///
    /// There is another number of them; or they have no value.
    pub fn event_indicators(&mut self, count: usize) -> Result<impl Iterator<Item = f64>, Error> {
        self.allow(Call::GetEventIndicators)?;
        check_count(count, self.event_indicators.len())?;
        let all = self.event_indicators.iter();
        let groups = all.fold(0, |groups, place| groups | self.groups[*place]);
        self.refresh(Call::GetEventIndicators, groups)?;
        let reals = self.model.reals();
        Ok(self.event_indicators.iter().map(|place| reals[*place]))
    }

    /// `fmi3GetNumberOfContinuousStates`.
    ///
    /// # Errors
    ///
    /// The state forbids the call.
    pub fn number_of_states(&self) -> Result<usize, Error> {
        self.allow(Call::GetNumberOfContinuousStates)?;
        Ok(self.states.len())
    }

    /// `fmi2SetContinuousStates`, `fmi3SetContinuousStates`: sets all states or none.
    ///
    /// # Errors
    ///
    /// There is another number of states, or a value is not finite.
    pub fn set_continuous_states(&mut self, values: &[f64]) -> Result<(), Error> {
        self.allow(Call::SetContinuousStates)?;
        check_count(values.len(), self.states.len())?;
        for (place, value) in self.states.iter().zip(values) {
            check_finite(&self.model.variables()[*place].name, *value)?;
        }
        let Self {
            model,
            states,
            quantities,
            ..
        } = self;
        let places = states.iter().zip(values);
        model.set_reals(places.map(|(place, value)| (quantities[*place], *value)));
        Ok(())
    }

    /// `fmi2GetContinuousStates`, `fmi3GetContinuousStates`: returns the values of all states, for a
    /// host that asks for `count`.
    ///
    /// # Errors
    ///
    /// There is another number of states; or they have no value.
    pub fn continuous_states(&mut self, count: usize) -> Result<impl Iterator<Item = f64>, Error> {
        self.allow(Call::GetContinuousStates)?;
        self.of_states(Call::GetContinuousStates, count, |_, state| state)
    }

    /// `fmi2GetDerivatives`, `fmi3GetContinuousStateDerivatives`: returns the time derivatives of all
    /// states, for a host that asks for `count`.
    ///
    /// # Errors
    ///
    /// There is another number of states; or the derivatives do not exist.
    pub fn derivatives_of_states(
        &mut self,
        count: usize,
    ) -> Result<impl Iterator<Item = f64>, Error> {
        self.allow(Call::GetDerivatives)?;
        self.of_states(Call::GetDerivatives, count, |instance, state| {
            instance.derivatives[state].expect("a state has a derivative")
        })
    }

    /// `fmi2GetNominalsOfContinuousStates`, `fmi3GetNominalsOfContinuousStates`: returns the usual
    /// magnitude of each state, for a host that asks for `count`.
    ///
    /// # Errors
    ///
    /// There is another number of states.
    pub fn nominals(&self, count: usize) -> Result<impl Iterator<Item = f64>, Error> {
        self.allow(Call::GetNominalsOfContinuousStates)?;
        check_count(count, self.states.len())?;
        let states = self.states.iter();
        Ok(states.map(|place| self.model.nominal(self.quantities[*place])))
    }

    /// Returns a Real for each state, at the place that `real` returns for that of the state.
    fn of_states(
        &mut self,
        call: Call,
        count: usize,
        real: impl Fn(&Self, usize) -> usize,
    ) -> Result<impl Iterator<Item = f64>, Error> {
        check_count(count, self.states.len())?;
        let places = self.states.iter().map(|state| real(self, *state));
        let groups = places.fold(0, |groups, place| groups | self.groups[place]);
        self.refresh(call, groups)?;
        let instance = &*self;
        let states = instance.states.iter();
        Ok(states.map(move |state| instance.model.reals()[real(instance, *state)]))
    }
}

/// Checks the number of values that a host gives or asks for.
fn check_count(given: usize, expected: usize) -> Result<(), Error> {
    if given == expected {
        Ok(())
    } else {
        Err(Error::Continuous { given, expected })
    }
}
