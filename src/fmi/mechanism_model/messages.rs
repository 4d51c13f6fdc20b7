//! Messages about poses and steps.

use super::MechanismModel;
use crate::fmi::error::{Failure, Status};
use crate::fmi::log::{Category, Logger};
use crate::kinematics::{Blocked, Progress, Reason};

impl MechanismModel {
    /// Describes why a step stopped: the drivers that move, their limits and the values asked for.
    pub(super) fn describe_dead_point(&mut self, blocked: &Blocked, start: f64, h: f64) -> String {
        let (limit, s) = match &blocked.reason {
            Reason::Singular(point) => (point.drivers.clone(), point.s),
            _ => (self.solver.pose().drivers.clone(), blocked.s),
        };
        let asked = self.solver.drivers_at_end(&self.path);
        let mut parts = Vec::new();
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            let show = |value| driver.coordinate.kind.show(value);
            if driver.motion().is_some() {
                parts.push(format!(
                    "driver `{}` cannot follow its motion beyond {} at t = {} s",
                    driver.name,
                    show(limit[index]),
                    start + s * h
                ));
            } else if (asked[index] - self.committed.drivers[index]).abs() > 0.0 {
                parts.push(format!(
                    "driver `{}` was asked for {} and cannot go beyond {}",
                    driver.name,
                    show(asked[index]),
                    show(limit[index])
                ));
            }
        }
        if self.path.moves_parameters() {
            parts.push("no mechanism exists for parameters on the way to those set".to_owned());
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
            Reason::Singular(point) => &point.to_string(),
            _ => "no continuous motion",
        };
        format!(
            "{what}, after {:.4} of the step from {start} s over {h} s: {}",
            blocked.s,
            parts.join("; ")
        )
    }

    /// Warns once of each approach to a singular position.
    pub(super) fn warn_of_approach(&mut self, log: &Logger) {
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            warn(&format!("t = {} s: {approach}", self.time), log);
        }
    }

    /// Warns of redundant constraints and of dimensions that do not fit.
    pub(super) fn warn_of_mechanism(&self, log: &Logger) {
        for redundancy in self.solver.redundancies() {
            warn(&redundancy.to_string(), log);
        }
        for misfit in self.solver.misfits() {
            warn(&misfit.to_string(), log);
        }
    }

    /// Logs the change points on the last path.
    pub(super) fn log_crossings(&self, log: &Logger) {
        if self.progress.crossings > 0 && log.wants(Category::Events) {
            for crossing in self.solver.crossed() {
                let message = self.solver.describe_crossing(crossing);
                log.write(Status::Ok, Category::Events, &message);
            }
        }
    }

    /// Logs the change points and the effort of a step.
    pub(super) fn log_step(&self, log: &Logger) {
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
}

/// Logs a warning.
pub(super) fn warn(message: &str, log: &Logger) {
    log.write(Status::Warning, Category::Warning, message);
}

/// Logs the reason of a discarded call as a warning, which users see with any settings.
pub(super) fn discard(message: String, log: &Logger) -> Failure {
    warn(&message, log);
    Failure::Discarded(message)
}
