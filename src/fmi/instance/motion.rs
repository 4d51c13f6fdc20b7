//! Where the mechanism is: initialization, steps, and poses between communication points.

use super::{Error, Freshness, Instance, Status};
use crate::fmi::inputs::DriverRates;
use crate::fmi::log::Category;
use crate::fmi::state::{Call, State};
use crate::fmi::variables::Order;
use crate::kinematics::{Blocked, Curve, Progress, Reason, Start};
use crate::mechanism::{DriverId, DriverSource, Jet};

/// Hosts add up step sizes: communication points may be off by this much, relative to the
/// larger of time and step.
const TIME_ROUNDING: f64 = 1e-9;

/// The part of a step's own travel below which two polynomials of an input count as meeting.
const SEAM: f64 = 0.01;

impl Instance {
    /// `fmi2DoStep`: goes from the last communication point over `h` seconds. Allocates nothing
    /// if it succeeds.
    ///
    /// # Errors
    ///
    /// [`Error::DeadPoint`] if no continuous motion leads there: the instance is in state
    /// `stepFailed` and stands at the last time whose driver values were reached. Anything else
    /// leaves it as it was.
    pub fn do_step(&mut self, communication_point: f64, h: f64) -> Result<(), Error> {
        self.allow(Call::DoStep)?;
        self.check_step(communication_point, h)?;
        let start = self.time;
        if !self.at_committed {
            self.solver.restore(&self.committed);
            self.at_committed = true;
        }
        self.lay_path(start, h);
        match self.solver.follow(&self.path) {
            Ok(progress) => {
                self.progress = progress;
                self.collect_driver_rates(start, h, 1.0);
                for input in &mut self.inputs {
                    input.complete_step(start);
                }
                self.time = communication_point + h;
                self.warn_of_approach();
                self.commit();
                self.log_step();
                Ok(())
            }
            Err(blocked) => Err(self.fail_step(blocked, start, h)),
        }
    }

    fn check_step(&self, communication_point: f64, h: f64) -> Result<(), Error> {
        super::check_finite("currentCommunicationPoint", communication_point)?;
        super::check_finite("communicationStepSize", h)?;
        let refuse = |message: String| Err(Error::Time { message });
        if h <= 0.0 {
            return refuse(format!("the step size {h} s is not positive"));
        }
        let rounding = TIME_ROUNDING * self.time.abs().max(h);
        if (communication_point - self.time).abs() > rounding {
            return refuse(format!(
                "the communication point {communication_point} s is not where the last step \
                 ended, {} s",
                self.time
            ));
        }
        match self.stop_time {
            Some(stop) if communication_point + h > stop + rounding => refuse(format!(
                "the step from {communication_point} s over {h} s passes the stop time {stop} s"
            )),
            _ => Ok(()),
        }
    }

    /// Lays the path from the committed pose to the values in force at the end of a step of size
    /// `h` from `start`; with `h = 0` to the values set.
    fn lay_path(&mut self, start: f64, h: f64) {
        let Self {
            path,
            committed,
            settings,
            inputs,
            ..
        } = self;
        path.start = start;
        path.duration = h;
        path.from.copy_from_slice(&committed.parameters);
        path.to.copy_from_slice(&settings.parameters);
        for ((curve, input), committed) in
            path.curves.iter_mut().zip(inputs).zip(&committed.drivers)
        {
            if let Curve::Input {
                position,
                velocity,
                acceleration,
                jump,
            } = curve
            {
                let rates = input.path_rates(settings.rates, settings.extrapolation, start);
                *position = input.get(Order::Position);
                *velocity = rates.velocity;
                *acceleration = rates.acceleration;
                *jump = committed - *position;
            }
        }
    }

    /// Takes the drivers' rates at the part `s` of a step of size `h` from `start`.
    fn collect_driver_rates(&mut self, start: f64, h: f64, s: f64) {
        let Self {
            driver_rates,
            mechanism,
            inputs,
            settings,
            solver,
            ..
        } = self;
        let drivers = mechanism.drivers.iter().enumerate();
        for ((rates, (index, driver)), input) in driver_rates.iter_mut().zip(drivers).zip(inputs) {
            *rates = match &driver.source {
                DriverSource::Input { .. } => {
                    let DriverRates {
                        velocity,
                        acceleration,
                    } = input.rates_after(settings.rates, settings.extrapolation, start, s * h);
                    Jet {
                        value: 0.0,
                        first: velocity,
                        second: acceleration,
                    }
                }
                DriverSource::Motion(_) => solver.motion(DriverId(index), start + s * h),
            };
        }
    }

    /// Makes the solver's pose the one of the communication point.
    pub(super) fn commit(&mut self) {
        self.solver.save(&mut self.committed);
        self.committed_rates.copy_from_slice(&self.driver_rates);
        self.at_committed = true;
        self.last_successful_time = self.time;
        self.freshness = Freshness::Pose;
    }

    /// Goes back to the last communication point.
    fn stand_at_committed(&mut self) {
        self.solver.restore(&self.committed);
        self.driver_rates.copy_from_slice(&self.committed_rates);
        self.at_committed = true;
    }

    /// Deals with a dead point at the part `blocked.s` of a step.
    fn fail_step(&mut self, blocked: Blocked, start: f64, h: f64) -> Error {
        let message = self.describe_dead_point(&blocked, start, h);
        self.progress = blocked.progress;
        self.log_crossings();
        // Held inputs and parameters reach their values only at the very end of the step; what
        // runs along its own curve has been right up to here. A host's polynomials do not meet
        // exactly where one ends and the next begins; that is no jump.
        let jumped = self.path.moves_parameters()
            || self.path.curves.iter().any(|curve| match *curve {
                Curve::Input {
                    velocity,
                    acceleration,
                    jump,
                    ..
                } => jump.abs() > SEAM * (h * (velocity + 0.5 * h * acceleration)).abs(),
                Curve::Motion => false,
            });
        if jumped {
            self.stand_at_committed();
        } else {
            self.time = start + blocked.s * h;
            self.collect_driver_rates(start, h, blocked.s);
        }
        self.commit();
        self.state = State::StepFailed;
        self.terminated = true;
        self.warn_of_dead_point(message)
    }

    fn warn_of_dead_point(&self, message: String) -> Error {
        self.logger
            .write(Status::Warning, Category::Warning, &message);
        Error::DeadPoint { message }
    }

    /// Warns once of each approach to a singular position.
    fn warn_of_approach(&mut self) {
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            let message = format!("t = {} s: {approach}", self.time);
            self.logger
                .write(Status::Warning, Category::Warning, &message);
        }
    }

    /// Tells of the change points passed on the path followed last.
    fn log_crossings(&self) {
        if self.progress.crossings > 0 && self.logger.wants(Category::Events) {
            for crossing in self.solver.crossed() {
                let message = self.solver.describe_crossing(crossing);
                self.logger.write(Status::Ok, Category::Events, &message);
            }
        }
    }

    /// Which drivers move along the path, how far they came and what was asked for.
    fn describe_dead_point(&mut self, blocked: &Blocked, start: f64, h: f64) -> String {
        let (limit, s) = match &blocked.reason {
            Reason::Singular(point) => (point.drivers.clone(), point.s),
            _ => (self.solver.pose().drivers.clone(), blocked.s),
        };
        let asked = self.solver.drivers_at_end(&self.path);
        let mut parts: Vec<String> = self
            .mechanism
            .drivers
            .iter()
            .enumerate()
            .filter(|(index, driver)| {
                let way = asked[*index] - self.committed.drivers[*index];
                driver.motion().is_some() || way.abs() > 0.0
            })
            .map(|(index, driver)| {
                let show = |value| driver.coordinate.kind.show(value);
                if driver.motion().is_some() {
                    let time = start + s * h;
                    return format!(
                        "driver `{}` cannot follow its motion beyond {} at t = {time} s",
                        driver.name,
                        show(limit[index])
                    );
                }
                format!(
                    "driver `{}` was asked for {} and cannot go beyond {}",
                    driver.name,
                    show(asked[index]),
                    show(limit[index])
                )
            })
            .collect();
        if self.path.moves_parameters() {
            parts.push("the parameters set lead to no mechanism on the way".to_owned());
        }
        let what = match &blocked.reason {
            Reason::Value(error) => {
                parts.push(error.to_string());
                "no mechanism"
            }
            Reason::Contradiction(open) => {
                parts.push(format!("beyond, {open}, redundant up to here"));
                "contradiction"
            }
            Reason::TooLong => {
                parts.push("the step asks for more sub-steps than can be taken".to_owned());
                "given up"
            }
            Reason::Singular(point) => &point.to_string(),
            _ => "no continuous motion",
        };
        format!(
            "{what}, after {:.4} of the step from {start} s over {h} s: {}",
            blocked.s,
            parts.join("; ")
        )
    }

    fn log_step(&self) {
        self.log_crossings();
        if self.logger.wants(Category::Solver) {
            let Progress {
                iterations,
                substeps,
                checked,
                ..
            } = self.progress;
            let message = format!(
                "t = {} s: {substeps} sub-steps, {checked} of them checked, not proved; \
                 {iterations} iterations, residual {:.1e}",
                self.time,
                self.solver.residual()
            );
            self.logger.write(Status::Ok, Category::Solver, &message);
        }
    }

    /// Makes sure that the solver stands at the pose of the values set.
    pub(super) fn refresh_pose(&mut self) -> Result<(), Error> {
        if self.freshness != Freshness::Stale {
            return Ok(());
        }
        match self.state {
            State::InitializationMode => self.initialize()?,
            State::StepComplete => self.look_ahead()?,
            // Nothing can be set in any other state that allows reading.
            _ => self.stand_at_committed(),
        }
        self.freshness = Freshness::Pose;
        Ok(())
    }

    /// Makes sure that the rates of q are those of the values set.
    pub(super) fn refresh_rates(&mut self) -> Result<(), Error> {
        self.refresh_pose()?;
        if self.freshness == Freshness::Pose {
            let driver_rates = &self.driver_rates;
            self.solver
                .solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)?;
            let part = 3 * self.mechanism.bodies.len();
            let all = [
                &self.solver.pose().q,
                self.rates.velocity(),
                self.rates.acceleration(),
            ];
            for (to, from) in self.coordinates.chunks_exact_mut(part.max(1)).zip(all) {
                to.copy_from_slice(&from[..part]);
            }
            self.freshness = Freshness::Rates;
        }
        Ok(())
    }

    /// Finds the pose at the start: moves from the file's own pose to the values set, or, if
    /// something is in the way, assembles at these values from the estimates.
    fn initialize(&mut self) -> Result<(), Error> {
        self.committed.clone_from(&self.home);
        self.lay_path(self.home.time, self.time - self.home.time);
        for curve in &mut self.path.curves {
            if let Curve::Input {
                velocity,
                acceleration,
                ..
            } = curve
            {
                (*velocity, *acceleration) = (0.0, 0.0);
            }
        }
        self.at_committed = false;
        match self.solver.start(&self.home, &self.path)? {
            Start::Continuous(progress) => {
                self.progress = progress;
                self.log_crossings();
            }
            Start::Reassembled(assembly) => {
                self.progress = Progress {
                    iterations: assembly.iterations,
                    substeps: 1,
                    crossings: 0,
                    checked: 0,
                };
                self.logger.write(
                    Status::Warning,
                    Category::Warning,
                    "no continuous motion leads from the mechanism file's own pose to the start \
                     values: assembled at the start values from the estimates instead, possibly \
                     in another assembly mode",
                );
            }
        }
        self.collect_driver_rates(self.time, 0.0, 0.0);
        Ok(())
    }

    /// Finds the pose for values set since the last communication point, without a step. The
    /// standard forbids reading it in co-simulation; biela answers it, committing nothing.
    fn look_ahead(&mut self) -> Result<(), Error> {
        self.solver.restore(&self.committed);
        self.lay_path(self.time, 0.0);
        let followed = self.solver.follow(&self.path);
        self.at_committed = false;
        self.collect_driver_rates(self.time, 0.0, 0.0);
        match followed {
            Ok(_) => Ok(()),
            Err(blocked) => {
                let message = self.describe_dead_point(&blocked, self.time, 0.0);
                Err(self.warn_of_dead_point(message))
            }
        }
    }
}
