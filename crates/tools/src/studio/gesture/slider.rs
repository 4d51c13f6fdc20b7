//! Points that slide along a line.

use super::super::drawn::inside;
use super::{Editing, Onto, Refusal, Target, marker_name};

/// Adds a slider on a guide of ground at an angle \[rad\]; at a marker it is pinned to that.
pub(super) fn slider(editing: &mut Editing, target: &Target, angle: f64) -> Result<(), Refusal> {
    let other = match &target.onto {
        Onto::Sheet | Onto::Ground => None,
        _ => Some(editing.marker_at(target)?),
    };
    let at = editing.settled(target)?;
    let guide = editing.ground_name("guide");
    let guide = editing.add_marker("ground", &guide, [at[0], at[1], angle]);
    let letter = match &other {
        Some(path) => marker_name(path).to_owned(),
        None => editing.names.new_letter(),
    };
    let body = editing.add_body(
        "slider",
        &[(letter.clone(), [0.0; 3])],
        [at[0], at[1], angle],
    );
    let own = format!("{body}.{letter}");
    if let Some(other) = &other {
        editing.join(&letter, "revolute", [other, &own]);
    }
    editing.join("guide", "translational", [&guide, &own]);
    Ok(())
}

/// Lets a marker slide along the line of a body.
pub(super) fn slot(editing: &mut Editing, path: &str, body: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    if editing.body_of(marker)? == body {
        return Err(format!("`{path}` is a point of `{body}` itself").into());
    }
    let [x, y] = editing.drawn.point(marker);
    let [u, v] = inside(editing.frame(body)?, [x, y]);
    let mechanism = editing.mechanism()?;
    let id = mechanism.body_id(body);
    let own = id.map_or(&[][..], |id| &mechanism.bodies[id.index()].markers);
    // A marker whose x-axis runs through the point is the line already.
    let along = own.iter().find(|id| {
        let [x, y, turn] = editing.drawn.inside(**id);
        let (sin, cos) = turn.sin_cos();
        let off = cos * (v - y) - sin * (u - x);
        off.abs() <= 1e-3 * editing.drawn.size()
    });
    let line = match along {
        Some(id) => mechanism.marker_path(*id),
        None => {
            let [first, ..] = own else {
                return Err(format!("`{body}` has no line: it has no marker").into());
            };
            let [x, y, _] = editing.drawn.inside(*first);
            let letter = editing.names.new_letter();
            editing.add_marker(body, &letter, [x, y, f64::atan2(v - y, u - x)])
        }
    };
    editing.join("slot", "slot", [&line, path]);
    Ok(())
}
