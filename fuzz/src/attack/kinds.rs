//! The kinds of generated mechanisms.

use std::f64::consts::PI;
use std::fmt::Write as _;

use super::Case;
use crate::mutation::Chance;

/// Draws a case at a scale, its names beginning with a prefix.
pub type Draw = fn(&mut Chance, f64, &str) -> Case;

/// The kinds with their names.
pub const KINDS: [(&str, Draw); 8] = [
    ("four_bar", four_bar),
    ("four_bar_of_moving_lengths", four_bar_of_moving_lengths),
    ("slider_crank", slider_crank),
    ("six_bar", six_bar),
    ("geared_five_bar", geared_five_bar),
    ("cam", cam),
    ("platform", platform),
    ("three_cranks", three_cranks),
];

/// The text of a mechanism, part by part.
struct Text<'a> {
    scale: f64,
    prefix: &'a str,
    head: String,
    ground: String,
    bodies: String,
    joints: String,
    drivers: String,
}

impl<'a> Text<'a> {
    fn new(scale: f64, prefix: &'a str) -> Self {
        let empty = String::new;
        Self {
            scale,
            prefix,
            head: empty(),
            ground: empty(),
            bodies: empty(),
            joints: empty(),
            drivers: empty(),
        }
    }

    /// Adds a marker on ground.
    fn ground(&mut self, name: &str, [x, y]: [f64; 2], angle: f64) {
        let (scale, prefix) = (self.scale, self.prefix);
        let (x, y) = (x * scale, y * scale);
        let _ = writeln!(self.ground, "{prefix}{name} = [{x:?}, {y:?}, {angle:?}]");
    }

    /// Adds a bar with its estimate: markers `a` at its origin and `b` at its end.
    fn bar(&mut self, name: &str, length: f64, estimate: [f64; 3]) {
        let length = length * self.scale;
        self.body(name, &format!("a = [0, 0], b = [{length:?}, 0]"), estimate);
    }

    fn body(&mut self, name: &str, markers: &str, [x, y, phi]: [f64; 3]) {
        let (scale, prefix) = (self.scale, self.prefix);
        let (x, y) = (x * scale, y * scale);
        let _ = writeln!(
            self.bodies,
            "[bodies.{prefix}{name}]\nmarkers = {{ {markers} }}\nestimate = [{x:?}, {y:?}, {phi:?}]"
        );
    }

    /// Adds a joint; the bodies of its markers get the prefix, markers on ground too.
    fn joint(&mut self, name: &str, kind: &str, [i, j]: [&str; 2], more: &str) {
        let (i, j) = (self.marker(i), self.marker(j));
        let prefix = self.prefix;
        let _ = writeln!(
            self.joints,
            "{prefix}{name} = {{ type = '{kind}', markers = ['{i}', '{j}']{more} }}"
        );
    }

    fn pin(&mut self, name: &str, markers: [&str; 2]) {
        self.joint(name, "revolute", markers, "");
    }

    fn driver(&mut self, name: &str, coordinate: &str, [i, j]: [&str; 2], start: f64) {
        let (i, j) = (self.marker(i), self.marker(j));
        let prefix = self.prefix;
        let _ = writeln!(
            self.drivers,
            "{prefix}{name} = {{ coordinate = '{coordinate}', markers = ['{i}', '{j}'], \
             start = {start:?} }}"
        );
    }

    fn marker(&self, marker: &str) -> String {
        let prefix = self.prefix;
        match marker.strip_prefix("ground.") {
            Some(own) => format!("ground.{prefix}{own}"),
            None => format!("{prefix}{marker}"),
        }
    }

    fn case(self, drivers: Vec<f64>) -> Case {
        let Self {
            head,
            ground,
            bodies,
            joints,
            drivers: driven,
            ..
        } = self;
        Case {
            text: format!(
                "format = 1\nname = 'attack'\n{head}[ground.markers]\n{ground}{bodies}\
                 [joints]\n{joints}[drivers]\n{driven}"
            ),
            drivers,
            parameters: Vec::new(),
        }
    }
}

/// Returns the angles of two bars from `from` and `to` that meet, bent to this side; straight
/// where they do not reach.
fn dyad(from: [f64; 2], to: [f64; 2], [first, second]: [f64; 2], side: f64) -> [f64; 2] {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let (far, along) = (x.hypot(y), y.atan2(x));
    let cosine = |near: f64, opposite: f64| {
        let cosine = (far * far + near * near - opposite * opposite) / (2.0 * far * near);
        cosine.clamp(-1.0, 1.0).acos()
    };
    [
        along + side * cosine(first, second),
        along + PI - side * cosine(second, first),
    ]
}

fn end([x, y]: [f64; 2], length: f64, angle: f64) -> [f64; 2] {
    [x + length * angle.cos(), y + length * angle.sin()]
}

/// Numbers of a four-bar: crank, coupler, rocker, base, the crank's angle, and the bend.
fn draw_four_bar(chance: &mut Chance) -> ([f64; 4], f64, f64) {
    let lengths = [0; 4].map(|_| chance.between(0.1, 0.6));
    let crank = chance.between(-PI, PI);
    (lengths, crank, chance.between(-1.0, 1.0).signum())
}

/// Adds a four-bar. Returns the rocker's angle.
fn add_four_bar(text: &mut Text<'_>, [a, b, c, d]: [f64; 4], crank: f64, side: f64) -> f64 {
    let pin = end([0.0, 0.0], a, crank);
    let [coupler, rocker] = dyad(pin, [d, 0.0], [b, c], side);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", [d, 0.0], 0.0);
    text.bar("crank", a, [0.0, 0.0, crank]);
    text.bar("coupler", b, [pin[0], pin[1], coupler]);
    text.bar("rocker", c, [d, 0.0, rocker]);
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "coupler.a"]);
    text.pin("B", ["coupler.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    text.driver("u", "angle", ["ground.O", "crank.a"], crank);
    rocker
}

fn four_bar(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (lengths, crank, side) = draw_four_bar(chance);
    let mut text = Text::new(scale, prefix);
    add_four_bar(&mut text, lengths, crank, side);
    text.case(vec![crank + chance.between(-7.0, 7.0)])
}

/// A four-bar whose coupler and rocker change their lengths while the crank turns.
fn four_bar_of_moving_lengths(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (lengths, crank, side) = draw_four_bar(chance);
    let mut text = Text::new(scale, prefix);
    add_four_bar(&mut text, lengths, crank, side);
    let mut parameters = Vec::new();
    text.head = "[parameters]\n".to_owned();
    for (name, body, length) in [("b", "coupler", lengths[1]), ("c", "rocker", lengths[2])] {
        let name = format!("{prefix}{name}");
        let length = length * scale;
        let _ = writeln!(
            text.head,
            "{name} = {{ value = {length:?}, tunable = true }}"
        );
        let bar = format!("[bodies.{prefix}{body}]\nmarkers = {{ a = [0, 0], b = [");
        text.bodies = text.bodies.replace(
            &format!("{bar}{length:?}, 0]"),
            &format!("{bar}'{name}', 0]"),
        );
        parameters.push((name, length * chance.between(0.6, 1.6)));
    }
    let case = text.case(vec![crank + chance.between(-2.0, 2.0)]);
    Case { parameters, ..case }
}

fn slider_crank(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (a, b) = (chance.between(0.1, 0.4), chance.between(0.1, 0.8));
    let (offset, crank) = (chance.between(-0.2, 0.2), chance.between(-PI, PI));
    let pin = end([0.0, 0.0], a, crank);
    let rod = ((offset - pin[1]) / b).clamp(-1.0, 1.0).asin();
    let mut text = Text::new(scale, prefix);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("S", [0.0, offset], 0.0);
    text.bar("crank", a, [0.0, 0.0, crank]);
    text.bar("rod", b, [pin[0], pin[1], rod]);
    text.body(
        "slider",
        "a = [0, 0]",
        [pin[0] + b * rod.cos(), offset, 0.0],
    );
    text.pin("O", ["ground.O", "crank.a"]);
    text.pin("A", ["crank.b", "rod.a"]);
    text.pin("B", ["rod.b", "slider.a"]);
    text.joint("S", "translational", ["ground.S", "slider.a"], "");
    text.driver("u", "angle", ["ground.O", "crank.a"], crank);
    text.case(vec![crank + chance.between(-7.0, 7.0)])
}

/// Two four-bars, the second on the rocker of the first.
fn six_bar(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (lengths, crank, side) = draw_four_bar(chance);
    let mut text = Text::new(scale, prefix);
    let rocker = add_four_bar(&mut text, lengths, crank, side);
    let pin = end([lengths[3], 0.0], lengths[2], rocker);
    let bars = [chance.between(0.1, 0.6), chance.between(0.1, 0.6)];
    let pivot = [chance.between(-0.4, 0.8), chance.between(-0.4, 0.4)];
    let angles = dyad(pin, pivot, bars, chance.between(-1.0, 1.0).signum());
    text.ground("F", pivot, 0.0);
    text.bar("rod", bars[0], [pin[0], pin[1], angles[0]]);
    text.bar("output", bars[1], [pivot[0], pivot[1], angles[1]]);
    text.pin("C", ["rocker.b", "rod.a"]);
    text.pin("E", ["rod.b", "output.b"]);
    text.pin("F", ["ground.F", "output.a"]);
    text.case(vec![crank + chance.between(-4.0, 4.0)])
}

/// A dyad between two cranks with gears.
fn geared_five_bar(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let base = chance.between(0.3, 0.6);
    let wheel = base * chance.between(0.2, 0.8);
    let cranks = [chance.between(0.05, 0.3), chance.between(0.05, 0.3)];
    let bars = [chance.between(0.2, 0.6), chance.between(0.2, 0.6)];
    let starts = [chance.between(-PI, PI), chance.between(-PI, PI)];
    let pins = [
        end([0.0, 0.0], cranks[0], starts[0]),
        end([base, 0.0], cranks[1], starts[1]),
    ];
    let angles = dyad(pins[0], pins[1], bars, chance.between(-1.0, 1.0).signum());
    let mut text = Text::new(scale, prefix);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", [base, 0.0], 0.0);
    text.bar("first", cranks[0], [0.0, 0.0, starts[0]]);
    text.bar("second", cranks[1], [base, 0.0, starts[1]]);
    text.bar("left", bars[0], [pins[0][0], pins[0][1], angles[0]]);
    text.bar("right", bars[1], [pins[1][0], pins[1][1], angles[1]]);
    text.pin("O", ["ground.O", "first.a"]);
    text.pin("D", ["ground.D", "second.a"]);
    text.pin("A", ["first.b", "left.a"]);
    text.pin("B", ["second.b", "right.a"]);
    text.pin("C", ["left.b", "right.b"]);
    let radii = format!(
        ", radii = [{:?}, {:?}]",
        wheel * scale,
        (base - wheel) * scale
    );
    text.joint("wheels", "gear", ["first.a", "second.a"], &radii);
    text.driver("u", "angle", ["ground.O", "first.a"], starts[0]);
    text.case(vec![starts[0] + chance.between(-6.0, 6.0)])
}

/// A knife edge or a roller on a cam of some waves and a lobe, which may be narrow.
fn cam(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (base, lift) = (chance.between(0.1, 0.2), chance.between(0.0, 0.05));
    let (waves, lobe) = (
        chance.between(1.0, 4.0).floor(),
        chance.between(-0.02, 0.05),
    );
    let (width, place) = (chance.between(0.02, 0.5), chance.between(-PI, PI));
    let cam = chance.between(-PI, PI);
    let knife = chance.between(0.0, 1.0) < 0.5;
    let roller = 0.01;
    let mut text = Text::new(scale, prefix);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("G", [0.0, 0.0], 0.5 * PI);
    text.body("cam", "a = [0, 0]", [0.0, 0.0, cam]);
    let radius = |theta: f64| {
        let bump = ((theta - place).cos() - 1.0) / (width * width);
        base + lift * (waves * theta).cos() + lobe * bump.exp()
    };
    let height = radius(0.5 * PI - cam) + if knife { 0.0 } else { roller };
    text.body(
        "follower",
        "a = [0, 0, 1.5707963267948966]",
        [0.0, height, 0.0],
    );
    text.pin("O", ["ground.O", "cam.a"]);
    text.joint("G", "translational", ["ground.G", "follower.a"], "");
    let square = width * width;
    let follower = if knife {
        "'knife'".to_owned()
    } else {
        format!("'roller', radius = {:?}", roller * scale)
    };
    let more = format!(
        ", follower = {follower}, profile = '{:?} + {:?}*cos({waves}*theta) \
         + {:?}*exp((cos(theta - ({place:?})) - 1)/{square:?})'",
        base * scale,
        lift * scale,
        lobe * scale
    );
    text.joint(
        "contact",
        "cam",
        ["cam.a", "follower.a"],
        &more.replace("+ -", "- "),
    );
    text.driver("u", "angle", ["ground.O", "cam.a"], cam);
    text.case(vec![cam + chance.between(-4.0, 4.0)])
}

/// A platform on three legs whose lengths change: one coupled block.
fn platform(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let mut text = Text::new(scale, prefix);
    let (x, y) = (chance.between(-0.1, 0.1), chance.between(-0.1, 0.1));
    let phi = chance.between(-PI, PI);
    let mut markers = String::new();
    let mut drivers = Vec::new();
    let mut legs = Vec::new();
    for k in 0..3 {
        let round = f64::from(k) * 2.0 * PI / 3.0 + chance.between(-0.3, 0.3);
        let foot = end([0.0, 0.0], chance.between(0.3, 0.5), round);
        let own = [0; 2].map(|_| chance.between(-0.15, 0.15));
        let top = end(end([x, y], own[0], phi), own[1], phi + 0.5 * PI);
        let (across, up) = (top[0] - foot[0], top[1] - foot[1]);
        let _ = write!(
            markers,
            "b{k} = [{:?}, {:?}], ",
            own[0] * scale,
            own[1] * scale
        );
        legs.push((k, foot, across.hypot(up)));
        drivers.push(across.hypot(up) * chance.between(0.6, 1.5) * scale);
    }
    text.body("platform", markers.trim_end_matches(", "), [x, y, phi]);
    for (k, foot, length) in legs {
        text.ground(&format!("f{k}"), foot, 0.0);
        let markers = [format!("ground.f{k}"), format!("platform.b{k}")];
        let markers = [markers[0].as_str(), markers[1].as_str()];
        text.driver(&format!("u{k}"), "distance", markers, length * scale);
    }
    text.case(drivers)
}

/// A parallelogram with a third crank, which is redundant, anywhere on the coupler, and cranks
/// that may be inclined.
fn three_cranks(chance: &mut Chance, scale: f64, prefix: &str) -> Case {
    let (crank, base) = (chance.between(0.1, 0.3), chance.between(0.2, 0.6));
    let (start, tilt) = (chance.between(-PI, PI), chance.between(-0.5, 0.5));
    let third = [chance.between(0.1, 0.5), chance.between(-0.2, 0.2)];
    let mut text = Text::new(scale, prefix);
    let pin = end([0.0, 0.0], crank, start);
    let far = end([0.0, 0.0], base, tilt);
    let middle = end(end([0.0, 0.0], third[0], tilt), third[1], tilt + 0.5 * PI);
    text.ground("O", [0.0, 0.0], 0.0);
    text.ground("D", far, 0.0);
    text.ground("E", middle, 0.0);
    text.bar("first", crank, [0.0, 0.0, start]);
    text.bar("second", crank, [far[0], far[1], start]);
    text.bar("third", crank, [middle[0], middle[1], start]);
    let markers = format!(
        "a = [0, 0], b = [{:?}, 0], c = [{:?}, {:?}]",
        base * scale,
        third[0] * scale,
        third[1] * scale
    );
    text.body("coupler", &markers, [pin[0], pin[1], tilt]);
    text.pin("O", ["ground.O", "first.a"]);
    text.pin("D", ["ground.D", "second.a"]);
    text.pin("E", ["ground.E", "third.a"]);
    text.pin("A", ["first.b", "coupler.a"]);
    text.pin("B", ["coupler.b", "second.b"]);
    text.pin("C", ["coupler.c", "third.b"]);
    text.driver("u", "angle", ["ground.O", "first.a"], start);
    text.case(vec![start + chance.between(-4.0, 4.0)])
}
