//! Machines with several drivers, and long chains.

use crate::attack::Case;
use crate::attack::text::{Text, angle, direction, distance, dyad, end, point, sign, somewhere};
use crate::mutation::Chance;

/// Boom, stick and bucket with three cylinders, the last of them on a four-bar.
pub fn excavator(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let foot = [0.0, 0.0];
    let knee = end(foot, chance.between(0.4, 0.7), chance.between(0.2, 1.2));
    let wrist = end(knee, chance.between(0.2, 0.4), chance.between(-2.0, 0.3));
    let tooth = end(wrist, chance.between(0.1, 0.2), angle(chance));
    let mut near =
        |[x, y]: [f64; 2]| [x + chance.between(-0.2, 0.2), y + chance.between(-0.2, 0.2)];
    let [base, on_boom, behind, rear] = [foot, foot, knee, knee].map(&mut near);
    let [front, pivot, ear] = [wrist, wrist, wrist].map(&mut near);
    let joint = near(pivot);
    text.ground("O", foot, 0.0);
    text.ground("F", base, 0.0);
    let pose = [foot[0], foot[1], direction(foot, knee)];
    let marks = [
        point("a", foot),
        point("c", on_boom),
        point("s", behind),
        point("b", knee),
    ];
    text.plate(chance, "boom", pose, &marks);
    let pose = [knee[0], knee[1], direction(knee, wrist)];
    let marks = [
        point("a", knee),
        point("r", rear),
        point("f", front),
        point("l", pivot),
        point("b", wrist),
    ];
    text.plate(chance, "stick", pose, &marks);
    let pose = [wrist[0], wrist[1], direction(wrist, tooth)];
    text.plate(
        chance,
        "bucket",
        pose,
        &[point("a", wrist), point("e", ear)],
    );
    text.bar_between(chance, "lever", pivot, joint);
    text.pin("O", ["ground.O", "boom.a"]);
    text.pin("K", ["boom.b", "stick.a"]);
    text.pin("W", ["stick.b", "bucket.a"]);
    text.pin("L", ["stick.l", "lever.a"]);
    let length = text.length(chance, distance(joint, ear));
    text.joint(
        "rod",
        "link",
        ["lever.b", "bucket.e"],
        &format!(", length = {length}"),
    );
    for (name, markers, length) in [
        ("u", ["ground.F", "boom.c"], distance(base, on_boom)),
        ("v", ["boom.s", "stick.r"], distance(behind, rear)),
        ("w", ["stick.f", "lever.b"], distance(front, joint)),
    ] {
        let to = length * chance.between(0.5, 1.8);
        text.push(name, "distance", markers, [length, to]);
    }
    text.case()
}

/// A dyad between two cranks that turn by themselves.
pub fn five_bar(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let base = chance.between(0.1, 0.6);
    let cranks = [0; 2].map(|_| chance.between(0.05, 0.3));
    let bars = [0; 2].map(|_| chance.between(0.2, 0.6));
    let starts = [0; 2].map(|_| angle(chance));
    let feet = [[0.0, 0.0], [base, 0.0]];
    let pins = [0, 1].map(|k: usize| end(feet[k], cranks[k], starts[k]));
    let angles = dyad(pins[0], pins[1], bars, sign(chance));
    for k in 0..2 {
        let crank = text.length(chance, cranks[k]);
        let bar = text.length(chance, bars[k]);
        text.ground(&format!("O{k}"), feet[k], 0.0);
        text.bar(&format!("crank{k}"), &crank, feet[k], starts[k]);
        text.bar(&format!("bar{k}"), &bar, pins[k], angles[k]);
        let [foot, near] = [format!("ground.O{k}"), format!("crank{k}.a")];
        text.pin(&format!("O{k}"), [&foot, &near]);
        text.pin(
            &format!("A{k}"),
            [&format!("crank{k}.b"), &format!("bar{k}.a")],
        );
        let to = starts[k] + chance.between(-5.0, 5.0);
        text.turn(&format!("u{k}"), [&foot, &near], starts[k], to);
    }
    text.pin("C", ["bar0.b", "bar1.b"]);
    text.case()
}

/// A plate on two cylinders and a bar that is turned by a third, all at once: two coupled loops.
pub fn two_loops_of_cylinders(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let near = [-0.2, 0.2];
    let feet = [[-0.5, 0.0], [0.5, 0.0], [0.0, 0.6]].map(|[x, y]: [f64; 2]| {
        let [across, up] = somewhere(chance, near, near);
        [x + across, y + up]
    });
    let tops = [0; 3].map(|_| somewhere(chance, near, near));
    let hand = somewhere(chance, [-0.4, 0.4], [0.2, 0.5]);
    let phi = angle(chance);
    let marks = [
        point("a", tops[0]),
        point("b", tops[1]),
        point("c", tops[2]),
    ];
    text.plate(chance, "plate", [tops[0][0], tops[0][1], phi], &marks);
    text.bar_between(chance, "arm", feet[2], hand);
    text.bar_between(chance, "rod", hand, tops[2]);
    for (name, foot) in ["P", "Q", "R"].iter().zip(feet) {
        text.ground(name, foot, 0.0);
    }
    text.pin("R", ["ground.R", "arm.a"]);
    text.pin("H", ["arm.b", "rod.a"]);
    text.pin("C", ["rod.b", "plate.c"]);
    let lengths = [
        distance(feet[0], tops[0]),
        distance(feet[1], tops[1]),
        distance(feet[0], hand),
    ];
    let markers = [
        ["ground.P", "plate.a"],
        ["ground.Q", "plate.b"],
        ["ground.P", "arm.b"],
    ];
    for (k, length) in lengths.into_iter().enumerate() {
        let to = length * chance.between(0.6, 1.5);
        text.push(&format!("u{k}"), "distance", markers[k], [length, to]);
    }
    text.case()
}

/// A scissor lift of up to twenty cells, driven at its base or, as one block, at its top.
pub fn scissor_lift(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let cells = 2 + chance.below(19);
    let (arm, tilt) = (chance.between(0.2, 0.4), chance.between(0.2, 1.3));
    let half = arm * chance.between(0.45, 0.55).max(0.5);
    let mut feet = [[0.0, 0.0], [2.0 * half * tilt.cos(), 0.0]];
    text.ground("O", feet[0], 0.0);
    let [written, middle] = [arm, half].map(|length| text.length(chance, length));
    let markers = format!("a = [0, 0], m = [{middle}, 0], b = [{written}, 0]");
    for cell in 0..cells {
        let angles = dyad(feet[0], feet[1], [half, half], 1.0);
        let [l, r] = [format!("l{cell}"), format!("r{cell}")];
        for ((name, foot), angle) in [&l, &r].into_iter().zip(feet).zip(angles) {
            text.body(name, &markers, [foot[0], foot[1], angle]);
        }
        text.pin(&format!("M{cell}"), [&format!("{l}.m"), &format!("{r}.m")]);
        let below = cell.checked_sub(1);
        if let Some(below) = below {
            let ends = [format!("r{below}.b"), format!("{l}.a")];
            text.pin(&format!("A{cell}"), [&ends[0], &ends[1]]);
            let ends = [format!("l{below}.b"), format!("{r}.a")];
            text.pin(&format!("B{cell}"), [&ends[0], &ends[1]]);
        }
        feet = [end(feet[1], arm, angles[1]), end(feet[0], arm, angles[0])];
    }
    text.pin("O", ["ground.O", "l0.a"]);
    text.joint("S", "slot", ["ground.O", "r0.a"], "");
    if chance.between(0.0, 1.0) < 0.3 {
        let to = tilt + chance.between(-1.5, 1.5);
        text.turn("u", ["ground.O", "l0.a"], tilt, to);
    } else {
        let top = format!("r{}.b", cells - 1);
        let length = distance([0.0, 0.0], feet[0]);
        let to = length * chance.between(0.3, 1.4);
        text.push("u", "distance", ["ground.O", &top], [length, to]);
    }
    text.case()
}
