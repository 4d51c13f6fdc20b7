//! Mechanisms with slides, slots and cylinders.

use std::f64::consts::PI;

use crate::attack::Case;
use crate::attack::text::{
    Point, Text, angle, direction, distance, dyad, end, frame, point, sign, somewhere,
};
use crate::mutation::Chance;

const ORIGIN: Point = [0.0, 0.0];

/// Adds a bar `crank` on ground at the origin. Returns its angle and its end.
fn add_crank(chance: &mut Chance, text: &mut Text<'_>, length: f64) -> (f64, Point) {
    let crank = angle(chance);
    text.ground("O", ORIGIN, 0.0);
    let written = text.length(chance, length);
    text.bar("crank", &written, ORIGIN, crank);
    text.pin("O", ["ground.O", "crank.a"]);
    (crank, end(ORIGIN, length, crank))
}

/// A slider-crank; the slider's pin may lie beside its guide.
pub fn slider_crank(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let length = chance.between(0.1, 0.4);
    let (crank, pin) = add_crank(chance, &mut text, length);
    let (rod, offset) = (chance.between(0.1, 0.8), chance.between(-0.2, 0.2));
    let slope = ((offset - pin[1]) / rod).clamp(-1.0, 1.0).asin();
    let foot = end(pin, rod, slope);
    text.ground("S", [0.0, offset], 0.0);
    text.bar_between(chance, "rod", pin, foot);
    text.pin("A", ["crank.b", "rod.a"]);
    if chance.between(0.0, 1.0) < 0.7 {
        let marks = [frame("a", foot, 0.0)];
        text.plate(chance, "slider", [foot[0], foot[1], 0.0], &marks);
        text.pin("B", ["rod.b", "slider.a"]);
        text.slide("S", ["ground.S", "slider.a"]);
    } else {
        let more = format!(", offset = {}", text.number(0.0));
        text.joint("B", "revolute_translational", ["ground.S", "rod.b"], &more);
    }
    let to = crank + chance.between(-7.0, 7.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// Drives the bar `crank` by a cylinder from a foot on ground to its marker `b`: as a distance, as
/// tube and rod, or as a rod through a sleeve that turns.
fn add_cylinder(chance: &mut Chance, text: &mut Text<'_>, foot: Point, pin: Point) {
    text.ground("F", foot, 0.0);
    let (length, along) = (distance(foot, pin), direction(foot, pin));
    let to = length * chance.between(0.4, 1.8);
    let kind = chance.below(3);
    if kind == 0 {
        text.push("u", "distance", ["ground.F", "crank.b"], [length, to]);
        return;
    }
    let to = if kind == 1 { to } else { -to };
    let marks = [point("a", foot), frame("g", foot, along)];
    text.plate(chance, "tube", [foot[0], foot[1], along], &marks);
    text.pin("F", ["ground.F", "tube.a"]);
    let marks = [frame("g", pin, along), point("b", pin)];
    text.plate(chance, "rod", [pin[0], pin[1], along], &marks);
    text.slide("G", ["tube.g", "rod.g"]);
    text.pin("B", ["rod.b", "crank.b"]);
    text.push("u", "x", ["tube.g", "rod.b"], [length, to]);
}

/// An inverted slider-crank: a cylinder turns a crank.
pub fn cylinder(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let length = chance.between(0.1, 0.4);
    let (_, pin) = add_crank(chance, &mut text, length);
    let foot = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    add_cylinder(chance, &mut text, foot, pin);
    text.case()
}

/// A cylinder that turns the crank of a four-bar.
pub fn cylinder_and_four_bar(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let length = chance.between(0.1, 0.4);
    let (_, pin) = add_crank(chance, &mut text, length);
    let foot = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let pivot = somewhere(chance, [0.1, 0.7], [-0.4, 0.4]);
    let bars = [chance.between(0.2, 0.7), chance.between(0.1, 0.6)];
    let angles = dyad(pin, pivot, bars, sign(chance));
    text.ground("D", pivot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("coupler", &bars[0], pin, angles[0]);
    text.bar("rocker", &bars[1], pivot, angles[1]);
    text.pin("A", ["crank.b", "coupler.a"]);
    text.pin("C", ["coupler.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    add_cylinder(chance, &mut text, foot, pin);
    text.case()
}

/// A Scotch yoke with an inclined slot, driven by its crank or by its yoke.
pub fn scotch_yoke(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let length = chance.between(0.1, 0.4);
    let (crank, pin) = add_crank(chance, &mut text, length);
    let guide = chance.between(-0.2, 0.2);
    let slot = chance.between(0.2, PI - 0.2);
    text.ground("G", [0.0, guide], 0.0);
    let yoke = [pin[0] + chance.between(-0.1, 0.1), guide];
    let marks = [
        frame("g", yoke, 0.0),
        frame("s", end(pin, chance.between(-0.2, 0.2), slot), slot),
    ];
    text.plate(chance, "yoke", [yoke[0], yoke[1], 0.0], &marks);
    text.slide("G", ["ground.G", "yoke.g"]);
    text.joint("A", "slot", ["yoke.s", "crank.b"], "");
    if chance.between(0.0, 1.0) < 0.6 {
        let to = crank + chance.between(-7.0, 7.0);
        text.turn("u", ["ground.O", "crank.a"], crank, to);
    } else {
        let to = yoke[0] + chance.between(-0.6, 0.6);
        text.push("u", "x", ["ground.G", "yoke.g"], [yoke[0], to]);
    }
    text.case()
}

/// Two shafts with a disc between them that slides in both.
pub fn oldham_coupling(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (start, tilt) = (angle(chance), chance.between(0.3, PI - 0.3));
    let shaft = somewhere(chance, [-0.2, 0.2], [-0.2, 0.2]);
    let disc = somewhere(chance, [-0.2, 0.2], [-0.2, 0.2]);
    let [first, second] = [start, start + tilt];
    text.ground("O", ORIGIN, 0.0);
    text.ground("D", shaft, 0.0);
    // The guides go through any points of shafts and disc.
    let aside = chance.between(-0.1, 0.1);
    let marks = [
        point("a", ORIGIN),
        frame("g", end(disc, aside, first), first),
    ];
    text.plate(chance, "first", [0.0, 0.0, first], &marks);
    let marks = [point("a", shaft), frame("g", disc, second)];
    text.plate(chance, "second", [shaft[0], shaft[1], start], &marks);
    let marks = [frame("g", disc, first), frame("h", disc, second)];
    text.plate(chance, "disc", [disc[0], disc[1], start], &marks);
    text.pin("O", ["ground.O", "first.a"]);
    text.pin("D", ["ground.D", "second.a"]);
    text.slide("G", ["first.g", "disc.g"]);
    text.slide("H", ["second.g", "disc.h"]);
    let to = first + chance.between(-7.0, 7.0);
    text.turn("u", ["ground.O", "first.a"], first, to);
    text.case()
}

/// A bar between two guides, driven by its angle, by a slider or by its distance from a point.
pub fn trammel(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let [first, second] = [0; 2].map(|_| somewhere(chance, [-0.4, 0.4], [-0.4, 0.4]));
    let (level, tilt) = (chance.between(-0.3, 0.3), chance.between(0.4, PI - 0.4));
    let along = direction(first, second);
    text.ground("L", end(first, chance.between(-0.3, 0.3), level), level);
    text.ground("U", end(second, chance.between(-0.3, 0.3), tilt), tilt);
    text.bar_between(chance, "bar", first, second);
    let marks = [frame("a", first, level)];
    text.plate(chance, "level", [first[0], first[1], level], &marks);
    text.pin("A", ["bar.a", "level.a"]);
    text.slide("L", ["ground.L", "level.a"]);
    if chance.between(0.0, 1.0) < 0.5 {
        let marks = [frame("a", second, tilt)];
        text.plate(chance, "upright", [second[0], second[1], tilt], &marks);
        text.pin("B", ["bar.b", "upright.a"]);
        text.slide("U", ["ground.U", "upright.a"]);
    } else {
        text.joint("U", "slot", ["ground.U", "bar.b"], "");
    }
    match chance.below(3) {
        0 => {
            let to = along - level + chance.between(-7.0, 7.0);
            text.turn("u", ["ground.L", "bar.a"], along - level, to);
        }
        1 => {
            let foot = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
            let length = distance(foot, second);
            text.ground("F", foot, 0.0);
            let to = length * chance.between(0.3, 2.0);
            text.push("u", "distance", ["ground.F", "bar.b"], [length, to]);
        }
        _ => {
            let foot = end(first, chance.between(-0.3, 0.3), level);
            text.ground("F", foot, level);
            let (sin, cos) = level.sin_cos();
            let place = (first[0] - foot[0]) * cos + (first[1] - foot[1]) * sin;
            let to = place + chance.between(-0.6, 0.6);
            text.push("u", "x", ["ground.F", "level.a"], [place, to]);
        }
    }
    text.case()
}

/// A crank whose pin runs in the slot of a lever, and a ram on a rod of the lever.
pub fn quick_return(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let length = chance.between(0.1, 0.4);
    let (crank, pin) = add_crank(chance, &mut text, length);
    let pivot = somewhere(chance, [-0.3, 0.3], [-0.5, 0.5]);
    let aside = if chance.between(0.0, 1.0) < 0.5 {
        0.0
    } else {
        chance.between(-0.1, 0.1)
    };
    // The line of the slot passes the lever's pivot at the distance `aside`.
    let lever = direction(pivot, pin) - (aside / distance(pivot, pin)).clamp(-1.0, 1.0).asin();
    let head = end(
        pivot,
        chance.between(0.1, 0.5),
        lever + chance.between(-0.5, 3.0),
    );
    let marks = [
        point("a", pivot),
        frame("s", end(pivot, aside, lever + 0.5 * PI), lever),
        point("b", head),
    ];
    text.ground("D", pivot, 0.0);
    text.plate(chance, "lever", [pivot[0], pivot[1], lever], &marks);
    text.pin("D", ["ground.D", "lever.a"]);
    text.joint("A", "slot", ["lever.s", "crank.b"], "");
    let rod = chance.between(0.1, 0.6);
    let ram = end(head, rod, angle(chance));
    let guide = angle(chance);
    text.ground("G", ram, guide);
    text.bar_between(chance, "rod", head, ram);
    let marks = [frame("a", ram, guide)];
    text.plate(chance, "ram", [ram[0], ram[1], guide], &marks);
    text.pin("B", ["lever.b", "rod.a"]);
    text.pin("C", ["rod.b", "ram.a"]);
    text.slide("G", ["ground.G", "ram.a"]);
    if chance.between(0.0, 1.0) < 0.7 {
        let to = crank + chance.between(-7.0, 7.0);
        text.turn("u", ["ground.O", "crank.a"], crank, to);
    } else {
        let to = lever + chance.between(-4.0, 4.0);
        text.turn("u", ["ground.D", "lever.a"], lever, to);
    }
    text.case()
}
