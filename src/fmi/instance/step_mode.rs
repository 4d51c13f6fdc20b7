//! Steps and events of co-simulation in FMI 3.0 (4.2).

use super::stepping::time_rounding;
use super::{Error, Failure, Instance, Interface, Version, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, Phase, State};
use crate::fmi::variable::{Causality, place};

/// Agreements between an instance and the host of an FMI 3.0 co-simulation
/// (`fmi3InstantiateCoSimulation`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CoSimulation {
    /// Whether the host handles events.
    pub event_mode_used: bool,
    /// Whether a step may end early.
    pub early_return_allowed: bool,
    /// Whether the host takes calls in intermediate update.
    pub intermediate_update: bool,
    /// Value references of the variables that the host reads or sets in intermediate update.
    pub required_intermediate_variables: Vec<u32>,
}

/// Outcome of a step that has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOutcome {
    /// Whether the host must enter event mode.
    pub event_handling_needed: bool,
    /// Whether the simulation must end.
    pub terminate_simulation: bool,
    /// Whether the step ended before its end.
    pub early_return: bool,
    /// Time that the step reached \[s\].
    pub last_successful_time: f64,
}

/// Progress of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepProgress {
    /// The host may read outputs, then set inputs, and goes on with
    /// [`resume_step`](Instance::resume_step).
    Intermediate {
        /// Time of the point \[s\].
        time: f64,
        /// Whether the host may ask for an early return.
        can_return_early: bool,
    },
    /// The step has ended.
    Done(StepOutcome),
}

/// A step that has called back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PendingStep {
    start: f64,
    size: f64,
    end: f64,
    /// Time at which the host wants the step to end.
    stop: f64,
    /// Points that the step has passed.
    points: u32,
    /// Whether values had been set since the step before.
    values_set: bool,
}

/// Points of intermediate update per step, the last one at its end: with the start, enough for a
/// host's polynomial of order 4 in time.
const POINTS: u32 = 4;

impl<M: Model> Instance<M> {
    /// Makes the agreements of `fmi3InstantiateCoSimulation`.
    ///
    /// # Errors
    ///
    /// A required intermediate variable is no continuous input or output.
    pub fn agree(&mut self, co_simulation: CoSimulation) -> Result<(), Error> {
        let mut intermediate = vec![false; self.variables().len()];
        for &value_reference in &co_simulation.required_intermediate_variables {
            let variable = self.variable(value_reference)?;
            let crosses = variable.causality == Causality::Input || variable.causality.is_output();
            if !(crosses && variable.kind.is_real()) {
                let name = variable.name.clone();
                return Err(Error::NotIntermediate { name });
            }
            intermediate[place(value_reference)] = true;
        }
        self.intermediate = intermediate.into();
        let wants_events = co_simulation.event_mode_used && co_simulation.early_return_allowed;
        self.model.end_steps_at_events(wants_events);
        self.co_simulation = co_simulation;
        Ok(())
    }

    /// Returns whether the instance ever is in event mode.
    pub(super) fn has_event_mode(&self) -> bool {
        match (self.version, self.interface) {
            (Version::Fmi3, Interface::CoSimulation) => self.co_simulation.event_mode_used,
            _ => true,
        }
    }

    /// `fmi3EnterEventMode` in co-simulation.
    pub(super) fn enter_event(&mut self) -> Result<(), Error> {
        if !self.has_event_mode() {
            let why = "the host does not use event mode in this instance";
            return Err(Error::NotProvided { why });
        }
        self.lifecycle.set_since_step = false;
        self.lifecycle.state = State::EventMode;
        Ok(())
    }

    /// `fmi3EnterStepMode`: commits values that have jumped.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if no pose exists for them.
    pub fn enter_step_mode(&mut self) -> Result<(), Error> {
        self.allow(Call::EnterStepMode)?;
        self.model
            .commit(Phase::Event, &self.logger)
            .map_err(|failure| self.failed(Call::EnterStepMode, failure))?;
        self.lifecycle.state = State::StepMode;
        Ok(())
    }

    /// `fmi3DoStep`: begins a step from the last communication point over `h` seconds. Without
    /// intermediate update the step has ended then.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if the model cannot reach the end and the host permits no early
    /// return; the instance is then as before the call.
    pub fn begin_step(&mut self, communication_point: f64, h: f64) -> Result<StepProgress, Error> {
        self.allow(Call::DoStep)?;
        self.check_step(communication_point, h)?;
        let end = communication_point + h;
        if M::CAPABILITIES.intermediate_update && self.co_simulation.intermediate_update {
            self.model.begin_step(h, end, &self.logger);
            self.pending_step = Some(PendingStep {
                start: communication_point,
                size: h,
                end,
                stop: end,
                points: 0,
                values_set: self.lifecycle.set_since_step,
            });
            return self.next_part();
        }
        let stays = !self.co_simulation.early_return_allowed;
        match self.model.step(h, end, stays, &self.logger) {
            Ok(()) => Ok(StepProgress::Done(self.step_ended(false))),
            Err(failure) => self.step_failed(communication_point, h, failure),
        }
    }

    /// Goes on with a step after the host has returned from intermediate update; `early_return` is
    /// the time at which the host wants it to end.
    ///
    /// # Errors
    ///
    /// As [`begin_step`](Self::begin_step); or a call in between has failed.
    pub fn resume_step(&mut self, early_return: Option<f64>) -> Result<StepProgress, Error> {
        let Some(step) = self.pending_step.as_mut() else {
            return Err(Error::StepAborted);
        };
        self.lifecycle.state = State::StepMode;
        if let Some(time) = early_return
            && self.co_simulation.early_return_allowed
        {
            let checked = check_finite("earlyReturnTime", time);
            if let Err(error) = checked {
                self.abandon_step();
                return Err(error);
            }
            let (now, end) = (self.model.time(), step.end);
            let rounding = time_rounding(end, step.size);
            step.stop = if time > end - rounding {
                end
            } else if time < now + rounding {
                now
            } else {
                time
            };
        }
        self.next_part()
    }

    /// Goes on to the next point of intermediate update, or ends the step.
    fn next_part(&mut self) -> Result<StepProgress, Error> {
        let points = self.points();
        let Some(step) = self.pending_step.as_mut() else {
            return Err(Error::StepAborted);
        };
        let PendingStep {
            start,
            size,
            end,
            stop,
            ..
        } = *step;
        step.points += 1;
        let next = if step.points < points {
            start + size * f64::from(step.points) / f64::from(points)
        } else {
            end
        };
        let reached = self.model.time();
        let early = stop < end;
        if reached < stop {
            let target = next.min(stop);
            if let Err(failure) = self.model.advance(target, &self.logger) {
                return self.step_failed(start, size, failure);
            }
            if target < stop || !early {
                self.lifecycle.set_since_step = false;
                self.lifecycle.state = State::IntermediateUpdateMode;
                return Ok(StepProgress::Intermediate {
                    time: target,
                    can_return_early: self.co_simulation.early_return_allowed,
                });
            }
        }
        if let Err(failure) = self.model.end_step(&self.logger) {
            return self.step_failed(start, size, failure);
        }
        self.pending_step = None;
        Ok(StepProgress::Done(self.step_ended(early)))
    }

    /// Returns the number of points of intermediate update per step. A host that uses none of them
    /// gets the end alone, and so the same bits as without intermediate update.
    fn points(&self) -> u32 {
        let wishes = &self.co_simulation;
        if wishes.required_intermediate_variables.is_empty() && !wishes.early_return_allowed {
            1
        } else {
            POINTS
        }
    }

    /// Ends a step that has reached its end, or the time at which the host wanted it to end.
    fn step_ended(&mut self, early_return: bool) -> StepOutcome {
        self.lifecycle.set_since_step = false;
        self.lifecycle.at_dead_point = false;
        self.lifecycle.last_successful_time = self.model.time();
        StepOutcome {
            event_handling_needed: false,
            terminate_simulation: false,
            early_return,
            last_successful_time: self.lifecycle.last_successful_time,
        }
    }

    /// Ends a step that the model did not end. At an event the host goes on from there. Where the host permits an early return, the step
    /// ends at the dead point; otherwise the instance is as before the step.
    #[cold]
    fn step_failed(&mut self, start: f64, h: f64, failure: Failure) -> Result<StepProgress, Error> {
        let reason = match failure {
            Failure::Event => {
                if self.pending_step.is_some()
                    && let Err(failure) = self.model.end_step(&self.logger)
                {
                    return self.step_failed(start, h, failure);
                }
                self.pending_step = None;
                return Ok(StepProgress::Done(StepOutcome {
                    event_handling_needed: true,
                    ..self.step_ended(true)
                }));
            }
            Failure::Discarded(reason) if self.co_simulation.early_return_allowed => reason,
            failure => {
                self.abandon_step();
                return Err(self.failed(Call::DoStep, failure));
            }
        };
        self.pending_step = None;
        self.model.meet_dead_point();
        let mut time = self.model.time();
        let progressed = self.has_progressed(start, h);
        let was_at_dead_point = std::mem::replace(&mut self.lifecycle.at_dead_point, true);
        if was_at_dead_point && !progressed {
            // The pose went the rest of its way to the same dead point.
            time = start;
        }
        let event_mode_used = self.co_simulation.event_mode_used;
        self.logger.warn(&format!("fmi3DoStep: {reason}"));
        self.lifecycle.set_since_step = false;
        self.lifecycle.last_successful_time = time;
        Ok(StepProgress::Done(StepOutcome {
            event_handling_needed: event_mode_used,
            terminate_simulation: !event_mode_used || was_at_dead_point && !progressed,
            early_return: true,
            last_successful_time: time,
        }))
    }

    /// Restores the model as it was before the pending step, if there is one.
    pub(super) fn abandon_step(&mut self) {
        if let Some(step) = self.pending_step.take() {
            self.model.abandon_step();
            self.lifecycle.set_since_step = step.values_set;
        }
    }

    /// Checks that variables are among the required intermediate ones.
    pub(super) fn check_intermediate(&self, value_references: &[u32]) -> Result<(), Error> {
        for &value_reference in value_references {
            if self.intermediate.get(place(value_reference)) != Some(&true) {
                let name = self.variable(value_reference)?.name.clone();
                return Err(Error::NotIntermediate { name });
            }
        }
        Ok(())
    }

    /// Notes that values are being set.
    pub(super) fn note_values_set(&mut self, value_references: &[u32]) {
        if value_references.is_empty() {
            return;
        }
        match self.lifecycle.state {
            State::IntermediateUpdateMode if !self.lifecycle.set_since_step => {
                self.lifecycle.set_since_step = true;
                self.model.split_step(&self.logger);
            }
            State::StepMode => self.lifecycle.set_since_step = true,
            _ => {}
        }
    }

    /// Checks that variables can be read in the present state: before initialization mode those
    /// with start values, in step mode computed ones only if nothing was set since the last step,
    /// in intermediate update the required ones, before any is set.
    pub(super) fn check_readable(&self, value_references: &[u32]) -> Result<(), Error> {
        match self.lifecycle.state {
            State::Instantiated => {
                let has_start = |c| {
                    matches!(
                        c,
                        Causality::Parameter
                            | Causality::Input
                            | Causality::StartedOutput
                            | Causality::State
                    )
                };
                self.refuse(
                    value_references,
                    |c| !has_start(c),
                    |name| Error::NoStart { name },
                )
            }
            State::StepMode if self.lifecycle.set_since_step => {
                let is_computed = |c: Causality| {
                    c.is_output()
                        || matches!(
                            c,
                            Causality::Local | Causality::LocalState | Causality::EventIndicator
                        )
                };
                self.refuse(value_references, is_computed, |name| Error::NotStepped {
                    name,
                })
            }
            State::IntermediateUpdateMode
                if self.lifecycle.set_since_step && !value_references.is_empty() =>
            {
                Err(Error::ReadAfterSet)
            }
            State::IntermediateUpdateMode => self.check_intermediate(value_references),
            _ => Ok(()),
        }
    }

    /// Refuses variables of some causalities.
    fn refuse(
        &self,
        value_references: &[u32],
        is_refused: impl Fn(Causality) -> bool,
        error: fn(String) -> Error,
    ) -> Result<(), Error> {
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if is_refused(variable.causality) {
                return Err(error(variable.name.clone()));
            }
        }
        Ok(())
    }
}
