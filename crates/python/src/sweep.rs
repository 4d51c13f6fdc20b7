//! The same motion of many variants, on all cores.

use std::sync::atomic::AtomicBool;

use biela::dynamics::Event;
use biela::kinematics::Output;
use biela::mechanism::{DriverId, Order, ParameterId};
use biela_tools::cli::check_parameter;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::call::Interrupt;
use crate::error::Failure;
use crate::events::{EventColumns, event_columns};
use crate::runner::{BATCH, Runner};
use crate::scenario::{ArrayPlace, Scenario, Start};

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
    /// Events of free motions, by the index of the variant.
    events: Vec<(usize, Event)>,
}

#[pymethods]
impl Sweep {
    /// Returns the values, by variant, then by column, then by row, and keeps none of them.
    fn take_values<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        std::mem::take(&mut self.values).into_pyarray(py)
    }

    /// Returns the events of free motions as columns.
    fn events<'py>(&self, py: Python<'py>) -> EventColumns<'py> {
        event_columns(py, &self.events)
    }
}

/// A quantity that differs between variants.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Quantity {
    Parameter(ParameterId),
    /// Value or velocity of a freedom at the start.
    Start(DriverId, Order),
}

/// Variants of a mechanism.
pub(crate) struct Variants<'a> {
    pub(crate) scenario: &'a Scenario,
    /// Parameters in force but for those that are swept \[SI\].
    pub(crate) parameters: &'a [f64],
    /// The quantities that are swept, with a value per variant \[SI\].
    pub(crate) swept: &'a [(Quantity, Vec<f64>)],
    /// The arrays of drivers and inputs of forces that are swept: positions, velocities and accelerations,
    /// or sizes first, by variant, then by row.
    pub(crate) courses: &'a [(ArrayPlace, [Vec<f64>; 3])],
    pub(crate) count: usize,
    pub(crate) columns: &'a [Output],
}

/// The outcome of one variant.
#[derive(Default)]
struct Outcome {
    rows: usize,
    reason: Option<String>,
    events: Vec<Event>,
}

impl Variants<'_> {
    /// Runs the variants. One that does not reach its start or stops has a reason and no values from
    /// there on.
    ///
    /// # Errors
    ///
    /// The equations of the mechanism do not fit; [`Failure::Ended`] after `stop`.
    pub(crate) fn run(&self, stop: &AtomicBool) -> Result<Sweep, Failure> {
        let Self {
            scenario, columns, ..
        } = *self;
        // An error of the equations is the same for all variants.
        Runner::new(scenario, columns)?;
        let size = scenario.times.len() * columns.len();
        let mut values = vec![f64::NAN; self.count * size];
        let batches = values.par_chunks_mut((BATCH * size).max(1)).enumerate();
        let outcomes: Vec<Vec<Outcome>> = batches
            .map(|(batch, values)| {
                Interrupt::Told(stop).check()?;
                let mut runner = Runner::new(scenario, columns)?;
                let variants = values.chunks_exact_mut(size).enumerate();
                variants
                    .map(|(index, values)| {
                        let mut outcome = Outcome::default();
                        let variant = BATCH * batch + index;
                        let run = self.run_one(&mut runner, variant, values, &mut outcome, stop);
                        if let Err(failure) = run {
                            outcome.reason = Some(failure.reason()?);
                        }
                        Ok(outcome)
                    })
                    .collect()
            })
            .collect::<Result<_, Failure>>()?;
        let mut result = Sweep {
            values,
            rows: Vec::with_capacity(self.count),
            reasons: Vec::new(),
            events: Vec::new(),
        };
        for (variant, outcome) in outcomes.into_iter().flatten().enumerate() {
            result.rows.push(outcome.rows);
            let reason = outcome.reason.map(|reason| (variant, reason));
            result.reasons.extend(reason);
            let events = outcome.events.into_iter();
            result.events.extend(events.map(|event| (variant, event)));
        }
        Ok(result)
    }

    /// Runs a variant; its values are by column, then by row.
    ///
    /// # Errors
    ///
    /// The reason for which it stops, or the cause that ends the call.
    fn run_one(
        &self,
        runner: &mut Runner,
        variant: usize,
        values: &mut [f64],
        outcome: &mut Outcome,
        stop: &AtomicBool,
    ) -> Result<(), Failure> {
        let Self {
            scenario, columns, ..
        } = *self;
        let mut interrupt = Interrupt::Told(stop);
        let (parameters, starts) = self.values(variant)?;
        if !starts.is_empty() {
            let mut own = scenario.clone();
            own.set_starts(&starts)?;
            *runner = Runner::new(&own, columns)?;
        }
        let rows = scenario.times.len();
        for (place, orders) in self.courses {
            let orders = orders.each_ref();
            let orders = orders.map(|order| &order[variant * rows..(variant + 1) * rows]);
            if !orders.into_iter().flatten().all(|value| value.is_finite()) {
                return Err(Failure::Usage("drive: expected finite numbers".to_owned()));
            }
            match *place {
                ArrayPlace::Samples(index) => runner.scenario.samples[index].take(orders),
                ArrayPlace::Loads(index) => {
                    let own = runner.scenario.loads[index].1.iter_mut().zip(orders);
                    own.for_each(|(own, order)| own.copy_from_slice(order));
                }
            }
        }
        runner.start(&parameters)?;
        for row in 0..rows {
            interrupt.check()?;
            let advanced = match row {
                0 => runner.lead(&mut interrupt),
                _ => runner.advance(row).map_err(Failure::Assembly),
            };
            runner.tell_events(&mut outcome.events);
            advanced?;
            for (column, values) in columns.iter().zip(values.chunks_exact_mut(rows)) {
                values[row] = runner.value(column);
            }
            outcome.rows += 1;
        }
        Ok(())
    }

    /// Returns the parameters of a variant, and the starts of freedoms that are swept.
    ///
    /// # Errors
    ///
    /// A value is beyond its limits.
    fn values(&self, variant: usize) -> Result<(Vec<f64>, Vec<Start>), Failure> {
        let own = &self.scenario.own;
        let mut parameters = self.parameters.to_vec();
        let mut starts = Vec::new();
        for (quantity, series) in self.swept {
            let value = series[variant];
            match *quantity {
                Quantity::Parameter(id) => {
                    check_parameter(own, id, value).map_err(Failure::Usage)?;
                    parameters[id.index()] = value;
                }
                Quantity::Start(..) if !value.is_finite() => {
                    let message = format!("{value} is no start of a freedom");
                    return Err(Failure::Usage(message));
                }
                Quantity::Start(freedom, order) => starts.push((freedom, order, value)),
            }
        }
        own.derive_parameters(&mut parameters);
        Ok((parameters, starts))
    }
}
