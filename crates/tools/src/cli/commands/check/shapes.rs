//! The part of the report of `biela check` about shapes.

use std::fmt::Write as _;
use std::sync::Arc;

use super::with_unit;
use crate::cli::given::input::Input;
use crate::cli::told::error::Error;
use biela::kinematics::{Path, RangeSettings, Solver};
use biela::mechanism::{
    BodyId, Coordinate, CoordinateKind, DriverId, FeatureRun, Measure, Mechanism, ShapeId, rounded,
    shown,
};

/// Tells the area of each body with shapes, and the mass that these give it.
pub(super) fn describe_areas(mechanism: &Mechanism, parameters: &[f64]) -> String {
    let mut out = String::new();
    for (body, id) in mechanism.bodies.iter().zip((0..).map(BodyId)) {
        let Some(section) = mechanism.section_of(id, parameters) else {
            continue;
        };
        if out.is_empty() {
            out += "\nshapes\n";
        }
        let _ = write!(out, "  {}: area {} m2", body.name, shown(section.area));
        let weight = mechanism.weight_at(id, parameters);
        if let Some(weight) = weight.filter(|_| body.is_weighed) {
            let [x, y] = weight.center;
            let [mass, x, y, inertia] = [weight.mass, x, y, weight.inertia].map(shown);
            let _ = write!(
                out,
                ", mass {mass} kg, center [{x}, {y}] m, inertia {inertia} kg.m2"
            );
        }
        out.push('\n');
    }
    out
}

/// Tells the clearance of each contact at the solver's pose, with the nearest places of both shapes.
pub(super) fn describe_contacts(solver: &Solver) -> String {
    let mechanism = solver.mechanism();
    let mut out = String::new();
    for stop in &mechanism.stops {
        let Some(shapes) = stop.coordinate.shapes() else {
            continue;
        };
        let Some((value, places)) = solver.clearance(shapes) else {
            continue;
        };
        if out.is_empty() {
            out += "\ncontacts\n";
        }
        let names = shapes.map(|id| mechanism.shape_path(id));
        let at =
            places.map(|[x, y]| format!("[{}, {}]", shown(rounded(x, 6)), shown(rounded(y, 6))));
        let _ = writeln!(
            out,
            "  {}: `{}` at {} and `{}` at {} are {} m apart",
            stop.name,
            names[0],
            at[0],
            names[1],
            at[1],
            shown(rounded(value, 6))
        );
    }
    out
}

/// Returns warnings of contacts of shapes that a pin joins.
pub(super) fn overlapping_contacts(mechanism: &Mechanism, parameters: &[f64]) -> Vec<String> {
    let contacts = mechanism.stops.iter();
    let pinned = contacts.filter_map(|stop| {
        let shapes = stop.coordinate.shapes()?;
        let pin = pin_of(mechanism, shapes, parameters)?;
        let [a, b] = shapes.map(|id| mechanism.shape_path(id));
        Some(format!(
            "contact `{}`: `{a}` and `{b}` have the pin `{pin}` in common and always overlap there",
            stop.name
        ))
    });
    pinned.collect()
}

/// Returns the pin joint that lies in two shapes.
fn pin_of<'a>(
    mechanism: &'a Mechanism,
    shapes: [ShapeId; 2],
    parameters: &[f64],
) -> Option<&'a str> {
    let pins = mechanism.joints.iter();
    let mut pins = pins.filter(|joint| joint.is_pin());
    let lies_in = |shape: ShapeId, markers: [biela::mechanism::MarkerId; 2]| {
        let shape = &mechanism.shapes[shape.index()];
        markers.iter().any(|id| {
            let marker = &mechanism.markers[id.index()];
            let point = marker.position.each_ref().map(|s| s.value(parameters));
            marker.body == shape.body && mechanism.covers(shape, point, parameters)
        })
    };
    let pin = pins.find(|joint| {
        let is_solid = |id: ShapeId| mechanism.shapes[id.index()].is_plate();
        shapes
            .iter()
            .all(|shape| is_solid(*shape) && lies_in(*shape, [joint.from, joint.to]))
    });
    pin.map(|joint| joint.name.as_str())
}

/// Tells the least clearance of all pairs of shapes but holes on different bodies over the range of each driver,
/// past contacts.
///
/// # Errors
///
/// Those of assembly.
pub(super) fn describe_clearances(input: &Input) -> Result<String, Error> {
    let mut mechanism = (*input.mechanism).clone();
    mechanism
        .stops
        .retain(|stop| stop.coordinate.shapes().is_none());
    let own_measures = mechanism.measures.len();
    let parameters = mechanism.default_parameters();
    let count = mechanism.shapes.len();
    let pairs = (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j].map(ShapeId)));
    let is_solid = |id: &ShapeId| !mechanism.shapes[id.index()].is_hole();
    let is_apart = |[a, b]: &[ShapeId; 2]| {
        mechanism.shapes[a.index()].body != mechanism.shapes[b.index()].body
    };
    let pairs = pairs.filter(|pair| pair.iter().all(is_solid) && is_apart(pair));
    let pairs: Vec<[ShapeId; 2]> = pairs.collect();
    let (pinned, pairs): (Vec<_>, Vec<_>) = pairs
        .into_iter()
        .partition(|pair| pin_of(&mechanism, *pair, &parameters).is_some());
    let names = |pair: [ShapeId; 2]| {
        let [a, b] = pair.map(|id| input.mechanism.shape_path(id));
        format!("`{a}` and `{b}`")
    };
    for pair in &pairs {
        let markers = pair.map(|id| mechanism.shapes[id.index()].markers().next());
        let [Some(from), Some(to)] = markers else {
            continue;
        };
        mechanism.measures.push(Measure {
            name: names(*pair),
            description: String::new(),
            coordinate: Coordinate {
                kind: CoordinateKind::Clearance(*pair, [FeatureRun::WHOLE; 2]),
                from,
                to,
                axes: from,
            },
        });
    }
    let mut out = String::new();
    let mechanism = Arc::new(mechanism);
    let mut solver = Solver::assembled(Arc::clone(&mechanism), &Path::new(&mechanism))
        .map_err(|error| input.error(error))?;
    for (index, driver) in mechanism.drivers.iter().enumerate() {
        let range = solver.range(DriverId(index), &RangeSettings::default());
        let _ = writeln!(out, "\nleast clearances over the range of {}", driver.name);
        let measures = mechanism.measures.iter().zip(&range.measures);
        for (measure, [least, _]) in measures.skip(own_measures) {
            let at = with_unit(driver.coordinate.kind, least.driver);
            let value = shown(rounded(least.value, 6));
            let _ = writeln!(out, "  {}: {value} m, at {at}", measure.name);
        }
    }
    for pair in pinned {
        let pin = pin_of(&mechanism, pair, &parameters).unwrap_or_default();
        let _ = writeln!(out, "  {} have the pin `{pin}` in common", names(pair));
    }
    Ok(out)
}
