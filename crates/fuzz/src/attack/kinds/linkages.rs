//! Chains of bars and pins.

use crate::attack::Case;
use crate::attack::text::{Text, angle, dyad, end, sign, somewhere};
use crate::mutation::Chance;

/// Numbers of a four-bar: crank, coupler, rocker, base, the crank's angle, and the bend.
fn draw_four_bar(chance: &mut Chance) -> ([f64; 4], f64, f64) {
    let lengths = [0; 4].map(|_| chance.between(0.1, 0.6));
    (lengths, angle(chance), sign(chance))
}

/// Adds a four-bar. Returns the rocker's angle.
fn add_four_bar(
    chance: &mut Chance,
    text: &mut Text<'_>,
    ([a, b, c, d], crank, side): ([f64; 4], f64, f64),
) -> f64 {
    let pin = end([0.0, 0.0], a, crank);
    let [coupler, rocker] = dyad(pin, [d, 0.0], [b, c], side);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", [d, 0.0], 0.0);
    let [a, b, c] = [a, b, c].map(|length| text.length(chance, length));
    text.bar("crank", &a, [0.0, 0.0], crank);
    text.bar("coupler", &b, pin, coupler);
    text.bar("rocker", &c, [d, 0.0], rocker);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "coupler.a"]);
    text.pin("B", ["coupler.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    rocker
}

pub fn four_bar(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let numbers = draw_four_bar(chance);
    add_four_bar(chance, &mut text, numbers);
    let to = numbers.1 + chance.between(-7.0, 7.0);
    text.turn("u", ["ground.O", "crank.a"], numbers.1, to);
    text.case()
}

/// Two four-bars, the second on the rocker of the first.
pub fn six_bar(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let numbers = draw_four_bar(chance);
    let rocker = add_four_bar(chance, &mut text, numbers);
    let (lengths, crank, _) = numbers;
    let pin = end([lengths[3], 0.0], lengths[2], rocker);
    let bars = [chance.between(0.1, 0.6), chance.between(0.1, 0.6)];
    let pivot = somewhere(chance, [-0.4, 0.8], [-0.4, 0.4]);
    let angles = dyad(pin, pivot, bars, sign(chance));
    text.ground("F", pivot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("rod", &bars[0], pin, angles[0]);
    text.bar("output", &bars[1], pivot, angles[1]);
    text.pin("C", ["rocker.b", "rod.a"]);
    text.pin("E", ["rod.b", "output.b"]);
    text.pin("F", ["ground.F", "output.a"]);
    let to = crank + chance.between(-4.0, 4.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}
