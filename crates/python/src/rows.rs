//! Named things, ranges, equilibria and diagnostics as rows: tuples to which the package gives names.

use biela::dynamics::{Equilibrium, Held, StateSpace};
use biela::kinematics::{End, Extreme, Pose};
use biela::mechanism::{
    Diagnostic, Driver, DriverId, ForceComponent, LoadInput, Mechanism, Parameter, Source, Unit,
};
use biela_tools::cli::{self, ToldRange};
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
    String,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    bool,
);

/// A driver or a freedom: name, description, unit, start value of an input or a freedom, limits, whether
/// it is wrapped; start velocity of a freedom.
pub(crate) type DriverRow = (
    String,
    String,
    String,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    bool,
    Option<f64>,
);

/// An input: name, description, unit, value where nobody gives one, limits.
pub(crate) type InputRow = (String, String, String, f64, Option<f64>, Option<f64>);

/// A force or a measure: name, description, unit, and the variable that has its value.
pub(crate) type NamedRow = (String, String, String, String);

/// Name, force and description of what holds a coordinate.
type HeldRow = (String, f64, String);

/// Linear equations: values of drivers, q, names of states and of inputs, A, B, C and D by rows, and what
/// holds.
pub(crate) type LinearRow = (
    Vec<f64>,
    Vec<f64>,
    Vec<String>,
    Vec<String>,
    [Vec<f64>; 4],
    Vec<HeldRow>,
);

/// An equilibrium: values of drivers, q, what holds, and the names of friction that is left out.
pub(crate) type EquilibriumRow = (Vec<f64>, Vec<f64>, Vec<HeldRow>, Vec<String>);

/// An end of a range: its kind, the driver's value, its text, the number of turns.
type EndRow = (&'static str, Option<f64>, String, Option<u32>);

/// The least or the greatest value of a measure, and the driver's value there.
type ExtremeRow = (f64, f64);

/// A range: both ends, then the change points with the bodies and connections that are dependent
/// there, listed and in words, then by sample the driver's value, the transmission angle, the
/// reciprocal condition, the poses of the bodies and the measures, then the extremes of these, none
/// where a computed measure has no value, and the forces.
pub(crate) type RangeRow<'py> = (
    EndRow,
    EndRow,
    Vec<(f64, Vec<String>, String)>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<(String, Option<[ExtremeRow; 2]>)>,
    ForcesRow,
);

/// Largest forces over a range: the effort, then the force in a joint and the joint, each with the
/// driver's value; places without forces, in words.
type ForcesRow = (
    Option<ExtremeRow>,
    Option<(ExtremeRow, Option<String>)>,
    Option<String>,
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
        p.unit.unwrap_or(Unit::ONE).name.to_string(),
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
        d.coordinate.kind.unit().name.to_string(),
        d.start(),
        d.min,
        d.max,
        d.wrapped,
        d.is_free().then(|| d.start_velocity()),
    )
}

/// Returns inputs, those of forces behind those of the file, as rows.
pub(crate) fn inputs(mechanism: &Mechanism) -> Vec<InputRow> {
    let inputs = mechanism.load_inputs().into_iter();
    let row = |input: LoadInput| {
        let unit = input.unit.unwrap_or(Unit::ONE).name.to_string();
        let [min, max] = input.limits;
        (input.name, input.description, unit, input.start, min, max)
    };
    inputs.map(row).collect()
}

/// Returns the forces that are no inputs as rows.
pub(crate) fn forces(mechanism: &Mechanism) -> Vec<NamedRow> {
    let forces = mechanism.given_forces().into_iter();
    forces.map(force_row).collect()
}

fn force_row(force: ForceComponent) -> NamedRow {
    let variable = force.name.clone();
    (
        force.name,
        force.description,
        force.unit.name.to_string(),
        variable,
    )
}

/// Returns the measures as rows: those of coordinates, then those computed from others.
pub(crate) fn measures(mechanism: &Mechanism) -> Vec<NamedRow> {
    let of_coordinates = mechanism.measures.iter().map(|measure| {
        let unit = measure.coordinate.kind.unit().name.to_string();
        let variable = format!("{}.position", measure.name);
        (
            measure.name.clone(),
            measure.description.clone(),
            unit,
            variable,
        )
    });
    let derived = mechanism.derived.iter().map(|measure| {
        let unit = measure.unit.unwrap_or(Unit::ONE).name.to_string();
        (
            measure.name.clone(),
            measure.description.clone(),
            unit,
            measure.name.clone(),
        )
    });
    of_coordinates.chain(derived).collect()
}

/// Returns linear equations at a pose as a row.
pub(crate) fn linear_row(space: StateSpace, pose: &Pose, mechanism: &Mechanism) -> LinearRow {
    let matrices = space.matrices().map(|rows| rows.concat());
    (
        pose.drivers.clone(),
        pose.q[..3 * mechanism.bodies.len()].to_vec(),
        space.states,
        space.inputs,
        matrices,
        held_rows(&space.held, mechanism),
    )
}

/// Returns an equilibrium as a row.
pub(crate) fn equilibrium_row(found: Equilibrium, mechanism: &Mechanism) -> EquilibriumRow {
    let left_out = found.left_out.iter();
    let left_out = left_out.map(|force| mechanism.forces[*force].name.clone());
    (
        found.drivers,
        found.q[..3 * mechanism.bodies.len()].to_vec(),
        held_rows(&found.held, mechanism),
        left_out.collect(),
    )
}

fn held_rows(held: &[Held], mechanism: &Mechanism) -> Vec<HeldRow> {
    let held = held.iter().map(|held| {
        let name = held.name(mechanism).to_owned();
        (name, held.size, held.describe(mechanism))
    });
    held.collect()
}

/// Returns the range of a driver as a row.
pub(crate) fn range_row<'py>(
    py: Python<'py>,
    mechanism: &Mechanism,
    driver: DriverId,
    told: &ToldRange,
) -> RangeRow<'py> {
    let range = &told.range;
    let extreme = |extreme: &Extreme| (extreme.value, extreme.driver);
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
        column(
            (samples().enumerate())
                .flat_map(|(index, sample)| {
                    let derived = told.derived.iter().map(move |(values, _)| values[index]);
                    sample.measures.iter().copied().chain(derived)
                })
                .collect(),
        ),
        measures(mechanism)
            .into_iter()
            .map(|(name, ..)| name)
            .zip(
                (range.measures.iter().map(Some))
                    .chain(told.derived.iter().map(|(_, extremes)| extremes.as_ref()))
                    .map(|extremes| extremes.map(|both| both.each_ref().map(extreme))),
            )
            .collect(),
        (
            told.effort.as_ref().map(extreme),
            told.reaction.as_ref().map(|(force, joint)| {
                let joint = joint.map(|joint| mechanism.joints[joint].name.clone());
                (extreme(force), joint)
            }),
            told.without_forces.clone(),
        ),
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
