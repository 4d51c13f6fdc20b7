//! Initialization, steps, and the pose and rates of the values set.

use std::sync::Arc;

use super::messages::describe_contradiction;
use super::rule::Source;
use super::{Course, Freshness, MechanismModel, failed, without_value};
use crate::fmi::error::Failure;
use crate::fmi::log::{Advice, Logger};
use crate::fmi::state::{Interface, Phase};
use crate::kinematics::{Blocked, Budget, DriverPath};
use crate::mechanism::{DriverId, DriverSource, Order, RateSource};

/// Gap between two polynomials of an input, relative to its travel in the step, below which the
/// input counts as continuous: a host's polynomials do not meet exactly.
const SEAM: f64 = 0.01;

impl MechanismModel {
    /// Takes a step of size `h` \[s\] from the last communication point. Allocates nothing if it
    /// succeeds and has nothing to report.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if no continuous motion leads to the end. With `stays` the mechanism is
    /// then as before, otherwise at the last time whose driver values it reached.
    #[inline(always)]
    pub(super) fn take_step(
        &mut self,
        h: f64,
        end: f64,
        stays: bool,
        log: &Logger,
    ) -> Result<(), Failure> {
        let was_current = stays && self.note_committed();
        if !self.course.at_committed {
            self.return_to_committed();
        }
        let start = self.start_of_step(h, end);
        self.set_path(start, h);
        if self.motion.free().is_some() {
            let stayed = stays.then_some(was_current);
            return self.take_free_step(end, stayed, log);
        }
        match self.motion.follow(&self.path) {
            Ok(progress) => {
                self.report_falls(log);
                self.course.path_progress = progress;
                self.course.progress = progress;
                self.set_driver_rates(start, h, 1.0);
                self.advance_forces(h);
                self.course.time = end;
                self.commit_pose();
                self.complete_step(start, h, log);
                Ok(())
            }
            Err(blocked) if stays => {
                let message = self.describe_dead_point(&blocked);
                self.stay_at_committed(was_current);
                Err(Failure::Discarded(message))
            }
            Err(blocked) => {
                self.report_falls(log);
                Err(self.fail_step(&blocked, log))
            }
        }
    }

    /// Returns the host's time of the committed point, at which a step of size `h` to `end` starts: the
    /// model's own, unless rounding has parted them.
    pub(super) fn start_of_step(&self, h: f64, end: f64) -> f64 {
        let time = self.course.time;
        if (time + h).to_bits() == end.to_bits() {
            time
        } else {
            end - h
        }
    }

    /// Ends a step of size `h` from `start`, or in model exchange an accepted step of the host:
    /// reports what it brought about, and records the inputs.
    pub(super) fn complete_step(&mut self, start: f64, h: f64, log: &Logger) {
        if log.is_on() {
            self.solve_contacts(log);
        }
        self.report(log);
        if log.is_on() {
            self.report_sources(start, log);
            self.log_effort(log);
        }
        let (rule, interface) = (self.rule(), self.interface);
        let observes_rates = log.wants_advice(Advice::Rates);
        let course = &mut self.course;
        let observed = course.monitors.iter_mut().zip(&course.sources);
        let inputs = self.mechanism.drivers.iter().zip(&mut course.inputs);
        for ((driver, input), (monitor, sources)) in inputs.zip(observed) {
            monitor.sources = *sources;
            if !driver.is_given() {
                continue;
            }
            let now = input.sample(rule.rates, start);
            if observes_rates
                && let Some(last) = input.last_sample(start)
                && let Some(contradiction) = monitor.compare(last, &now)
            {
                log.advise(Advice::Rates, || {
                    describe_contradiction(driver, contradiction, start, interface)
                });
            }
            input.record(rule, now, h);
        }
    }

    /// Notes the solver's choices at the committed pose, to which a step may have to return. Returns
    /// whether that pose belongs to the values set.
    pub(super) fn note_committed(&mut self) -> bool {
        if self.course.at_committed {
            self.motion
                .solver
                .copy_choices(&mut self.course.committed_choices);
        }
        self.course.at_committed && self.course.freshness != Freshness::Stale
    }

    /// Returns to the committed pose as [`note_committed`](Self::note_committed) found it.
    pub(super) fn stay_at_committed(&mut self, was_current: bool) {
        self.return_to_committed();
        (self.motion.solution.driver_rates).copy_from_slice(&self.course.committed_rates);
        self.set_freshness(if was_current {
            Freshness::Pose
        } else {
            Freshness::Stale
        });
    }

    /// Sets the path from the committed pose to the values in force at the end of a step of size
    /// `h` from `start`; with `h = 0` to the values set. The solver gets its whole budget for it.
    pub(super) fn set_path(&mut self, start: f64, h: f64) {
        self.set_followers(start);
        let rule = self.rule();
        // A saturating cast.
        (self.motion.solver).set_budget(Budget::of(self.course.budget as u32));
        let (path, committed) = (&mut self.path, &self.course.committed);
        path.start = start;
        path.duration = h;
        path.from.copy_from_slice(&committed.parameters);
        path.to.copy_from_slice(&self.course.parameters);
        let drivers = path.driver_paths.iter_mut().zip(&mut self.course.inputs);
        let drivers = drivers.zip(&committed.drivers);
        for ((driver_path, input), committed) in drivers {
            if let DriverPath::Input {
                position,
                velocity,
                acceleration,
                jump,
            } = driver_path
            {
                let rates = input.path(rule, start, h);
                *position = input.position();
                [*velocity, *acceleration] = rates;
                *jump = committed - *position;
            }
        }
    }

    /// Sets the drivers' rates to those at the part `s` of a step of size `h` from `start`.
    pub(super) fn set_driver_rates(&mut self, start: f64, h: f64, s: f64) {
        let rule = self.rule();
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            match driver.source {
                // Accelerations follow from the forces when they are asked for.
                DriverSource::Free { .. } => {
                    let velocity = self.course.inputs[index].get(Order::Velocity);
                    self.motion.solution.driver_rates[index].derivatives = [velocity, 0.0];
                }
                DriverSource::Input { .. } => {
                    let (rates, sources) =
                        self.course.inputs[index].rates_after(rule, start, s * h);
                    self.course.sources[index] = sources;
                    // A whole number would be copied, which waits for its parts.
                    self.motion.solution.driver_rates[index].derivatives = rates;
                }
                DriverSource::Motion(_) => {
                    self.motion.solution.driver_rates[index] =
                        self.motion.solver.motion(DriverId(index), start + s * h);
                }
            }
        }
    }

    /// Sets the drivers' rates at an event: those that are given, and otherwise those of the last
    /// step, since no estimate is made from values that no step has reached.
    fn set_driver_rates_at_event(&mut self) {
        self.set_driver_rates(self.course.time, 0.0, 0.0);
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            // The rates of a prescribed motion are exact, those of a freedom follow from forces.
            if !driver.is_given() {
                continue;
            }
            let rates = self.motion.solution.driver_rates[index]
                .derivatives
                .iter_mut();
            let last = self.course.committed_rates[index].derivatives;
            for ((rate, last), source) in rates.zip(last).zip(self.course.sources[index]) {
                if matches!(source, Source::Estimate | Source::Difference) {
                    *rate = last;
                }
            }
        }
    }

    /// Commits the pose of the values set.
    ///
    /// # Errors
    ///
    /// The pose does not exist; the committed one stays.
    pub(super) fn commit_values(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        let starting = phase == Phase::Initialization;
        let estimated = self.course.rule.rates == RateSource::Estimated;
        if starting && estimated && self.interface == Interface::ModelExchange {
            let why = "`rates` is `estimated`, which needs communication points; in model exchange \
                       the velocity and acceleration inputs have to be given";
            return Err(Failure::Failed(why.to_owned()));
        }
        if phase == Phase::Event {
            return self.commit_event(log);
        }
        self.has_jumped = !starting && self.motion.free().is_some() && self.jumps();
        if !starting && self.hosts_freedoms() {
            self.evaluate(false)?;
            self.set_freshness(Freshness::Pose);
        }
        self.refresh_pose(phase, log)?;
        if !starting {
            self.report_falls(log);
        }
        self.commit_pose();
        if starting {
            self.settle_freedoms(log)?;
            for input in &mut self.course.inputs {
                input.start();
            }
            self.report_mechanism(log);
        } else {
            self.complete_step(self.course.time, 0.0, log);
        }
        Ok(())
    }

    /// Returns whether inputs of drivers, or parameters, differ from those of the committed pose at its time.
    fn jumps(&self) -> bool {
        let Course {
            time,
            committed,
            parameters,
            inputs,
            ..
        } = &self.course;
        let drivers = self.mechanism.drivers.iter().zip(inputs);
        let mut given =
            (drivers.zip(&committed.drivers)).filter(|((driver, _), _)| driver.is_given());
        time.to_bits() == committed.time.to_bits()
            && (*parameters != committed.parameters
                || given.any(|((_, input), last)| (input.position() - last).abs() > 0.0))
    }

    /// Commits the pose of the values set at an event. An input that has jumped starts its history
    /// anew.
    fn commit_event(&mut self, log: &Logger) -> Result<(), Failure> {
        if self.course.freshness != Freshness::Stale && self.course.at_committed {
            return Ok(());
        }
        self.refresh_pose(Phase::Event, log)?;
        let course = &mut self.course;
        for (input, last) in course.inputs.iter_mut().zip(&course.committed.drivers) {
            if (input.position() - last).abs() > 0.0 {
                input.forget_samples();
            }
        }
        self.commit_pose();
        self.report(log);
        Ok(())
    }

    /// Commits the solver's pose.
    pub(super) fn commit_pose(&mut self) {
        let course = &mut self.course;
        self.motion.solver.save(&mut course.committed);
        (course.committed_rates).copy_from_slice(&self.motion.solution.driver_rates);
        self.course.at_committed = true;
        self.set_freshness(Freshness::Pose);
    }

    /// Puts the solver back to the committed pose, with the choices that it had there.
    pub(super) fn return_to_committed(&mut self) {
        let course = &self.course;
        let (pose, choices) = (&course.committed, &course.committed_choices);
        self.motion.return_to(pose, choices, course.free.as_ref());
        self.course.at_committed = true;
    }

    /// Lets the solver leave the committed pose: notes its choices, and begins with them.
    fn leave_committed(&mut self) {
        if self.course.at_committed {
            self.motion
                .solver
                .copy_choices(&mut self.course.committed_choices);
        }
        self.return_to_committed();
        self.course.at_committed = false;
    }

    /// Restores the committed pose and its rates.
    pub(super) fn restore_committed(&mut self) {
        self.leave_committed();
        (self.motion.solution.driver_rates).copy_from_slice(&self.course.committed_rates);
        self.course.at_committed = true;
    }

    /// Commits the last pose before a dead point on the path.
    pub(super) fn fail_step(&mut self, blocked: &Blocked, log: &Logger) -> Failure {
        let message = self.describe_dead_point(blocked);
        let (start, h) = (self.path.start, self.path.duration);
        self.course.path_progress = blocked.progress;
        self.course.progress = blocked.progress;
        self.report_crossings(log);
        // Held inputs and parameters reach their values at the end of the step only. Inputs on a
        // curve of their own have right values up to the dead point.
        let jumped = self.path.moves_parameters()
            || self
                .path
                .driver_paths
                .iter()
                .any(|driver_path| match *driver_path {
                    DriverPath::Input {
                        velocity,
                        acceleration,
                        jump,
                        ..
                    } => jump.abs() > SEAM * (h * (velocity + 0.5 * h * acceleration)).abs(),
                    DriverPath::Motion | DriverPath::Polynomial(_) => false,
                });
        self.advance_forces(if jumped { 0.0 } else { blocked.s * h });
        if jumped {
            self.restore_committed();
        } else {
            self.course.time = start + blocked.s * h;
            self.set_driver_rates(start, h, blocked.s);
        }
        // A prescribed motion would be ahead of the pose at the dead point itself.
        let known = !jumped && !self.path.has_motions();
        self.dead_point = known.then(|| start + blocked.place() * h);
        self.commit_pose();
        Failure::Discarded(message)
    }

    /// Moves the inputs of forces on by a time `h`.
    pub(super) fn advance_forces(&mut self, h: f64) {
        for input in &mut self.course.force_inputs {
            input.advance(h);
        }
    }

    /// Brings the solver to the pose of the values set.
    ///
    /// # Errors
    ///
    /// The pose does not exist.
    #[inline]
    pub(super) fn refresh_pose(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        if self.course.freshness == Freshness::Stale {
            self.find_pose(phase, log)?;
        }
        Ok(())
    }

    /// Brings the solver to the pose of the values set, which it has left or never was at.
    fn find_pose(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        match phase {
            Phase::Initialization => self.initialize(log)?,
            Phase::Running => self.evaluate(self.hosts_freedoms())?,
            Phase::Event => {
                self.evaluate(false)?;
                self.set_driver_rates_at_event();
            }
            Phase::Halted => self.restore_committed(),
        }
        self.set_freshness(Freshness::Pose);
        Ok(())
    }

    /// Solves the rates at the pose, which is up to date.
    ///
    /// # Errors
    ///
    /// The rates do not exist.
    pub(super) fn refresh_rates(&mut self) -> Result<(), Failure> {
        if self.course.freshness == Freshness::Pose {
            self.solve_freedoms()?;
            let solved = self.motion.solution.solve_rates(&mut self.motion.solver);
            solved.map_err(without_value)?;
            self.course.freshness = Freshness::Rates;
        }
        Ok(())
    }

    /// Finds the start pose: moves from the file's own pose to the values set.
    ///
    /// # Errors
    ///
    /// No continuous motion leads there, or the mechanism does not close there.
    fn initialize(&mut self, log: &Logger) -> Result<(), Failure> {
        let start_pose = Arc::clone(&self.course.start_pose);
        self.course.committed.clone_from(&start_pose);
        let start = start_pose.time;
        self.set_path(start, self.course.time - start);
        for driver_path in &mut self.path.driver_paths {
            if let DriverPath::Input {
                velocity,
                acceleration,
                ..
            } = driver_path
            {
                (*velocity, *acceleration) = (0.0, 0.0);
            }
        }
        (self.course.committed_choices).clone_from(&self.file_choices);
        self.return_to_committed();
        self.course.at_committed = false;
        let started = self.motion.solver.start(&start_pose, &self.path);
        self.course.path_progress = started.map_err(failed)?;
        self.report_crossings(log);
        self.set_driver_rates(self.course.time, 0.0, 0.0);
        Ok(())
    }

    /// Returns whether the host integrates freedoms of a mechanism with open curves: its trial points may
    /// lie beyond the end of a curve, the points that it accepts may not.
    fn hosts_freedoms(&self) -> bool {
        self.interface == Interface::ModelExchange
            && self.motion.free().is_some()
            && self.motion.solver.has_ends_of_curves()
    }

    /// Finds the pose for values set since the last commit, and commits nothing. A `trial` may lie
    /// beyond stops. In co-simulation the standard forbids reading it without a step (4.2.4); biela
    /// answers as an extension.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if no continuous motion leads there.
    fn evaluate(&mut self, trial: bool) -> Result<(), Failure> {
        self.leave_committed();
        let (now, committed) = (self.course.time, self.course.committed.time);
        let (start, h) = match self.interface {
            Interface::ModelExchange => (committed, now - committed),
            Interface::CoSimulation => (now, 0.0),
        };
        self.set_path(start, h);
        let (path, is_free) = (&self.path, self.motion.free().is_some());
        let followed = self.motion.follow_by(|solver| {
            // Stops act on freedoms by their forces.
            if trial {
                solver.track_through_stops(path)
            } else if is_free {
                solver.track_past_stops(path, None)
            } else {
                solver.track(path)
            }
        });
        self.set_driver_rates(start, h, 1.0);
        match followed {
            Ok(progress) => {
                self.course.path_progress = progress;
                Ok(())
            }
            Err(blocked) => {
                let message = self.describe_dead_point(&blocked);
                Err(Failure::Discarded(message))
            }
        }
    }
}
