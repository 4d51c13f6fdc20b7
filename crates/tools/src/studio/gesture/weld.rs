//! Bodies that are made one, as they are drawn.

use serde_json::json;

use super::super::drawn::within_turn;
use super::super::reference::references;
use super::put::put;
use super::{Editing, Refusal, marker_name};
use biela::mechanism::{Joint, MarkerId};

/// Angle within which two directions are one \[rad\].
const SAME_DIRECTION: f64 = 1e-9;

/// Makes a weld of a pin.
pub(super) fn weld_joint(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    let joint = editing.joint(name)?;
    if !joint.is_pin() {
        return Err(format!("joint `{name}` is no pin: choose one that is to be fixed").into());
    }
    let mut drivers = mechanism.drivers.iter();
    if let Some(driver) = drivers.find(|driver| joint.free_coordinate() == Some(driver.coordinate))
    {
        let noun = driver.noun();
        return Err(format!(
            "the {noun} `{}` moves this pin: delete it first",
            driver.name
        )
        .into());
    }
    let of_ground = mechanism.markers[joint.from.index()].body.is_none();
    let (kept, turned) = if of_ground {
        (joint.to, joint.from)
    } else {
        (joint.from, joint.to)
    };
    let kept_path = mechanism.marker_path(kept);
    let turned_path = directed(editing, turned, name, editing.drawn.place(kept)[2])?;
    let [from, to] = if of_ground {
        [turned_path, kept_path]
    } else {
        [kept_path, turned_path]
    };
    editing.text.set(&["joints", name, "type"], "\"weld\"");
    let markers = format!("[\"{from}\", \"{to}\"]");
    editing.text.set(&["joints", name, "markers"], &markers);
    Ok(())
}

/// Welds a marker to ground.
pub(super) fn weld_to_ground(editing: &mut Editing, path: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    if editing.body_of(marker)? == "ground" {
        return Err(format!("`{path}` is a point of ground: choose one of a body").into());
    }
    let [x, y] = editing.drawn.point(marker);
    let turn = editing
        .drawn
        .settled_value(editing.drawn.place(marker)[2], true);
    let name = editing.ground_name(marker_name(path));
    let ground = editing.add_marker("ground", &name, [x, y, turn]);
    editing.join(&name, "weld", [&ground, path]);
    Ok(())
}

/// Returns a marker at a marker's point whose x-axis has a direction \[rad\]: the marker itself, turned if
/// only `joint` and pins use it, or a new one.
fn directed(
    editing: &mut Editing,
    marker: MarkerId,
    joint: &str,
    direction: f64,
) -> Result<String, Refusal> {
    let mechanism = editing.mechanism()?;
    let path = mechanism.marker_path(marker);
    let body = editing.body_of(marker)?;
    let [x, y, before] = editing.drawn.inside(marker);
    let now = within_turn(direction - editing.frame(body)?[2]);
    if within_turn(now - before).abs() <= SAME_DIRECTION {
        return Ok(path);
    }
    let now = editing.drawn.settled_value(now, true);
    let own = match body {
        "ground" => vec!["ground", "markers", marker_name(&path)],
        _ => vec!["bodies", body, "markers", marker_name(&path)],
    };
    let is_blind = |user: &str| user == joint || editing.joint(user).is_ok_and(Joint::is_pin);
    let users = references(&editing.text).into_iter();
    let mut users = users.filter(|found| found.is_of(&path));
    let is_own = users.all(|found| matches!(&found.path[..], [section, user, ..] if section == "joints" && is_blind(user)));
    if is_own && editing.text.element(&own, 1).is_some() {
        let own: Vec<String> = own.iter().map(|&key| key.to_owned()).collect();
        put(editing, &own, Some(2), &json!(Editing::angle(now)))?;
        return Ok(path);
    }
    let letter = editing.names.new_letter();
    Ok(editing.add_marker(body, &letter, [x, y, now]))
}
