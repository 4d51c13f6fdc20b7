//! Co-simulation in FMI 2.0: steps and their outcome.

use super::{Error, Failure, Instance, check_finite};
use crate::fmi::model::Model;
use crate::fmi::state::{Call, State};
use crate::fmi::status::Status;

/// Tolerance of communication points, relative to the larger of time and step: hosts add up step
/// sizes.
pub(super) const TIME_ROUNDING: f64 = 1e-9;

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
        self.course.last_successful_time = self.model.time();
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
            let rounding = TIME_ROUNDING * communication_point.abs().max(h);
            let progressed = self.course.last_successful_time > communication_point + rounding;
            self.course.state = State::StepFailed;
            self.course.discarded = true;
            self.course.terminated = !(progressed && self.state_held);
        }
        self.failed(Call::DoStep, failure)
    }

    /// Checks that a step starts where the last one has ended, and passes no stop time.
    #[inline(always)]
    pub(super) fn check_step(&self, communication_point: f64, h: f64) -> Result<(), Error> {
        check_finite("currentCommunicationPoint", communication_point)?;
        check_finite("communicationStepSize", h)?;
        let refuse = |message: String| Err(Error::Time { message });
        if h <= 0.0 {
            return refuse(format!("the step size {h} s is not positive"));
        }
        let time = self.model.time();
        let rounding = TIME_ROUNDING * time.abs().max(h);
        let is_behind = communication_point + h < time;
        if (communication_point - time).abs() > rounding || is_behind {
            return refuse(format!(
                "the communication point {communication_point} s is not where the last step \
                 ended, {time} s"
            ));
        }
        match self.course.stop_time {
            Some(stop) if communication_point + h > stop + rounding => refuse(format!(
                "the step from {communication_point} s over {h} s passes the stop time {stop} s"
            )),
            _ => Ok(()),
        }
    }

    /// `fmi2GetStatus` of `fmi2DoStepStatus`: status of the last step.
    #[must_use]
    pub fn step_status(&self) -> Status {
        if self.course.discarded {
            Status::Discard
        } else {
            Status::Ok
        }
    }

    /// `fmi2GetRealStatus` of `fmi2LastSuccessfulTime` \[s\]: the last time that the model reached.
    #[must_use]
    pub fn last_successful_time(&self) -> f64 {
        self.course.last_successful_time
    }

    /// `fmi2GetBooleanStatus` of `fmi2Terminated`: whether the simulation must end. False after a
    /// discarded step that a host with an FMU state of its start can repeat with a smaller size.
    #[must_use]
    pub fn is_terminated(&self) -> bool {
        self.course.terminated
    }
}
