//! Joints that are driven, and joints that move freely.

use super::mass::{USUAL_MASS, give_mass};
use super::{Editing, Refusal};
use biela::mechanism::{Body, Coordinate};

/// Drives the coordinate of a joint, from where it is drawn.
pub(super) fn driver(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    start(editing, "drivers", name)
}

/// Lets the coordinate of a joint follow the forces. Where no body has a mass, the joint's bodies
/// get one.
pub(super) fn freedom(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    start(editing, "freedoms", name)?;
    let mechanism = editing.mechanism()?;
    if !mechanism.bodies.iter().any(Body::has_mass) {
        let joint = editing.joint(name)?;
        let bodies = [joint.from, joint.to].map(|id| mechanism.markers[id.index()].body);
        for body in bodies.into_iter().flatten() {
            give_mass(editing, &mechanism.bodies[body.index()], USUAL_MASS);
        }
    }
    Ok(())
}

/// Adds the coordinate of a joint to a section, with the value at which it is drawn.
fn start(editing: &mut Editing, section: &str, joint: &str) -> Result<(), Refusal> {
    let (coordinate, word) = coordinate(editing, joint)?;
    let keys = editing.coordinate_keys(coordinate)?;
    let is_angle = coordinate.kind.is_angle();
    let start = editing
        .drawn
        .settled_value(editing.drawn.value(coordinate), is_angle);
    let start = editing.value(start, is_angle);
    let name = editing.names.new_name(&word);
    let value = format!("{{ {keys}, start = {start} }}");
    editing.text.set(&[section, &name], &value);
    Ok(())
}

/// Returns the coordinate of a joint that can be driven, and a word for it.
fn coordinate(editing: &Editing, name: &str) -> Result<(Coordinate, String), Refusal> {
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
    let body = editing.body_of(to)?;
    let body = if body == "ground" {
        editing.body_of(from)?
    } else {
        body
    };
    let word = if coordinate.kind.is_angle() {
        "angle"
    } else {
        "travel"
    };
    Ok((coordinate, format!("{body}_{word}")))
}
