//! Masses of bodies.

use serde_json::Value;

use super::{Editing, Refusal};
use crate::mechanism::{Body, rounded};

/// Mass of a body for which nobody has given one \[kg\].
pub(super) const USUAL_MASS: f64 = 1.0;
/// Significant digits of a moment of inertia.
const INERTIA_DIGITS: usize = 3;

/// Gives a body a mass \[kg\], the usual one if the gesture has none; a body that has one already gets
/// another one.
pub(super) fn mass(editing: &mut Editing, name: &str, mass: &Value) -> Result<(), Refusal> {
    let body = editing.body(name)?;
    let mass = match (mass.as_f64(), &body.mass) {
        (Some(mass), _) => mass,
        (None, None) => USUAL_MASS,
        (None, Some(_)) => {
            return Err(format!("`{name}` has a mass already: change its number").into());
        }
    };
    if !(mass.is_finite() && mass > 0.0) {
        return Err(format!("a mass is above zero, unlike {mass} kg").into());
    }
    if body.mass.is_some() {
        let path = ["bodies", name, "mass"];
        editing.text.set(&path, &format!("{mass}"));
    } else {
        give_mass(editing, body, mass);
    }
    Ok(())
}

/// Gives a body that has no mass one \[kg\]: it is a slender bar as long as its markers are apart, with
/// its centre in the middle of them.
pub(super) fn give_mass(editing: &mut Editing, body: &Body, mass: f64) {
    let markers = body.markers.iter();
    let places: Vec<[f64; 3]> = markers.map(|id| editing.drawn.inside(*id)).collect();
    let count = places.len().max(1) as f64;
    let center = [0, 1].map(|k| places.iter().map(|place| place[k]).sum::<f64>() / count);
    let reach = places
        .iter()
        .map(|p| f64::hypot(p[0] - center[0], p[1] - center[1]));
    let long = 2.0 * reach.fold(0.0, f64::max);
    let inertia = rounded(mass * long * long / 12.0, INERTIA_DIGITS);
    let [x, y] = center.map(|part| editing.length(part));
    let mut set = |key: &str, value: &str| editing.text.set(&["bodies", &body.name, key], value);
    set("mass", &format!("{mass}"));
    if inertia > 0.0 {
        set("inertia", &format!("{inertia}"));
    }
    if [&*x, &*y] != ["0", "0"] {
        set("center", &format!("[{x}, {y}]"));
    }
}
