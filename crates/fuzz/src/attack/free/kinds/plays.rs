//! Wheels that rattle between their flanks, and ropes that go slack.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{STOPS, is, log_between};
use crate::attack::free::case::{Case, Check};
use crate::attack::free::text::Text;
use crate::attack::text::sign;
use crate::mutation::Chance;

/// Adds torque on a wheel, damping, a spring and friction, or not.
fn load_wheel(chance: &mut Chance, text: &mut Text, checks: &mut Vec<Check>, k: usize, start: f64) {
    let (foot, own) = (format!("ground.G{k}"), format!("w{k}.O"));
    let markers = [foot.as_str(), own.as_str()];
    if is(chance, 0.7) {
        let torque = text.nudged(log_between(chance, 0.1, 15.0) * sign(chance));
        let [rate, phase] = [chance.between(0.5, 20.0), chance.between(-PI, PI)];
        let value = if is(chance, 0.2) {
            format!("{torque:?}")
        } else {
            format!("'{torque:?}*sin({rate:?}*t + ({phase:?}))'")
        };
        text.along(
            "forces",
            &format!("torque{k}"),
            "angle",
            markers,
            &format!(", value = {value}"),
        );
    }
    if is(chance, 0.3) {
        let damping = text.nudged(log_between(chance, 1e-3, 0.5));
        text.along(
            "forces",
            &format!("drag{k}"),
            "angle",
            markers,
            &format!(", damping = {damping:?}"),
        );
    }
    if is(chance, 0.3) {
        let stiffness = text.nudged(log_between(chance, 1.0, 100.0));
        let free = start + chance.between(-0.5, 0.5);
        let more = format!(", stiffness = {stiffness:?}, free = {free:?}");
        text.along("forces", &format!("spring{k}"), "angle", markers, &more);
    }
    if is(chance, 0.3) {
        let torque = log_between(chance, 0.02, 2.0);
        let name = format!("rub{k}");
        text.add(
            "friction",
            &name,
            &format!("{{ of = 'f{k}', force = {torque:?} }}"),
        );
        checks.push(Check::friction(
            &name,
            &format!("f{k}"),
            [torque, torque, 0.0],
        ));
    }
}

/// Wheels in a row with gears and couplings that have backlash, from the first turn or many turns on; the
/// first wheel is free, or turns at a given speed.
pub fn backlash(chance: &mut Chance, mut text: Text) -> Case {
    let count = 2 + chance.below(3);
    // Light wheels between heavy ones with more restitution bounce ten thousands of times.
    let one = [0.0, chance.between(0.0, 0.7)][chance.below(2)];
    let mut start = match chance.below(3) {
        0 => 0.0,
        1 => chance.between(-TAU, TAU),
        _ => chance.between(-500.0, 500.0),
    };
    let mut speed = [0.0, chance.between(-20.0, 20.0)][chance.below(2)];
    let is_driven = is(chance, 0.25);
    let mut checks = Vec::new();
    for k in 0..count {
        let (foot, body) = (format!("G{k}"), format!("w{k}"));
        let place = [k as f64, 0.0];
        text.ground(&foot, place, 0.0);
        let markers = [format!("ground.{foot}"), format!("{body}.O")];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        let inertia = log_between(chance, 0.01, 2.0);
        if k > 0 {
            let width = log_between(chance, 1e-3, 0.2);
            let off = width * chance.between(-0.45, 0.45);
            let more = format!(
                ", backlash = {width:?}, restitution = {:?}",
                text.nudged(one)
            );
            let last = k - 1;
            // φ_k is between ratio φ_last − width/2 and ratio φ_last + width/2.
            let ratio = match chance.below(3) {
                0 => {
                    let ratio = chance.between(0.3, 3.0) * sign(chance);
                    let entry = format!(
                        "{{ type = 'coupling', equation = 'f{k} = {ratio:?}*f{last}'{more} }}"
                    );
                    text.add("joints", &format!("mesh{k}"), &entry);
                    ratio
                }
                1 => {
                    let teeth = [15 + chance.below(60), 15 + chance.below(60)];
                    let more = format!(", teeth = {teeth:?}{more}");
                    let wheels = [format!("w{last}.O"), format!("w{k}.O")];
                    text.joint(&format!("mesh{k}"), "gear", [&wheels[0], &wheels[1]], &more);
                    -(teeth[0] as f64) / teeth[1] as f64
                }
                _ => {
                    let ratio = chance.between(0.3, 3.0);
                    let more = format!(", radii = [{ratio:?}, 1.0]{more}");
                    let wheels = [format!("w{last}.O"), format!("w{k}.O")];
                    text.joint(&format!("mesh{k}"), "gear", [&wheels[0], &wheels[1]], &more);
                    -ratio
                }
            };
            start = ratio * start + off;
            speed = ratio * speed + [0.0, chance.between(-2.0, 2.0)][chance.below(2)];
            let gap = move |q: &[f64]| {
                let off = q[3 * k + 2] - ratio * q[3 * last + 2];
                // The rounding of turns.
                0.5 * width - off.abs() + 1e-13 * q[3 * k + 2].abs()
            };
            checks.push(Check::Gap {
                name: format!("mesh{k}"),
                gap: Box::new(gap),
            });
        }
        text.body(
            &body,
            "O = [0, 0]",
            [place[0], 0.0, start],
            [1.0, inertia, 0.0],
        );
        text.joint(&format!("p{k}"), "revolute", markers, "");
        if k == 0 && is_driven {
            let [reach, rate] = [chance.between(0.0, 1.0), chance.between(1.0, 20.0)];
            let speed = text.nudged(speed);
            let motion = format!("({start:?}) + ({speed:?})*t + {reach:?}*sin({rate:?}*t)");
            text.driver("f0", "angle", markers, &motion);
        } else {
            text.freedom(&format!("f{k}"), "angle", markers, [start, speed]);
        }
        load_wheel(chance, &mut text, &mut checks, k, start);
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// A ball on one or two ropes, in the plane or on a vertical guide, thrown up or down, perhaps with an
/// elastic floor or a spring below.
pub fn ball_on_ropes(chance: &mut Chance, mut text: Text) -> Case {
    let is_guided = is(chance, 0.4);
    let mass = chance.between(0.3, 3.0);
    let place = [
        [chance.between(-0.4, 0.4), 0.0][usize::from(is_guided)],
        -chance.between(0.1, 0.8),
    ];
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("G", [0.0, 0.0], FRAC_PI_2);
    let markers = format!("B = [0, 0], S = [0, 0, {FRAC_PI_2:?}]");
    text.body(
        "ball",
        &markers,
        [place[0], place[1], 0.0],
        [mass, 0.01 * mass, 0.0],
    );
    let mut checks = Vec::new();
    let up = chance.between(-3.0, 3.0);
    if is_guided {
        text.joint("guide", "translational", ["ground.G", "ball.S"], "");
        text.freedom("y", "x", ["ground.G", "ball.S"], [place[1], up]);
    } else {
        let aside = chance.between(-2.0, 2.0);
        text.freedom("x", "x", ["ground.O", "ball.B"], [place[0], aside]);
        text.freedom("y", "y", ["ground.O", "ball.B"], [place[1], up]);
        text.freedom("turn", "angle", ["ground.O", "ball.B"], [0.0, 0.3]);
    }
    let is_elastic = is(chance, 0.4);
    if is_elastic {
        let floor = place[1] - chance.between(0.05, 0.5);
        let stiffness = text.nudged(mass * log_between(chance, 100.0, 5000.0));
        let more = format!(", min = {floor:?}, stiffness = {stiffness:?}, damping = 0.5");
        text.along("stops", "mat", "y", ["ground.O", "ball.B"], &more);
    } else {
        checks.push(Check::Energy);
    }
    if is(chance, 0.3) {
        let stiffness = text.nudged(mass * log_between(chance, 10.0, 200.0));
        let more = format!(", stiffness = {stiffness:?}, free = {:?}", place[1]);
        text.along("forces", "spring", "y", ["ground.O", "ball.B"], &more);
    }
    for k in 0..1 + chance.below(2) {
        let foot = [chance.between(-0.5, 0.5), chance.between(-0.1, 0.3)];
        let name = format!("A{k}");
        text.ground(&name, foot, 0.0);
        let away = (place[0] - foot[0]).hypot(place[1] - foot[1]);
        let length = away + [0.0, log_between(chance, 1e-3, 0.5)][usize::from(is(chance, 0.8))];
        let restitution = [0.0, chance.between(0.0, 0.7)][chance.below(2)];
        let restitution = text.nudged(restitution);
        let more =
            format!(", length = {length:?}, unilateral = true, restitution = {restitution:?}");
        let foot = format!("ground.{name}");
        let markers = [foot.as_str(), "ball.B"];
        text.joint(&format!("rope{k}"), "rope", markers, &more);
        text.along("measures", &format!("far{k}"), "distance", markers, "");
        checks.push(Check::stop(&format!("far{k}"), [0.0, length]));
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// Two weights on a rope over a pulley, which may fall on floors.
pub fn hoist(chance: &mut Chance, mut text: Text) -> Case {
    let [top, radius] = [1.5, chance.between(0.05, 0.2)];
    text.ground("P", [0.0, top], 0.0);
    let mut length = PI * radius;
    let mut checks = Vec::new();
    for (k, side) in [(0, -1.0), (1, 1.0)] {
        let foot = format!("G{k}");
        text.ground(&foot, [side * radius, 0.0], FRAC_PI_2);
        let mass = chance.between(0.3, 3.0);
        let height = chance.between(0.2, 0.9);
        let speed = [0.0, chance.between(-1.5, 1.5)][chance.below(2)];
        let name = format!("m{k}");
        let marker = format!("S = [0, 0, {FRAC_PI_2:?}]");
        text.body(
            &name,
            &marker,
            [side * radius, height, 0.0],
            [mass, 0.0, 0.0],
        );
        let markers = [format!("ground.{foot}"), format!("{name}.S")];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        text.joint(&format!("g{k}"), "translational", markers, "");
        let freedom = format!("y{k}");
        text.freedom(&freedom, "x", markers, [height, speed]);
        // The rope ends where a weight meets the pulley.
        let most = top - radius;
        let least = if is(chance, 0.6) {
            height - log_between(chance, 0.01, 0.6)
        } else {
            height - 10.0
        };
        let restitution = text.nudged(chance.between(0.0, 0.8));
        let entry = format!(
            "{{ of = '{freedom}', min = {least:?}, max = {most:?}, restitution = {restitution:?} }}"
        );
        text.add("stops", &format!("mat{k}"), &entry);
        checks.push(Check::stop(&freedom, [least, most]));
        if is(chance, 0.3) {
            let force = log_between(chance, 0.05, 3.0);
            text.add(
                "friction",
                &format!("rub{k}"),
                &format!("{{ of = '{freedom}', force = {force:?} }}"),
            );
            checks.push(Check::friction(
                &format!("rub{k}"),
                &freedom,
                [force, force, 0.0],
            ));
        }
        length += top - height;
    }
    let length = length + [0.0, log_between(chance, 1e-3, 0.3)][chance.below(2)];
    let restitution = text.nudged([0.0, chance.between(0.0, 0.7)][chance.below(2)]);
    let entry = format!(
        "{{ type = 'rope', markers = ['m0.S', {{ marker = 'ground.P', radius = {radius:?}, side = 'right' }}, 'm1.S'], \
         length = {length:?}, unilateral = true, restitution = {restitution:?} }}"
    );
    text.add("joints", "rope", &entry);
    checks.push(Check::Energy);
    checks.push(Check::Gap {
        name: "rope".to_owned(),
        gap: Box::new(move |q| length - PI * radius - (top - q[1]) - (top - q[4])),
    });
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// A rack that a pinion moves to and fro with backlash, against a spring, a stop or friction.
pub fn rack_play(chance: &mut Chance, mut text: Text) -> Case {
    let radius = chance.between(0.02, 0.1);
    let width = log_between(chance, 1e-5, 5e-3);
    let restitution = text.nudged([0.0, chance.between(0.0, 0.9)][chance.below(2)]);
    let mass = log_between(chance, 0.2, 5.0);
    let mut checks = Vec::new();
    text.ground("P", [0.0, radius], 0.0);
    text.ground("G", [0.0, 0.0], 0.0);
    let inertia = mass * radius * radius * log_between(chance, 0.1, 10.0);
    text.body(
        "pinion",
        "O = [0, 0]",
        [0.0, radius, 0.0],
        [1.0, inertia, 0.0],
    );
    text.body("rack", "O = [0, 0]", [0.0; 3], [mass, 0.0, 0.0]);
    let [pins, guide] = [["ground.P", "pinion.O"], ["ground.G", "rack.O"]];
    text.joint("P", "revolute", pins, "");
    text.joint("G", "translational", guide, "");
    let more =
        format!(", radius = {radius:?}, backlash = {width:?}, restitution = {restitution:?}");
    text.joint("mesh", "rack_and_pinion", ["pinion.O", "rack.O"], &more);
    let rate = chance.between(1.0, 30.0);
    if is(chance, 0.3) {
        let reach = text.nudged(chance.between(0.1, 2.0));
        text.driver("turn", "angle", pins, &format!("{reach:?}*sin({rate:?}*t)"));
    } else {
        let speed = [0.0, chance.between(-10.0, 10.0)][chance.below(2)];
        text.freedom("turn", "angle", pins, [0.0, speed]);
        let torque = text.nudged(mass * radius * chance.between(-30.0, 30.0));
        let value = if is(chance, 0.3) {
            format!("{torque:?}")
        } else {
            format!("'{torque:?}*sin({rate:?}*t)'")
        };
        text.along(
            "forces",
            "torque",
            "angle",
            pins,
            &format!(", value = {value}"),
        );
    }
    let speed = [0.0, chance.between(-1.0, 1.0)][chance.below(2)];
    text.freedom("way", "x", guide, [0.0, speed]);
    if is(chance, 0.5) {
        let stiffness = text.nudged(mass * log_between(chance, 10.0, 1000.0));
        let free = chance.between(-0.05, 0.05);
        let more = format!(", stiffness = {stiffness:?}, free = {free:?}");
        text.along("forces", "spring", "x", guide, &more);
    }
    if is(chance, 0.5) {
        let force = mass * log_between(chance, 0.1, 9.0);
        let sticking = force * [1.0, chance.between(1.0, 1.5)][chance.below(2)];
        let entry = format!("{{ of = 'way', force = {force:?}, static = {sticking:?} }}");
        text.add("friction", "rub", &entry);
        checks.push(Check::friction("rub", "way", [force, sticking, 0.0]));
    }
    if is(chance, 0.3) {
        let limits = [-chance.between(0.01, 0.2), chance.between(0.01, 0.2)];
        let entry = format!(
            "{{ of = 'way', min = {:?}, max = {:?}, restitution = {restitution:?} }}",
            limits[0], limits[1]
        );
        text.add("stops", "end", &entry);
        checks.push(Check::stop("way", limits));
    }
    checks.push(Check::Gap {
        name: "mesh".to_owned(),
        // The rack moves to the right where a pinion above it turns counter-clockwise.
        gap: Box::new(move |q| 0.5 * width - (q[3] - radius * q[2]).abs()),
    });
    let duration = chance.between(0.3, 1.5);
    Case {
        checks,
        refusals: STOPS,
        ..Case::new(text.end(duration), duration)
    }
}
