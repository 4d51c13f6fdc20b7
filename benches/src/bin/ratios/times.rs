//! What criterion has measured.

use std::path::PathBuf;

use serde_json::Value;

/// Time of one iteration \[ns\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Time {
    /// Of the quickest sample, which was disturbed least.
    pub(crate) least: f64,
    /// Of the sample in the middle.
    pub(crate) median: f64,
}

impl Time {
    /// Of one part in so many.
    pub(crate) fn of_each(self, parts: usize) -> Self {
        Self {
            least: self.least / parts as f64,
            median: self.median / parts as f64,
        }
    }
}

/// The newest measurement of a benchmark: `group/function` or `group/function/size`. Nothing if
/// there is none.
pub(crate) fn time(benchmark: &str) -> Option<Time> {
    let program = std::env::current_exe().expect("this program runs from a file");
    let target: PathBuf = program.ancestors().nth(2)?.into();
    let sample = target
        .join("criterion")
        .join(benchmark)
        .join("new/sample.json");
    let sample: Value = serde_json::from_str(&std::fs::read_to_string(sample).ok()?).ok()?;
    let numbers = |key: &str| -> Option<Vec<f64>> {
        sample[key].as_array()?.iter().map(Value::as_f64).collect()
    };
    let (iterations, times) = (numbers("iters")?, numbers("times")?);
    let mut each: Vec<f64> = times
        .iter()
        .zip(&iterations)
        .map(|(time, iterations)| time / iterations)
        .collect();
    each.sort_by(f64::total_cmp);
    Some(Time {
        least: *each.first()?,
        median: each[each.len() / 2],
    })
}
