//! Mechanisms with equations between coordinates.

use std::f64::consts::PI;

use crate::attack::Case;
use crate::attack::text::{
    Point, Text, angle, direction, distance, dyad, end, frame, point, sign, somewhere,
};
use crate::mutation::Chance;

const ORIGIN: Point = [0.0, 0.0];

/// Returns f(x) as text, with f(`at`) = `value`: linear, with a sine, with a part that begins at a
/// place, or through points.
fn function(chance: &mut Chance, x: &str, [at, value]: [f64; 2]) -> (String, String) {
    let ratio = sign(chance) * chance.between(0.2, 2.0);
    let bend = chance.between(-0.3, 0.3);
    let place = at + chance.between(-4.0, 4.0);
    let (shape, law, here) = match chance.below(4) {
        0 => (format!("{ratio:?}*{x}"), String::new(), ratio * at),
        1 => (
            format!("{ratio:?}*{x} + {bend:?}*sin({x} - {place:?})"),
            String::new(),
            ratio * at + bend * (at - place).sin(),
        ),
        2 => (
            format!("{ratio:?}*{x} + {bend:?}*max(0, {x} - {place:?})^2"),
            String::new(),
            ratio * at + bend * (at - place).max(0.0).powi(2),
        ),
        _ => {
            // A hill between two points at which the curve rests.
            let (low, high) = (place - 1.0, place + 1.0);
            let points = format!("[[{low:?}, 0], [{high:?}, {bend:?}]]");
            let law = format!(", law = {{ table = {points}, law = 'polynomial_345' }}");
            let part = ((at - low) / (high - low)).clamp(0.0, 1.0);
            let risen = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
            (
                format!("{ratio:?}*{x} + law({x})"),
                law,
                ratio * at + bend * risen,
            )
        }
    };
    (format!("{shape} + ({:?})", value - here), law)
}

/// Two cranks coupled by a function of their angles; the second one moves a rocker by a rod.
pub fn coupled_cranks(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let angles = [angle(chance), angle(chance)];
    let pins = add_cranks(chance, &mut text, angles);
    text.measure("w", "angle", ["ground.P", "second.a"]);
    let (own, other) = (text.name("u"), text.name("w"));
    let (function, law) = function(chance, &own, angles);
    text.couple("tie", &format!("{other} = {function}"), &law);
    add_rocker(chance, &mut text, "second.b", pins[1]);
    let to = angles[0] + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "first.a"], angles[0], to);
    text.case()
}

/// Two cranks of which each moves a rocker; their sum and a product with a third body's angle are
/// coupled to a driven wheel, so that all is one block.
pub fn differential(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let angles = [angle(chance), angle(chance)];
    let pins = add_cranks(chance, &mut text, angles);
    // The rod between the cranks' pins leaves one degree of freedom, which the sum drives.
    let rod = distance(pins[0], pins[1]);
    let rod = text.length(chance, rod);
    let along = direction(pins[0], pins[1]);
    text.bar("rod", &rod, pins[0], along);
    text.pin("A", ["first.b", "rod.a"]);
    text.pin("B", ["second.b", "rod.b"]);
    let marks = [point("a", ORIGIN)];
    text.plate(chance, "wheel", [0.0, 0.0, 0.0], &marks);
    text.pin("W", ["ground.O", "wheel.a"]);
    text.measure("v", "angle", ["ground.O", "first.a"]);
    text.measure("w", "angle", ["ground.P", "second.a"]);
    let [sum, v, w] = ["u", "v", "w"].map(|name| text.name(name));
    let ratio = chance.between(0.2, 1.0);
    let bend = chance.between(-0.2, 0.2);
    let here = ratio * angles[0] + angles[1] + bend * (angles[0] - angles[1]).sin();
    let equation = format!("{sum} + ({here:?}) = {ratio:?}*{v} + {w} + {bend:?}*sin({v} - {w})");
    text.couple("sum", &equation, "");
    let to = chance.between(-2.0, 2.0);
    text.turn("u", ["ground.O", "wheel.a"], 0.0, to);
    text.case()
}

/// A screw: a driven wheel moves a slider, which a rod joins to a rocker; the slider's way has a
/// part of second order.
pub fn screw(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (start, slope) = (angle(chance), chance.between(-PI, PI));
    let seat = somewhere(chance, [-0.3, 0.3], [-0.3, 0.3]);
    text.ground("O", ORIGIN, 0.0);
    text.ground("S", ORIGIN, slope);
    let marks = [frame("a", ORIGIN, start)];
    text.plate(chance, "wheel", [0.0, 0.0, start], &marks);
    text.pin("O", ["ground.O", "wheel.a"]);
    let way = [slope.cos(), slope.sin()];
    let x = seat[0] * way[0] + seat[1] * way[1];
    let foot = [x * way[0], x * way[1]];
    let marks = [frame("s", foot, slope), point("b", foot)];
    text.plate(chance, "nut", [foot[0], foot[1], slope], &marks);
    text.slide("S", ["ground.S", "nut.s"]);
    text.measure("x", "x", ["ground.S", "nut.s"]);
    let (turn, travel) = (text.name("u"), text.name("x"));
    let lead = sign(chance) * chance.between(0.02, 0.1);
    let bend = chance.between(-0.01, 0.01);
    let shift = x - lead * start - bend * start * start;
    let [lead, bend, shift] = [lead, bend, shift].map(|length| text.number(length));
    let equation = format!("{travel} = ({lead})*{turn} + ({bend})*{turn}^2 + ({shift})");
    text.couple("thread", &equation, "");
    add_rocker(chance, &mut text, "nut.b", foot);
    let to = start + chance.between(-6.0, 6.0);
    text.turn("u", ["ground.O", "wheel.a"], start, to);
    text.case()
}

/// Adds two cranks on ground at these angles. Returns their pins.
fn add_cranks(chance: &mut Chance, text: &mut Text<'_>, angles: [f64; 2]) -> [Point; 2] {
    let centres = [ORIGIN, somewhere(chance, [0.2, 0.9], [-0.4, 0.4])];
    let crank = |(ground, name, centre, angle): (&str, &str, Point, f64)| {
        let pin = end(centre, chance.between(0.1, 0.4), angle);
        text.ground(ground, centre, 0.0);
        text.bar_between(chance, name, centre, pin);
        text.pin(ground, [&format!("ground.{ground}"), &format!("{name}.a")]);
        pin
    };
    [
        ("O", "first", centres[0], angles[0]),
        ("P", "second", centres[1], angles[1]),
    ]
    .map(crank)
}

/// Adds a rod from a marker at `pin` to a rocker on ground.
fn add_rocker(chance: &mut Chance, text: &mut Text<'_>, marker: &str, pin: Point) {
    let foot = somewhere(chance, [-0.6, 0.9], [-0.6, 0.6]);
    let bars = [0; 2].map(|_| chance.between(0.2, 0.8));
    let angles = dyad(pin, foot, bars, sign(chance));
    text.ground("D", foot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("rod", &bars[0], pin, angles[0]);
    text.bar("rocker", &bars[1], foot, angles[1]);
    text.pin("B", [marker, "rod.a"]);
    text.pin("C", ["rod.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
}
