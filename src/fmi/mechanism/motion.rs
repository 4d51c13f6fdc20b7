//! Where the mechanism is: initialization, steps, and poses between communication points.

use super::inputs::DriverRates;
use super::variables::Order;
use super::{Freshness, MechanismModel, RateSource, failed};
use crate::fmi::error::{Failure, Status};
use crate::fmi::log::{Category, Logger};
use crate::fmi::state::{Interface, Phase};
use crate::kinematics::{Blocked, Curve, Progress, Reason, Start};
use crate::mechanism::{DriverId, DriverSource, Jet};

/// The part of a step's own travel below which two polynomials of an input count as meeting.
const SEAM: f64 = 0.01;

impl MechanismModel {
    /// Takes a step of size `h` from the last communication point. Allocates nothing if it
    /// succeeds.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if no continuous motion leads there: the mechanism stands at the
    /// last time whose driver values were reached.
    pub(super) fn take_step(&mut self, h: f64, end: f64, log: &Logger) -> Result<(), Failure> {
        let start = self.time;
        if !self.at_committed {
            self.solver.restore(&self.committed);
            self.at_committed = true;
        }
        self.lay_path(start, h);
        match self.solver.track(&self.path) {
            Ok(progress) => {
                self.progress = progress;
                self.collect_driver_rates(start, h, 1.0);
                for input in &mut self.inputs {
                    input.complete_step(start);
                }
                self.time = end;
                self.warn_of_approach(log);
                self.freshness = Freshness::Pose;
                self.commit_pose();
                self.log_step(log);
                Ok(())
            }
            Err(blocked) => Err(self.fail_step(blocked, start, h, log)),
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
            interface,
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
                let rates = match interface {
                    // The host integrates; a value that it has not set yet is none of ours.
                    Interface::ModelExchange => DriverRates::default(),
                    Interface::CoSimulation => {
                        input.path_rates(settings.rates, settings.extrapolation, start)
                    }
                };
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
            interface,
            ..
        } = self;
        let drivers = mechanism.drivers.iter().enumerate();
        for ((rates, (index, driver)), input) in driver_rates.iter_mut().zip(drivers).zip(inputs) {
            *rates = match &driver.source {
                DriverSource::Input { .. } => {
                    let DriverRates {
                        velocity,
                        acceleration,
                    } = match interface {
                        Interface::ModelExchange => input.given_rates(),
                        Interface::CoSimulation => {
                            let (source, extrapolation) = (settings.rates, settings.extrapolation);
                            input.rates_after(source, extrapolation, start, s * h)
                        }
                    };
                    Jet::new(0.0, [velocity, acceleration])
                }
                DriverSource::Motion(_) => solver.motion(DriverId(index), start + s * h),
            };
        }
    }

    /// Makes the pose of the values set the one that is gone on from.
    pub(super) fn commit_values(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        let starting = phase == Phase::Initialization;
        if starting
            && self.interface == Interface::ModelExchange
            && self.settings.rates == RateSource::Estimated
        {
            let why = "`rates` is `estimated`, which needs communication points; in model exchange \
                       the velocity and acceleration inputs have to be given";
            return Err(Failure::Failed(why.to_owned()));
        }
        self.refresh_pose(phase, log)?;
        self.commit_pose();
        if starting {
            let redundancies = self.solver.redundancies().into_iter();
            let redundancies = redundancies.map(|redundancy| redundancy.to_string());
            let misfits = self.solver.geometry_warnings().into_iter();
            for warning in redundancies.chain(misfits.map(|misfit| misfit.to_string())) {
                log.write(Status::Warning, Category::Warning, &warning);
            }
        } else {
            self.log_crossings(log);
            self.warn_of_approach(log);
        }
        Ok(())
    }

    /// Makes the solver's pose the one that is gone on from.
    fn commit_pose(&mut self) {
        self.solver.save(&mut self.committed);
        self.committed_rates.copy_from_slice(&self.driver_rates);
        self.at_committed = true;
        self.freshness = self.freshness.max(Freshness::Pose);
    }

    /// Goes back to the last communication point.
    fn stand_at_committed(&mut self) {
        self.solver.restore(&self.committed);
        self.driver_rates.copy_from_slice(&self.committed_rates);
        self.at_committed = true;
    }

    /// Deals with a dead point at the part `blocked.s` of a step.
    fn fail_step(&mut self, blocked: Blocked, start: f64, h: f64, log: &Logger) -> Failure {
        let message = self.describe_dead_point(&blocked, start, h);
        self.progress = blocked.progress;
        self.log_crossings(log);
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
        self.freshness = Freshness::Pose;
        self.commit_pose();
        discard(message, log)
    }

    /// Warns once of each approach to a singular position.
    fn warn_of_approach(&mut self, log: &Logger) {
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            let message = format!("t = {} s: {approach}", self.time);
            log.write(Status::Warning, Category::Warning, &message);
        }
    }

    /// Tells of the change points passed on the path followed last.
    fn log_crossings(&self, log: &Logger) {
        if self.progress.crossings > 0 && log.wants(Category::Events) {
            for crossing in self.solver.crossed() {
                let message = self.solver.describe_crossing(crossing);
                log.write(Status::Ok, Category::Events, &message);
            }
        }
    }

    /// Which drivers move along the path, how far they came and what was asked for.
    fn describe_dead_point(&mut self, blocked: &Blocked, start: f64, h: f64) -> String {
        let (limit, s) = match &blocked.reason {
            Reason::Singular(point) => (point.drivers.clone(), point.s),
            _ => (self.solver.pose().drivers.clone(), blocked.s),
        };
        let asked = self.path.drivers_at_end(&self.mechanism);
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

    fn log_step(&self, log: &Logger) {
        self.log_crossings(log);
        if log.wants(Category::Solver) {
            let Progress {
                iterations,
                substeps,
                checked,
                ..
            } = self.progress;
            let checked = match checked {
                0 => String::new(),
                checked => format!(" ({checked} checked, not proved)"),
            };
            let message = format!(
                "t = {} s: sub-steps {substeps}{checked}, iterations {iterations}, residual {:.1e}",
                self.time,
                self.solver.residual()
            );
            log.write(Status::Ok, Category::Solver, &message);
        }
    }

    /// Makes sure that the solver stands at the pose of the values set.
    pub(super) fn refresh_pose(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        if self.freshness != Freshness::Stale {
            return Ok(());
        }
        match phase {
            Phase::Initialization => self.initialize(log)?,
            Phase::Running => self.look_ahead(log)?,
            Phase::Halted => self.stand_at_committed(),
        }
        self.freshness = Freshness::Pose;
        Ok(())
    }

    /// Makes sure that the rates of q are those of the values set.
    pub(super) fn refresh_rates(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        self.refresh_pose(phase, log)?;
        if self.freshness == Freshness::Pose {
            let driver_rates = &self.driver_rates;
            self.solver
                .solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)
                .map_err(failed)?;
            let q = &self.solver.pose().q;
            let (velocity, acceleration) = (self.rates.velocity(), self.rates.acceleration());
            let bodies = self.mechanism.outputs.bodies.iter();
            for (to, body) in self.coordinates.chunks_exact_mut(9).zip(bodies) {
                let own = 3 * body.index()..3 * body.index() + 3;
                to[..3].copy_from_slice(&q[own.clone()]);
                to[3..6].copy_from_slice(&velocity[own.clone()]);
                to[6..].copy_from_slice(&acceleration[own]);
            }
            self.freshness = Freshness::Rates;
        }
        Ok(())
    }

    /// Finds the pose at the start: moves from the file's own pose to the values set, or, if
    /// something is in the way, assembles at these values from the estimates.
    fn initialize(&mut self, log: &Logger) -> Result<(), Failure> {
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
        match self.solver.start(&self.home, &self.path).map_err(failed)? {
            Start::Continuous(progress) => {
                self.progress = progress;
                self.log_crossings(log);
            }
            Start::Reassembled(assembly) => {
                self.progress = Progress {
                    iterations: assembly.iterations,
                    substeps: 1,
                    crossings: 0,
                    checked: 0,
                };
                log.write(
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

    /// Finds the pose for values set since the last one was committed, committing nothing. In
    /// co-simulation the standard forbids reading it without a step; biela answers it.
    fn look_ahead(&mut self, log: &Logger) -> Result<(), Failure> {
        self.solver.restore(&self.committed);
        let (start, h) = match self.interface {
            Interface::ModelExchange => (self.committed.time, self.time - self.committed.time),
            Interface::CoSimulation => (self.time, 0.0),
        };
        self.lay_path(start, h);
        let followed = self.solver.track(&self.path);
        self.at_committed = false;
        self.collect_driver_rates(start, h, 1.0);
        match followed {
            Ok(progress) => {
                if self.interface == Interface::ModelExchange {
                    self.progress = progress;
                }
                Ok(())
            }
            Err(blocked) => Err(discard(self.describe_dead_point(&blocked, start, h), log)),
        }
    }
}

/// Tells why something is discarded: users see a warning with any settings.
fn discard(message: String, log: &Logger) -> Failure {
    log.write(Status::Warning, Category::Warning, &message);
    Failure::Discarded(message)
}
