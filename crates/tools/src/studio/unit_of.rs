//! The unit of a number by its place in the file.

use super::drawn::Drawn;
use biela::mechanism::{Coordinate, Load, Mechanism};

/// Returns the unit of the number at a path, or of an element of the list there; nothing where it has
/// none, or none that is known.
pub(super) fn unit_of<'a>(
    drawn: &'a Drawn,
    path: &[&str],
    element: Option<usize>,
) -> Option<&'a str> {
    let mechanism = drawn.mechanism.as_deref();
    let pose = |element| if element == Some(2) { "rad" } else { "m" };
    Some(match path[..] {
        ["ground", "markers", _] | ["bodies", _, "markers", _] => pose(element),
        ["ground", "markers", _, key] | ["bodies", _, "markers", _, key] => match key {
            "angle" => "rad",
            _ => "m",
        },
        ["bodies", _, key] => match key {
            "estimate" => pose(element),
            "center" => "m",
            "mass" => "kg",
            "inertia" => "kg.m2",
            _ => return None,
        },
        ["bodies", _, "shapes", _, _]
        | ["joints", _, "length" | "offset" | "radius" | "radii"]
        | ["friction", _, "radius" | "length"] => "m",
        ["simulation", "start" | "stop" | "step"] => "s",
        ["simulation", "gravity"] => "m/s2",
        ["parameters", name] | ["parameters", name, "value" | "min" | "max" | "tolerance"] => {
            let mechanism = mechanism?;
            let id = mechanism.parameter_id(name)?;
            mechanism.parameters[id.index()]
                .unit
                .as_ref()?
                .name
                .as_str()
        }
        ["forces", name, key] => {
            let forces = &mechanism?.forces;
            let force = forces.iter().find(|force| force.name == name)?;
            let coordinate = match force.load {
                Load::Coordinate { coordinate, .. } => coordinate,
                _ if key == "torque" => return Some("N.m"),
                _ => return Some("N"),
            };
            match key {
                "value" if coordinate.kind.is_angle() => "N.m",
                "value" => "N",
                _ => along(coordinate, key)?,
            }
        }
        [section, name, key] => along(coordinate_of(mechanism?, section, name)?, key)?,
        _ => return None,
    })
}

/// Returns the coordinate of a thing that has one.
fn coordinate_of(mechanism: &Mechanism, section: &str, name: &str) -> Option<Coordinate> {
    let named = |names: Vec<(&String, Coordinate)>| {
        let found = names.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, coordinate)| coordinate)
    };
    named(match section {
        "drivers" | "freedoms" => {
            (mechanism.drivers.iter().map(|d| (&d.name, d.coordinate))).collect()
        }
        "constraints" => (mechanism
            .constraints
            .iter()
            .map(|c| (&c.name, c.coordinate)))
        .collect(),
        "stops" => (mechanism.stops.iter().map(|s| (&s.name, s.coordinate))).collect(),
        _ => return None,
    })
}

/// Returns the unit of a key of a thing that has a coordinate.
fn along(coordinate: Coordinate, key: &str) -> Option<&'static str> {
    let is_angle = coordinate.kind.is_angle();
    let [angle, length] = match key {
        "start" | "min" | "max" | "value" | "free" => ["rad", "m"],
        "velocity" => ["rad/s", "m/s"],
        "stiffness" => ["N.m/rad", "N/m"],
        "damping" => ["N.m.s/rad", "N.s/m"],
        _ => return None,
    };
    Some(if is_angle { angle } else { length })
}
