//! Ropes over points and pulleys.

use std::f64::consts::{PI, TAU};

use crate::attack::Case;
use crate::attack::text::{Point, Text, angle, direction, distance, end, point, sign, somewhere};
use crate::mutation::Chance;

/// A crank pulls an arm by a rope over a pulley or a point of ground.
pub fn rope_on_arm(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let start = angle(chance);
    let crank = end([0.0, 0.0], chance.between(0.05, 0.2), start);
    let pivot = somewhere(chance, [0.6, 1.0], [-0.3, 0.3]);
    let tip = end(pivot, chance.between(0.2, 0.5), angle(chance));
    let over = somewhere(chance, [0.2, 0.8], [0.6, 1.0]);
    let pulley = (chance.below(3) > 0).then(|| (chance.between(0.02, 0.08), sign(chance)));
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("P", pivot, 0.0);
    text.ground("F", over, 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], crank);
    text.bar_between(chance, "arm", pivot, tip);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("P", ["ground.P", "arm.a"]);
    let reach = pulley.map_or(0.0, |(radius, side)| side * radius);
    let length = taut(&[(crank, 0.0), (over, reach), (tip, 0.0)]);
    let length = text.length(chance, length);
    let pulley = pulley.map(|(radius, side)| (text.length(chance, radius), side));
    let way = [("crank.b", None), ("ground.F", pulley), ("arm.b", None)];
    text.rope("rope", &way, &length);
    let to = start + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], start, to);
    text.case()
}

/// A lever lifts a weight that swings on a rope, over a pulley of the lever itself and one of ground.
pub fn counterweight(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let start = angle(chance);
    let near = end([0.0, 0.0], chance.between(0.1, 0.3), start);
    // At both pulleys the rope turns about as far as back, far from the ends of its arcs.
    let over = somewhere(chance, [-1.0, -0.7], [0.6, 0.9]);
    let weight = somewhere(chance, [-1.2, -0.9], [-0.8, -0.4]);
    let hook = somewhere(chance, [-0.9, -0.6], [-0.3, 0.1]);
    let radii = [0; 2].map(|_| chance.between(0.02, 0.06));
    let sides = [1.0, sign(chance)];
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("H", hook, 0.0);
    text.ground("F", over, 0.0);
    text.ground("guide", weight, angle(chance));
    text.bar_between(chance, "lever", [0.0, 0.0], near);
    let mark = [point("a", weight)];
    text.plate(chance, "weight", [weight[0], weight[1], 0.0], &mark);
    text.pin("O", ["ground.O", "lever.a"]);
    let guide = ["ground.guide", "weight.a"];
    text.joint("slot", "slot", guide, "");
    let level = ["ground.O", "weight.a"];
    text.turn("level", level, 0.0, 0.0);
    let [first, second] = [0, 1].map(|k| sides[k] * radii[k]);
    let length = taut(&[(hook, 0.0), (near, first), (over, second), (weight, 0.0)]);
    let length = text.length(chance, length);
    let [first, second] = [0, 1].map(|k| Some((text.length(chance, radii[k]), sides[k])));
    let way = [
        ("ground.H", None),
        ("lever.b", first),
        ("ground.F", second),
        ("weight.a", None),
    ];
    text.rope("rope", &way, &length);
    let to = start + chance.between(-3.0, 3.0);
    text.turn("u", ["ground.O", "lever.a"], start, to);
    text.case()
}

/// Returns the length of a rope over circles, whose radii are positive on its left.
fn taut(way: &[(Point, f64)]) -> f64 {
    let legs = way.windows(2).map(|pair| {
        let [(p, r), (q, s)] = [pair[0], pair[1]];
        let (far, across) = (distance(p, q), s - r);
        let length = (far * far - across * across).max(0.0).sqrt();
        (length, direction(p, q) - across.atan2(length))
    });
    let legs: Vec<_> = legs.collect();
    let arcs = legs.windows(2).zip(&way[1..]).map(|(pair, (_, r))| {
        // From -45 to 315 degrees.
        let turn = (pair[1].1 - pair[0].1) * r.signum();
        r.abs() * ((turn + PI / 4.0).rem_euclid(TAU) - PI / 4.0)
    });
    legs.iter().map(|(length, _)| length).sum::<f64>() + arcs.sum::<f64>()
}
