//! Bodies that are duplicated or mirrored, with the joints among them and with ground; duplicates with
//! what drives and loads them, too.

use std::collections::BTreeMap;

use super::super::drawn::within_turn;
use super::super::reference::references;
use super::{Editing, Refusal};
use crate::write::{TomlText, in_braces, in_lines};
use biela::mechanism::{Body, BodyId, Joint, MarkerId, Mechanism};

/// The way from a body to its copy.
#[derive(Clone, Copy, Debug)]
enum Way {
    By([f64; 2]),
    /// Over the line through a point at an angle \[rad\].
    Over([f64; 2], f64),
}

impl Way {
    /// Returns the copy of a frame; a mirrored one has mirrored points in it.
    fn frame(self, [x, y, phi]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::By([dx, dy]) => [x + dx, y + dy, phi],
            Self::Over([u, v], angle) => {
                let (sin, cos) = (2.0 * angle).sin_cos();
                let [dx, dy] = [x - u, y - v];
                let place = [u + cos * dx + sin * dy, v + sin * dx - cos * dy];
                [place[0], place[1], 2.0 * angle - phi]
            }
        }
    }

    fn is_mirror(self) -> bool {
        matches!(self, Self::Over(..))
    }
}

/// The names of the copies.
struct Copies {
    bodies: BTreeMap<String, String>,
    /// Paths of points of ground.
    ground: BTreeMap<String, String>,
}

impl Copies {
    /// Returns the name of the copy of a body, or the path of that of a marker, if there is one.
    fn of(&self, name: &str) -> Option<String> {
        if let Some(copy) = self.ground.get(name) {
            return Some(copy.clone());
        }
        let (body, rest) = name.split_at(name.find('.').unwrap_or(name.len()));
        Some(format!("{}{rest}", self.bodies.get(body)?))
    }
}

/// Sections whose entries are duplicated with all bodies that they name.
const DUPLICATED: [&str; 4] = ["drivers", "freedoms", "forces", "stops"];

/// Copies bodies, moved by a way.
pub(super) fn duplicate(
    editing: &mut Editing,
    bodies: &[String],
    by: [f64; 2],
) -> Result<(), Refusal> {
    copy(editing, bodies, Way::By(by))
}

/// Copies bodies, mirrored over the line through a point at an angle \[rad\].
pub(super) fn mirror(
    editing: &mut Editing,
    bodies: &[String],
    at: [f64; 2],
    angle: f64,
) -> Result<(), Refusal> {
    copy(editing, bodies, Way::Over(at, angle))
}

/// Copies bodies. The joints among them and with ground are copied, too, with points of ground of their
/// own; where they are not mirrored, also their drivers, freedoms, forces and stops.
fn copy(editing: &mut Editing, names: &[String], way: Way) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    if names.is_empty() {
        return Err("choose bodies to copy".into());
    }
    let mut bodies: Vec<&Body> = Vec::new();
    for name in names {
        let body = editing.body(name)?;
        if !bodies.iter().any(|other| other.name == body.name) {
            bodies.push(body);
        }
    }
    let is_copied = |id: MarkerId| match mechanism.markers[id.index()].body {
        Some(body) => bodies
            .iter()
            .any(|copied| copied.name == mechanism.bodies[body.index()].name),
        None => true,
    };
    // An equation ties drivers and measures, which have no copies.
    let joints = mechanism
        .joints
        .iter()
        .filter(|joint| joint.equation().is_none() && joint.markers().all(is_copied));
    let joints: Vec<&Joint> = joints.collect();
    if way.is_mirror() {
        refuse_unmirrored(&joints)?;
    }
    let mut copies = Copies {
        bodies: BTreeMap::new(),
        ground: BTreeMap::new(),
    };
    let wheels: Vec<BodyId> = (joints.iter())
        .flat_map(|joint| {
            let Some(wheels) = joint.wheels() else {
                return Vec::new();
            };
            let ends = joint.markers().map(|id| mechanism.markers[id.index()].body);
            ends.chain([wheels.carrier()]).flatten().collect()
        })
        .collect();
    for body in &bodies {
        let name = editing.names.new_name(stem(&body.name));
        copies.bodies.insert(body.name.clone(), name);
    }
    for body in &bodies {
        let id = mechanism.body_id(&body.name);
        let mut frame = way.frame(editing.drawn.frame(id));
        // The angles of wheels count turns.
        if way.is_mirror() && !id.is_some_and(|id| wheels.contains(&id)) {
            frame[2] = within_turn(frame[2]);
        }
        copy_body(editing, body, way, frame, &copies.bodies[&body.name]);
    }
    for joint in &joints {
        for id in joint.markers() {
            copy_ground(editing, mechanism, id, way, &mut copies);
        }
    }
    for joint in joints {
        copy_joint(editing, joint, way, &copies)?;
    }
    if !way.is_mirror() {
        for section in DUPLICATED {
            for entry in editing.text.keys(&[section]) {
                copy_entry(editing, mechanism, [section, &entry], way, &mut copies)?;
            }
        }
    }
    Ok(())
}

/// Copies a marker if it is one of ground and has no copy yet.
fn copy_ground(
    editing: &mut Editing,
    mechanism: &Mechanism,
    id: MarkerId,
    way: Way,
    copies: &mut Copies,
) {
    let marker = &mechanism.markers[id.index()];
    let path = mechanism.marker_path(id);
    if marker.body.is_none() && !copies.ground.contains_key(&path) {
        let name = editing.ground_name(stem(&marker.name));
        let place = way.frame(editing.drawn.inside(id));
        let copy = editing.add_marker("ground", &name, place);
        copies.ground.insert(path, copy);
    }
}

/// Adds the copy of an entry if it names bodies and all of them have copies.
fn copy_entry(
    editing: &mut Editing,
    mechanism: &Mechanism,
    own: [&str; 2],
    way: Way,
    copies: &mut Copies,
) -> Result<(), Refusal> {
    let all = references(&editing.text);
    let named: Vec<&str> = (all.iter())
        .filter(|found| found.is_in(&own))
        .map(|found| &*found.name)
        .collect();
    let mut grounds = Vec::new();
    let mut has_copy = false;
    for name in named {
        let head = name.split('.').next().unwrap_or(name);
        if head == "ground" {
            grounds.extend(editing.drawn.marker(name));
        } else if copies.bodies.contains_key(head) {
            has_copy = true;
        } else if mechanism.parameter_id(head).is_none() && editing.names.is_taken(head) {
            // A body that stays alone, a joint or a driver.
            return Ok(());
        }
    }
    if !has_copy {
        return Ok(());
    }
    for id in grounds {
        copy_ground(editing, mechanism, id, way, copies);
    }
    let mut entries = Vec::new();
    for key in editing.text.keys(&own) {
        let value = editing.text.value(&[own[0], own[1], &key]);
        let value = renamed([own[0], &key], &value, copies)?;
        entries.push((key, value));
    }
    write_entry(editing, own, &entries);
    Ok(())
}

/// Writes the copy of an entry of a section, under a new name.
fn write_entry(editing: &mut Editing, [section, name]: [&str; 2], entries: &[(String, String)]) {
    let name = editing.names.new_name(stem(name));
    let path = [section, &*name];
    match in_braces(&name, entries) {
        Some(braces) => editing.text.set(&path, &braces),
        None => editing.text.add_section(&path, &in_lines(entries)),
    }
}

/// Refuses to mirror what has a shape of its own.
fn refuse_unmirrored(joints: &[&Joint]) -> Result<(), Refusal> {
    let shaped = joints.iter().find_map(|joint| {
        let of_cam = joint.cam().map(|_| "the contour of its cam");
        let of_curve = joint.curve().map(|_| "its curve");
        Some((joint, of_cam.or(of_curve)?))
    });
    match shaped {
        Some((joint, shape)) => Err(format!(
            "joint `{}` cannot be mirrored, as {shape} would have to be drawn anew: duplicate the \
             bodies, or choose others",
            joint.name
        )
        .into()),
        None => Ok(()),
    }
}

/// Returns a name without the number behind it.
fn stem(name: &str) -> &str {
    match name.rsplit_once('_') {
        Some((stem, number))
            if number.bytes().all(|b| b.is_ascii_digit()) && !number.is_empty() =>
        {
            stem
        }
        _ => name,
    }
}

fn copy_body(editing: &mut Editing, body: &Body, way: Way, frame: [f64; 3], name: &str) {
    let own = ["bodies", &*body.name];
    let mut markers = Vec::new();
    let mut lines = vec![format!("estimate = {}", editing.estimate(frame))];
    for key in editing.text.keys(&own) {
        let path = [own[0], own[1], &key];
        match &*key {
            "markers" => {
                for marker in editing.text.keys(&path) {
                    let path = [own[0], own[1], "markers", &marker];
                    let place = copied_marker(editing, &path, way.is_mirror());
                    markers.push((marker, place));
                }
            }
            "estimate" => {}
            "center" if way.is_mirror() => {
                lines.push(format!("{key} = {}", mirrored_list(editing, &path)));
            }
            _ => lines.push(format!("{key} = {}", editing.text.value(&path))),
        }
    }
    editing.write_body(name, &markers, lines);
}

/// Writes the copy of a marker.
fn copied_marker(editing: &Editing, path: &[&str], is_mirror: bool) -> String {
    if !is_mirror {
        return editing.text.value(path);
    }
    if editing.text.element(path, 0).is_some() {
        return mirrored_list(editing, path);
    }
    let part = |key: &str| editing.text.value(&[path, &[key]].concat());
    format!(
        "{{ r = {}, angle = {} }}",
        part("r"),
        negative(&part("angle"))
    )
}

/// Writes a list `[x, y]` or `[x, y, angle]` with y and angle negative.
fn mirrored_list(editing: &Editing, path: &[&str]) -> String {
    let elements = (0..).map_while(|index| editing.text.element(path, index));
    let elements = elements.enumerate().map(|(index, place)| {
        let text = &editing.text.as_str()[place];
        if index == 0 {
            text.to_owned()
        } else {
            negative(text)
        }
    });
    format!("[{}]", elements.collect::<Vec<_>>().join(", "))
}

/// Writes the negative of a number or of an expression.
fn negative(value: &str) -> String {
    let inside = value.trim().trim_matches(['"', '\'']);
    let quoted = |text: String| {
        if value.starts_with(['"', '\'']) {
            format!("\"{text}\"")
        } else {
            text
        }
    };
    let number = inside.replace('_', "").parse::<f64>();
    if number.as_ref().is_ok_and(|number| *number == 0.0) {
        return value.to_owned();
    }
    // The sign of a number and that of a product are those of the whole.
    let is_product = |text: &str| number.is_ok() || !text.contains(['+', '-', '(']);
    match inside.strip_prefix('-') {
        Some(rest) if is_product(rest) => quoted(rest.trim().to_owned()),
        _ if is_product(inside) => quoted(format!("-{}", inside.trim_start_matches('+'))),
        _ => quoted(format!("-({inside})")),
    }
}

/// Adds the copy of a joint.
fn copy_joint(
    editing: &mut Editing,
    joint: &Joint,
    way: Way,
    copies: &Copies,
) -> Result<(), Refusal> {
    let own = ["joints", &*joint.name];
    let mut entries = Vec::new();
    for key in editing.text.keys(&own) {
        let value = editing.text.value(&[own[0], own[1], &key]);
        let mut value = renamed(["joints", &key], &value, copies)?;
        if way.is_mirror() {
            value = mirrored(&key, value);
        }
        entries.push((key, value));
    }
    if way.is_mirror() {
        mirror_phase(editing, &mut entries, joint, copies);
    }
    if way.is_mirror()
        && joint.wheels().is_some_and(|wheels| wheels.is_on_line())
        && !entries.iter().any(|(key, _)| key == "side")
    {
        entries.push(("side".to_owned(), "\"below\"".to_owned()));
    }
    write_entry(editing, own, &entries);
    Ok(())
}

/// Mirrors the phase of wheels: its sign changes on a carrier that is mirrored, too; on one that is not,
/// such as ground, and on racks and tracks, they mesh as they are drawn.
fn mirror_phase(
    editing: &Editing,
    entries: &mut Vec<(String, String)>,
    joint: &Joint,
    copies: &Copies,
) {
    let Some(wheels) = joint.wheels() else {
        return;
    };
    let carrier = wheels.carrier();
    let mechanism = editing.drawn.mechanism.as_ref();
    let bodies = mechanism.map_or(&[][..], |mechanism| &mechanism.bodies);
    let carrier = carrier.and_then(|id| bodies.get(id.index()));
    let is_carried = carrier.is_some_and(|body| copies.bodies.contains_key(&body.name));
    let drawn = || "\"drawn\"".to_owned();
    match entries.iter_mut().find(|(key, _)| key == "phase") {
        Some((_, phase)) if is_carried && *phase != drawn() => *phase = negative(phase),
        Some((_, phase)) => *phase = drawn(),
        None if is_carried => {}
        None => entries.push(("phase".to_owned(), drawn())),
    }
}

/// Writes a value of an entry of a section with the names of the copies.
fn renamed([section, key]: [&str; 2], value: &str, copies: &Copies) -> Result<String, Refusal> {
    let head = format!("{section}.copy.{key} = ");
    let text = TomlText::new(format!("{head}{value}"));
    let mut text = text.map_err(|error| error.to_string())?;
    let parts: Vec<_> = (references(&text).into_iter())
        .filter_map(|found| Some((found.place.clone(), copies.of(&found.name)?)))
        .collect();
    text.replace_all(&parts);
    Ok(text.as_str()[head.len()..].trim_end().to_owned())
}

/// Writes a value of a joint mirrored.
fn mirrored(key: &str, value: String) -> String {
    match key {
        "offset" => negative(&value),
        "side" if value.trim_matches('"') == "above" => "\"below\"".to_owned(),
        "side" => "\"above\"".to_owned(),
        // The pulleys of a rope.
        "markers" if value.contains("\"left\"") || value.contains("\"right\"") => value
            .replace("\"left\"", "\"\u{0}\"")
            .replace("\"right\"", "\"left\"")
            .replace("\"\u{0}\"", "\"right\""),
        _ => value,
    }
}
