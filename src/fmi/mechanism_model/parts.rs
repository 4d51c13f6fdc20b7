//! A step in parts, between which the host reads outputs and sets inputs: intermediate update of
//! FMI 3.0 (4.2.1).
//!
//! The path of the step leads from the committed pose to the values in force at its end, as that
//! of a whole step does. Values that the host sets on the way hold from there on: the mechanism
//! goes to them at that time, and the path starts anew.

use super::{Course, MechanismModel};
use crate::dynamics::Told;
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::kinematics::{DriverPath, Path, Progress};

/// A step that is being taken in parts.
#[derive(Debug)]
pub(super) struct Parts {
    /// Time of the end \[s\].
    end: f64,
    /// The path of the values in force, from the time at which they were set to the end.
    path: Path,
    /// Whether values were set at the present time, which the mechanism has not reached yet.
    split: bool,
    /// The model's course before the step, and whether the pose belonged to the values set.
    before: Course,
    told_before: Told,
    was_current: bool,
}

impl MechanismModel {
    /// Begins a step of size `h` to the time `end`.
    pub(super) fn begin_parts(&mut self, h: f64, end: f64, log: &Logger) {
        let was_current = self.note_committed();
        let before = self.course.clone();
        if !self.course.at_committed {
            self.return_to_committed();
        }
        self.course.time = self.start_of_step(h, end);
        self.set_path(self.course.time, h);
        self.report_falls(log);
        self.course.path_progress = Progress::default();
        self.parts = Some(Box::new(Parts {
            end,
            path: self.path.clone(),
            split: false,
            before,
            told_before: self.motion.told.clone(),
            was_current,
        }));
    }

    /// Goes on to `time` and commits the pose there.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if no continuous motion leads there. The mechanism is then at the last
    /// time whose driver values it reached.
    pub(super) fn take_part(&mut self, time: f64, log: &Logger) -> Result<(), Failure> {
        let Some(mut parts) = self.parts.take() else {
            return Ok(());
        };
        let taken = self
            .reach_values_set(&mut parts, log)
            .and_then(|()| self.follow_part(&parts, time, log));
        self.parts = Some(parts);
        taken
    }

    /// Lets values that are set from now on hold from the present time on.
    pub(super) fn split_parts(&mut self, log: &Logger) {
        if let Some(parts) = &mut self.parts {
            parts.split = true;
            let start = parts.path.start;
            self.complete_step(start, self.course.time - start, log);
        }
    }

    /// Ends the step at the present time, at the values set last.
    ///
    /// # Errors
    ///
    /// As [`take_part`](Self::take_part).
    pub(super) fn end_parts(&mut self, log: &Logger) -> Result<(), Failure> {
        let Some(mut parts) = self.parts.take() else {
            return Ok(());
        };
        let ended = self
            .reach_values_set(&mut parts, log)
            .and_then(|()| self.reach_held_values(&parts, log));
        match ended {
            Ok(()) => {
                self.course.progress = self.course.path_progress;
                let start = parts.path.start;
                self.complete_step(start, self.course.time - start, log);
                Ok(())
            }
            Err(failure) => {
                self.parts = Some(parts);
                Err(failure)
            }
        }
    }

    /// Restores the model as it was before the step.
    pub(super) fn abandon_parts(&mut self) {
        let Some(parts) = self.parts.take() else {
            return;
        };
        self.course = parts.before;
        self.motion.told = parts.told_before;
        self.stay_at_committed(parts.was_current);
    }

    /// Goes to the values that the host has set at the present time, and lets the path start there.
    fn reach_values_set(&mut self, parts: &mut Parts, log: &Logger) -> Result<(), Failure> {
        if std::mem::take(&mut parts.split) {
            self.set_path(self.course.time, 0.0);
            self.follow(log)?;
            self.set_driver_rates(self.course.time, 0.0, 0.0);
            self.commit_pose();
            self.set_path(self.course.time, parts.end - self.course.time);
            parts.path.clone_from(&self.path);
        }
        Ok(())
    }

    /// Follows the path of the step to `time`.
    fn follow_part(&mut self, parts: &Parts, time: f64, log: &Logger) -> Result<(), Failure> {
        let whole = &parts.path;
        let to_end = time >= parts.end;
        if to_end && self.course.time.to_bits() == whole.start.to_bits() {
            // The same bits as a step that is taken at once.
            self.path.clone_from(whole);
        } else {
            let end = if to_end {
                1.0
            } else {
                (time - whole.start) / whole.duration
            };
            let start = (self.course.time - whole.start) / whole.duration;
            self.set_part_of_path(whole, start, end);
        }
        let followed = self.follow(log);
        if followed.is_ok() {
            self.advance_forces(self.path.duration);
        }
        // Also after a dead point, whose time may be earlier.
        let reached = match followed {
            Ok(()) => time,
            Err(_) => self.course.time,
        };
        let s = if to_end && followed.is_ok() {
            1.0
        } else {
            (reached - whole.start) / whole.duration
        };
        if followed.is_ok() || self.course.time > self.path.start {
            self.set_driver_rates(whole.start, whole.duration, s);
            self.course.time = if s < 1.0 { reached } else { parts.end };
            self.commit_pose();
        }
        followed
    }

    /// Goes to the values in force at the present time where the step ends before its path does:
    /// held inputs and parameters reach their values at the end of a step.
    fn reach_held_values(&mut self, parts: &Parts, log: &Logger) -> Result<(), Failure> {
        if self.course.time >= parts.end {
            return Ok(());
        }
        let whole = &parts.path;
        let elapsed = self.course.time - whole.start;
        self.path.start = self.course.time;
        self.path.duration = 0.0;
        (self.path.from).copy_from_slice(&self.course.committed.parameters);
        self.path.to.copy_from_slice(&whole.to);
        let driver_paths = self.path.driver_paths.iter_mut().zip(&whole.driver_paths);
        for ((driver_path, whole), now) in driver_paths.zip(&self.course.committed.drivers) {
            if let Some(at) = whole.input_after(elapsed) {
                *driver_path = DriverPath::held(at.value, *now);
            }
        }
        self.follow(log)?;
        self.set_driver_rates(whole.start, whole.duration, elapsed / whole.duration);
        self.commit_pose();
        Ok(())
    }

    /// Sets the path to the part from `s0` to `s1` of a whole one.
    fn set_part_of_path(&mut self, whole: &Path, s0: f64, s1: f64) {
        let path = &mut self.path;
        path.start = self.course.time;
        path.duration = (s1 - s0) * whole.duration;
        path.from.copy_from_slice(&self.course.committed.parameters);
        for ((to, from), end) in path.to.iter_mut().zip(&whole.from).zip(&whole.to) {
            *to = if s1 < 1.0 {
                from + s1 * (end - from)
            } else {
                *end
            };
        }
        self.mechanism.derive_parameters(&mut path.to);
        let driver_paths = path.driver_paths.iter_mut().zip(&whole.driver_paths);
        for ((driver_path, whole_curve), now) in driver_paths.zip(&self.course.committed.drivers) {
            if let (DriverPath::Input { jump, .. }, Some(at)) =
                (*whole_curve, whole_curve.input_after(s0 * whole.duration))
            {
                // The rest of the jump at the end of the part belongs to the part's polynomial.
                let position = at.value + (1.0 - s1) * jump;
                *driver_path = DriverPath::Input {
                    position,
                    velocity: at.first(),
                    acceleration: at.second(),
                    jump: now - position,
                };
            }
        }
    }

    /// Follows the path that is set.
    fn follow(&mut self, log: &Logger) -> Result<(), Failure> {
        if self.motion.free().is_some() {
            let end = self.path.start + self.path.duration;
            return self.follow_free(end, log);
        }
        match self.motion.follow(&self.path) {
            Ok(progress) => {
                self.course.path_progress.add(&progress);
                Ok(())
            }
            Err(blocked) => Err(self.fail_step(&blocked, log)),
        }
    }
}
