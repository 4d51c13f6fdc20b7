//! Parameters, drivers, ranges and diagnostics as rows: tuples to which the package gives names.

use biela::kinematics::{End, Range};
use biela::mechanism::{Diagnostic, Driver, DriverId, Mechanism, Parameter, Source, Unit};
use biela_tools::cli;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

/// A diagnostic: severity, code, message, help, line and column of the primary place, both from 1.
pub(crate) type Problem = (
    &'static str,
    &'static str,
    String,
    Option<String>,
    Option<(usize, usize)>,
);

/// A parameter: name, description, value, unit, smallest and largest value, tolerance, whether it is
/// derived.
pub(crate) type ParameterRow = (
    String,
    String,
    f64,
    &'static str,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    bool,
);

/// A driver: name, description, unit, start value of an input, limits, whether it is wrapped.
pub(crate) type DriverRow = (
    String,
    String,
    &'static str,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    bool,
);

/// An end of a range: its kind, the driver's value, its text, the number of turns.
type EndRow = (&'static str, Option<f64>, String, Option<u32>);

/// The least or the greatest value of a measure, and the driver's value there.
type ExtremeRow = (f64, f64);

/// A range: both ends, then the change points with the bodies and connections that are dependent
/// there, listed and in words, then by sample the driver's value, the transmission angle, the
/// reciprocal condition, the poses of the bodies and the measures, then the extremes of these.
pub(crate) type RangeRow<'py> = (
    EndRow,
    EndRow,
    Vec<(f64, Vec<String>, String)>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<(String, [ExtremeRow; 2])>,
);

/// Returns diagnostics as rows.
pub(crate) fn problems(source: &Source, diagnostics: &[Diagnostic]) -> Vec<Problem> {
    let problem = |d: &Diagnostic| {
        let label = d.labels.first();
        let position = label.map(|label| source.position(label.span.start));
        let place = position.map(|position| (position.line, position.column));
        let (message, help) = (d.message.clone(), d.help.clone());
        (d.severity.as_str(), d.code, message, help, place)
    };
    diagnostics.iter().map(problem).collect()
}

/// Returns a parameter as a row.
pub(crate) fn parameter_row(p: &Parameter) -> ParameterRow {
    (
        p.name.clone(),
        p.description.clone(),
        p.default,
        p.unit.unwrap_or(Unit::ONE).name,
        p.min,
        p.max,
        p.tolerance,
        p.derived,
    )
}

/// Returns a driver as a row.
pub(crate) fn driver_row(d: &Driver) -> DriverRow {
    (
        d.name.clone(),
        d.description.clone(),
        d.coordinate.kind.unit().name,
        d.start(),
        d.min,
        d.max,
        d.wrapped,
    )
}

/// Returns the range of a driver as a row.
pub(crate) fn range_row<'py>(
    py: Python<'py>,
    mechanism: &Mechanism,
    driver: DriverId,
    range: &Range,
) -> RangeRow<'py> {
    let samples = || range.samples.iter();
    let column = |values: Vec<f64>| values.into_pyarray(py);
    let poses = 3 * mechanism.bodies.len();
    let crossings = range.crossings.iter();
    (
        end_row(mechanism, driver, &range.lower),
        end_row(mechanism, driver, &range.upper),
        crossings
            .map(|c| (c.value, c.bodies.clone(), c.geometry.clone()))
            .collect(),
        column(samples().map(|s| s.driver).collect()),
        column(
            samples()
                .map(|s| s.transmission.unwrap_or(f64::NAN))
                .collect(),
        ),
        column(samples().map(|s| s.rcond).collect()),
        column(
            samples()
                .flat_map(|s| s.pose.q[..poses].iter().copied())
                .collect(),
        ),
        column(samples().flat_map(|s| s.measures.iter().copied()).collect()),
        (mechanism.measures.iter().zip(&range.measures))
            .map(|(measure, extremes)| {
                let extremes = extremes.map(|extreme| (extreme.value, extreme.driver));
                (measure.name.clone(), extremes)
            })
            .collect(),
    )
}

fn end_row(mechanism: &Mechanism, driver: DriverId, end: &End) -> EndRow {
    let text = cli::describe_end(end, mechanism, driver);
    match end {
        End::Turns(turns) => ("turns", None, text, Some(*turns)),
        End::Singular(point) => ("singular", Some(point.drivers[driver.index()]), text, None),
        End::Stop { value, .. } => ("stop", Some(*value), text, None),
        End::Blocked { value, .. } => ("blocked", Some(*value), text, None),
        End::Bound { value } => ("bound", Some(*value), text, None),
        End::NotFound { value } => ("not found", Some(*value), text, None),
    }
}
