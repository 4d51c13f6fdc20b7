//! Bodies that are solved together: coupled blocks.

use std::f64::consts::PI;

use crate::attack::Case;
use crate::attack::text::{Point, Text, angle, direction, distance, end, frame, point, somewhere};
use crate::mutation::Chance;

/// A platform on three legs whose lengths change.
pub fn platform(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (x, y) = (chance.between(-0.1, 0.1), chance.between(-0.1, 0.1));
    let phi = angle(chance);
    let mut tops = [[0.0; 2]; 3];
    for (k, top) in tops.iter_mut().enumerate() {
        let round = k as f64 * 2.0 * PI / 3.0 + chance.between(-0.3, 0.3);
        let foot = end([0.0, 0.0], chance.between(0.3, 0.5), round);
        let own = [0; 2].map(|_| chance.between(-0.15, 0.15));
        *top = [x + own[0], y + own[1]];
        text.ground(&format!("f{k}"), foot, 0.0);
        let length = distance(foot, *top);
        let to = length * chance.between(0.6, 1.5);
        let markers = [format!("ground.f{k}"), format!("platform.b{k}")];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        text.push(&format!("u{k}"), "distance", markers, [length, to]);
    }
    let marks = [
        point("b0", tops[0]),
        point("b1", tops[1]),
        point("b2", tops[2]),
    ];
    text.plate(chance, "platform", [x, y, phi], &marks);
    text.case()
}

/// Adds a body of points with a marker for each, `m0`, `m1` and so on.
fn add_plate(chance: &mut Chance, text: &mut Text<'_>, name: &str, points: &[Point]) {
    let names: Vec<String> = (0..points.len()).map(|k| format!("m{k}")).collect();
    let marks = names.iter().zip(points);
    let marks: Vec<_> = marks.map(|(name, place)| point(name, *place)).collect();
    let pose = [points[0][0], points[0][1], angle(chance)];
    text.plate(chance, name, pose, &marks);
}

fn anywhere(chance: &mut Chance) -> Point {
    somewhere(chance, [-0.4, 0.4], [-0.4, 0.4])
}

/// An Assur group of class III: a plate on three bars, one on a crank, two on ground.
pub fn triad(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let pin = end([0.0, 0.0], chance.between(0.05, 0.3), angle(chance));
    let crank = direction([0.0, 0.0], pin);
    let feet = [pin, anywhere(chance), anywhere(chance)];
    let corners = [0; 3].map(|_| anywhere(chance));
    text.ground("O", [0.0, 0.0], 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], pin);
    text.pin("O", ["ground.O", "crank.a"]);
    add_plate(chance, &mut text, "plate", &corners);
    for k in 0..3 {
        let bar = format!("bar{k}");
        text.bar_between(chance, &bar, feet[k], corners[k]);
        let foot = if k == 0 {
            "crank.b".to_owned()
        } else {
            text.ground(&format!("F{k}"), feet[k], 0.0);
            format!("ground.F{k}")
        };
        text.pin(&format!("A{k}"), [&foot, &format!("{bar}.a")]);
        text.pin(
            &format!("B{k}"),
            [&format!("{bar}.b"), &format!("plate.m{k}")],
        );
    }
    let to = crank + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// An Assur group of class IV: two plates that two bars join to each other, on a crank and on
/// ground.
pub fn ring_of_four(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let pin = end([0.0, 0.0], chance.between(0.05, 0.3), angle(chance));
    let crank = direction([0.0, 0.0], pin);
    let foot = anywhere(chance);
    let [a, b, c, d] = [0; 4].map(|_| anywhere(chance));
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("F", foot, 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], pin);
    add_plate(chance, &mut text, "near", &[pin, a, b]);
    add_plate(chance, &mut text, "far", &[foot, c, d]);
    text.bar_between(chance, "upper", a, c);
    text.bar_between(chance, "lower", b, d);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("P", ["crank.b", "near.m0"]);
    text.pin("F", ["ground.F", "far.m0"]);
    text.pin("A", ["near.m1", "upper.a"]);
    text.pin("B", ["near.m2", "lower.a"]);
    text.pin("C", ["far.m1", "upper.b"]);
    text.pin("D", ["far.m2", "lower.b"]);
    let to = crank + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// Four or six bodies with joints of all types between any two of them, a crank and ground, one of
/// the double butterflies among them. Many of these do not move.
pub fn any_group(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let bodies = 2 * (1 + chance.below(3));
    let pin = end([0.0, 0.0], chance.between(0.05, 0.3), angle(chance));
    let crank = direction([0.0, 0.0], pin);
    text.ground("O", [0.0, 0.0], 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], pin);
    text.pin("O", ["ground.O", "crank.a"]);
    // Numbers of bodies: the crank is `bodies`, ground the one after.
    let mut marks: Vec<Vec<(String, Point, f64)>> = vec![Vec::new(); bodies];
    let name = |k: usize| match k.checked_sub(bodies) {
        None => format!("b{k}"),
        Some(0) => "crank".to_owned(),
        Some(_) => "ground".to_owned(),
    };
    for number in 0..3 * bodies / 2 {
        let i = number % bodies;
        // The first joint holds the crank.
        let j = match number {
            0 => bodies,
            1 => bodies + 1,
            _ => (i + 1 + chance.below(bodies + 1)) % (bodies + 2),
        };
        let j = if i == j { bodies + 1 } else { j };
        let kind = chance.below(5);
        let (place, turn) = if j == bodies {
            (pin, crank)
        } else {
            (anywhere(chance), angle(chance))
        };
        let (here, there) = (format!("m{number}"), format!("n{number}"));
        marks[i].push((here.clone(), place, turn));
        let other = match j.checked_sub(bodies) {
            None => {
                marks[j].push((there.clone(), place, turn));
                there
            }
            Some(0) => "b".to_owned(),
            Some(_) => {
                text.ground(&there, place, turn);
                there
            }
        };
        let markers = [
            format!("{}.{other}", name(j)),
            format!("{}.{here}", name(i)),
        ];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        match kind {
            0 => text.slide(&format!("J{number}"), markers),
            _ => text.pin(&format!("J{number}"), markers),
        }
    }
    for (k, marks) in marks.iter().enumerate() {
        let all: Vec<_> = marks
            .iter()
            .map(|(name, place, turn)| frame(name, *place, *turn))
            .collect();
        let at = marks.first().map_or([0.0; 2], |mark| mark.1);
        let pose = [at[0], at[1], angle(chance)];
        text.plate(chance, &name(k), pose, &all);
    }
    let to = crank + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}
