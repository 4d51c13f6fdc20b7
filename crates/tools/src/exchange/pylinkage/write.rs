//! Mechanisms of pylinkage, written.

use std::f64::consts::TAU;

use serde_json::{Map, Value, json};

use crate::exchange::pins::Pins;

/// Angle of an input per step of pylinkage \[rad\].
const STEP: f64 = TAU / 360.0;

/// Returns a mechanism as JSON of pylinkage, with lengths in metres.
#[must_use]
pub fn pylinkage_json(pins: &Pins) -> String {
    // A pin without a way that one link has is a point of that link.
    let links_of = |pin: usize| {
        let links = pins.links.iter().filter(move |link| link.pins.len() > 1);
        links.filter(move |link| link.pins.contains(&pin))
    };
    let is_tracker = |pin: usize| {
        let only = &pins.pins[pin];
        !only.is_ground
            && only.way.is_none()
            && links_of(pin).count() == 1
            && references(pins, pin).is_some()
    };
    let joints = pins.pins.iter().enumerate().map(|(index, pin)| {
        let mut joint = Map::new();
        let kind = match pin.way {
            _ if pin.is_ground => "ground",
            Some(_) => "prismatic",
            None if is_tracker(index) => "tracker",
            None => "revolute",
        };
        joint.insert("id".to_owned(), json!(id(pins, index)));
        joint.insert("type".to_owned(), json!(kind));
        joint.insert("position".to_owned(), json!(pin.at));
        joint.insert("name".to_owned(), json!(pin.name));
        if let Some(angle) = pin.way {
            joint.insert("axis".to_owned(), json!([angle.cos(), angle.sin()]));
            joint.insert("line_point".to_owned(), json!(pin.at));
            joint.insert("slide_distance".to_owned(), json!(0.0));
        }
        if let Some([first, second]) = references(pins, index).filter(|_| kind == "tracker") {
            let way = |from: usize, to: usize| {
                let [from, to] = [from, to].map(|pin| pins.pins[pin].at);
                [to[0] - from[0], to[1] - from[1]]
            };
            let (own, base) = (way(first, index), way(first, second));
            let angle = own[1].atan2(own[0]) - base[1].atan2(base[0]);
            joint.insert("ref_joint1_id".to_owned(), json!(id(pins, first)));
            joint.insert("ref_joint2_id".to_owned(), json!(id(pins, second)));
            joint.insert("distance".to_owned(), json!(own[0].hypot(own[1])));
            joint.insert("angle".to_owned(), json!(angle));
        }
        Value::Object(joint)
    });
    let ground = (0..pins.pins.len()).filter(|pin| pins.pins[*pin].is_ground);
    let ground: Vec<String> = ground.map(|pin| id(pins, pin)).collect();
    let mut links = vec![json!({ "id": "ground", "type": "ground", "joints": ground })];
    for (index, link) in pins.links.iter().enumerate() {
        // The block of a slider is its joint.
        if link.pins.len() < 2 {
            continue;
        }
        let joints = link.pins.iter().filter(|pin| !is_tracker(**pin));
        let joints: Vec<String> = joints.map(|pin| id(pins, *pin)).collect();
        links.push(match pins.inputs.iter().find(|input| input.link == index) {
            None => json!({ "id": link.name, "type": "link", "joints": joints }),
            Some(input) => {
                let others = link.pins.iter().filter(|pin| **pin != input.pin);
                let angle = others.map(|pin| {
                    let [from, to] = [input.pin, *pin].map(|pin| pins.pins[pin].at);
                    (to[1] - from[1]).atan2(to[0] - from[0])
                });
                json!({
                    "id": link.name,
                    "type": "driver",
                    "joints": joints,
                    "motor_joint": id(pins, input.pin),
                    "angular_velocity": STEP.copysign(input.speed.unwrap_or(1.0)),
                    "initial_angle": angle.take(1).sum::<f64>(),
                })
            }
        });
    }
    let mechanism = json!({
        "name": pins.name,
        "joints": joints.collect::<Vec<Value>>(),
        "links": links,
        "ground": "ground",
    });
    format!("{mechanism:#}\n")
}

/// Returns the id of a joint: its name, numbered where another one has it.
fn id(pins: &Pins, pin: usize) -> String {
    let name = &pins.pins[pin].name;
    let before = pins.pins[..pin].iter().filter(|other| other.name == *name);
    match before.count() {
        0 => name.clone(),
        count => format!("{name}_{}", count + 1),
    }
}

/// Returns two other joints of the link of a point, between which pylinkage measures it: joints that
/// several links, ground or a way hold.
fn references(pins: &Pins, point: usize) -> Option<[usize; 2]> {
    let link = pins.links.iter().find(|link| link.pins.contains(&point))?;
    let is_held = |pin: &&usize| {
        let held = &pins.pins[**pin];
        let links = pins.links.iter().filter(|link| link.pins.contains(pin));
        **pin != point && (held.is_ground || held.way.is_some() || links.count() > 1)
    };
    let mut others = link.pins.iter().filter(is_held);
    Some([*others.next()?, *others.next()?])
}
