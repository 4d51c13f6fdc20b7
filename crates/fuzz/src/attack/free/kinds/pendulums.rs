//! Pendulums that meet obstacles.

use std::f64::consts::PI;

use super::{JAMS, is, log_between};
use crate::attack::free::case::{Case, Check};
use crate::attack::free::text::Text;
use crate::attack::text::{angle, end};
use crate::mutation::Chance;

/// Adds a rod that hangs from a marker, with its end at T.
fn add_rod(
    chance: &mut Chance,
    text: &mut Text,
    name: &str,
    at: (&str, [f64; 2]),
    [length, direction]: [f64; 2],
) -> [f64; 2] {
    let mass = chance.between(0.3, 3.0);
    // Rods that swing alike would touch without any force.
    let inertia = mass * length * length * chance.between(0.05, 0.2);
    let markers = format!("O = [0, 0], T = [{length:?}, 0]");
    let pose = [at.1[0], at.1[1], direction];
    text.body(name, &markers, pose, [mass, inertia, 0.5 * length]);
    let own = format!("{name}.O");
    text.joint(&format!("pin_{name}"), "revolute", [at.0, &own], "");
    end(at.1, length, direction)
}

/// A pendulum of one or two rods whose ends meet small round obstacles.
pub fn pendulum_obstacles(chance: &mut Chance, mut text: Text) -> Case {
    let rods = 1 + chance.below(2);
    text.ground("O", [0.0, 0.0], 0.0);
    let mut at = ("ground.O".to_owned(), [0.0, 0.0]);
    let mut checks = vec![Check::Energy];
    let mut reach = 0.0;
    for k in 0..rods {
        let length = chance.between(0.3, 1.2);
        let direction = angle(chance);
        let name = format!("rod{k}");
        let tip = add_rod(chance, &mut text, &name, (&at.0, at.1), [length, direction]);
        let speed = [0.0, chance.between(-5.0, 5.0)][chance.below(2)];
        let own = format!("{name}.O");
        text.freedom(
            &format!("turn{k}"),
            "angle",
            ["ground.O", &own],
            [direction, speed],
        );
        reach += length;
        at = (format!("{name}.T"), tip);
    }
    for k in 0..1 + chance.below(2) {
        let least = log_between(chance, 0.01, 0.2);
        // On the circle of the tip of one rod; anywhere within reach of two.
        let far = match rods {
            1 => reach + least * chance.between(-0.95, 0.95),
            _ => reach * chance.between(0.3, 1.0),
        };
        let place = end([0.0, 0.0], far, angle(chance));
        if (place[0] - at.1[0]).hypot(place[1] - at.1[1]) < 1.05 * least {
            continue;
        }
        let name = format!("P{k}");
        text.ground(&name, place, 0.0);
        let markers = [format!("ground.{name}"), at.0.clone()];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        let restitution = [0.0, chance.between(0.0, 0.9)][chance.below(2)];
        let restitution = text.nudged(restitution);
        let more = format!(", min = {least:?}, restitution = {restitution:?}");
        text.along("stops", &format!("hit{k}"), "distance", markers, &more);
        text.along("measures", &format!("far{k}"), "distance", markers, "");
        checks.push(Check::stop(&format!("far{k}"), [least, f64::INFINITY]));
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// Pendulums side by side that knock against each other.
pub fn cradle(chance: &mut Chance, mut text: Text) -> Case {
    let count = 2 + chance.below(3);
    let is_elastic = is(chance, 0.2);
    let one = chance.between(0.0, 1.0);
    let length = chance.between(0.5, 1.0);
    let width = chance.between(0.05, 0.1);
    let mut checks = Vec::new();
    let (mut place, mut last) = (0.0, String::new());
    for k in 0..count {
        // Rods in touch that hang straight would touch without any force.
        let pivot = [place, 0.0];
        place += width * chance.between(1.002, 1.05);
        let foot = format!("O{k}");
        text.ground(&foot, pivot, 0.0);
        let direction = match k {
            0 => -0.5 * PI - chance.between(0.1, 1.0),
            _ => -0.5 * PI,
        };
        let name = format!("rod{k}");
        let at = (format!("ground.{foot}"), pivot);
        add_rod(chance, &mut text, &name, (&at.0, at.1), [length, direction]);
        let own = format!("{name}.O");
        text.freedom(
            &format!("turn{k}"),
            "angle",
            [&at.0, &own],
            [direction, 0.0],
        );
        let tip = format!("{name}.T");
        if k > 0 {
            let more = if is_elastic {
                let stiffness = text.nudged(log_between(chance, 1e3, 1e5));
                format!(", min = {width:?}, stiffness = {stiffness:?}")
            } else {
                let restitution = text.nudged(one);
                format!(", min = {width:?}, restitution = {restitution:?}")
            };
            // Along the horizontal of ground.
            let more = format!(", axes = 'ground.O0'{more}");
            text.along("stops", &format!("hit{k}"), "x", [&last, &tip], &more);
            text.along(
                "measures",
                &format!("gap{k}"),
                "x",
                [&last, &tip],
                ", axes = 'ground.O0'",
            );
            if !is_elastic {
                checks.push(Check::stop(&format!("gap{k}"), [width, f64::INFINITY]));
            }
        }
        last = tip;
    }
    if !is_elastic {
        checks.push(Check::Energy);
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}

/// A chain of rods, perhaps on a slider that is free, driven or held, each joint with a stop, with friction,
/// with both or with neither.
pub fn chain(chance: &mut Chance, mut text: Text) -> Case {
    let mut checks = Vec::new();
    let mut at = ("ground.O".to_owned(), [0.0, 0.0]);
    let mut is_driven = false;
    let mut is_elastic = false;
    text.ground("O", [0.0, 0.0], 0.0);
    if is(chance, 0.5) {
        let mass = chance.between(0.5, 3.0);
        text.body("slider", "O = [0, 0]", [0.0; 3], [mass, 0.0, 0.0]);
        let markers = ["ground.O", "slider.O"];
        text.joint("guide", "translational", markers, "");
        match chance.below(4) {
            0 => {
                let [reach, rate] = [chance.between(0.05, 0.3), chance.between(1.0, 15.0)];
                let reach = text.nudged(reach);
                text.driver("way", "x", markers, &format!("{reach:?}*sin({rate:?}*t)"));
                is_driven = true;
            }
            1 => {
                // An input that stays.
                text.along("drivers", "way", "x", markers, ", start = 0");
            }
            _ => {
                let speed = chance.between(-1.0, 1.0);
                text.freedom("way", "x", markers, [0.0, speed]);
                is_elastic |= add_contacts(chance, &mut text, &mut checks, "way", "guide", 0.6);
            }
        }
        at.0 = "slider.O".to_owned();
    }
    for k in 0..1 + chance.below(3) {
        let [length, direction] = [chance.between(0.2, 0.8), chance.between(-0.19, 0.19)];
        let name = format!("rod{k}");
        let tip = add_rod(chance, &mut text, &name, (&at.0, at.1), [length, direction]);
        let speed = chance.between(-3.0, 3.0);
        let (own, turn) = (format!("{name}.O"), format!("turn{k}"));
        text.freedom(&turn, "angle", [&at.0, &own], [direction, speed]);
        let pin = format!("pin_{name}");
        is_elastic |= add_contacts(chance, &mut text, &mut checks, &turn, &pin, 1.5);
        at = (format!("{name}.T"), tip);
    }
    if !is_driven && !is_elastic {
        checks.push(Check::Energy);
    }
    let duration = chance.between(0.5, 2.0);
    Case {
        checks,
        refusals: JAMS,
        ..Case::new(text.end(duration), duration)
    }
}

/// Adds a stop and friction, or not, to a freedom. Returns whether the stop is elastic.
fn add_contacts(
    chance: &mut Chance,
    text: &mut Text,
    checks: &mut Vec<Check>,
    name: &str,
    joint: &str,
    reach: f64,
) -> bool {
    let mut is_elastic = false;
    if is(chance, 0.7) {
        let [least, most] = [chance.between(-reach, -0.2), chance.between(0.2, reach)];
        is_elastic = is(chance, 0.4);
        let more = if is_elastic {
            let stiffness = text.nudged(log_between(chance, 50.0, 5000.0));
            let damping = chance.between(0.0, 5.0);
            format!("stiffness = {stiffness:?}, damping = {damping:?}")
        } else {
            checks.push(Check::stop(name, [least, most]));
            let restitution = chance.between(0.0, 0.9);
            format!("restitution = {:?}", text.nudged(restitution))
        };
        let entry = format!("{{ of = '{name}', min = {least:?}, max = {most:?}, {more} }}");
        text.add("stops", &format!("stop_{name}"), &entry);
    }
    let over = [1.0, chance.between(1.0, 1.5)][chance.below(2)];
    match chance.below(3) {
        0 => {
            let force = log_between(chance, 0.01, 3.0);
            checks.push(Check::friction(
                &format!("rub_{name}"),
                name,
                [force, force * over, 0.0],
            ));
            let entry = format!(
                "{{ of = '{name}', force = {force:?}, static = {:?} }}",
                force * over
            );
            text.add("friction", &format!("rub_{name}"), &entry);
        }
        1 => {
            let coefficient = chance.between(0.05, 0.4);
            let sticking = coefficient * over;
            let size = match joint {
                "guide" => String::new(),
                _ => format!(", radius = {:?}", log_between(chance, 0.003, 0.03)),
            };
            let entry = format!(
                "{{ joint = '{joint}', coefficient = {coefficient:?}, static = {sticking:?}{size} }}"
            );
            text.add("friction", &format!("rub_{name}"), &entry);
        }
        _ => {}
    }
    is_elastic
}
