//! Gears, belts, racks and wheels in closed loops.

use crate::attack::Case;
use crate::attack::text::{
    Text, angle, direction, distance, dyad, end, frame, point, sign, somewhere,
};
use crate::mutation::Chance;

/// A dyad between two cranks with gears or a belt.
pub fn geared_five_bar(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let base = chance.between(0.3, 0.6);
    let wheel = base * chance.between(0.2, 0.8);
    let cranks = [0; 2].map(|_| chance.between(0.05, 0.3));
    let bars = [0; 2].map(|_| chance.between(0.2, 0.6));
    let starts = [0; 2].map(|_| angle(chance));
    let pins = [
        end([0.0, 0.0], cranks[0], starts[0]),
        end([base, 0.0], cranks[1], starts[1]),
    ];
    let angles = dyad(pins[0], pins[1], bars, sign(chance));
    let cranks = cranks.map(|length| text.length(chance, length));
    let bars = bars.map(|length| text.length(chance, length));
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", [base, 0.0], 0.0);
    for (k, name, foot) in [(0, "first", [0.0, 0.0]), (1, "second", [base, 0.0])] {
        // The wheels are in phase where their markers' angles are zero.
        let phase = text.level() - starts[k];
        let markers = format!("a = [0, 0], b = [{}, 0], w = [0, 0, {phase:?}]", cranks[k]);
        text.body(name, &markers, [foot[0], foot[1], starts[k]]);
    }
    text.bar("left", &bars[0], pins[0], angles[0]);
    text.bar("right", &bars[1], pins[1], angles[1]);
    text.pin("O", ["ground.O", "first.a"]);
    text.pin("D", ["ground.D", "second.a"]);
    text.pin("A", ["first.b", "left.a"]);
    text.pin("B", ["second.b", "right.a"]);
    text.pin("C", ["left.b", "right.b"]);
    let [near, far] = [wheel, base - wheel].map(|radius| text.length(chance, radius));
    let kind = ["gear", "belt"][chance.below(2)];
    let radii = format!(", radii = [{near}, {far}]");
    text.joint("wheels", kind, ["first.w", "second.w"], &radii);
    let to = starts[0] + chance.between(-6.0, 6.0);
    text.turn("u", ["ground.O", "first.a"], starts[0], to);
    text.case()
}

/// A planet on a crank, round a sun at rest, with a slider or a dyad on a pin of the planet.
pub fn planet_crank(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (arm, crank) = (chance.between(0.1, 0.3), angle(chance));
    let teeth = [20, 15 + chance.below(40)];
    let kind = chance.below(3);
    let centre = end([0.0, 0.0], arm, crank);
    let pin = end(centre, chance.between(0.05, 0.2), angle(chance));
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("W", [0.0, 0.0], crank);
    text.bar_between(chance, "crank", [0.0, 0.0], centre);
    let pose = [centre[0], centre[1], angle(chance)];
    let marks = [
        point("a", centre),
        point("b", pin),
        frame("w", centre, crank),
    ];
    text.plate(chance, "planet", pose, &marks);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "planet.a"]);
    let carrier = text.name("crank");
    let more = [", internal = true", "", ", crossed = true"][kind];
    let more = format!(", teeth = {teeth:?}, carrier = '{carrier}'{more}");
    let mesh = ["gear", "gear", "belt"][kind];
    text.joint("mesh", mesh, ["ground.W", "planet.w"], &more);
    let pivot = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let top = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let bars = [distance(pin, top), distance(pivot, top)];
    let angles = [direction(pin, top), direction(pivot, top)];
    text.ground("D", pivot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("rod", &bars[0], pin, angles[0]);
    text.bar("rocker", &bars[1], pivot, angles[1]);
    text.pin("B", ["planet.b", "rod.a"]);
    text.pin("C", ["rod.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    if chance.between(0.0, 1.0) < 0.7 {
        let to = crank + chance.between(-5.0, 5.0);
        text.turn("u", ["ground.O", "crank.a"], crank, to);
    } else {
        // One block of planet and dyad.
        let rocker = angles[1];
        let to = rocker + chance.between(-2.0, 2.0);
        text.turn("u", ["ground.D", "rocker.a"], rocker, to);
    }
    text.case()
}

/// A rack on the pin of a crank, which a pinion guides and which turns the pinion; a dyad joins a
/// pin of the pinion to the crank's.
pub fn rack_in_loop(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (arm, crank) = (chance.between(0.05, 0.3), angle(chance));
    let (radius, side) = (chance.between(0.02, 0.1), sign(chance));
    let pin = end([0.0, 0.0], arm, crank);
    let centre = somewhere(chance, [-0.5, 0.5], [-0.5, 0.5]);
    // The rack's line passes the centre at the radius.
    let lean = (side * radius / distance(pin, centre))
        .clamp(-1.0, 1.0)
        .asin();
    let rack = direction(pin, centre) - lean;
    let tooth = end(centre, chance.between(0.02, 0.2), angle(chance));
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("P", centre, 0.0);
    text.bar_between(chance, "crank", [0.0, 0.0], pin);
    let marks = [frame("r", pin, rack)];
    text.plate(chance, "rack", [pin[0], pin[1], rack], &marks);
    // Pinion and rack are in phase where the rack's travel and the pinion's angle are zero.
    let travel = (distance(pin, centre).powi(2) - radius * radius)
        .max(0.0)
        .sqrt();
    let pose = [centre[0], centre[1], rack - side * travel / radius];
    text.plate(
        chance,
        "pinion",
        pose,
        &[point("a", centre), point("b", tooth)],
    );
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "rack.r"]);
    text.pin("P", ["ground.P", "pinion.a"]);
    let written = text.length(chance, radius);
    let offset = if written.starts_with('\'') {
        let name = written.trim_matches('\'');
        format!(", offset = '{side}*{name}'")
    } else {
        format!(", offset = {}", text.number(side * radius))
    };
    text.joint(
        "guide",
        "revolute_translational",
        ["rack.r", "ground.P"],
        &offset,
    );
    let side = if side > 0.0 { "above" } else { "below" };
    let more = format!(", radius = {written}, side = '{side}'");
    text.joint("teeth", "rack_and_pinion", ["pinion.a", "rack.r"], &more);
    let foot = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let bars = [0; 2].map(|_| chance.between(0.2, 0.7));
    let angles = dyad(tooth, foot, bars, 1.0);
    text.ground("D", foot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("rod", &bars[0], tooth, angles[0]);
    text.bar("rocker", &bars[1], foot, angles[1]);
    text.pin("B", ["pinion.b", "rod.a"]);
    text.pin("C", ["rod.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    let to = crank + chance.between(-5.0, 5.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// A wheel on a track, which a crank pushes by a rod on a pin beside the wheel's centre.
pub fn rolling_wheel(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (arm, crank) = (chance.between(0.05, 0.3), angle(chance));
    let (radius, slope) = (chance.between(0.05, 0.3), chance.between(-0.5, 0.5));
    let pin = end([0.0, 0.0], arm, crank);
    let centre = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let hook = end(centre, chance.between(0.0, 1.2) * radius, angle(chance));
    let side = sign(chance);
    text.ground("O", [0.0, 0.0], 0.0);
    // At travel zero the axes have one direction.
    text.ground(
        "T",
        end(centre, -side * radius, slope + 0.5 * std::f64::consts::PI),
        slope,
    );
    text.bar_between(chance, "crank", [0.0, 0.0], pin);
    text.bar_between(chance, "rod", pin, hook);
    let pose = [centre[0], centre[1], slope];
    text.plate(
        chance,
        "wheel",
        pose,
        &[point("c", centre), point("b", hook)],
    );
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "rod.a"]);
    text.pin("B", ["rod.b", "wheel.b"]);
    let written = text.length(chance, radius);
    let side = if side > 0.0 { "above" } else { "below" };
    let more = format!(", radius = {written}, side = '{side}'");
    text.joint("track", "rolling", ["wheel.c", "ground.T"], &more);
    let to = crank + chance.between(-6.0, 6.0);
    text.turn("u", ["ground.O", "crank.a"], crank, to);
    text.case()
}

/// A four-bar with a wheel on its coupler that drives another on the crank's or the rocker's pivot,
/// whose pin a rod joins to a slider; driven at the crank or, as one block, at the slider.
pub fn wheel_on_coupler(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let (d, crank) = (chance.between(0.1, 0.6), angle(chance));
    let pin = end([0.0, 0.0], chance.between(0.1, 0.6), crank);
    let top = somewhere(chance, [-0.6, 0.6], [-0.6, 0.6]);
    let (coupler, rocker) = (direction(pin, top), direction([d, 0.0], top));
    let [a, b, c] = [([0.0; 2], pin), (pin, top), ([d, 0.0], top)].map(|(a, b)| distance(a, b));
    let hook = end([0.0, 0.0], chance.between(0.05, 0.2), angle(chance));
    let slider = end(hook, chance.between(0.1, 0.5), angle(chance));
    let guide = angle(chance);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", [d, 0.0], 0.0);
    text.ground("G", slider, guide);
    let [a, b, c] = [a, b, c].map(|length| text.length(chance, length));
    text.bar("crank", &a, [0.0, 0.0], crank);
    // The wheels are in phase where their markers have the crank's direction.
    let phase = crank - coupler;
    let markers = format!("a = [0, 0], b = [{b}, 0], w = [0, 0, {phase:?}]");
    text.body("coupler", &markers, [pin[0], pin[1], coupler]);
    text.bar("rocker", &c, [d, 0.0], rocker);
    let marks = [
        point("a", [0.0; 2]),
        point("b", hook),
        frame("w", [0.0; 2], crank),
    ];
    text.plate(
        chance,
        "wheel",
        [0.0, 0.0, direction([0.0; 2], hook)],
        &marks,
    );
    text.bar_between(chance, "rod", hook, slider);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("W", ["ground.O", "wheel.a"]);
    text.pin("A", ["crank.b", "coupler.a"]);
    text.pin("B", ["coupler.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    text.pin("H", ["wheel.b", "rod.a"]);
    text.joint("G", "slot", ["ground.G", "rod.b"], "");
    let teeth = [15 + chance.below(40), 15 + chance.below(40)];
    let more = format!(", teeth = {teeth:?}, carrier = '{}'", text.name("crank"));
    let kind = ["gear", "belt"][chance.below(2)];
    text.joint("mesh", kind, ["coupler.w", "wheel.w"], &more);
    if chance.between(0.0, 1.0) < 0.6 {
        let to = crank + chance.between(-5.0, 5.0);
        text.turn("u", ["ground.O", "crank.a"], crank, to);
    } else {
        let to = chance.between(-0.4, 0.4);
        text.push("u", "x", ["ground.G", "rod.b"], [0.0, to]);
    }
    text.case()
}
