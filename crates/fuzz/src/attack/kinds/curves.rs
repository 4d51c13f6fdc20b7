//! Points on curves.

use crate::attack::Case;
use crate::attack::text::{Text, angle, distance, end, point, sign};
use crate::mutation::Chance;

/// A crank turns a bar whose end runs in a groove of ground: a ring, or a wave that ends nowhere.
pub fn bar_in_groove(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let start = angle(chance);
    let crank = end([0.0, 0.0], chance.between(0.05, 0.2), start);
    let size = chance.between(0.3, 0.6);
    let centre = [chance.between(-0.2, 0.2), chance.between(-0.2, 0.2)];
    let at = angle(chance);
    // Ripples that keep the ring convex or nearly so.
    let ripple = size * chance.between(-0.1, 0.1);
    let radius = size + ripple * (2.0 * at).cos();
    let pin = end(centre, radius, at);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("G", centre, 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], crank);
    text.bar_between(chance, "bar", crank, pin);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "bar.a"]);
    let [size, ripple] = [size, ripple].map(|length| text.length(chance, length));
    let [size, ripple] = [size, ripple].map(|length| length.replace('\'', ""));
    let round = format!("({size} + {ripple}*cos(2*s))");
    let groove =
        format!(", x = '{round}*cos(s)', y = '{round}*sin(s)', to = '2*pi', closed = true");
    text.joint("groove", "curve", ["ground.G", "bar.b"], &groove);
    let to = start + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], start, to);
    text.case()
}

/// A carriage on a track through points, pushed by a cylinder.
pub fn carriage(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let height = [0; 6].map(|_| chance.between(-0.1, 0.1));
    let along = |k: usize| [0.25 * k as f64, height[k]];
    let start = along(2);
    let foot = end(
        start,
        chance.between(0.6, 1.0),
        -1.6 + chance.between(-0.3, 0.3),
    );
    text.ground("C", [0.0, 0.0], 0.0);
    text.ground("F", foot, 0.0);
    // The direction of a natural spline is not at hand: estimates are near.
    let slope = (height[3] - height[1]) / 0.5;
    let pose = [start[0], start[1], slope.atan()];
    let marks = [point("a", start), point("b", end(start, 0.1, slope.atan()))];
    text.plate(chance, "carriage", pose, &marks);
    let points: Vec<String> = (0..6)
        .map(|k| {
            let [x, y] = along(k).map(|x| text.number(x));
            format!("[{x}, {y}]")
        })
        .collect();
    let track = format!(
        ", points = {{ table = [{}] }}, follow = true",
        points.join(", ")
    );
    text.joint("track", "curve", ["ground.C", "carriage.a"], &track);
    let length = distance(foot, start);
    let to = length * (1.0 + 0.05 * sign(chance));
    text.push("u", "distance", ["ground.F", "carriage.a"], [length, to]);
    text.case()
}
