//! Targets of a fit, for Python: costs of many variants, and attempts.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pyo3::prelude::*;
use rayon::prelude::*;

use crate::attempt::Attempt;
use crate::call::{Cores, Interrupt, apart};
use crate::error::Failure;
use crate::follower::{Fit, Follower};
use crate::runner::BATCH;

/// Targets of a fit, for Python.
#[pyclass(frozen)]
pub(crate) struct Targets {
    fit: Arc<Fit>,
}

impl Targets {
    pub(crate) fn new(fit: Fit) -> Self {
        Self { fit: Arc::new(fit) }
    }
}

#[pymethods]
impl Targets {
    /// Returns the costs of variants, whose free parameters are by variant, then by parameter: the
    /// index of the variant, that of its assembly mode, and the sum of squared residuals. Free
    /// timing is that of the nearest poses. Variants that do not reach all targets are left out.
    fn costs(&self, py: Python<'_>, values: Vec<f64>) -> Result<Vec<(usize, usize, f64)>, Failure> {
        let cores = Cores::of_process(py)?;
        let costs = |stop: &AtomicBool| {
            let size = self.fit.free.len();
            let batches = values.par_chunks(BATCH * size).enumerate();
            let costs: Vec<Vec<_>> = batches
                .map(|(batch, values)| {
                    let mut follower = Follower::new(&self.fit)?;
                    let mut found = Vec::new();
                    for (index, values) in values.chunks_exact(size).enumerate() {
                        Interrupt::Told(stop).check()?;
                        let costs = follower.costs(values).into_iter();
                        found.extend(costs.map(|(mode, cost)| (BATCH * batch + index, mode, cost)));
                    }
                    Ok(found)
                })
                .collect::<Result<_, Failure>>()?;
            Ok(costs.into_iter().flatten().collect())
        };
        apart(py, || cores.run(costs))
    }

    /// Begins attempts at free parameters, which are by attempt, then by parameter: each in the
    /// assembly mode of this index.
    fn attempts(
        &self,
        py: Python<'_>,
        values: Vec<f64>,
        modes: Vec<usize>,
    ) -> Result<Vec<Attempt>, Failure> {
        let cores = Cores::of_process(py)?;
        apart(py, || {
            cores.run(|_| {
                let values = values.par_chunks(self.fit.free.len());
                let begun = values.zip(modes.par_iter());
                let begun = begun
                    .map(|(values, &mode)| Attempt::begin(&self.fit, values.to_vec(), Some(mode)));
                begun.collect()
            })
        })
    }

    /// Begins an attempt at the free parameters `values`, on the continuous motion from the file's
    /// own pose.
    fn attempt(&self, py: Python<'_>, values: Vec<f64>) -> Result<Attempt, Failure> {
        apart(py, || Attempt::begin(&self.fit, values, None))
    }
}
