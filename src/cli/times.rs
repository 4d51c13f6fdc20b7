//! The times of a run.

use clap::Args;

use super::error::Error;
use crate::mechanism::{Mechanism, Simulation, shown};

/// Largest number of rows; more are a slip in --step.
const MOST_ROWS: f64 = 1e9;

/// Options of all commands that run a mechanism.
#[derive(Args, Debug)]
pub(super) struct Span {
    /// Start time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Time between rows in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    step: Option<f64>,
}

/// Times of the rows.
pub(super) struct Times {
    pub(super) start: f64,
    pub(super) stop: f64,
    pub(super) step: f64,
    pub(super) steps: u64,
}

impl Span {
    /// Returns the times for a mechanism.
    pub(super) fn times(&self, mechanism: &Mechanism) -> Result<Times, Error> {
        let simulation = &mechanism.simulation;
        let start = self.start.unwrap_or(simulation.start);
        let stop = self.stop.unwrap_or(simulation.stop);
        let step = self.step.unwrap_or(simulation.step);
        let refuse = |message: String| Err(Error::Usage(message));
        for (option, value) in [("--start", start), ("--stop", stop), ("--step", step)] {
            if !value.is_finite() {
                return refuse(format!("{option} is {value}; expected a finite number"));
            }
        }
        let [from, to, apart] = [start, stop, step].map(shown);
        if stop < start {
            return refuse(format!(
                "cannot run from {from} s to {to} s: the stop time must not be before the start"
            ));
        }
        if step <= 0.0 {
            return refuse(format!("--step is {apart}; expected a positive time"));
        }
        let steps = steps(start, stop, step);
        if steps >= MOST_ROWS {
            return refuse(format!(
                "a step of {apart} s from {from} s to {to} s makes more than {MOST_ROWS:e} rows"
            ));
        }
        Ok(Times {
            start,
            stop,
            step,
            steps: steps as u64,
        })
    }
}

/// Returns the number of steps, of which the last may be shorter.
fn steps(start: f64, stop: f64, step: f64) -> f64 {
    // A last step shorter than this part of the others is rounding.
    ((stop - start) / step - 1e-9).ceil().max(0.0)
}

impl Times {
    /// Returns the times of a file; longer steps, if those of the file are more than `most`.
    pub(super) fn of_file(mechanism: &Mechanism, most: u64) -> Self {
        let &Simulation {
            start, stop, step, ..
        } = &mechanism.simulation;
        let all = steps(start, stop, step);
        let (steps, step) = if all <= most as f64 {
            (all as u64, step)
        } else {
            (most, (stop - start) / most as f64)
        };
        Self {
            start,
            stop,
            step,
            steps,
        }
    }

    /// Returns the time of a row \[s\].
    pub(super) fn at(&self, row: u64) -> f64 {
        match row {
            0 => self.start,
            row if row == self.steps => self.stop,
            row => self.start + row as f64 * self.step,
        }
    }
}
