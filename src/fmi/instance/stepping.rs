//! Co-simulation in FMI 2.0: steps and their outcome.

use super::{Error, Failure, Instance, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, State};
use crate::fmi::status::Status;

/// Roundings of a time within which two times are one: a host that multiplies makes two per point, and
/// the sum of point and step size is rounded too.
const TIME_ROUNDINGS: f64 = 4.0;
/// Part of a step within which two times are one: some hosts count time in nanoseconds.
const PART_OF_STEP: f64 = 1e-6;
/// Part of a step within which a dead point is located.
const LOCATED: f64 = 1e-9;

/// Returns the difference within which two times of an experiment near `time`, with steps of size `h`,
/// are one.
pub(super) fn time_rounding(time: f64, h: f64) -> f64 {
    (TIME_ROUNDINGS * f64::EPSILON * time.abs()).max(PART_OF_STEP * h)
}

impl<M: Model> Instance<M> {
    /// `fmi2DoStep`: steps from the last communication point over `h` seconds.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] leaves the instance in state `stepFailed`, at the last time that the
    /// model reached. Any other error changes nothing.
    pub fn do_step(&mut self, communication_point: f64, h: f64) -> Result<(), Error> {
        self.allow(Call::DoStep)?;
        self.check_step(communication_point, h)?;
        let end = communication_point + h;
        let stepped = self.model.step(h, end, false, &self.logger);
        self.lifecycle.last_successful_time = self.model.time();
        match stepped {
            Ok(()) => {
                self.state_held = false;
                Ok(())
            }
            Err(failure) => Err(self.fail_step(communication_point, h, failure)),
        }
    }

    /// Decides whether a host should end after a discarded step, or may retry a shorter one: it may
    /// if it can go back to the start of the step, and a shorter step would lead further.
    #[cold]
    fn fail_step(&mut self, communication_point: f64, h: f64, failure: Failure) -> Error {
        if let Failure::Discarded(_) = failure {
            let progressed = self.has_progressed(communication_point, h);
            self.lifecycle.state = State::StepFailed;
            self.lifecycle.discarded = true;
            self.lifecycle.terminated = !(progressed && self.state_held);
        }
        self.failed(Call::DoStep, failure)
    }

    /// Returns whether the model has left the start of a step of size `h`.
    pub(super) fn has_progressed(&self, start: f64, h: f64) -> bool {
        let rounding = time_rounding(start, 0.0).max(LOCATED * h);
        self.model.time() > start + rounding
    }

    /// Returns the stop time if a step of size `h` to `time` passes it by more than rounding.
    #[inline(always)]
    pub(super) fn passed_stop_time(&self, time: f64, h: f64) -> Option<f64> {
        let passed = |stop: &f64| time > *stop && time - *stop > self.summed_rounding(time, h);
        self.lifecycle.stop_time.filter(passed)
    }

    /// Returns the rounding of the time of a host that adds up steps of size `h`: up to half a rounding
    /// of the time per step. A step that passes the stop time by half of itself passes it anyway.
    #[cold]
    fn summed_rounding(&self, time: f64, h: f64) -> f64 {
        let steps = (time - self.lifecycle.start_time) / h;
        let summed = 0.5 * f64::EPSILON * time.abs() * steps;
        time_rounding(time, h).max(summed.min(0.5 * h))
    }

    /// Checks that a step starts where the last one has ended, and passes no stop time. The step then
    /// starts at the host's point, so that its rounding does not add up.
    #[inline(always)]
    pub(super) fn check_step(&self, communication_point: f64, h: f64) -> Result<(), Error> {
        check_finite("currentCommunicationPoint", communication_point)?;
        check_finite("communicationStepSize", h)?;
        let refuse = |message: String| Err(Error::Time { message });
        if h <= 0.0 {
            return refuse(format!("the step size {h} s is not positive"));
        }
        let time = self.model.time();
        let (end, rounding) = (communication_point + h, time_rounding(time, h));
        if (communication_point - time).abs() > rounding || end < time {
            return refuse(format!(
                "the communication point {communication_point} s is not where the last step \
                 ended, {time} s"
            ));
        }
        match self.passed_stop_time(end, h) {
            Some(stop) => refuse(format!(
                "the step from {communication_point} s over {h} s passes the stop time {stop} s"
            )),
            None => Ok(()),
        }
    }

    /// `fmi2GetStatus` of `fmi2DoStepStatus`: status of the last step.
    #[must_use]
    pub fn step_status(&self) -> Status {
        if self.lifecycle.discarded {
            Status::Discard
        } else {
            Status::Ok
        }
    }

    /// `fmi2GetRealStatus` of `fmi2LastSuccessfulTime` \[s\]: the last time that the model reached.
    #[must_use]
    pub fn last_successful_time(&self) -> f64 {
        self.lifecycle.last_successful_time
    }

    /// `fmi2GetBooleanStatus` of `fmi2Terminated`: whether the simulation must end. False after a
    /// discarded step that a host with an FMU state of its start can repeat with a smaller size.
    #[must_use]
    pub fn is_terminated(&self) -> bool {
        self.lifecycle.terminated
    }
}
