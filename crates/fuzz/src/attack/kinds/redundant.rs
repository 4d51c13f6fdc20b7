//! Mechanisms with more constraints than they need.

use std::f64::consts::PI;

use crate::attack::Case;
use crate::attack::text::{Text, angle, end, frame};
use crate::mutation::Chance;

/// A parallelogram with a third crank, anywhere on the coupler, and cranks that may be inclined.
pub fn three_cranks(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (length, base) = (chance.between(0.1, 0.3), chance.between(0.2, 0.6));
    let (start, tilt) = (angle(chance), chance.between(-0.5, 0.5));
    let third = [chance.between(0.1, 0.5), chance.between(-0.2, 0.2)];
    let middle = end(end([0.0, 0.0], third[0], tilt), third[1], tilt + 0.5 * PI);
    let feet = [[0.0, 0.0], end([0.0, 0.0], base, tilt), middle];
    let pins = feet.map(|foot| end(foot, length, start));
    let crank = text.length(chance, length);
    for (k, foot) in feet.into_iter().enumerate() {
        let name = format!("crank{k}");
        text.ground(&format!("O{k}"), foot, 0.0);
        text.bar(&name, &crank, foot, start);
        text.pin(
            &format!("O{k}"),
            [&format!("ground.O{k}"), &format!("{name}.a")],
        );
        text.pin(
            &format!("A{k}"),
            [&format!("{name}.b"), &format!("coupler.m{k}")],
        );
    }
    let marks = ["m0", "m1", "m2"];
    // The coupler does not change, or it would contradict ground.
    let (sin, cos) = tilt.sin_cos();
    let mut markers = Vec::new();
    for (name, pin) in marks.iter().zip(pins) {
        let (x, y) = (pin[0] - pins[0][0], pin[1] - pins[0][1]);
        let (x, y) = (
            text.number(cos * x + sin * y),
            text.number(cos * y - sin * x),
        );
        markers.push(format!("{name} = [{x}, {y}]"));
    }
    text.body(
        "coupler",
        &markers.join(", "),
        [pins[0][0], pins[0][1], tilt],
    );
    let to = start + chance.between(-4.0, 4.0);
    text.turn("u", ["ground.O0", "crank0.a"], start, to);
    text.case()
}

/// A table in two guides, pushed by a slider-crank.
pub fn double_guide(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (length, rod) = (chance.between(0.1, 0.3), chance.between(0.2, 0.6));
    let (crank, slope, tilt) = (angle(chance), angle(chance), chance.between(-0.5, 0.5));
    let pin = end([0.0, 0.0], length, crank);
    let foot = end(pin, rod, slope);
    let aside = end(foot, chance.between(0.05, 0.3), tilt + 0.5 * PI);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("G", foot, tilt);
    text.ground("H", aside, tilt);
    let [written, rod] = [length, rod].map(|length| text.length(chance, length));
    text.bar("crank", &written, [0.0, 0.0], crank);
    text.bar("rod", &rod, pin, slope);
    let across = text.number((aside[0] - foot[0]).hypot(aside[1] - foot[1]));
    let along = text.length(chance, 0.1);
    let markers = format!("a = [0, 0], g = [0, {across}], h = [{along}, {across}]");
    text.body("table", &markers, [foot[0], foot[1], tilt]);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "rod.a"]);
    text.pin("B", ["rod.b", "table.a"]);
    text.slide("G", ["ground.G", "table.a"]);
    if chance.between(0.0, 1.0) < 0.5 {
        text.slide("H", ["ground.H", "table.g"]);
    } else {
        text.joint("H", "slot", ["ground.H", "table.g"], "");
        text.joint("I", "slot", ["ground.H", "table.h"], "");
    }
    let to = crank + chance.between(-7.0, 7.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// A trammel with a crank from the crossing of its guides to the middle of its bar: it passes
/// positions in which either slider alone would not be moved by the crank.
pub fn cardan(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (half, crank) = (chance.between(0.1, 0.3), angle(chance));
    let tilt = chance.between(-0.5, 0.5);
    let pin = end([0.0, 0.0], half, crank);
    let bar = 2.0 * tilt - crank;
    let ends = [end(pin, half, bar), end(pin, -half, bar)];
    let other = tilt + 0.5 * PI;
    text.ground("O", [0.0, 0.0], tilt);
    text.ground("U", [0.0, 0.0], other);
    let written = text.length(chance, half);
    let [plus, minus] = match written.trim_matches('\'') {
        name if written.starts_with('\'') => [format!("'{name}'"), format!("'-{name}'")],
        number => [number.to_owned(), format!("-{number}")],
    };
    text.bar("crank", &written, [0.0, 0.0], crank);
    let markers = format!("m = [0, 0], mx = [{plus}, 0], my = [{minus}, 0]");
    text.body("bar", &markers, [pin[0], pin[1], bar]);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "bar.m"]);
    for (name, place, guide, direction) in [("mx", ends[0], "O", tilt), ("my", ends[1], "U", other)]
    {
        let marker = format!("bar.{name}");
        let ground = format!("ground.{guide}");
        if chance.between(0.0, 1.0) < 0.5 {
            text.joint(&format!("S{name}"), "slot", [&ground, &marker], "");
            continue;
        }
        let slider = format!("s{name}");
        let marks = [frame("a", place, direction)];
        text.plate(chance, &slider, [place[0], place[1], direction], &marks);
        let own = format!("{slider}.a");
        text.slide(&format!("S{name}"), [&ground, &own]);
        text.pin(&format!("P{name}"), [&marker, &own]);
    }
    let to = crank + chance.between(-7.0, 7.0);
    text.turn("u", ["ground.O", "crank.a"], crank - tilt, to - tilt);
    text.case()
}

/// Two equal slider-cranks on one slider, their cranks joined by a bar.
pub fn twin_slider_cranks(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (length, rod) = (chance.between(0.1, 0.3), chance.between(0.2, 0.6));
    let (crank, slope) = (angle(chance), angle(chance));
    let apart = [chance.between(-0.4, 0.4), chance.between(-0.4, 0.4)];
    let moved = |[x, y]: [f64; 2]| [x + apart[0], y + apart[1]];
    let pin = end([0.0, 0.0], length, crank);
    let foot = end(pin, rod, slope);
    let guide = chance.between(-0.5, 0.5);
    text.ground("G", foot, guide);
    let [length, rod] = [length, rod].map(|length| text.length(chance, length));
    for (k, origin) in [[0.0, 0.0], apart].into_iter().enumerate() {
        let at = |place| if k == 0 { place } else { moved(place) };
        let (turning, pushing) = (format!("crank{k}"), format!("rod{k}"));
        text.ground(&format!("O{k}"), origin, 0.0);
        text.bar(&turning, &length, origin, crank);
        text.bar(&pushing, &rod, at(pin), slope);
        text.pin(
            &format!("O{k}"),
            [&format!("ground.O{k}"), &format!("{turning}.a")],
        );
        text.pin(
            &format!("A{k}"),
            [&format!("{turning}.b"), &format!("{pushing}.a")],
        );
        text.pin(
            &format!("B{k}"),
            [&format!("{pushing}.b"), &format!("slider.m{k}")],
        );
    }
    let (sin, cos) = guide.sin_cos();
    let across = text.number(cos * apart[0] + sin * apart[1]);
    let up = text.number(cos * apart[1] - sin * apart[0]);
    let markers = format!("m0 = [0, 0], m1 = [{across}, {up}]");
    text.body("slider", &markers, [foot[0], foot[1], guide]);
    text.slide("G", ["ground.G", "slider.m0"]);
    if chance.between(0.0, 1.0) < 0.7 {
        let along = apart[1].atan2(apart[0]);
        let number = text.number(apart[0].hypot(apart[1]));
        text.bar("link", &number, pin, along);
        text.pin("L0", ["crank0.b", "link.a"]);
        text.pin("L1", ["crank1.b", "link.b"]);
    }
    let to = crank + chance.between(-6.0, 6.0);
    text.turn("u", ["ground.O0", "crank0.a"], crank, to);
    text.case()
}
