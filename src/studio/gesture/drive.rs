//! Joints that are driven, and joints that move freely.

use super::{Editing, Refusal};
use crate::mechanism::{Coordinate, Joint, JointKind, Mechanism};

/// Mass of a body that moves by forces and has none \[kg\].
const USUAL_MASS: f64 = 1.0;

/// Drives the coordinate of a joint, from where it is drawn.
pub(super) fn driver(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    let (coordinate, keys, word) = coordinate(editing, name)?;
    let start = editing.drawn.value(coordinate);
    let start = editing.value(start, coordinate.kind.is_angle());
    let name = editing.names.new_name(&word);
    let value = format!("{{ {keys}, start = {start} }}");
    editing.text.set(&["drivers", &name], &value);
    Ok(())
}

/// Lets the coordinate of a joint follow the forces. Where no body has a mass, the joint's bodies
/// get one.
pub(super) fn freedom(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    let (coordinate, keys, word) = coordinate(editing, name)?;
    let start = editing.drawn.value(coordinate);
    let start = editing.value(start, coordinate.kind.is_angle());
    let mechanism = editing.mechanism()?;
    if mechanism.bodies.iter().all(|body| body.mass.is_none()) {
        give_masses(editing, mechanism, editing.joint(name)?);
    }
    let name = editing.names.new_name(&word);
    let value = format!("{{ {keys}, start = {start} }}");
    editing.text.set(&["freedoms", &name], &value);
    Ok(())
}

/// Returns the coordinate of a joint that can be driven, its keys, and a word for it.
fn coordinate(editing: &Editing, name: &str) -> Result<(Coordinate, String, String), Refusal> {
    let mechanism = editing.mechanism()?;
    let joint = editing.joint(name)?;
    let coordinate = joint.free_coordinate().ok_or_else(|| {
        Refusal::Because(format!(
            "joint `{name}` has no coordinate of its own to be driven: choose a pin or a slide"
        ))
    })?;
    let is_same = |other: &Coordinate| {
        other.kind == coordinate.kind && other.from == coordinate.from && other.to == coordinate.to
    };
    if let Some(driver) = mechanism.drivers.iter().find(|d| is_same(&d.coordinate)) {
        let noun = driver.noun();
        return Err(format!("the {noun} `{}` moves this joint already", driver.name).into());
    }
    let [from, to] = [coordinate.from, coordinate.to];
    let kind = if coordinate.kind.is_angle() {
        "angle"
    } else {
        "x"
    };
    let keys = format!(
        "coordinate = \"{kind}\", markers = [\"{}\", \"{}\"]",
        mechanism.marker_path(from),
        mechanism.marker_path(to)
    );
    let body = editing.body_of(to)?;
    let body = if body == "ground" {
        editing.body_of(from)?
    } else {
        body
    };
    let word = match joint.kind {
        JointKind::Revolute => format!("{body}_angle"),
        _ => format!("{body}_travel"),
    };
    Ok((coordinate, keys, word))
}

/// Gives the moving bodies of a joint the mass of a slender bar.
fn give_masses(editing: &mut Editing, mechanism: &Mechanism, joint: &Joint) {
    for marker in [joint.from, joint.to] {
        let Some(id) = mechanism.markers[marker.index()].body else {
            continue;
        };
        let body = &mechanism.bodies[id.index()];
        let places: Vec<[f64; 3]> = body
            .markers
            .iter()
            .map(|m| editing.drawn.inside(*m))
            .collect();
        let count = places.len() as f64;
        let center = [0, 1].map(|k| places.iter().map(|place| place[k]).sum::<f64>() / count);
        let reach = places
            .iter()
            .map(|p| f64::hypot(p[0] - center[0], p[1] - center[1]));
        let long = 2.0 * reach.fold(0.0, f64::max);
        let inertia = crate::mechanism::rounded(USUAL_MASS * long * long / 12.0, 4);
        let [x, y] = center.map(|part| editing.length(part));
        let name = &*body.name;
        editing
            .text
            .set(&["bodies", name, "mass"], &format!("{USUAL_MASS}"));
        if inertia > 0.0 {
            editing
                .text
                .set(&["bodies", name, "inertia"], &format!("{inertia}"));
        }
        if [&*x, &*y] != ["0", "0"] {
            editing
                .text
                .set(&["bodies", name, "center"], &format!("[{x}, {y}]"));
        }
    }
}
