//! The same motion of many variants, on all cores.

use std::sync::atomic::AtomicBool;

use biela::kinematics::Output;
use biela::mechanism::ParameterId;
use biela_tools::cli::check_parameter;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::call::Interrupt;
use crate::error::Failure;
use crate::runner::{BATCH, Runner};
use crate::scenario::Scenario;

/// The rows of many variants.
#[pyclass]
pub(crate) struct Sweep {
    /// Values by variant, then by column, then by row; not a number where the variant stopped.
    values: Vec<f64>,
    /// Number of rows that each variant reached.
    #[pyo3(get)]
    rows: Vec<usize>,
    /// Reasons of the variants that stopped, by their index.
    #[pyo3(get)]
    reasons: Vec<(usize, String)>,
}

#[pymethods]
impl Sweep {
    /// Returns the values, by variant, then by column, then by row, and keeps none of them.
    fn take_values<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        std::mem::take(&mut self.values).into_pyarray(py)
    }
}

/// The outcome of one variant.
struct Outcome {
    rows: usize,
    reason: Option<String>,
}

/// Runs the variants, whose parameters \[SI\] are by parameter, then by variant. A variant that
/// does not reach its start or stops has a reason and no values from there on.
///
/// # Errors
///
/// The equations of the mechanism do not fit; [`Failure::Ended`] after `stop`.
pub(crate) fn sweep(
    scenario: &Scenario,
    parameters: &[f64],
    swept: &[(ParameterId, Vec<f64>)],
    variants: usize,
    columns: &[Output],
    stop: &AtomicBool,
) -> Result<Sweep, Failure> {
    // An error of the equations is the same for all variants.
    Runner::new(scenario, columns)?;
    let rows = scenario.times.len();
    let size = rows * columns.len();
    let mut values = vec![f64::NAN; variants * size];
    let run = |runner: &mut Runner, variant: usize, values: &mut [f64]| {
        let mut outcome = Outcome {
            rows: 0,
            reason: None,
        };
        let mut interrupt = Interrupt::Told(stop);
        let mut own = parameters.to_vec();
        for (parameter, series) in swept {
            let value = series[variant];
            if let Err(reason) = check_parameter(&scenario.own, *parameter, value) {
                outcome.reason = Some(reason);
                return Ok(outcome);
            }
            own[parameter.index()] = value;
        }
        scenario.own.derive_parameters(&mut own);
        if let Err(failure) = runner.start(&own) {
            outcome.reason = Some(failure.reason()?);
            return Ok(outcome);
        }
        for row in 0..rows {
            interrupt.check()?;
            if row > 0
                && let Err(reason) = runner.advance(row)
            {
                outcome.reason = Some(reason);
                return Ok(outcome);
            }
            for (column, values) in columns.iter().zip(values.chunks_exact_mut(rows)) {
                values[row] = runner.value(column);
            }
            outcome.rows += 1;
        }
        Ok(outcome)
    };
    let batches = values.par_chunks_mut((BATCH * size).max(1)).enumerate();
    let outcomes: Vec<Vec<Outcome>> = batches
        .map(|(batch, values)| {
            Interrupt::Told(stop).check()?;
            let mut runner = Runner::new(scenario, columns)?;
            let variants = values.chunks_exact_mut(size).enumerate();
            variants
                .map(|(index, values)| run(&mut runner, BATCH * batch + index, values))
                .collect()
        })
        .collect::<Result<_, Failure>>()?;
    let mut result = Sweep {
        values,
        rows: Vec::with_capacity(variants),
        reasons: Vec::new(),
    };
    for (variant, outcome) in outcomes.into_iter().flatten().enumerate() {
        result.rows.push(outcome.rows);
        result
            .reasons
            .extend(outcome.reason.map(|reason| (variant, reason)));
    }
    Ok(result)
}
