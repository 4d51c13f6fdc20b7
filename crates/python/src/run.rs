//! One motion of a mechanism, with its gradients.

use std::sync::Arc;

use biela::dynamics::Event;
use biela::kinematics::{Direction, Output};
use biela::mechanism::Mechanism;
use biela_tools::drawing::ForcePlace;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::call::{Interrupt, apart};
use crate::error::Failure;
use crate::events::{EventColumns, event_columns};
use crate::film::Film;
use crate::runner::Runner;
use crate::scenario::Scenario;

/// The rows of a run.
#[pyclass]
pub(crate) struct Run {
    mechanism: Arc<Mechanism>,
    /// Values by row, then by column.
    values: Vec<f64>,
    /// Derivatives by row, then by direction, then by column.
    gradient: Vec<f64>,
    /// None unless it was asked for.
    film: Option<Film>,
    /// Number of rows that were reached.
    #[pyo3(get)]
    rows: usize,
    /// Cause of a stop before the last row.
    #[pyo3(get)]
    stop: Option<String>,
    /// Warnings about samples in whole angles, then the notices of the motion but events, as `biela run`
    /// tells them.
    #[pyo3(get)]
    notices: Vec<String>,
    events: Vec<(usize, Event)>,
}

#[pymethods]
impl Run {
    /// Returns the values, by row, then by column, and keeps none of them.
    fn take_values<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        std::mem::take(&mut self.values).into_pyarray(py)
    }

    /// Returns the derivatives, by row, then by direction, then by column, and keeps none of them.
    fn take_gradient<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        std::mem::take(&mut self.gradient).into_pyarray(py)
    }

    /// Returns the events of free motion as columns.
    fn events<'py>(&self, py: Python<'py>) -> EventColumns<'py> {
        event_columns(py, &self.events)
    }

    /// Returns whether the run has forces that arrows can show.
    #[getter]
    fn has_forces(&self) -> bool {
        self.film.as_ref().is_some_and(Film::has_forces)
    }

    /// Returns the page on which the mechanism moves; `None` for a run without rows or film.
    fn page(&self, py: Python<'_>, forces: bool) -> Result<Option<String>, Failure> {
        apart(py, || {
            let film = self.film.as_ref();
            Ok(film.and_then(|film| film.page(&self.mechanism, forces)))
        })
    }
}

/// Runs a mechanism; records the columns, and their derivatives along the directions. With columns that
/// a film tells, it makes one.
///
/// # Errors
///
/// The start cannot be reached from the file's own pose.
pub(crate) fn run(
    scenario: &Scenario,
    parameters: &[f64],
    columns: &[Output],
    by: &[Direction],
    told: Option<Vec<Output>>,
) -> Result<Run, Failure> {
    let mut runner = Runner::along(scenario, columns, by)?;
    let rows = scenario.times.len();
    runner.start(parameters)?;
    let film = told.map(|told| {
        let arrows = ForcePlace::sought(&mut runner.motion.solver, &runner.motion.solution);
        Film::new(told, arrows, rows, parameters)
    });
    runner.watch_contacts()?;
    let mut result = Run {
        mechanism: scenario.driven.clone(),
        values: Vec::with_capacity(rows * columns.len()),
        gradient: Vec::with_capacity(rows * columns.len() * by.len()),
        film,
        rows: 0,
        stop: None,
        notices: scenario.whole_angles(),
        events: Vec::new(),
    };
    let mut events = Vec::new();
    runner.tell(&mut result.notices, &mut events);
    let mut interrupt = Interrupt::of_call();
    for row in 0..rows {
        interrupt.check()?;
        let advanced = match row {
            0 => runner.lead(&mut interrupt),
            _ => runner.advance(row).map_err(Failure::Assembly),
        };
        runner.tell(&mut result.notices, &mut events);
        if let Err(stop) = advanced {
            result.stop = Some(stop.reason()?);
            break;
        }
        let values = columns.iter().map(|column| runner.value(column));
        result.values.extend(values);
        if !by.is_empty() {
            let directions = runner.directions(by)?;
            runner.differentiate(columns, &directions, &mut result.gradient)?;
        }
        if let Some(film) = &mut result.film {
            film.add(row, &runner.motion);
        }
        result.rows += 1;
    }
    result.events = events.into_iter().map(|event| (0, event)).collect();
    Ok(result)
}
