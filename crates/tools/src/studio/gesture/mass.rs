//! Masses of bodies.

use std::ops::Range;

use super::{Editing, Refusal};
use biela::mechanism::{Body, MarkerId, rounded};

/// Mass of a body for which nobody has given one \[kg\].
pub(super) const USUAL_MASS: f64 = 1.0;
/// Significant digits of a moment of inertia.
const INERTIA_DIGITS: usize = 3;
/// Part of a number by which rounding may have changed it.
const OWN: f64 = 5e-3;

/// Gives a body a mass \[kg\], the usual one if the gesture has none; a body that has one already gets
/// another one.
pub(super) fn mass(editing: &mut Editing, name: &str, mass: Option<f64>) -> Result<(), Refusal> {
    let body = editing.body(name)?;
    if body.is_weighed {
        return Err(
            format!("the shapes of `{name}` give it its mass: change their `density`").into(),
        );
    }
    let mass = match (mass, &body.mass) {
        (Some(mass), _) => mass,
        (None, None) => USUAL_MASS,
        (None, Some(_)) => {
            return Err(format!("`{name}` has a mass already: change its number").into());
        }
    };
    if mass <= 0.0 {
        return Err(format!("a mass is above zero, unlike {mass} kg").into());
    }
    if body.mass.is_some() {
        follow_mass(editing, body, mass);
        let path = ["bodies", name, "mass"];
        editing.text.set(&path, &format!("{mass}"));
    } else {
        give_mass(editing, body, mass);
    }
    Ok(())
}

/// Gives a body that has no mass one \[kg\]: that of a [`Bar`].
pub(super) fn give_mass(editing: &mut Editing, body: &Body, mass: f64) {
    let bar = Bar::through(body, |marker| editing.drawn.inside(marker));
    let inertia = bar.inertia(mass);
    let center = bar.center(editing);
    let mut set = |key: &str, value: &str| editing.text.set(&["bodies", &body.name, key], value);
    set("mass", &format!("{mass}"));
    if inertia > 0.0 {
        set("inertia", &format!("{inertia}"));
    }
    if center != "[0, 0]" {
        set("center", &center);
    }
}

/// Lets the inertia of a body follow its mass to another value \[kg\], if it is still the one of the bar
/// through its markers.
pub(super) fn follow_mass(editing: &mut Editing, body: &Body, mass: f64) {
    let parts = followed(editing, body, Some(mass), |id| editing.drawn.inside(id));
    editing.text.replace_all(&parts);
}

/// Returns the numbers of a body's mass that follow another `mass` \[kg\], and its markers to other
/// places in its frame, each with its place in the text: those that are still the ones of the bar
/// through its markers.
pub(super) fn followed(
    editing: &Editing,
    body: &Body,
    mass: Option<f64>,
    inside: impl Fn(MarkerId) -> [f64; 3],
) -> Vec<(Range<usize>, String)> {
    let path = |key: &'static str| ["bodies", &*body.name, key];
    let written = |place: Range<usize>| editing.text.as_str()[place].trim().parse::<f64>().ok();
    let Some(old_mass) = editing.text.place(&path("mass")).and_then(written) else {
        return Vec::new();
    };
    let mass = mass.unwrap_or(old_mass);
    let before = Bar::through(body, |marker| editing.drawn.inside(marker));
    let now = Bar::through(body, inside);
    let mut parts = Vec::new();
    let inertias = [before.inertia(old_mass), now.inertia(mass)];
    if let Some(place) = editing.text.place(&path("inertia"))
        && let Some(old) = written(place.clone())
        && (old - inertias[0]).abs() <= OWN * old
        && inertias[0].to_bits() != inertias[1].to_bits()
    {
        parts.push((place, format!("{}", inertias[1])));
    }
    let elements = [0, 1].map(|k| editing.text.element(&path("center"), k).and_then(written));
    if let Some(place) = editing.text.place(&path("center"))
        && let [Some(x), Some(y)] = elements
        && f64::hypot(x - before.middle[0], y - before.middle[1]) <= OWN * before.long
        && now.center(editing) != before.center(editing)
    {
        parts.push((place, now.center(editing)));
    }
    parts
}

/// A slender bar, as long as the markers of a body are apart, with its centre in the middle of them
/// \[m\].
struct Bar {
    middle: [f64; 2],
    long: f64,
}

impl Bar {
    fn through(body: &Body, inside: impl Fn(MarkerId) -> [f64; 3]) -> Self {
        let places: Vec<[f64; 3]> = body.markers.iter().map(|id| inside(*id)).collect();
        let count = places.len().max(1) as f64;
        let middle = [0, 1].map(|k| places.iter().map(|place| place[k]).sum::<f64>() / count);
        let reach = places
            .iter()
            .map(|p| f64::hypot(p[0] - middle[0], p[1] - middle[1]));
        let long = 2.0 * reach.fold(0.0, f64::max);
        Self { middle, long }
    }

    /// Returns the moment of inertia about the centre \[kg m²\], rounded.
    fn inertia(&self, mass: f64) -> f64 {
        rounded(mass * self.long * self.long / 12.0, INERTIA_DIGITS)
    }

    /// Writes the centre.
    fn center(&self, editing: &Editing) -> String {
        let [x, y] = self.middle.map(|part| editing.usual(part));
        format!("[{x}, {y}]")
    }
}
