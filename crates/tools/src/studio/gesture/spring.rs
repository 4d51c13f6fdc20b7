//! Springs and dampers between two points.

use super::cylinder::ends;
use super::mass::USUAL_MASS;
use super::{Editing, Refusal, Target};
use biela::mechanism::rounded;

/// Natural frequency with which the lighter body swings on its spring \[Hz\]: slow enough for the eye,
/// and little enough to sag by a few centimetres under its own weight.
const FREQUENCY: f64 = 2.0;
/// Part of the critical damping of that frequency: the body comes to rest in a few swings.
const DAMPING_RATIO: f64 = 0.2;
/// Significant digits of the values.
const DIGITS: usize = 2;

/// Natural angular frequency \[rad/s\].
const ANGULAR: f64 = std::f64::consts::TAU * FREQUENCY;

/// Adds a spring, free of force as it is drawn, between two points of different bodies.
pub(super) fn spring(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let (ends, long) = ends(editing, "spring", points)?;
    let stiffness = rounded(lighter(editing, &ends) * ANGULAR * ANGULAR, DIGITS);
    let free = editing.usual(long);
    let keys = format!("stiffness = {stiffness}, free = {free}");
    add(editing, "spring", ends, &keys);
    Ok(())
}

/// Adds a damper between two points of different bodies.
pub(super) fn damper(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let (ends, _) = ends(editing, "damper", points)?;
    let damping = rounded(
        2.0 * DAMPING_RATIO * lighter(editing, &ends) * ANGULAR,
        DIGITS,
    );
    add(editing, "damper", ends, &format!("damping = {damping}"));
    Ok(())
}

/// Adds a force along the distance between two markers.
fn add(editing: &mut Editing, noun: &str, [from, to]: [String; 2], keys: &str) {
    let name = editing.names.new_name(noun);
    let value =
        format!("{{ coordinate = \"distance\", markers = [\"{from}\", \"{to}\"], {keys} }}");
    editing.text.set(&["forces", &name], &value);
}

/// Returns the mass of the lighter of the two bodies \[kg\], the usual one if none has a mass.
fn lighter(editing: &Editing, ends: &[String; 2]) -> f64 {
    let masses = ends.iter().filter_map(|path| {
        let (body, _) = path.split_once('.')?;
        let mechanism = editing.mechanism().ok()?;
        let id = mechanism.body_id(body)?;
        Some(mechanism.weight_at(id, &editing.drawn.parameters)?.mass)
    });
    masses.reduce(f64::min).unwrap_or(USUAL_MASS)
}
