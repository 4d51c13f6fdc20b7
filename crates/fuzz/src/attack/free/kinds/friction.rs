//! Friction along coordinates.

use std::f64::consts::PI;

use super::{JAMS, STOPS, is, log_between};
use crate::attack::free::case::{Case, Check, Truth};
use crate::attack::free::text::Text;
use crate::attack::free::truth::{Block, Sine};
use crate::mutation::Chance;

/// A block on a plate that moves to and fro, with friction between them, and a load.
pub fn friction_plate(chance: &mut Chance, mut text: Text) -> Case {
    let frequency = log_between(chance, 1.0, 50.0);
    let plate = Sine {
        amplitude: log_between(chance, 0.1, 30.0) / (frequency * frequency),
        frequency,
        phase: [0.0, chance.between(-PI, PI), 0.5 * PI][chance.below(3)],
    };
    let plate = Sine {
        amplitude: text.nudged(plate.amplitude.min(0.3)),
        ..plate
    };
    let mass = chance.between(0.5, 3.0);
    let sliding = log_between(chance, 0.2, 20.0);
    let sticking = sliding * [1.0, chance.between(1.0, 1.5)][chance.below(2)];
    let load = if is(chance, 0.4) {
        sliding * chance.between(-0.8, 0.8)
    } else {
        0.0
    };
    let speed = match chance.below(3) {
        0 => 0.0,
        1 => plate.at(0.0)[1],
        _ => chance.between(-1.0, 1.0),
    };
    let duration = chance.between(0.5, 3.0);
    text.ground("G", [0.0, 0.0], 0.0);
    text.body(
        "plate",
        "O = [0, 0]",
        [plate.at(0.0)[0], 0.0, 0.0],
        [1.0, 0.0, 0.0],
    );
    text.body("block", "O = [0, 0]", [0.0; 3], [mass, 0.0, 0.0]);
    text.joint("gp", "translational", ["ground.G", "plate.O"], "");
    text.joint("gb", "translational", ["ground.G", "block.O"], "");
    text.driver("p", "x", ["ground.G", "plate.O"], &plate.expression());
    text.freedom("b", "x", ["ground.G", "block.O"], [0.0, speed]);
    let [force, most, push] = [sliding, sticking, load].map(|value| text.nudged(value));
    let more = format!(", force = {force:?}, static = {:?}", most.max(force));
    text.along("friction", "rub", "x", ["plate.O", "block.O"], &more);
    text.along("measures", "way", "x", ["plate.O", "block.O"], "");
    text.along(
        "forces",
        "load",
        "x",
        ["ground.G", "block.O"],
        &format!(", value = {push:?}"),
    );
    let block = Block {
        plate,
        friction: [sliding / mass, sticking / mass],
        load: load / mass,
        start: [0.0, speed],
    };
    let parts = block.motion(duration);
    Case {
        checks: vec![Check::friction("rub", "way", [sliding, sticking, 0.0])],
        truth: Some(Truth {
            until: duration,
            variables: vec!["b.position".to_owned()],
            values: Box::new(move |time| vec![parts.at(time)]),
            impacts: Vec::new(),
        }),
        ..Case::new(text.end(duration), duration)
    }
}

/// A block on the ground, a plate that is driven or held on it or beside it, and a block on that: friction
/// between all of them, loads and springs.
pub fn rubbing_blocks(chance: &mut Chance, mut text: Text) -> Case {
    let count = 1 + chance.below(3);
    let bodies: Vec<String> = (0..count).map(|k| format!("b{k}")).collect();
    text.ground("G", [0.0, 0.0], 0.0);
    let mut names = vec!["ground.G".to_owned()];
    for driven in 0..1 + chance.below(2) {
        let name = format!("d{driven}");
        let own = format!("{name}.O");
        let [reach, rate] = [
            log_between(chance, 0.01, 0.3),
            log_between(chance, 1.0, 20.0),
        ];
        let speed = text.nudged(chance.between(-1.0, 1.0));
        let motion = match chance.below(4) {
            0 => format!("{speed:?}*t"),
            1 => "0".to_owned(),
            2 => format!("{reach:?}*cos({rate:?}*t)"),
            _ => format!("{reach:?}*sin({rate:?}*t)"),
        };
        let start = [0.0, reach][usize::from(motion.contains("cos"))];
        text.body(&name, "O = [0, 0]", [start, 0.0, 0.0], [1.0, 0.0, 0.0]);
        text.joint(&format!("g{name}"), "translational", ["ground.G", &own], "");
        text.driver(&format!("u{driven}"), "x", ["ground.G", &own], &motion);
        names.push(own);
    }
    let mut checks = Vec::new();
    let mut frictions = 0;
    for (k, body) in bodies.iter().enumerate() {
        let own = format!("{body}.O");
        let mass = log_between(chance, 0.3, 3.0);
        text.body(body, "O = [0, 0]", [0.0; 3], [mass, 0.0, 0.0]);
        text.joint(&format!("g{body}"), "translational", ["ground.G", &own], "");
        let speed = [0.0, chance.between(-1.0, 1.0)][chance.below(2)];
        text.freedom(&format!("x{k}"), "x", ["ground.G", &own], [0.0, speed]);
        if is(chance, 0.5) {
            let load = text.nudged(mass * chance.between(-9.0, 9.0));
            let more = match chance.below(3) {
                0 => format!(", value = {load:?}"),
                1 => format!(
                    ", value = '{load:?}*sin({:?}*t)'",
                    chance.between(1.0, 20.0)
                ),
                // An input that stays.
                _ => String::new(),
            };
            text.along(
                "forces",
                &format!("load{k}"),
                "x",
                ["ground.G", &own],
                &more,
            );
        }
        if is(chance, 0.4) {
            let stiffness = text.nudged(mass * log_between(chance, 10.0, 1000.0));
            let free = chance.between(-0.1, 0.1);
            let more = format!(", stiffness = {stiffness:?}, free = {free:?}");
            let base = names[chance.below(names.len())].clone();
            text.along("forces", &format!("spring{k}"), "x", [&base, &own], &more);
        }
        names.push(own);
    }
    // Friction of pairs; those of driven parts alone too.
    for other in 1..names.len() {
        for base in 0..other {
            if !is(chance, 0.55) {
                continue;
            }
            let sliding = log_between(chance, 0.3, 12.0);
            let sticking = sliding * [1.0, chance.between(1.0, 1.5)][chance.below(2)];
            let viscous = [0.0, chance.between(0.0, 2.0)][usize::from(is(chance, 0.3))];
            let name = format!("rub{frictions}");
            let measure = format!("way{frictions}");
            frictions += 1;
            let markers = [names[base].as_str(), names[other].as_str()];
            text.along("measures", &measure, "x", markers, "");
            let more =
                format!(", force = {sliding:?}, static = {sticking:?}, viscous = {viscous:?}");
            text.along("friction", &name, "x", markers, &more);
            checks.push(Check::friction(
                &name,
                &measure,
                [sliding, sticking, viscous],
            ));
        }
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// A block on a belt, held by a spring: it sticks and slips.
pub fn stick_slip(chance: &mut Chance, mut text: Text) -> Case {
    let mass = chance.between(0.3, 3.0);
    let sliding = log_between(chance, 0.5, 10.0);
    let sticking = sliding * [1.0, chance.between(1.0, 1.8)][chance.below(2)];
    let speed = text.nudged(log_between(chance, 0.01, 1.0));
    let stiffness = text.nudged(mass * log_between(chance, 20.0, 5000.0));
    let has_stribeck = is(chance, 0.4);
    let motion = if is(chance, 0.7) {
        format!("{speed:?}*t")
    } else {
        format!("{speed:?}*t + 0.05*sin({:?}*t)", chance.between(1.0, 10.0))
    };
    text.ground("G", [0.0, 0.0], 0.0);
    text.body("belt", "O = [0, 0]", [0.0; 3], [1.0, 0.0, 0.0]);
    text.body("block", "O = [0, 0]", [0.0; 3], [mass, 0.0, 0.0]);
    text.joint("gp", "translational", ["ground.G", "belt.O"], "");
    text.joint("gb", "translational", ["ground.G", "block.O"], "");
    text.driver("p", "x", ["ground.G", "belt.O"], &motion);
    let start = [0.0, chance.between(-0.05, 0.05)][chance.below(2)];
    text.freedom("b", "x", ["ground.G", "block.O"], [start, 0.0]);
    let more = format!(", stiffness = {stiffness:?}, free = 0");
    text.along("forces", "spring", "x", ["ground.G", "block.O"], &more);
    let stribeck = if has_stribeck {
        let exponent = [2.0, chance.between(1.0, 4.0)][chance.below(2)];
        let speed = log_between(chance, 0.01, 0.5);
        format!(", stribeck = {speed:?}, exponent = {exponent:?}")
    } else {
        String::new()
    };
    let more = format!(", force = {sliding:?}, static = {sticking:?}{stribeck}");
    text.along("friction", "rub", "x", ["belt.O", "block.O"], &more);
    text.along("measures", "way", "x", ["belt.O", "block.O"], "");
    let duration = chance.between(0.5, 3.0);
    let mut case = Case::new(text.end(duration), duration);
    if !has_stribeck {
        case.checks
            .push(Check::friction("rub", "way", [sliding, sticking, 0.0]));
    }
    case
}

/// An arm of links of which some are driven, some held and some free, with friction in all joints.
pub fn driven_arm(chance: &mut Chance, mut text: Text) -> Case {
    let links = 2 + chance.below(2);
    let free = chance.below(links);
    let mut checks = Vec::new();
    text.ground("O", [0.0, 0.0], 0.0);
    let (mut marker, mut at, mut direction) = ("ground.O".to_owned(), [0.0, 0.0], 0.0);
    for k in 0..links {
        let length = chance.between(0.2, 0.6);
        let start = chance.between(-0.5, 0.5);
        direction += start;
        let body = format!("l{k}");
        let own = format!("{body}.O");
        let mass = chance.between(0.5, 3.0);
        let markers = format!("O = [0, 0], T = [{length:?}, 0]");
        let inertia = mass * length * length / 12.0;
        text.body(
            &body,
            &markers,
            [at[0], at[1], direction],
            [mass, inertia, 0.5 * length],
        );
        let (joint, name) = (format!("pin{k}"), format!("u{k}"));
        let pair = [marker.as_str(), own.as_str()];
        text.joint(&joint, "revolute", pair, "");
        if k == free || is(chance, 0.2) {
            let speed = [0.0, chance.between(-3.0, 3.0)][chance.below(2)];
            text.freedom(&name, "angle", pair, [start, speed]);
        } else {
            let [reach, rate] = [chance.between(0.1, 1.5), chance.between(0.5, 10.0)];
            let reach = text.nudged(reach);
            match chance.below(4) {
                0 => text.driver(&name, "angle", pair, &format!("{start:?} + {reach:?}*t")),
                1 => text.driver(&name, "angle", pair, &format!("{start:?}")),
                2 => text.along(
                    "drivers",
                    &name,
                    "angle",
                    pair,
                    &format!(", start = {start:?}"),
                ),
                _ => {
                    let motion = format!("{start:?} + {reach:?}*sin({rate:?}*t)");
                    text.driver(&name, "angle", pair, &motion);
                }
            }
        }
        let rub = format!("rub{k}");
        match chance.below(3) {
            0 => {
                let force = log_between(chance, 0.02, 3.0);
                let viscous = [0.0, chance.between(0.0, 0.5)][chance.below(2)];
                let entry =
                    format!("{{ of = '{name}', force = {force:?}, viscous = {viscous:?} }}");
                text.add("friction", &rub, &entry);
                checks.push(Check::friction(&rub, &name, [force, force, viscous]));
            }
            1 => {
                let coefficient = chance.between(0.05, 0.5);
                let radius = log_between(chance, 0.003, 0.04);
                let entry = format!(
                    "{{ joint = '{joint}', coefficient = {coefficient:?}, radius = {radius:?} }}"
                );
                text.add("friction", &rub, &entry);
            }
            _ => {}
        }
        if is(chance, 0.4) {
            let [least, most] = [
                start - chance.between(0.1, 1.5),
                start + chance.between(0.1, 1.5),
            ];
            let restitution = text.nudged(chance.between(0.0, 0.8));
            let entry = format!(
                "{{ of = '{name}', min = {least:?}, max = {most:?}, restitution = {restitution:?} }}"
            );
            text.add("stops", &format!("stop{k}"), &entry);
            checks.push(Check::stop(&name, [least, most]));
        }
        at = crate::attack::text::end(at, length, direction);
        marker = format!("{body}.T");
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        refusals: JAMS,
        ..Case::new(text.end(duration), duration)
    }
}

/// A mass that a driven pusher strikes, with a wall behind it or not, and stops on the driver.
pub fn pusher(chance: &mut Chance, mut text: Text) -> Case {
    let frequency = log_between(chance, 1.0, 30.0);
    let push = Sine {
        amplitude: text.nudged(log_between(chance, 0.02, 0.3)),
        frequency,
        phase: [0.0, chance.between(-PI, PI)][chance.below(2)],
    };
    let restitution = [0.0, chance.between(0.0, 0.9)][chance.below(2)];
    let mut checks = Vec::new();
    text.ground("G", [0.0, 0.0], 0.0);
    text.body(
        "rod",
        "O = [0, 0]",
        [push.at(0.0)[0], 0.0, 0.0],
        [1.0, 0.0, 0.0],
    );
    text.joint("gp", "translational", ["ground.G", "rod.O"], "");
    text.driver("p", "x", ["ground.G", "rod.O"], &push.expression());
    if is(chance, 0.4) {
        let limit = push.amplitude * chance.between(0.7, 1.5);
        if limit > push.at(0.0)[0] {
            text.add("stops", "end", &format!("{{ of = 'p', max = {limit:?} }}"));
            checks.push(Check::stop("p", [f64::NEG_INFINITY, limit]));
        }
    }
    let mut last = "rod.O".to_owned();
    let mut place = push.at(0.0)[0];
    for k in 0..1 + chance.below(2) {
        let size = chance.between(0.02, 0.1);
        place += size + [0.0, log_between(chance, 1e-3, 0.3)][usize::from(is(chance, 0.8))];
        let body = format!("m{k}");
        let own = format!("{body}.O");
        let mass = log_between(chance, 0.3, 3.0);
        text.body(&body, "O = [0, 0]", [place, 0.0, 0.0], [mass, 0.0, 0.0]);
        text.joint(&format!("g{k}"), "translational", ["ground.G", &own], "");
        text.freedom(&format!("x{k}"), "x", ["ground.G", &own], [place, 0.0]);
        let e = text.nudged(restitution);
        let more = format!(", min = {size:?}, restitution = {e:?}");
        text.along("stops", &format!("hit{k}"), "x", [&last, &own], &more);
        text.along("measures", &format!("gap{k}"), "x", [&last, &own], "");
        checks.push(Check::stop(&format!("gap{k}"), [size, f64::INFINITY]));
        match chance.below(3) {
            0 => {
                let force = mass * log_between(chance, 0.1, 9.0);
                let (rub, freedom) = (format!("rub{k}"), format!("x{k}"));
                text.add(
                    "friction",
                    &rub,
                    &format!("{{ of = '{freedom}', force = {force:?} }}"),
                );
                checks.push(Check::friction(&rub, &freedom, [force, force, 0.0]));
            }
            1 => {
                let stiffness = text.nudged(mass * log_between(chance, 10.0, 1000.0));
                let more = format!(", stiffness = {stiffness:?}, free = {place:?}");
                text.along(
                    "forces",
                    &format!("spring{k}"),
                    "x",
                    ["ground.G", &own],
                    &more,
                );
            }
            _ => {}
        }
        last = own;
    }
    if is(chance, 0.4) {
        let wall = place + chance.between(0.0, 0.3);
        let restitution = text.nudged(restitution);
        let name = format!("x{}", last.as_bytes()[1] - b'0');
        let entry = format!("{{ of = '{name}', max = {wall:?}, restitution = {restitution:?} }}");
        text.add("stops", "wall", &entry);
        checks.push(Check::stop(&name, [f64::NEG_INFINITY, wall]));
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        refusals: STOPS,
        ..Case::new(text.end(duration), duration)
    }
}
