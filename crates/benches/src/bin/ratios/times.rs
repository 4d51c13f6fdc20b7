//! Times that criterion has measured.

use std::path::PathBuf;

use serde_json::Value;
use yardstick::cases::Case;

use crate::table::short;

/// Time of one step \[ns\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Time {
    /// Time in the quickest sample, which was disturbed least.
    pub(crate) least: f64,
    /// Time in the sample in the middle.
    pub(crate) median: f64,
}

impl Time {
    /// Returns the time of one of a number of equal parts.
    pub(crate) fn of_each(self, parts: usize) -> Self {
        Self {
            least: self.least / parts as f64,
            median: self.median / parts as f64,
        }
    }

    /// Writes the least time.
    pub(crate) fn write(self) -> String {
        match self.least {
            least if least < 1e4 => format!("{} ns", short(least)),
            least if least < 1e7 => format!("{} µs", short(least / 1e3)),
            least => format!("{} ms", short(least / 1e6)),
        }
    }
}

/// Returns the newest measurement of a case, if there is one.
pub(crate) fn time(case: &Case) -> Option<Time> {
    let program = std::env::current_exe().expect("this program runs from a file");
    let target: PathBuf = program.ancestors().nth(2)?.into();
    let sample = target
        .join("criterion")
        .join(&case.name)
        .join(case.size.to_string())
        .join("new/sample.json");
    let sample: Value = serde_json::from_str(&std::fs::read_to_string(sample).ok()?).ok()?;
    let numbers = |key: &str| -> Option<Vec<f64>> {
        sample[key].as_array()?.iter().map(Value::as_f64).collect()
    };
    let (iterations, times) = (numbers("iters")?, numbers("times")?);
    let span = case.span().ok()? as f64;
    let mut each: Vec<f64> = times
        .iter()
        .zip(&iterations)
        .map(|(time, iterations)| time / (iterations * span))
        .collect();
    each.sort_by(f64::total_cmp);
    Some(Time {
        least: *each.first()?,
        median: each[each.len() / 2],
    })
}
