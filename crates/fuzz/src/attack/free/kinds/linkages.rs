//! Linkages with friction in their joints, stops, and freedoms whose coordinates have dead points.

use std::f64::consts::FRAC_PI_2;

use super::{DEAD_POINTS, is, log_between};
use crate::attack::free::case::{Case, Check};
use crate::attack::free::text::Text;
use crate::attack::text::{Point, angle, direction, distance, dyad, end, sign};
use crate::mutation::Chance;

/// Adds a bar between two points, with a mass.
fn add_bar(chance: &mut Chance, text: &mut Text, name: &str, from: Point, to: Point) {
    let length = distance(from, to);
    let mass = chance.between(0.2, 2.0);
    let inertia = mass * length * length / 12.0;
    let markers = format!("a = [0, 0], b = [{length:?}, 0]");
    let pose = [from[0], from[1], direction(from, to)];
    text.body(name, &markers, pose, [mass, inertia, 0.5 * length]);
}

/// Adds a pin, with friction or not.
fn add_pin(chance: &mut Chance, text: &mut Text, name: &str, markers: [&str; 2]) {
    text.joint(name, "revolute", markers, "");
    if is(chance, 0.4) {
        let coefficient = chance.between(0.02, 0.3);
        let sticking = coefficient * [1.0, chance.between(1.0, 1.5)][chance.below(2)];
        let radius = log_between(chance, 0.003, 0.03);
        let entry = format!(
            "{{ joint = '{name}', coefficient = {coefficient:?}, static = {sticking:?}, radius = {radius:?} }}"
        );
        text.add("friction", &format!("rub_{name}"), &entry);
    }
}

/// Adds a stop to an angle that starts somewhere, or not.
fn add_stop(chance: &mut Chance, text: &mut Text, checks: &mut Vec<Check>, name: &str, start: f64) {
    if !is(chance, 0.5) {
        return;
    }
    let mut away = || {
        if is(chance, 0.7) {
            chance.between(0.05, 2.0)
        } else {
            100.0
        }
    };
    let [least, most] = [start - away(), start + away()];
    let restitution = text.nudged([0.0, chance.between(0.0, 0.8)][chance.below(2)]);
    let entry = format!(
        "{{ of = '{name}', min = {least:?}, max = {most:?}, restitution = {restitution:?} }}"
    );
    text.add("stops", &format!("stop_{name}"), &entry);
    checks.push(Check::stop(name, [least, most]));
}

/// Adds a torque that pushes to and fro. Returns whether there is one.
fn add_torque(chance: &mut Chance, text: &mut Text, markers: [&str; 2]) -> bool {
    let is_pushed = is(chance, 0.5);
    if is_pushed {
        let torque = text.nudged(log_between(chance, 0.1, 10.0));
        let rate = chance.between(0.5, 10.0);
        text.along(
            "forces",
            "torque",
            "angle",
            markers,
            &format!(", value = '{torque:?}*sin({rate:?}*t)'"),
        );
    }
    is_pushed
}

/// A four-bar, perhaps with a dyad and a slider, or with a pendulum on its coupler; the freedom is the angle of
/// any of its bars, with dead points or without.
pub fn four_bar(chance: &mut Chance, mut text: Text) -> Case {
    let ground = chance.between(0.4, 0.8);
    let crank = chance.between(0.1, 0.5);
    let bars = [chance.between(0.4, 0.9), chance.between(0.3, 0.9)];
    let start = angle(chance);
    let foot = [ground, 0.0];
    let pin = end([0.0, 0.0], crank, start);
    // Bars that do not reach are drawn longer.
    let reach = distance(pin, foot);
    let short = (1.05 * reach - bars[0] - bars[1]).max(0.0);
    let bars = bars.map(|bar| bar + 0.5 * short);
    let angles = dyad(pin, foot, bars, sign(chance));
    let top = end(pin, bars[0], angles[0]);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", foot, 0.0);
    add_bar(chance, &mut text, "crank", [0.0, 0.0], pin);
    add_bar(chance, &mut text, "coupler", pin, top);
    add_bar(chance, &mut text, "rocker", foot, top);
    add_pin(chance, &mut text, "O", ["ground.O", "crank.a"]);
    add_pin(chance, &mut text, "A", ["crank.b", "coupler.a"]);
    add_pin(chance, &mut text, "B", ["coupler.b", "rocker.b"]);
    add_pin(chance, &mut text, "D", ["ground.D", "rocker.a"]);
    let speed = chance.between(-8.0, 8.0);
    let mut checks = Vec::new();
    let [crank_pins, rocker_pins] = [["ground.O", "crank.a"], ["ground.D", "rocker.a"]];
    let rocker = direction(foot, top);
    let is_driven = is(chance, 0.15);
    if is_driven {
        let rate = text.nudged(speed);
        text.driver(
            "u",
            "angle",
            crank_pins,
            &format!("{start:?} + 0.2*sin({rate:?}*t)"),
        );
    } else {
        match chance.below(4) {
            0 => text.freedom("u", "angle", rocker_pins, [rocker, speed]),
            1 => text.freedom(
                "u",
                "angle",
                ["ground.O", "coupler.a"],
                [direction(pin, top), speed],
            ),
            2 => {
                let far = distance([0.0, 0.0], top);
                text.freedom(
                    "u",
                    "distance",
                    ["ground.O", "rocker.b"],
                    [far, 0.1 * speed],
                );
            }
            _ => text.freedom("u", "angle", crank_pins, [start, speed]),
        }
        text.along("measures", "rock", "angle", rocker_pins, "");
        add_stop(chance, &mut text, &mut checks, "rock", rocker);
    }
    let mut is_pushed = add_torque(chance, &mut text, crank_pins);
    if is(chance, 0.4) {
        let slider = end(top, chance.between(0.2, 0.6), angle(chance));
        let slope = angle(chance);
        text.ground("G", slider, slope);
        add_bar(chance, &mut text, "rod", top, slider);
        let mass = chance.between(0.2, 2.0);
        text.body(
            "ram",
            "a = [0, 0]",
            [slider[0], slider[1], slope],
            [mass, 0.01, 0.0],
        );
        add_pin(chance, &mut text, "E", ["rocker.b", "rod.a"]);
        add_pin(chance, &mut text, "F", ["rod.b", "ram.a"]);
        text.joint("G", "translational", ["ground.G", "ram.a"], "");
        if is(chance, 0.5) {
            let coefficient = chance.between(0.02, 0.25);
            text.add(
                "friction",
                "rub_G",
                &format!("{{ joint = 'G', coefficient = {coefficient:?} }}"),
            );
        }
    }
    if is_driven || is(chance, 0.3) {
        let hang = end(top, chance.between(0.2, 0.5), -FRAC_PI_2);
        add_bar(chance, &mut text, "swing", top, hang);
        add_pin(chance, &mut text, "H", ["coupler.b", "swing.a"]);
        let swing = ["ground.O", "swing.a"];
        text.freedom(
            "hang",
            "angle",
            swing,
            [-FRAC_PI_2, chance.between(-3.0, 3.0)],
        );
        add_stop(chance, &mut text, &mut checks, "hang", -FRAC_PI_2);
        is_pushed |= is_driven;
    }
    if !is_pushed {
        checks.push(Check::Energy);
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        refusals: DEAD_POINTS,
        ..Case::new(text.end(duration), duration)
    }
}

/// A slider-crank with friction in its guide and pins; the freedom is the crank, the slider or the rod.
pub fn slider_crank(chance: &mut Chance, mut text: Text) -> Case {
    let crank = chance.between(0.1, 0.3);
    let rod = crank * chance.between(1.3, 4.0);
    let offset = [0.0, crank * chance.between(-0.25, 0.25)][chance.below(2)];
    let start = angle(chance);
    let pin = end([0.0, 0.0], crank, start);
    let tilt = ((offset - pin[1]) / rod).clamp(-1.0, 1.0).asin();
    let slider = end(pin, rod, tilt);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("G", [0.0, offset], 0.0);
    add_bar(chance, &mut text, "crank", [0.0, 0.0], pin);
    add_bar(chance, &mut text, "rod", pin, slider);
    let mass = chance.between(0.2, 3.0);
    text.body(
        "ram",
        "a = [0, 0]",
        [slider[0], offset, 0.0],
        [mass, 0.01, 0.0],
    );
    add_pin(chance, &mut text, "O", ["ground.O", "crank.a"]);
    add_pin(chance, &mut text, "A", ["crank.b", "rod.a"]);
    add_pin(chance, &mut text, "B", ["rod.b", "ram.a"]);
    text.joint("G", "translational", ["ground.G", "ram.a"], "");
    let mut checks = Vec::new();
    let rubs_in_guide = is(chance, 0.5);
    if rubs_in_guide {
        let coefficient = chance.between(0.02, 0.3);
        let length = if is(chance, 0.5) {
            format!(", length = {:?}", chance.between(0.05, 0.2))
        } else {
            String::new()
        };
        text.add(
            "friction",
            "rub_G",
            &format!("{{ joint = 'G', coefficient = {coefficient:?}{length} }}"),
        );
    }
    let crank_pins = ["ground.O", "crank.a"];
    let guide = ["ground.G", "ram.a"];
    let speed = chance.between(-15.0, 15.0);
    match chance.below(4) {
        0 => text.freedom("u", "x", guide, [slider[0], crank * speed]),
        1 => text.freedom("u", "angle", ["ground.O", "rod.a"], [tilt, 0.3 * speed]),
        _ => text.freedom("u", "angle", crank_pins, [start, speed]),
    }
    text.along("measures", "stroke", "x", guide, "");
    if is(chance, 0.4) {
        let most = slider[0] + crank * chance.between(0.02, 0.5);
        let restitution = text.nudged([0.0, chance.between(0.0, 0.8)][chance.below(2)]);
        let entry = format!("{{ of = 'stroke', max = {most:?}, restitution = {restitution:?} }}");
        text.add("stops", "bump", &entry);
        checks.push(Check::stop("stroke", [f64::NEG_INFINITY, most]));
    }
    // Friction shares what holds one coordinate at rest with other friction in any way.
    if is(chance, 0.4) && !rubs_in_guide {
        let force = log_between(chance, 0.1, 20.0);
        text.add(
            "friction",
            "rail",
            &format!("{{ of = 'stroke', force = {force:?} }}"),
        );
        checks.push(Check::friction("rail", "stroke", [force, force, 0.0]));
    }
    if !add_torque(chance, &mut text, crank_pins) {
        checks.push(Check::Energy);
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        refusals: DEAD_POINTS,
        ..Case::new(text.end(duration), duration)
    }
}

/// A pendulum or a platform on two equal links whose freedom is its height or its way, with a stop or
/// friction.
pub fn dead_points(chance: &mut Chance, mut text: Text) -> Case {
    let length = chance.between(0.5, 2.0);
    let start = if is(chance, 0.5) {
        -FRAC_PI_2 + chance.between(-1.4, 1.4)
    } else {
        angle(chance)
    };
    let tip = end([0.0, 0.0], length, start);
    let is_platform = is(chance, 0.5);
    let mass = chance.between(0.3, 3.0);
    text.ground("O", [0.0, 0.0], 0.0);
    let markers = if is_platform {
        let width = chance.between(0.5, 1.5);
        text.ground("P", [width, 0.0], 0.0);
        let markers = format!("A = [0, 0], B = [{width:?}, 0]");
        text.body(
            "seat",
            &markers,
            [tip[0], tip[1], 0.0],
            [mass, 0.1, 0.5 * width],
        );
        let more = format!(", length = {length:?}");
        text.joint("left", "link", ["ground.O", "seat.A"], &more);
        text.joint("right", "link", ["ground.P", "seat.B"], &more);
        ["ground.O", "seat.A"]
    } else {
        let own = format!("O = [0, 0], T = [{length:?}, 0]");
        let inertia = mass * length * length / 12.0;
        text.body(
            "rod",
            &own,
            [0.0, 0.0, start],
            [mass, inertia, 0.5 * length],
        );
        text.joint("O", "revolute", ["ground.O", "rod.O"], "");
        ["ground.O", "rod.T"]
    };
    let speed = [0.0, chance.between(-2.0, 2.0)][chance.below(2)];
    if is(chance, 0.5) {
        text.freedom("u", "y", markers, [tip[1], speed])
    } else {
        text.freedom("u", "x", markers, [tip[0], speed])
    }
    let mut checks = vec![Check::Energy];
    text.along("measures", "aside", "x", markers, "");
    if is(chance, 0.4) {
        let most = (tip[0] + length * chance.between(0.02, 0.5)).min(1.5 * length);
        let restitution = text.nudged(chance.between(0.0, 0.8));
        let entry = format!("{{ of = 'aside', max = {most:?}, restitution = {restitution:?} }}");
        text.add("stops", "bump", &entry);
        checks.push(Check::stop("aside", [f64::NEG_INFINITY, most]));
    }
    if is(chance, 0.4) {
        let force = mass * log_between(chance, 0.05, 3.0);
        text.add(
            "friction",
            "rub",
            &format!("{{ of = 'aside', force = {force:?} }}"),
        );
        checks.push(Check::friction("rub", "aside", [force, force, 0.0]));
    }
    let duration = chance.between(0.5, 3.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}
