//! The motion of freedoms: in co-simulation the model integrates, in model exchange the host.
//!
//! Values and velocities of freedoms stand among the inputs of their drivers, as if the host gave
//! them; in model exchange it does.

use super::force_input::ForceInput;
use super::input::DriverInput;
use super::{Course, MechanismModel, failed, without_value};
use crate::dynamics::{FreeMotion, Given, GivenByPath, Stop};
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::kinematics::Path;
use crate::mechanism::{DriverId, Order};

/// Returns the inputs in force during a step, or a part of one.
fn given<'a>(path: &'a Path, forces: &'a [ForceInput]) -> impl Given + Copy + 'a {
    GivenByPath {
        path,
        load: |input: usize, tau| forces[input].after(tau),
    }
}

impl MechanismModel {
    /// Takes a step to `end` on the path that is set, by integration. `stayed` says for a step that is
    /// all or nothing whether the pose belonged to the values set.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if the motion cannot go on: the mechanism is then where the integrator
    /// has left it, or as before.
    #[inline(never)]
    pub(super) fn take_free_step(
        &mut self,
        end: f64,
        stayed: Option<bool>,
        log: &Logger,
    ) -> Result<(), Failure> {
        let start = self.path.start;
        let h = self.path.duration;
        let before = std::mem::take(&mut self.course.path_progress);
        let followed = self.integrate(end, stayed.is_some(), log);
        if stayed.is_none() || followed.is_ok() {
            self.course.progress = self.course.path_progress;
        }
        match (followed, stayed) {
            (Err(Failure::Event), _) => {
                self.stop_free(start, h);
                self.complete_step(start, self.course.time - start, log);
                Err(Failure::Event)
            }
            (Ok(()), _) => {
                self.set_driver_rates(start, h, 1.0);
                self.advance_forces(h);
                self.course.time = end;
                self.commit_pose();
                self.complete_step(start, h, log);
                Ok(())
            }
            (Err(failure), Some(was_current)) => {
                self.course.path_progress = before;
                self.stay_at_committed(was_current);
                Err(failure)
            }
            (Err(failure), None) => {
                self.stop_free(start, h);
                Err(failure)
            }
        }
    }

    /// Follows the path that is set to the time `end`, by integration.
    ///
    /// # Errors
    ///
    /// As [`take_free_step`](Self::take_free_step).
    pub(super) fn follow_free(&mut self, end: f64, log: &Logger) -> Result<(), Failure> {
        let (start, h) = (self.path.start, self.path.duration);
        let followed = self.integrate(end, false, log);
        if followed.is_err() {
            self.stop_free(start, h);
        }
        followed
    }

    /// Commits the pose at which the integrator has stopped.
    fn stop_free(&mut self, start: f64, h: f64) {
        let time = self.motion.solver.pose().time;
        let s = if h > 0.0 { (time - start) / h } else { 0.0 };
        self.set_driver_rates(start, h, s);
        self.advance_forces(time - start);
        self.course.time = time;
        self.commit_pose();
    }

    /// Moves the mechanism to the time `end`, and notes the values of its freedoms there; with `stays` only
    /// if it can.
    fn integrate(&mut self, end: f64, stays: bool, log: &Logger) -> Result<(), Failure> {
        let Self {
            motion,
            path,
            course,
            ..
        } = self;
        let Some(state) = &mut course.free else {
            return Ok(());
        };
        let given = given(path, &course.force_inputs);
        let steps = state.integrator.statistics.accepted;
        let resumed = motion.resume_free(state).map_err(Stop::Free);
        let moved = resumed.and_then(|()| motion.advance(path, &given, end));
        let moved = moved.map_err(|stop| self.describe_stop(&stop));
        if stays && let Err(why) = moved {
            self.motion.happenings().for_each(drop);
            return Err(Failure::Discarded(why));
        }
        self.save_free();
        let Some(state) = &self.course.free else {
            return Ok(());
        };
        let reached = state.integrator.t;
        let taken = state.integrator.statistics.accepted.wrapping_sub(steps);
        let progress = &mut self.course.path_progress.substeps;
        *progress = progress.saturating_add(u32::try_from(taken).unwrap_or(u32::MAX));
        self.note_states();
        self.report_happenings(log);
        moved.map_err(Failure::Discarded)?;
        if reached < end {
            Err(Failure::Event)
        } else {
            Ok(())
        }
    }

    /// Takes the committed pose and the states that the host has set for those of the motion, when
    /// initialization ends. Parts that overlap there are moved apart.
    ///
    /// # Errors
    ///
    /// Freedoms have no acceleration there.
    pub(super) fn settle_freedoms(&mut self, log: &Logger) -> Result<(), Failure> {
        self.settle(true)?;
        self.report_start(log);
        self.commit_settled();
        Ok(())
    }

    /// Takes values and velocities for those that the host gives, and commits the pose, after contacts have
    /// met.
    fn commit_settled(&mut self) {
        if self.has_passive_forces() {
            self.note_states();
            self.set_driver_rates(self.course.time, 0.0, 0.0);
            self.commit_pose();
        }
    }

    /// Returns whether stops or friction act on freedoms.
    fn has_passive_forces(&self) -> bool {
        (self.motion.free()).is_some_and(FreeMotion::has_passive_forces)
    }

    /// Takes the committed pose and the states that the host has set for those of the motion, which goes
    /// on, or `starts`.
    fn settle(&mut self, starts: bool) -> Result<(), Failure> {
        if self.motion.free().is_none() {
            return Ok(());
        }
        self.set_path(self.course.time, 0.0);
        let Self {
            motion,
            path,
            course,
            ..
        } = self;
        let given = given(path, &course.force_inputs);
        let velocity = |freedom: DriverId| course.inputs[freedom.index()].get(Order::Velocity);
        // Nothing is left of a run before a reset, such as the length of its steps.
        if let Some(state) = &course.free {
            motion.resume_free(state).map_err(failed)?;
        }
        if let Some((free, solver, _)) = motion.parts() {
            let settled = if starts {
                free.restart(solver, &given, velocity)
            } else {
                free.go_on_with(solver, &given, velocity)
            };
            settled.map_err(failed)?;
        }
        self.save_free();
        Ok(())
    }

    /// Notes the state of the free motion.
    fn save_free(&mut self) {
        if let (Some(free), Some(state)) = (self.motion.free(), &mut self.course.free) {
            free.save(state);
        }
    }

    /// Returns whether the states are those of coordinates that are better exchanged at the committed
    /// pose.
    pub(super) fn wants_exchange(&mut self) -> bool {
        self.has_local_states
            && self.solve_freedoms().is_ok()
            && (self.motion.parts()).is_some_and(|(free, solver, _)| free.wants_exchange(solver))
    }

    /// Goes on from the committed pose in the coordinates that are best there, if those in use are
    /// not good any more. Returns whether it does: the states are others then.
    ///
    /// # Errors
    ///
    /// Freedoms have no acceleration there.
    pub(super) fn exchange_states(&mut self) -> Result<bool, Failure> {
        if !self.has_local_states || self.solve_freedoms().is_err() {
            return Ok(false);
        }
        self.set_path(self.course.time, 0.0);
        let given = given(&self.path, &self.course.force_inputs);
        let Some((free, solver, solution)) = self.motion.parts() else {
            return Ok(false);
        };
        let exchanged = free.exchange(solver, solution, &given);
        if matches!(exchanged, Ok(false)) {
            return Ok(false);
        }
        self.save_free();
        self.note_states();
        self.set_driver_rates(self.course.time, 0.0, 0.0);
        self.commit_pose();
        exchanged.map_err(without_value)
    }

    /// Returns whether held coordinates have drifted from where they are held, at the committed pose.
    pub(super) fn wants_projection(&mut self) -> bool {
        self.has_passive_forces()
            && self.solve_freedoms().is_ok()
            && self.motion.free().is_some_and(FreeMotion::has_drifted)
    }

    /// Lets contacts bounce or rest, and friction stick or slide, at the committed pose. Returns whether
    /// the states have other values.
    ///
    /// # Errors
    ///
    /// Freedoms have no acceleration there.
    pub(super) fn settle_events(&mut self, log: &Logger) -> Result<bool, Failure> {
        if !self.has_passive_forces() {
            return Ok(false);
        }
        let states = |course: &Course| -> Vec<[f64; 2]> {
            let inputs = course.inputs.iter();
            let values = |input: &DriverInput| {
                [Order::Position, Order::Velocity].map(|order| input.get(order))
            };
            inputs.map(values).collect()
        };
        let before = states(&self.course);
        self.settle(false)?;
        if !std::mem::take(&mut self.has_jumped)
            && let Some((free, ..)) = self.motion.parts()
        {
            // A host finds the instant of an event as well as it integrates.
            free.overlaps().for_each(drop);
        }
        self.report_happenings(log);
        self.commit_settled();
        Ok(states(&self.course) != before)
    }

    /// Takes values and velocities of the coordinates in use for those that the host gives.
    fn note_states(&mut self) {
        let (Some(free), pose) = (self.motion.free(), self.motion.pose()) else {
            return;
        };
        for (freedom, velocity) in free.freedoms().iter().zip(free.velocities()) {
            let input = &mut self.course.inputs[freedom.index()];
            input.set(Order::Position, pose.drivers[freedom.index()]);
            input.set(Order::Velocity, velocity);
        }
    }

    /// Solves the accelerations of freedoms at the pose, which is up to date.
    ///
    /// # Errors
    ///
    /// They do not exist.
    pub(super) fn solve_freedoms(&mut self) -> Result<(), Failure> {
        if self.motion.free().is_some() {
            self.set_loads();
        }
        let Some((free, solver, solution)) = self.motion.parts() else {
            return Ok(());
        };
        free.solve_accelerations(solver, solution)
            .map_err(without_value)
    }
}
