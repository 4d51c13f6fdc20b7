//! Masses on straight guides that bounce.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{is, log_between};
use crate::attack::free::case::{Case, Check, Truth};
use crate::attack::free::text::Text;
use crate::attack::free::truth::{Ball, Contact, Mass, MassRow, Sine, places};
use crate::mutation::Chance;

/// A ball that falls on a table which shakes, slowly or at a thousand radians per second.
pub fn vibrating_table(chance: &mut Chance, mut text: Text) -> Case {
    let frequency = log_between(chance, 5.0, 1000.0);
    let table = Sine {
        amplitude: log_between(chance, 0.2, 20.0) * 9.81 / (frequency * frequency),
        frequency,
        phase: chance.between(-PI, PI),
    };
    let table = Sine {
        amplitude: text.nudged(table.amplitude.min(0.05)),
        phase: text.nudged(table.phase),
        ..table
    };
    let height = table.at(0.0)[0] + log_between(chance, 1e-3, 0.3);
    let speed = [0.0, chance.between(-1.0, 1.0)][chance.below(2)];
    let restitution = chance.between(0.0, 0.95);
    let duration = chance.between(0.5, 2.0);
    text.ground("G", [0.0, 0.0], FRAC_PI_2);
    let marker = format!("S = [0, 0, {FRAC_PI_2:?}]");
    let mass = chance.between(0.2, 5.0);
    text.body(
        "table",
        &marker,
        [0.0, table.at(0.0)[0], 0.0],
        [1.0, 0.0, 0.0],
    );
    text.body("ball", &marker, [0.0, height, 0.0], [mass, 0.0, 0.0]);
    text.joint("gt", "translational", ["ground.G", "table.S"], "");
    text.joint("gb", "translational", ["ground.G", "ball.S"], "");
    text.driver("shake", "x", ["ground.G", "table.S"], &table.expression());
    text.freedom("y", "x", ["ground.G", "ball.S"], [height, speed]);
    let restitution_there = text.nudged(restitution);
    let more = format!(", min = 0, restitution = {restitution_there:?}");
    text.along("stops", "hit", "x", ["table.S", "ball.S"], &more);
    text.along("measures", "gap", "x", ["table.S", "ball.S"], "");
    let ball = Ball {
        table,
        gravity: 9.81,
        restitution,
        start: [height, speed],
    };
    let (parts, impacts) = ball.motion("hit", duration);
    Case {
        checks: vec![Check::stop("gap", [0.0, f64::INFINITY])],
        truth: Some(Truth {
            until: duration,
            variables: vec!["y.position".to_owned()],
            values: Box::new(move |time| vec![parts.at(time)]),
            impacts,
        }),
        ..Case::new(text.end(duration), duration)
    }
}

/// Masses in a row between walls, pushed by gravity or not, with springs between them or not.
pub fn row_of_masses(chance: &mut Chance, mut text: Text) -> Case {
    let count = 1 + chance.below(4);
    let is_pushed = is(chance, 0.6);
    let has_springs = is_pushed && is(chance, 0.3);
    let touches = is(chance, 0.2);
    let slope: f64 = if is_pushed {
        chance.between(0.1, FRAC_PI_2)
    } else {
        0.0
    };
    let duration = chance.between(0.5, 2.0);
    text.ground("G", [0.0, 0.0], slope);
    text.gravity([0.0, [0.0, -9.81][usize::from(is_pushed)]]);
    let mut row = MassRow {
        masses: Vec::new(),
        contacts: Vec::new(),
    };
    let one = chance.between(0.0, 0.9);
    let own = is(chance, 0.5);
    let restitution = |chance: &mut Chance| if own { chance.between(0.0, 0.95) } else { one };
    let mut checks = Vec::new();
    let (mut place, mut last) = (0.0, "ground.G".to_owned());
    for k in 0..=count {
        let name = format!("m{k}");
        let size = [0.0, chance.between(0.05, 0.2)][usize::from(k > 0)];
        // A row without any play would not move.
        let gap = if touches && k < count && is(chance, 0.7) {
            0.0
        } else {
            log_between(chance, 1e-3, 0.4)
        };
        let e = restitution(chance);
        let stop = format!("hit{k}");
        let left = (k > 0).then(|| k - 1);
        if k == count {
            // A wall at the end, not for all rows.
            if is(chance, 0.6) {
                let wall = place + gap;
                let there = text.nudged(e);
                let entry = format!(
                    "{{ of = 'x{}', max = {wall:?}, restitution = {there:?} }}",
                    k - 1
                );
                text.add("stops", &stop, &entry);
                checks.push(Check::Within {
                    variable: format!("x{}.position", k - 1),
                    limits: [f64::NEG_INFINITY, wall],
                });
                row.contacts.push(Contact {
                    name: stop,
                    between: [left, None],
                    touch: wall,
                    restitution: e,
                });
            }
            break;
        }
        place += size + gap;
        let body = format!("{name}.O");
        let mass = log_between(chance, 0.2, 5.0);
        let speed = if is(chance, 0.5) {
            chance.between(-2.0, 2.0)
        } else {
            0.0
        };
        let (sin, cos) = slope.sin_cos();
        let estimate = [place * cos, place * sin, slope];
        text.body(&name, "O = [0, 0]", estimate, [mass, 0.0, 0.0]);
        text.joint(&format!("g{k}"), "translational", ["ground.G", &body], "");
        text.freedom(&format!("x{k}"), "x", ["ground.G", &body], [place, speed]);
        let there = text.nudged(e);
        let more = format!(", min = {size:?}, restitution = {there:?}");
        text.along("stops", &stop, "x", [&last, &body], &more);
        text.along("measures", &format!("gap{k}"), "x", [&last, &body], "");
        checks.push(Check::stop(&format!("gap{k}"), [size, f64::INFINITY]));
        if has_springs && is(chance, 0.5) {
            let stiffness = text.nudged(log_between(chance, 10.0, 1000.0));
            let free = size + gap + chance.between(-0.1, 0.1);
            let more = format!(", stiffness = {stiffness:?}, free = {free:?}");
            text.along("forces", &format!("spring{k}"), "x", [&last, &body], &more);
        }
        row.masses.push(Mass { mass, place, speed });
        row.contacts.push(Contact {
            name: stop,
            between: [left, Some(k)],
            touch: size,
            restitution: e,
        });
        last = body;
    }
    checks.push(Check::Energy);
    let truth = (!is_pushed && !touches).then(|| {
        let (parts, impacts, until) = row.motion(duration);
        Truth {
            until,
            variables: (0..count).map(|k| format!("x{k}.position")).collect(),
            values: Box::new(move |time| places(&parts, time)),
            impacts,
        }
    });
    Case {
        checks,
        truth,
        ..Case::new(text.end(duration), duration)
    }
}

/// Masses in a row with elastic stops between them and at walls, pushed by gravity and braked by friction or
/// not.
pub fn elastic_row(chance: &mut Chance, mut text: Text) -> Case {
    let slope = chance.between(-FRAC_PI_2, FRAC_PI_2);
    text.ground("G", [0.0, 0.0], slope);
    let mut checks = Vec::new();
    let (mut place, mut last) = (0.0, "ground.G".to_owned());
    let count = 1 + chance.below(3);
    for k in 0..count {
        let size = chance.between(0.05, 0.2);
        place += size + [0.0, log_between(chance, 1e-3, 0.4)][usize::from(is(chance, 0.8))];
        let (body, freedom) = (format!("m{k}"), format!("x{k}"));
        let own = format!("{body}.O");
        let mass = log_between(chance, 0.2, 5.0);
        let (sin, cos) = slope.sin_cos();
        let estimate = [place * cos, place * sin, slope];
        text.body(&body, "O = [0, 0]", estimate, [mass, 0.0, 0.0]);
        text.joint(&format!("g{k}"), "translational", ["ground.G", &own], "");
        let speed = [0.0, chance.between(-3.0, 3.0)][chance.below(2)];
        text.freedom(&freedom, "x", ["ground.G", &own], [place, speed]);
        let elastic = |chance: &mut Chance, text: &mut Text| {
            let stiffness = text.nudged(mass * log_between(chance, 1e2, 1e6));
            // Up to critical damping and beyond.
            let damping =
                (stiffness * mass).sqrt() * [0.0, chance.between(0.0, 3.0)][chance.below(2)];
            format!("stiffness = {stiffness:?}, damping = {damping:?}")
        };
        let more = format!(", min = {size:?}, {}", elastic(chance, &mut text));
        text.along("stops", &format!("hit{k}"), "x", [&last, &own], &more);
        if k + 1 == count {
            let wall = place + log_between(chance, 1e-3, 0.5);
            let reach = format!("{{ value = {wall:?}, unit = 'm' }}");
            text.add("parameters", "reach", &reach);
            let more = elastic(chance, &mut text);
            text.add(
                "stops",
                "wall",
                &format!("{{ of = '{freedom}', max = 'reach', {more} }}"),
            );
        }
        if is(chance, 0.4) {
            let force = mass * log_between(chance, 0.1, 9.0);
            let rub = format!("rub{k}");
            text.add(
                "friction",
                &rub,
                &format!("{{ of = '{freedom}', force = {force:?} }}"),
            );
            checks.push(Check::friction(&rub, &freedom, [force, force, 0.0]));
        }
        last = own;
    }
    let duration = chance.between(0.3, 1.5);
    Case {
        checks,
        ..Case::new(text.end(duration), duration)
    }
}
