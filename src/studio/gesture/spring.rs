//! Springs and dampers between two points.

use super::cylinder::ends;
use super::mass::USUAL_MASS;
use super::{Editing, Refusal, Target};
use crate::mechanism::rounded;

/// Natural frequency with which the lighter body swings on its spring \[Hz\]: slow enough for the eye,
/// and little enough to sag by a few centimetres under its own weight.
const FREQUENCY: f64 = 2.0;
/// Part of the critical damping of that frequency: the body comes to rest in a few swings.
const DAMPING_RATIO: f64 = 0.2;
/// Significant digits of the values.
const DIGITS: usize = 2;

/// Adds a `spring`, free of force as it is drawn, or a `damper` between two points of different bodies.
pub(super) fn spring(editing: &mut Editing, noun: &str, points: &[Target]) -> Result<(), Refusal> {
    let (ends, long) = ends(editing, noun, points)?;
    let mass = lighter(editing, &ends);
    let angular = std::f64::consts::TAU * FREQUENCY;
    let keys = match noun {
        "spring" => {
            let stiffness = rounded(mass * angular * angular, DIGITS);
            format!("stiffness = {stiffness}, free = {}", editing.length(long))
        }
        _ => {
            let damping = rounded(2.0 * DAMPING_RATIO * mass * angular, DIGITS);
            format!("damping = {damping}")
        }
    };
    let name = editing.names.new_name(noun);
    let [from, to] = ends;
    let value =
        format!("{{ coordinate = \"distance\", markers = [\"{from}\", \"{to}\"], {keys} }}");
    editing.text.set(&["forces", &name], &value);
    Ok(())
}

/// Returns the mass of the lighter of the two bodies \[kg\], the usual one if none has a mass.
fn lighter(editing: &Editing, ends: &[String; 2]) -> f64 {
    let masses = ends.iter().filter_map(|path| {
        let (body, _) = path.split_once('.')?;
        let mass = editing.body(body).ok()?.mass.as_ref()?;
        Some(mass.value(&editing.drawn.parameters))
    });
    masses.reduce(f64::min).unwrap_or(USUAL_MASS)
}
