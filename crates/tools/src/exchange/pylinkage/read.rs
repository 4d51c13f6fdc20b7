//! Mechanisms of pylinkage, read.

use std::collections::HashMap;

use serde_json::{Map, Value};

use crate::exchange::draft::{
    Coordinate, Draft, Driver, DriverSource, GROUND, JointKind, LengthUnit, Point, turn_between,
};
use crate::exchange::error::{self, Error};
use crate::exchange::note::Note;
use crate::exchange::others::Others;
use crate::exchange::sketch::{Bodies, Sketch};

/// Reads a file.
pub(in crate::exchange) fn read(
    text: &str,
    length: Option<LengthUnit>,
    draft: &mut Draft,
) -> Result<(), Error> {
    let root: Value = serde_json::from_str(text).map_err(|error| Error::Json {
        line: error.line(),
        reason: error::start_of(&error.to_string()),
    })?;
    let root = object(&root, "the file")?;
    refuse_others(root)?;
    draft.unit = length.unwrap_or(LengthUnit::Metre);
    if length.is_none() {
        draft.note(Note::Unit {
            unit: draft.unit.name(),
        });
    }
    if let Some(name) = root.get("name").and_then(Value::as_str) {
        draft.name = error::start_of(name);
    }
    let joints = list(root, "joints")?;
    let links = list(root, "links")?;
    sort_keys(root, joints, links).note(draft);
    let ground = root.get("ground").and_then(Value::as_str);
    let mut sketch = Sketch::default();
    let mut by_id = HashMap::new();
    let mut motors = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let place = format!("joints[{index}]");
        let joint = object(joint, &place)?;
        let id = text_of(joint, "id", &place)?;
        let name = joint.get("name").and_then(Value::as_str);
        let name = name.filter(|name| !name.is_empty()).unwrap_or(id);
        let point = sketch.add_point(name, pair(joint, "position", &place)?);
        if text_of(joint, "type", &place)? == "ground" {
            sketch.anchor(point);
        }
        by_id.insert(id, point);
    }
    let point = |id: &str, place: &str| {
        by_id.get(id).copied().ok_or_else(|| Error::Unknown {
            place: place.to_owned(),
            kind: "joint",
            name: error::start_of(id),
        })
    };
    let mut read_links = Vec::new();
    for (index, link) in links.iter().enumerate() {
        let place = format!("links[{index}]");
        let link = object(link, &place)?;
        let id = text_of(link, "id", &place)?;
        let kind = text_of(link, "type", &place)?;
        let mut points = Vec::new();
        for id in list(link, "joints").map_err(|_| wrong(&format!("{place}.joints"), "a list"))? {
            let id = id.as_str().ok_or_else(|| wrong(&place, "a list of ids"))?;
            points.push(point(id, &place)?);
        }
        if kind == "ground" || Some(id) == ground {
            for point in points {
                sketch.anchor(point);
            }
            continue;
        }
        if kind == "driver" || kind == "arc_driver" {
            let motor = point(text_of(link, "motor_joint", &place)?, &place)?;
            // Files leave its type out.
            sketch.anchor(motor);
            motors.push((motor, read_links.len(), link));
        }
        let name = link.get("name").and_then(Value::as_str).unwrap_or(id);
        read_links.push((name, points));
    }
    let trackers = trackers(joints, &mut read_links, &point)?;
    let of_link: Vec<usize> = read_links
        .into_iter()
        .map(|(name, points)| sketch.add_link(name, points))
        .collect();
    let bodies = sketch.build(draft);
    for (motor, link, keys) in motors {
        let body = bodies.of_link[of_link[link]];
        let ends = bodies.on(GROUND, motor).zip(bodies.on(body, motor));
        let Some((from, to)) = ends.filter(|_| body != GROUND) else {
            continue;
        };
        let name = sketch.name(motor).to_owned();
        let speed = keys.get("angular_velocity").and_then(Value::as_f64);
        let name = format!("{name}_angle");
        if speed.is_some_and(|speed| speed != 0.0) {
            draft.note(Note::PerStep { name: name.clone() });
        }
        let arc = ["arc_start", "arc_end"].map(|key| keys.get(key).and_then(Value::as_f64));
        let start = draft.drawn(Coordinate::Angle, from, to);
        // Both ends as turns from the start, so that it lies between them.
        let arc = match arc {
            [Some(a), Some(b)] if error::is_usable(a) && error::is_usable(b) => {
                let at = start + turn_between(start, a);
                Some([at.min(at + b - a), at.max(at + b - a)])
            }
            _ => None,
        };
        draft.drivers.push(Driver {
            name,
            coordinate: Coordinate::Angle,
            from,
            to,
            source: DriverSource::Input,
            limits: arc.filter(|[min, max]| (*min..=*max).contains(&start)),
        });
    }
    slides(joints, draft, &bodies, &point)?;
    for tracker in trackers {
        let placed = bodies.at_point[tracker].iter();
        let moving = placed.copied().find(|placed| placed.body != GROUND);
        draft.outputs.extend(moving);
    }
    Ok(())
}

/// Sorts the keys of a file; what the positions give is not taken twice.
fn sort_keys(root: &Map<String, Value>, joints: &[Value], links: &[Value]) -> Others {
    const FILE: [&str; 4] = ["name", "ground", "joints", "links"];
    const JOINT: [&str; 8] = [
        "id",
        "type",
        "name",
        "position",
        "axis",
        "line_point",
        "ref_joint1_id",
        "ref_joint2_id",
    ];
    const LINK: [&str; 8] = [
        "id",
        "type",
        "name",
        "joints",
        "motor_joint",
        "angular_velocity",
        "arc_start",
        "arc_end",
    ];
    let mut others = Others::default();
    for key in root.keys() {
        others.sort("file", key, &FILE, &[]);
    }
    let keys = |list: &[Value]| -> Vec<String> {
        let objects = list.iter().filter_map(Value::as_object);
        objects.flat_map(Map::keys).cloned().collect()
    };
    for key in keys(joints) {
        others.sort(
            "joint",
            &key,
            &JOINT,
            &["slide_distance", "distance", "angle"],
        );
    }
    for key in keys(links) {
        others.sort("link", &key, &LINK, &["initial_angle"]);
    }
    others
}

/// Refuses files of pylinkage that have no positions, or other classes.
fn refuse_others(root: &Map<String, Value>) -> Result<(), Error> {
    let has = |key| root.contains_key(key);
    let first = root.get("joints").and_then(|joints| joints.get(0));
    let kind = first
        .and_then(|joint| joint.get("type"))
        .and_then(Value::as_str);
    let kind = match kind {
        _ if has("nodes") || has("hyperedges") || has("edges") => "hypergraph",
        _ if has("groups") || has("assur_groups") => "Assur graph",
        Some("Static" | "Crank" | "Revolute" | "Fixed" | "Linear" | "Prismatic") => {
            "Linkage of the former classes"
        }
        _ => return Ok(()),
    };
    Err(Error::OtherJson { kind })
}

/// Adds trackers to the links of their two joints; returns their points.
fn trackers(
    joints: &[Value],
    links: &mut [(&str, Vec<usize>)],
    point: &impl Fn(&str, &str) -> Result<usize, Error>,
) -> Result<Vec<usize>, Error> {
    let mut trackers = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let place = format!("joints[{index}]");
        let joint = object(joint, &place)?;
        if text_of(joint, "type", &place)? != "tracker" {
            continue;
        }
        let id = text_of(joint, "id", &place)?;
        let own = point(id, &place)?;
        let references = [
            point(text_of(joint, "ref_joint1_id", &place)?, &place)?,
            point(text_of(joint, "ref_joint2_id", &place)?, &place)?,
        ];
        trackers.push(own);
        if links.iter().any(|(_, points)| points.contains(&own)) {
            continue;
        }
        let carries = |points: &[usize]| {
            references
                .iter()
                .all(|reference| points.contains(reference))
        };
        match links.iter_mut().find(|(_, points)| carries(points)) {
            Some((_, points)) => points.push(own),
            None => {
                return Err(Error::Unknown {
                    place: format!("tracker `{}`", error::start_of(id)),
                    kind: "a link through both its joints, of",
                    name: error::start_of(id),
                });
            }
        }
    }
    Ok(trackers)
}

/// Adds the lines of prismatic joints, which stand still.
fn slides(
    joints: &[Value],
    draft: &mut Draft,
    bodies: &Bodies,
    point: &impl Fn(&str, &str) -> Result<usize, Error>,
) -> Result<(), Error> {
    for (index, joint) in joints.iter().enumerate() {
        let place = format!("joints[{index}]");
        let joint = object(joint, &place)?;
        match text_of(joint, "type", &place)? {
            "ground" | "revolute" | "tracker" => continue,
            "prismatic" => {}
            other => {
                return Err(Error::UnknownJoint {
                    joint: error::start_of(text_of(joint, "id", &place)?),
                    class: error::start_of(other),
                });
            }
        }
        let id = text_of(joint, "id", &place)?;
        let axis = pair(joint, "axis", &place)?;
        if axis[0].hypot(axis[1]) <= 0.0 {
            return Err(wrong(&format!("{place}.axis"), "a direction"));
        }
        let at = if joint.contains_key("line_point") {
            pair(joint, "line_point", &place)?
        } else {
            pair(joint, "position", &place)?
        };
        let placed = bodies.at_point[point(id, &place)?].first();
        let Some(&slid) = placed.filter(|placed| placed.body != GROUND) else {
            continue;
        };
        let from = draft.add_point(
            GROUND,
            Point {
                name: format!("{id}_way"),
                at,
                angle: Some(axis[1].atan2(axis[0])),
            },
        );
        draft.join(&format!("{id}_slot"), JointKind::Slot, from, slid);
    }
    Ok(())
}

fn wrong(place: &str, expected: &'static str) -> Error {
    Error::JsonType {
        place: place.to_owned(),
        expected,
    }
}

fn object<'a>(value: &'a Value, place: &str) -> Result<&'a Map<String, Value>, Error> {
    value.as_object().ok_or_else(|| wrong(place, "an object"))
}

fn list<'a>(object: &'a Map<String, Value>, key: &str) -> Result<&'a Vec<Value>, Error> {
    let list = object.get(key).and_then(Value::as_array);
    list.ok_or_else(|| wrong(key, "a list"))
}

fn text_of<'a>(object: &'a Map<String, Value>, key: &str, place: &str) -> Result<&'a str, Error> {
    let text = object.get(key).and_then(Value::as_str);
    text.ok_or_else(|| wrong(&format!("{place}.{key}"), "a text"))
}

fn pair(object: &Map<String, Value>, key: &str, place: &str) -> Result<[f64; 2], Error> {
    let numbers = object.get(key).and_then(Value::as_array);
    let numbers = numbers.map(|numbers| {
        let numbers = numbers.iter().filter_map(Value::as_f64);
        numbers
            .filter(|x| error::is_usable(*x))
            .collect::<Vec<f64>>()
    });
    match numbers.as_deref() {
        Some(&[x, y]) => Ok([x, y]),
        _ => Err(wrong(&format!("{place}.{key}"), "two numbers up to 1e9")),
    }
}
