//! The text of a generated mechanism, part by part.

use std::f64::consts::PI;
use std::fmt::Write as _;

use super::Case;
use crate::mutation::Chance;

/// The numbers of a mechanism that are not as simple as they could be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// None: all lengths stay, all bodies are estimated where they are.
    Fixed,
    /// Some lengths, and angles of contours, are parameters that jump.
    Moving,
    /// Some lengths, and angles of contours, are functions of parameters that jump over their corners.
    Cornered,
    /// Estimates are up to 0.2 lengths and 0.7 rad off.
    Rough,
    /// All estimates are at the origin.
    LeftOut,
}

/// The law by which the drivers move to their ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// At once, straight.
    Jump,
    /// From rest, evenly accelerated, within a second.
    FromRest,
    /// The same as motions that the file prescribes.
    Prescribed,
}

/// One of the ways to write down the same mechanism and its jump.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Factor on all lengths.
    pub scale: f64,
    /// The first letters of all names.
    pub prefix: &'a str,
    /// Rigid motion of the whole mechanism, ground included: x and y of the origin, in parts of
    /// the scale, and the angle \[rad\].
    pub place: [f64; 3],
    /// Whether bodies and joints come in reverse order, and the markers of pins too.
    pub reversed: bool,
    /// The law of its motion. Parameters run straight with any.
    pub law: Law,
}

impl Default for View<'_> {
    fn default() -> Self {
        Self {
            scale: 1.0,
            prefix: "",
            place: [0.0; 3],
            reversed: false,
            law: Law::Jump,
        }
    }
}

impl View<'_> {
    /// Returns the coordinates of all bodies as they are in the view that changes nothing.
    pub fn undo(&self, q: &[f64]) -> Vec<f64> {
        let [right, up, turn] = self.place;
        let (sin, cos) = turn.sin_cos();
        let body = |q: &[f64]| {
            let (x, y) = (q[0] / self.scale - right, q[1] / self.scale - up);
            [cos * x + sin * y, cos * y - sin * x, q[2] - turn]
        };
        let bodies = q.chunks_exact(3).map(body);
        if self.reversed {
            bodies.rev().flatten().collect()
        } else {
            bodies.flatten().collect()
        }
    }
}

/// A point of the plane.
pub type Point = [f64; 2];

/// A marker of a body, where it is in the plane.
#[derive(Clone, Copy, Debug)]
pub struct Mark<'a>(&'a str, Point, Option<f64>);

/// A marker whose x-axis does not matter.
pub fn point(name: &str, place: Point) -> Mark<'_> {
    Mark(name, place, None)
}

/// A marker with the angle of its x-axis.
pub fn frame(name: &str, place: Point, angle: f64) -> Mark<'_> {
    Mark(name, place, Some(angle))
}

/// Functions of P with a corner or a join at C, zero where P is.
const CORNERS: [&str; 10] = [
    "abs(P - C) - C",
    "max(P, C) - C",
    "min(P, C)",
    "max(0, P - C)^3",
    "max(0, P - C)^1.5",
    "hypot(P - C, 0) - C",
    "sqrt((P - C)^2) - C",
    "sign(P - C)*(P - C) - C",
    "abs(mod(P + C, 1) - 0.5) - abs(C - 0.5)",
    "abs(sin(3*P - 3*C)) - abs(sin(3*C))",
];

/// The text of a mechanism. All places and angles are those in the plane in which the mechanism
/// begins.
pub struct Text<'a> {
    view: View<'a>,
    variant: Variant,
    head: String,
    ground: String,
    bodies: Vec<String>,
    joints: Vec<String>,
    drivers: String,
    measures: String,
    to: Vec<f64>,
    parameters: Vec<(String, f64)>,
}

impl<'a> Text<'a> {
    /// Begins a mechanism.
    pub fn new(view: View<'a>, variant: Variant) -> Self {
        Self {
            view,
            variant,
            head: String::new(),
            ground: String::new(),
            bodies: Vec::new(),
            joints: Vec::new(),
            drivers: String::new(),
            measures: String::new(),
            to: Vec::new(),
            parameters: Vec::new(),
        }
    }

    /// Returns a length as it is written in the file: a number, or the name of a parameter that
    /// jumps.
    pub fn length(&mut self, chance: &mut Chance, value: f64) -> String {
        let length = value * self.view.scale;
        let by = length * chance.between(-0.3, 0.4);
        self.moving(chance, length, by)
    }

    /// Returns an angle of a contour \[rad\] likewise.
    pub fn turning(&mut self, chance: &mut Chance, value: f64) -> String {
        let by = chance.between(-1.0, 1.0);
        self.moving(chance, value, by)
    }

    /// Returns a number as it is written in the file: as it is, the name of a parameter that changes
    /// it by `by`, or a function with a corner of such a parameter.
    fn moving(&mut self, chance: &mut Chance, value: f64, by: f64) -> String {
        let is_moving = matches!(self.variant, Variant::Moving | Variant::Cornered);
        if !is_moving || chance.between(0.0, 1.0) > 0.3 {
            return format!("{value:?}");
        }
        let name = format!("{}p{}", self.view.prefix, self.parameters.len());
        let is_cornered = self.variant == Variant::Cornered;
        let [start, end] = if is_cornered {
            [0.0, 1.0]
        } else {
            [value, value + by]
        };
        let _ = writeln!(
            self.head,
            "{name} = {{ value = {start:?}, tunable = true }}"
        );
        self.parameters.push((name.clone(), end));
        if !is_cornered {
            return format!("'{name}'");
        }
        let corner = chance.between(0.0, 1.0);
        let shape = CORNERS[chance.below(CORNERS.len())];
        let shape = shape.replace('C', &format!("{corner:?}"));
        let shape = shape.replace('P', &name);
        let derived = format!("{}d{}", self.view.prefix, self.parameters.len());
        let _ = writeln!(self.head, "{derived} = '{shape}'");
        format!("'({value:?} + ({by:?})*{derived})'")
    }

    /// Returns a length as a number.
    pub fn number(&self, value: f64) -> String {
        format!("{:?}", value * self.view.scale)
    }

    /// Adds a marker on ground.
    pub fn ground(&mut self, name: &str, [x, y]: Point, angle: f64) {
        let ([x, y], angle) = self.placed([x, y], angle);
        let prefix = self.view.prefix;
        let _ = writeln!(self.ground, "{prefix}{name} = [{x:?}, {y:?}, {angle:?}]");
    }

    /// Returns the angle that is zero in the file.
    pub fn level(&self) -> f64 {
        -self.view.place[2]
    }

    fn placed(&self, [x, y]: Point, angle: f64) -> (Point, f64) {
        let [right, up, turn] = self.view.place;
        let (sin, cos) = turn.sin_cos();
        let scale = self.view.scale;
        let x_there = (right + cos * x - sin * y) * scale;
        let y_there = (up + sin * x + cos * y) * scale;
        ([x_there, y_there], angle + turn)
    }

    /// Adds a bar with its estimate: markers `a` at its origin and `b` at its end.
    pub fn bar(&mut self, name: &str, length: &str, from: Point, angle: f64) {
        let markers = format!("a = [0, 0], b = [{length}, 0]");
        self.body(name, &markers, [from[0], from[1], angle]);
    }

    /// Adds a bar between two points.
    pub fn bar_between(&mut self, chance: &mut Chance, name: &str, a: Point, b: Point) {
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        let length = self.length(chance, x.hypot(y));
        self.bar(name, &length, a, y.atan2(x));
    }

    /// Adds a body with markers in the plane.
    pub fn plate(&mut self, chance: &mut Chance, name: &str, pose: [f64; 3], marks: &[Mark<'_>]) {
        let (sin, cos) = pose[2].sin_cos();
        let mut markers = String::new();
        for Mark(marker, place, angle) in marks {
            let (x, y) = (place[0] - pose[0], place[1] - pose[1]);
            let x_own = self.length(chance, cos * x + sin * y);
            let y_own = self.length(chance, cos * y - sin * x);
            let angle = angle.map_or(0.0, |angle| angle - pose[2]);
            let _ = write!(markers, "{marker} = [{x_own}, {y_own}, {angle:?}], ");
        }
        self.body(name, markers.trim_end_matches(", "), pose);
    }

    /// Adds a body with markers as they are written in the file.
    pub fn body(&mut self, name: &str, markers: &str, pose: [f64; 3]) {
        let [x, y, phi] = match self.variant {
            Variant::Fixed | Variant::Moving | Variant::Cornered => pose,
            Variant::Rough => near(name, pose),
            Variant::LeftOut => [0.0; 3],
        };
        let ([x, y], phi) = self.placed([x, y], phi);
        let prefix = self.view.prefix;
        self.bodies.push(format!(
            "[bodies.{prefix}{name}]\nmarkers = {{ {markers} }}\n\
             estimate = [{x:?}, {y:?}, {phi:?}]\n"
        ));
    }

    /// Adds a joint; the bodies of its markers get the prefix, markers on ground too.
    pub fn joint(&mut self, name: &str, kind: &str, [i, j]: [&str; 2], more: &str) {
        let (i, j) = (self.marker(i), self.marker(j));
        let prefix = self.view.prefix;
        self.joints.push(format!(
            "{prefix}{name} = {{ type = '{kind}', markers = ['{i}', '{j}']{more} }}\n"
        ));
    }

    /// Adds a coupling by an equation, in which names have their prefix, and a law that it calls.
    pub fn couple(&mut self, name: &str, equation: &str, law: &str) {
        let prefix = self.view.prefix;
        self.joints.push(format!(
            "{prefix}{name} = {{ type = 'coupling', equation = '{equation}'{law} }}\n"
        ));
    }

    /// Adds a measure.
    pub fn measure(&mut self, name: &str, coordinate: &str, [i, j]: [&str; 2]) {
        let (i, j) = (self.marker(i), self.marker(j));
        let prefix = self.view.prefix;
        let _ = writeln!(
            self.measures,
            "{prefix}{name} = {{ coordinate = '{coordinate}', markers = ['{i}', '{j}'] }}"
        );
    }

    /// Adds a rope over markers and over pulleys of some radius on the left (1) or right (-1) of the
    /// rope.
    pub fn rope(&mut self, name: &str, way: &[(&str, Option<(String, f64)>)], length: &str) {
        let sign = if self.view.reversed { -1.0 } else { 1.0 };
        let mut way: Vec<String> = (way.iter())
            .map(|(marker, pulley)| match (self.marker(marker), pulley) {
                (marker, None) => format!("'{marker}'"),
                (marker, Some((radius, side))) => {
                    let side = if sign * side > 0.0 { "left" } else { "right" };
                    format!("{{ marker = '{marker}', radius = {radius}, side = '{side}' }}")
                }
            })
            .collect();
        if self.view.reversed {
            way.reverse();
        }
        let (prefix, way) = (self.view.prefix, way.join(", "));
        self.joints.push(format!(
            "{prefix}{name} = {{ type = 'rope', markers = [{way}], length = {length} }}\n"
        ));
    }

    /// Adds a revolute.
    pub fn pin(&mut self, name: &str, [i, j]: [&str; 2]) {
        let markers = if self.view.reversed { [j, i] } else { [i, j] };
        self.joint(name, "revolute", markers, "");
    }

    /// Adds a translational joint.
    pub fn slide(&mut self, name: &str, markers: [&str; 2]) {
        self.joint(name, "translational", markers, "");
    }

    /// Adds a driver of an angle and its jump \[rad\].
    pub fn turn(&mut self, name: &str, markers: [&str; 2], from: f64, to: f64) {
        self.driver(name, "angle", markers, [from, to]);
    }

    /// Adds a driver of a length, `x`, `y` or `distance`, and its jump.
    pub fn push(&mut self, name: &str, kind: &str, markers: [&str; 2], jump: [f64; 2]) {
        let jump = jump.map(|length| length * self.view.scale);
        self.driver(name, kind, markers, jump);
    }

    fn driver(&mut self, name: &str, coordinate: &str, [i, j]: [&str; 2], [from, to]: [f64; 2]) {
        let (i, j) = (self.marker(i), self.marker(j));
        let prefix = self.view.prefix;
        let source = match self.view.law {
            Law::Jump | Law::FromRest => format!("start = {from:?}"),
            Law::Prescribed => format!("motion = '{from:?} + ({:?})*t^2'", to - from),
        };
        let _ = writeln!(
            self.drivers,
            "{prefix}{name} = {{ coordinate = '{coordinate}', markers = ['{i}', '{j}'], {source} }}"
        );
        self.to.push(to);
    }

    /// Returns the name of a body in the file.
    pub fn name(&self, body: &str) -> String {
        format!("{}{body}", self.view.prefix)
    }

    fn marker(&self, marker: &str) -> String {
        let prefix = self.view.prefix;
        match marker.strip_prefix("ground.") {
            Some(own) => format!("ground.{prefix}{own}"),
            None => format!("{prefix}{marker}"),
        }
    }

    /// Ends the mechanism.
    pub fn case(mut self) -> Case {
        if self.view.reversed {
            self.bodies.reverse();
            self.joints.reverse();
        }
        let head = match self.head.as_str() {
            "" => String::new(),
            parameters => format!("[parameters]\n{parameters}"),
        };
        let (ground, drivers, measures) = (self.ground, self.drivers, self.measures);
        let (bodies, joints) = (self.bodies.concat(), self.joints.concat());
        Case {
            text: format!(
                "format = 1\nname = 'attack'\n{head}[ground.markers]\n{ground}{bodies}\
                 [joints]\n{joints}[drivers]\n{drivers}[measures]\n{measures}"
            ),
            drivers: self.to,
            parameters: self.parameters,
        }
    }
}

/// Returns the angles of two bars from `from` and `to` that meet, bent to this side; straight
/// where they do not reach.
pub fn dyad(from: Point, to: Point, [first, second]: [f64; 2], side: f64) -> [f64; 2] {
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

/// Returns the point at a distance from another, in the direction of an angle.
pub fn end([x, y]: Point, length: f64, angle: f64) -> Point {
    [x + length * angle.cos(), y + length * angle.sin()]
}

/// Returns a point of a rectangle.
pub fn somewhere(chance: &mut Chance, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Point {
    [chance.between(left, right), chance.between(low, high)]
}

/// Returns the distance of two points.
pub fn distance(a: Point, b: Point) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Returns the direction from a point to another \[rad\].
pub fn direction(a: Point, b: Point) -> f64 {
    (b[1] - a[1]).atan2(b[0] - a[0])
}

/// Returns an angle anywhere.
pub fn angle(chance: &mut Chance) -> f64 {
    chance.between(-PI, PI)
}

/// Returns 1 or -1.
pub fn sign(chance: &mut Chance) -> f64 {
    chance.between(-1.0, 1.0).signum()
}

/// Returns a pose near that of a body. The body's name decides which, so that it is the same in all
/// views.
fn near(name: &str, [x, y, phi]: [f64; 3]) -> [f64; 3] {
    let seed = name.bytes().fold(1, |seed: u64, byte| {
        (seed ^ u64::from(byte)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    let mut chance = Chance::new(seed);
    let mut off = |most: f64| chance.between(-most, most);
    [x + off(0.2), y + off(0.2), phi + off(0.7)]
}
