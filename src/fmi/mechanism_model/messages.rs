//! Messages about poses and steps.

use std::f64::consts::PI;

use super::MechanismModel;
use super::monitor::Contradiction;
use super::rule::Source;
use crate::dynamics::{self, Notice, Stop};
use crate::fmi::log::{Advice, Category, Logger};
use crate::fmi::state::Interface;
use crate::fmi::status::Status;
use crate::kinematics::{Blocked, DriverPath, Progress, Reason};
use crate::mechanism::{Driver, DriverId, Order, RateSource, rounded, show_time, shown};

/// The host's way out where the budget of a step is spent.
const RAISE: &str = "set `solver.budget` higher";

impl MechanismModel {
    /// Describes why the path was not followed to its end: the drivers that may be the cause, their
    /// limits and the values asked for.
    pub(super) fn describe_dead_point(&self, blocked: &Blocked) -> String {
        let (start, h) = (self.path.start, self.path.duration);
        let (limit, s) = match &blocked.reason {
            Reason::Singular(point) => (point.drivers.clone(), point.s),
            _ => (self.motion.solver.pose().drivers.clone(), blocked.s),
        };
        let asked = self.path.drivers_at_end(&self.mechanism);
        let mut parts = Vec::new();
        let drivers = self.mechanism.drivers.iter().enumerate();
        for (index, driver) in drivers.filter(|(index, _)| self.may_stop(*index, &blocked.reason)) {
            let show = |value| driver.coordinate.kind.show(value);
            if driver.motion().is_some() {
                parts.push(format!(
                    "driver `{}` cannot follow its motion beyond {} at t = {} s",
                    driver.name,
                    show(limit[index]),
                    show_time(start + s * h)
                ));
            } else if (asked[index] - self.course.committed.drivers[index]).abs() > 0.0 {
                let kind = driver.coordinate.kind;
                let [asked, limit] = kind.show_apart(asked[index], limit[index]);
                let name = &driver.name;
                parts.push(if asked == limit {
                    format!("driver `{name}` was asked for {asked}, where it cannot go on")
                } else {
                    format!("driver `{name}` was asked for {asked} and cannot go beyond {limit}")
                });
            }
        }
        if let Reason::Stop(_) = blocked.reason {
            if self.path.moves_parameters() {
                parts.push("parameters move from the last values to those set".to_owned());
            }
        } else if self.path.moves_parameters() {
            parts.push(
                "the mechanism does not exist for parameters between the last and those set"
                    .to_owned(),
            );
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
                parts.push("the step needs more sub-steps than the solver takes".to_owned());
                "given up"
            }
            Reason::NearSingular => {
                parts.push(
                    "next to a singular position the step needs more sub-steps than the solver \
                     takes"
                        .to_owned(),
                );
                "given up"
            }
            Reason::Spent(most) => {
                parts.push(format!(
                    "the step takes more than {most} sub-steps: take shorter steps, or {RAISE}"
                ));
                "given up"
            }
            Reason::Singular(point) => &point.to_string(),
            Reason::Stop(limit) => &limit.to_string(),
            Reason::Jump(driver) => {
                let driver = &self.mechanism.drivers[driver.index()];
                &format!("the motion of driver `{}` jumps", driver.name)
            }
            _ => "no continuous motion",
        };
        format!(
            "{what}, after {:.4} of the step from {} s over {} s: {}",
            blocked.s,
            show_time(start),
            show_time(h),
            parts.join("; ")
        )
    }

    /// Describes why the free motion was not followed to the end of the path.
    pub(super) fn describe_stop(&self, stop: &Stop) -> String {
        let error = match stop {
            Stop::Blocked(blocked) => return self.describe_dead_point(blocked),
            Stop::Free(error) => error,
        };
        match error {
            dynamics::Error::Spent { .. } => {
                let [start, h] = [self.path.start, self.path.duration].map(show_time);
                format!("given up in the step from {start} s over {h} s: {error}, or {RAISE}")
            }
            _ => error.to_string(),
        }
    }

    /// Returns whether a driver may be the cause of a stop. At a singular position it has to move an
    /// unknown that is free there.
    fn may_stop(&self, driver: usize, reason: &Reason) -> bool {
        match reason {
            Reason::Singular(point) => {
                let structure = self.motion.solver.structure();
                let moved_by = |column| &structure.dependencies(column).drivers;
                let mut free = point.free.iter().enumerate();
                free.any(|(q, motion)| *motion != 0.0 && moved_by(q).contains(&DriverId(driver)))
            }
            Reason::Jump(jumping) => jumping.index() == driver,
            Reason::Value(_) => !self.path.moves_parameters(),
            _ => true,
        }
    }

    /// Reports redundant constraints and dimensions that do not fit.
    pub(super) fn report_mechanism(&self, log: &Logger) {
        if log.wants(Category::Warning) {
            for redundancy in self.motion.solver.redundancies() {
                log.remark(|| redundancy.to_string());
            }
            for misfit in self.motion.solver.geometry_warnings() {
                log.remark(|| misfit.to_string());
            }
        }
    }

    /// Reports what is worth knowing of the motion and was not told yet.
    pub(super) fn report(&mut self, log: &Logger) {
        self.set_loads();
        self.motion.tell_notices(|notice| report(&notice, log));
    }

    /// Reports overlaps and events of the free motion.
    pub(super) fn report_happenings(&mut self, log: &Logger) {
        (self.motion.happenings()).for_each(|notice| report(&notice, log));
    }

    /// Reports the change points on the last path.
    pub(super) fn report_crossings(&self, log: &Logger) {
        if self.course.path_progress.crossings > 0 {
            (self.motion.crossings()).for_each(|notice| report(&notice, log));
        }
    }

    /// Reports once an angle that falls by more than half a turn on the path, as an angle does that
    /// the host wraps. Observes nothing if the message would not reach the host.
    #[inline]
    pub(super) fn report_falls(&mut self, log: &Logger) {
        if log.wants_advice(Advice::WrappedAngle) {
            self.observe_falls(log);
        }
    }

    /// Observes the angles on the path, and reports once one that falls.
    fn observe_falls(&mut self, log: &Logger) {
        let drivers = self.mechanism.drivers.iter().zip(&self.path.driver_paths);
        let observed = self.course.inputs.iter().zip(&mut self.course.monitors);
        for ((driver, driver_path), (input, monitor)) in drivers.zip(observed) {
            if let DriverPath::Input { jump, .. } = *driver_path
                && jump.abs() > PI
                && driver.coordinate.kind.is_angle()
                && monitor.falls(-jump, input.last_change())
            {
                let name = &driver.name;
                log.advise(Advice::WrappedAngle, || {
                    format!(
                        "t = {} s: driver `{name}` jumps by {} rad within one step, which the \
                         mechanism follows turn by turn; if the host wraps the angle, set \
                         `wrapped = true` for the driver in the mechanism file",
                        show_time(self.course.time),
                        shown(-jump)
                    )
                });
            }
        }
    }

    /// Logs rates that come from another source than in the step before.
    pub(super) fn report_sources(&self, start: f64, log: &Logger) {
        if self.rule().rates != RateSource::Auto || !log.wants(Category::Events) {
            return;
        }
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            if driver.motion().is_none() {
                let monitor = &self.course.monitors[index];
                for (order, source) in monitor.changes(self.course.sources[index]) {
                    let message = describe_source(driver, order, source, start);
                    log.write(Status::Ok, Category::Events, &message);
                }
            }
        }
    }

    /// Advises of parts that overlap at the start, and logs impacts there: those of the file's start, if the
    /// host has set no other one.
    pub(super) fn report_start(&mut self, log: &Logger) {
        let (start, own) = (&self.course.committed, &self.file_pose);
        let mut inputs = self.mechanism.drivers.iter().zip(&self.course.inputs);
        let keeps_velocities = inputs.all(|(driver, input)| {
            let velocity = input.get(Order::Velocity);
            !driver.is_free() || velocity.to_bits() == driver.start_velocity().to_bits()
        });
        if start.drivers == own.drivers && start.parameters == own.parameters && keeps_velocities {
            let mechanism = &*self.mechanism;
            for overlap in &self.overlaps {
                report(&Notice::Overlap(overlap.clone(), mechanism), log);
            }
            for impact in &self.impacts {
                report(&Notice::Event(*impact, mechanism), log);
            }
        }
        self.report_happenings(log);
    }

    /// Logs the effort of a step.
    pub(super) fn log_effort(&self, log: &Logger) {
        if log.wants(Category::Solver) {
            let Progress {
                iterations,
                substeps,
                checked,
                ..
            } = self.course.path_progress;
            let checked = match checked {
                0 => String::new(),
                checked => format!(" ({checked} checked, not proved)"),
            };
            let message = format!(
                "t = {} s: sub-steps {substeps}{checked}, iterations {iterations}, residual {:.1e}",
                show_time(self.course.time),
                self.motion.solver.residual()
            );
            log.write(Status::Ok, Category::Solver, &message);
        }
    }
}

/// Tells the host a notice: as advice on wrong use, as a remark, or among the events.
fn report(notice: &Notice<'_>, log: &Logger) {
    let text = || notice.to_string();
    match notice {
        Notice::Approach(..) => log.advise(Advice::SingularPosition, text),
        Notice::Excursion(_) => log.advise(Advice::Limits, text),
        Notice::Overlap(..) => log.advise(Advice::Overlap, text),
        Notice::Beyond(..) => log.advise(Advice::Points, text),
        Notice::OffPulley(_) | Notice::LiftOff(_) => log.remark(text),
        Notice::Event(..) | Notice::Crossing(..) => {
            if log.wants(Category::Events) {
                log.write(Status::Ok, Category::Events, &text());
            }
        }
    }
}

fn describe_source(driver: &Driver, order: Order, source: Source, time: f64) -> String {
    let source = match source {
        Source::Input => "the rate input",
        Source::Derivatives => "input derivatives",
        Source::Difference => "differences of the velocity",
        Source::Estimate => "an estimate from positions",
    };
    let Driver { name, .. } = driver;
    let rate = order.suffix();
    let time = show_time(time);
    format!("t = {time} s: the {rate} of driver `{name}` now comes from {source}")
}

/// Describes a given rate that contradicts the motion.
pub(super) fn describe_contradiction(
    driver: &Driver,
    contradiction: Contradiction,
    time: f64,
    interface: Interface,
) -> String {
    let advice = match interface {
        Interface::CoSimulation => ", or set `rates` to 3 (`estimated`)",
        Interface::ModelExchange => "",
    };
    let Contradiction {
        order,
        given,
        actual,
    } = contradiction;
    let Driver { name, .. } = driver;
    let time = show_time(time);
    let unit = driver.coordinate.kind.units()[order as usize].name;
    // Four digits: differences of positions have rounding.
    let [given, actual] = [given, actual].map(|rate| format!("{} {unit}", shown(rounded(rate, 4))));
    let (lower, rate) = match order {
        Order::Acceleration => ("velocity", "acceleration"),
        _ => ("position", "velocity"),
    };
    format!(
        "t = {time} s: the {rate} of driver `{name}` is given as {given}, but its {lower} changes \
         by {actual}: connect `{name}.{rate}`{advice}"
    )
}
