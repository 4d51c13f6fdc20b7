//! Links that open a mechanism in PMKS+.

use std::fmt::Write as _;

use super::digits::{PARTS, check, digits};
use crate::exchange::pins::Pins;

/// Address of the program.
const ADDRESS: &str = "https://app.pmksplus.com/?";

/// Switches and scale of the picture as a new mechanism has them; lengths in centimetres, newtons.
const SWITCHES: u64 = 24;
const SCALE: &str = "Ti";
const UNITS: &str = "101";

/// Speed of an input without a motion \[rpm\], the program's own.
const RPM: f64 = 20.0;

/// Bits of a joint.
const PRISMATIC: u64 = 1;
const INPUT: u64 = 2;
const GROUNDED: u64 = 4;
const CURVE: u64 = 16;

/// Returns a link that opens a mechanism in PMKS+, to ten micrometres.
#[must_use]
pub fn pmks_link(pins: &Pins) -> String {
    let in_rpm =
        |speed: Option<f64>| speed.map_or(RPM, |speed| speed * 30.0 / std::f64::consts::PI);
    let rpm = in_rpm(pins.inputs.first().and_then(|input| input.speed));
    // Whole turns per minute, and a mechanism that turns.
    let speed = rpm.abs().round().max(1.0);
    // The sign of an own speed is its sense; both are written with the same digits.
    let is_common = |own: f64, common: f64| (own - common).abs() < 0.5 / PARTS;
    let are_alike = |common: f64| {
        let mut speeds = pins.inputs.iter().map(|input| in_rpm(input.speed));
        speeds.all(|own| is_common(own, common))
    };
    let is_clockwise = rpm < 0.0 && are_alike(-speed);
    let common = if is_clockwise { -speed } else { speed };
    let switches = SWITCHES + u64::from(is_clockwise);
    let mut query = format!(
        "0{}.{SCALE}.{},0.{UNITS}.",
        digits(switches as f64),
        digits(speed)
    );
    // Lengths in centimetres; names may stand for themselves.
    let decimal = |value: f64| digits((PARTS * value).round());
    let at = |at: [f64; 2]| at.map(|x| decimal(100.0 * x)).join(",");
    let id = |pin: usize| format!("J{pin}");
    let mut ways = Vec::new();
    for (index, pin) in pins.pins.iter().enumerate() {
        let input = pins.inputs.iter().find(|input| input.pin == index);
        let is_input = input.is_some();
        // A speed that is not the common one stands in the ninth field.
        let own = input
            .map(|input| in_rpm(input.speed))
            .filter(|own| !is_common(*own, common));
        let own = own.map_or(String::new(), |own| format!(",,,,{}", decimal(own)));
        let mut flags = if pin.is_ground { GROUNDED } else { 0 };
        flags += if is_input { INPUT } else { 0 };
        flags += if pin.is_shown { CURVE } else { 0 };
        let (id, name) = (id(index), &pin.name);
        let _ = write!(
            query,
            "{}{id},{name},{},0{own}.",
            digits(flags as f64),
            at(pin.at)
        );
        if let Some(angle) = pin.way {
            ways.push((index, angle));
        }
    }
    for (index, angle) in &ways {
        let flags = digits((PRISMATIC + GROUNDED) as f64);
        let place = at(pins.pins[*index].at);
        let _ = write!(
            query,
            "{flags}W{index},W{index},{place},{}.",
            decimal(*angle)
        );
    }
    query.push('.');
    let mut link = |kind: char, id: &str, name: &str, joints: &[String], middle: [f64; 2]| {
        let one = decimal(1.0);
        let _ = write!(
            query,
            "Y{kind}{id},{name},{one},{one},{},303e9f,{},,.",
            at(middle),
            joints.join(",")
        );
    };
    for (index, body) in pins.links.iter().enumerate() {
        if body.pins.len() < 2 {
            continue;
        }
        let count = body.pins.len() as f64;
        let middle = [0, 1].map(|k| {
            let sum: f64 = body.pins.iter().map(|pin| pins.pins[*pin].at[k]).sum();
            sum / count
        });
        let joints: Vec<String> = body.pins.iter().map(|pin| id(*pin)).collect();
        link('R', &format!("L{index}"), &body.name, &joints, middle);
    }
    for (index, _) in &ways {
        let joints = [id(*index), format!("W{index}")];
        let mut blocks = pins.links.iter().filter(|link| link.pins == [*index]);
        let own = format!("slider_{}", pins.pins[*index].name);
        let name = blocks.next().map_or(own, |block| block.name.clone());
        link(
            'P',
            &format!("S{index}"),
            &name,
            &joints,
            pins.pins[*index].at,
        );
    }
    // No force, and nothing chosen.
    query.push_str("..N");
    let last = check(&query);
    format!("{ADDRESS}{query}{last}")
}
