//! The times of a run.

use clap::Args;

use crate::cli::told::error::Error;
use biela::mechanism::{Mechanism, Simulation, shown};

/// Largest number of rows; more are a slip in --step.
const MOST_ROWS: f64 = 1e9;

/// Reads a time of the command line.
fn seconds(text: &str) -> Result<f64, String> {
    let error = |_| "expected a number of seconds, such as 0.5".to_owned();
    text.parse().map_err(error)
}

/// Options of all commands that run a mechanism.
#[derive(Args, Debug)]
pub(in crate::cli) struct Span {
    /// Start time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Time between rows in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    step: Option<f64>,
}

/// Times of the rows.
pub(in crate::cli) struct Times {
    pub(in crate::cli) start: f64,
    pub(in crate::cli) stop: f64,
    pub(in crate::cli) step: f64,
    pub(in crate::cli) steps: u64,
}

impl Span {
    /// Returns the times for a mechanism.
    pub(in crate::cli) fn times(&self, mechanism: &Mechanism) -> Result<Times, Error> {
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
    pub(in crate::cli) fn of_file(mechanism: &Mechanism, most: u64) -> Self {
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
    pub(in crate::cli) fn at(&self, row: u64) -> f64 {
        match row {
            0 => self.start,
            row if row == self.steps => self.stop,
            row => as_written(self.start, row as f64, self.step),
        }
    }
}

/// Returns start + row · step as decimal numbers: 0.7 for seven steps of 0.1, where the product of
/// binary numbers is 0.7000000000000001.
fn as_written(start: f64, row: f64, step: f64) -> f64 {
    let decimals = |number: f64| {
        let text = number.to_string();
        text.split_once('.')
            .map_or(0, |(_, decimals)| decimals.len())
    };
    let time = start + row * step;
    let decimals = decimals(start).max(decimals(step));
    let written: f64 = format!("{time:.decimals$}").parse().unwrap_or(time);
    // The roundings of the step, of the product and of the sum.
    let rounding = 2.0 * f64::EPSILON * (start.abs() + (row * step).abs());
    if (written - time).abs() <= rounding {
        written
    } else {
        time
    }
}

#[cfg(test)]
mod tests {
    use super::as_written;

    #[test]
    fn times_are_those_that_a_person_writes() {
        for (start, row, step, expected) in [
            (0.0, 7.0, 0.1, 0.7),
            (0.3, 3.0, 0.1, 0.6),
            (-1.0, 9.0, 0.1, -0.1),
            (0.0, 3.0, 1e-3, 0.003),
            (1e9, 3.0, 0.1, 1_000_000_000.3),
        ] {
            assert_eq!(
                as_written(start, row, step).to_bits(),
                f64::to_bits(expected)
            );
        }
        // A step that nobody writes stays as it is.
        let third = 1.0 / 3.0;
        assert!((as_written(0.0, 2.0, third) - 2.0 * third).abs() <= f64::EPSILON);
        assert_eq!(as_written(0.0, 5.0, 1e-300).to_bits(), 5e-300_f64.to_bits());
    }
}
