//! The mechanism file of a draft.

use std::fmt::Write as _;

use super::draft::{
    BodyRef, Coordinate, Draft, Driver, DriverSource, ForceKind, GROUND, JointKind, LengthUnit,
    PointRef, Stop, Wheels,
};
use super::source_names::Names;
use crate::write::{degrees, in_unit};
use biela::mechanism::{is_identifier, shortest, similar_identifier};

/// Longest line of comments, and of markers in one line.
const LINE: usize = 100;

/// Names that the file gives.
struct Given {
    bodies: Vec<String>,
    markers: Vec<Vec<String>>,
    joints: Vec<String>,
    held: Vec<String>,
    drivers: Vec<String>,
    freedoms: Vec<String>,
    forces: Vec<String>,
    stops: Vec<String>,
}

impl Draft {
    /// Returns the mechanism file; `source` is the name of the file that was read.
    #[must_use]
    pub fn write(&self, source: &str) -> String {
        let writer = Writer {
            draft: self,
            given: self.names(),
            decimals: self.decimals(),
        };
        writer.file(source)
    }

    /// Returns the name of the mechanism: that of the source if it is one, otherwise a similar one.
    #[must_use]
    pub fn mechanism_name(&self) -> String {
        let legal = Names::shared().give(&self.name, "mechanism");
        if is_identifier(&legal) {
            return legal;
        }
        similar_identifier(&legal).unwrap_or_else(|| "mechanism".to_owned())
    }

    fn names(&self) -> Given {
        let mut names = Names::shared();
        for parameter in &self.parameters {
            names.give(parameter.name, "parameter");
        }
        let mut all = |sources: Vec<&String>, word| -> Vec<String> {
            let given = sources.into_iter().map(|source| names.give(source, word));
            given.collect()
        };
        let bodies = all(self.bodies.iter().map(|b| &b.name).collect(), "body");
        let joints = all(self.joints.iter().map(|j| &j.name).collect(), "joint");
        let held = all(self.held.iter().map(|h| &h.name).collect(), "angle");
        let drivers = all(self.drivers.iter().map(|d| &d.name).collect(), "driver");
        let freedoms = all(self.freedoms.iter().map(|f| &f.name).collect(), "freedom");
        let forces = all(self.forces.iter().map(|f| &f.name).collect(), "force");
        let stops = all(self.stops.iter().map(|s| &s.name).collect(), "stop");
        let markers = self.bodies.iter().map(|body| {
            let mut names = Names::of_markers();
            let points = body.points.iter();
            points.map(|point| names.give(&point.name, "P")).collect()
        });
        Given {
            bodies,
            markers: markers.collect(),
            joints,
            held,
            drivers,
            freedoms,
            forces,
            stops,
        }
    }

    /// Returns the number of decimals of lengths.
    fn decimals(&self) -> usize {
        let size = self.size().max(1e-12);
        let whole = size.log10().ceil() as i32;
        usize::try_from(self.digits - whole).unwrap_or(0).min(15)
    }
}

struct Writer<'a> {
    draft: &'a Draft,
    given: Given,
    decimals: usize,
}

impl Writer<'_> {
    fn file(&self, source: &str) -> String {
        let draft = self.draft;
        let mut text = String::new();
        let from = format!("From {} ({}).", plain(source), draft.format);
        comment(&mut text, "", &from);
        if !draft.notes.is_empty() {
            text.push_str("#\n");
        }
        for note in &draft.notes {
            comment(&mut text, "- ", &note.to_string());
        }
        let _ = writeln!(text, "format = 1\nname = \"{}\"", draft.mechanism_name());
        self.parameters(&mut text);
        self.bodies(&mut text);
        self.joints(&mut text);
        self.coordinates(&mut text);
        self.rest(&mut text);
        text
    }

    fn parameters(&self, text: &mut String) {
        if self.draft.parameters.is_empty() {
            return;
        }
        text.push_str("\n[parameters]\n");
        for parameter in &self.draft.parameters {
            let _ = writeln!(
                text,
                "{} = {{ value = \"{}\", unit = \"{}\", display = \"{}\", description = \"{}\" }}",
                parameter.name,
                parameter.value,
                parameter.unit,
                parameter.display,
                parameter.description
            );
        }
    }

    fn bodies(&self, text: &mut String) {
        for (index, body) in self.draft.bodies.iter().enumerate() {
            if body.points.is_empty() {
                continue;
            }
            let body_ref = BodyRef(index);
            let frame = self.draft.frame(body_ref);
            let markers = self.markers(body_ref, frame);
            if body_ref == GROUND {
                text.push_str("\n[ground.markers]\n");
                let _ = writeln!(text, "{}", markers.join("\n"));
                continue;
            }
            let name = &self.given.bodies[index];
            let _ = writeln!(text, "\n[bodies.{name}]{}", origin(name, &body.name));
            if let Some(mass) = &body.mass {
                let _ = writeln!(text, "mass = {}", shortest(mass.mass, 15));
                let _ = writeln!(text, "inertia = {}", shortest(mass.inertia, 15));
                let [x, y] = self.local(frame, mass.center);
                let _ = writeln!(text, "center = [{x}, {y}]");
            }
            let [x, y] = [frame[0], frame[1]].map(|x| self.length(x));
            let estimate = format!("estimate = [{x}, {y}, {}]", self.angle(frame[2]));
            let line = format!("markers = {{ {} }}", markers.join(", "));
            if line.len() <= LINE && !line.contains('#') {
                let _ = writeln!(text, "{line}\n{estimate}");
            } else {
                let _ = writeln!(text, "{estimate}\n[bodies.{name}.markers]");
                let _ = writeln!(text, "{}", markers.join("\n"));
            }
        }
    }

    /// Returns a line for each marker of a body.
    fn markers(&self, body: BodyRef, frame: [f64; 3]) -> Vec<String> {
        let points = self.draft.bodies[body.0].points.iter();
        let names = &self.given.markers[body.0];
        let lines = points.zip(names).map(|(point, name)| {
            let [x, y] = self.local(frame, point.at);
            let turn = point
                .angle
                .map(|angle| super::draft::turn_between(frame[2], angle));
            let turn = turn.map_or("0".to_owned(), |turn| self.angle(turn));
            let origin = origin(name, &point.name);
            match &*turn {
                "0" => format!("{name} = [{x}, {y}]{origin}"),
                turn => format!("{name} = [{x}, {y}, {turn}]{origin}"),
            }
        });
        lines.collect()
    }

    fn joints(&self, text: &mut String) {
        let draft = self.draft;
        text.push_str("\n[joints]\n");
        let width = widest(&self.given.joints);
        for (joint, name) in draft.joints.iter().zip(&self.given.joints) {
            let (kind, keys) = self.joint_keys(&joint.kind);
            let markers = self.pair(joint.from, joint.to);
            let origin = origin(name, &joint.name);
            let _ = writeln!(
                text,
                "{name:width$} = {{ type = \"{kind}\", {markers}{keys} }}{origin}"
            );
        }
        if draft.held.is_empty() {
            return;
        }
        text.push_str("\n[constraints]\n");
        let width = widest(&self.given.held);
        for (held, name) in draft.held.iter().zip(&self.given.held) {
            let value = self.angle(draft.drawn(Coordinate::Angle, held.from, held.to));
            let markers = self.pair(held.from, held.to);
            let origin = origin(name, &held.name);
            let _ = writeln!(
                text,
                "{name:width$} = {{ coordinate = \"angle\", {markers}, value = {value} }}{origin}"
            );
        }
    }

    /// Returns the type of a joint in the file, and its further keys.
    fn joint_keys(&self, kind: &JointKind) -> (&'static str, String) {
        let none = String::new();
        match kind {
            JointKind::Revolute => ("revolute", none),
            JointKind::Translational => ("translational", none),
            JointKind::Slot => ("slot", none),
            JointKind::Weld => ("weld", none),
            JointKind::Offset(offset) => (
                "revolute_translational",
                format!(", offset = {}", self.length(*offset)),
            ),
            JointKind::Link(length) => ("link", format!(", length = {}", self.length(*length))),
            JointKind::Gear(wheels) => ("gear", self.wheels(wheels)),
            JointKind::Belt(wheels) => ("belt", self.wheels(wheels)),
            JointKind::Rack(radius) => {
                let side = if *radius < 0.0 { "below" } else { "above" };
                let radius = self.length(radius.abs());
                let keys = format!(", radius = {radius}, side = \"{side}\", phase = \"drawn\"");
                ("rack_and_pinion", keys)
            }
        }
    }

    fn wheels(&self, wheels: &Wheels) -> String {
        let sizes = wheels.sizes.map(|size| {
            if wheels.are_radii {
                self.length(size)
            } else {
                shortest(size, 9)
            }
        });
        let key = if wheels.are_radii { "radii" } else { "teeth" };
        let carrier = match wheels.carrier {
            GROUND => String::new(),
            body => format!(", carrier = \"{}\"", self.given.bodies[body.0]),
        };
        format!(
            ", {key} = [{}, {}]{carrier}, phase = \"drawn\"",
            sizes[0], sizes[1]
        )
    }

    fn coordinates(&self, text: &mut String) {
        let draft = self.draft;
        if !draft.drivers.is_empty() {
            text.push_str("\n[drivers]\n");
        }
        let width = widest(&self.given.drivers);
        for (driver, name) in draft.drivers.iter().zip(&self.given.drivers) {
            let markers = self.pair(driver.from, driver.to);
            let kind = driver.coordinate.name();
            let value = self.driver_value(driver);
            let origin = origin(name, &driver.name);
            let _ = writeln!(
                text,
                "{name:width$} = {{ coordinate = \"{kind}\", {markers}, {value} }}{origin}"
            );
        }
        self.freedoms(text);
        self.forces(text);
        if !draft.stops.is_empty() {
            text.push_str("\n[stops]\n");
        }
        let width = widest(&self.given.stops);
        for (stop, name) in draft.stops.iter().zip(&self.given.stops) {
            let markers = self.pair(stop.from, stop.to);
            let kind = stop.coordinate.name();
            let limits = limits(stop);
            let origin = origin(name, &stop.name);
            let _ = writeln!(
                text,
                "{name:width$} = {{ coordinate = \"{kind}\", {markers}{limits} }}{origin}"
            );
        }
    }

    fn freedoms(&self, text: &mut String) {
        let draft = self.draft;
        if !draft.freedoms.is_empty() {
            text.push_str("\n[freedoms]\n");
        }
        let width = widest(&self.given.freedoms);
        for (freedom, name) in draft.freedoms.iter().zip(&self.given.freedoms) {
            let markers = self.pair(freedom.from, freedom.to);
            let coordinate = freedom.coordinate;
            let start = draft.drawn(coordinate, freedom.from, freedom.to);
            let start = self.value(coordinate, start);
            let velocity = match (freedom.velocity, coordinate) {
                (0.0, _) => String::new(),
                (velocity, Coordinate::Angle) => {
                    format!(", velocity = {}", shortest(velocity, 12))
                }
                (velocity, _) => format!(", velocity = {}", self.length(velocity)),
            };
            let kind = coordinate.name();
            let origin = origin(name, &freedom.name);
            let _ = writeln!(
                text,
                "{name:width$} = {{ coordinate = \"{kind}\", {markers}, start = {start}{velocity} }}{origin}"
            );
        }
    }

    fn forces(&self, text: &mut String) {
        let draft = self.draft;
        if !draft.forces.is_empty() {
            text.push_str("\n[forces]\n");
        }
        let width = widest(&self.given.forces);
        for (force, name) in draft.forces.iter().zip(&self.given.forces) {
            let origin = origin(name, &force.name);
            let keys = match &force.kind {
                ForceKind::Along {
                    coordinate,
                    from,
                    to,
                    value,
                } => {
                    let kind = coordinate.name();
                    let markers = self.pair(*from, *to);
                    format!(
                        "coordinate = \"{kind}\", {markers}, value = {}",
                        quoted(value)
                    )
                }
                ForceKind::At {
                    point,
                    axes,
                    value: [x, y],
                    torque,
                } => {
                    let mut keys = format!("marker = {}", self.marker(*point));
                    if let Some(axes) = axes {
                        let _ = write!(keys, ", axes = {}", self.marker(*axes));
                    }
                    let _ = write!(keys, ", value = [{}, {}]", quoted(x), quoted(y));
                    if torque != "0" {
                        let _ = write!(keys, ", torque = {}", quoted(torque));
                    }
                    keys
                }
            };
            let _ = writeln!(text, "{name:width$} = {{ {keys} }}{origin}");
        }
    }

    fn driver_value(&self, driver: &Driver) -> String {
        let drawn = self.draft.drawn(driver.coordinate, driver.from, driver.to);
        let start = self.value(driver.coordinate, drawn);
        let mut keys = match &driver.source {
            DriverSource::Input => format!("start = {start}"),
            DriverSource::Motion(motion) => format!("motion = \"{motion}\""),
            DriverSource::Added { shift, text } => {
                let start = self.value(driver.coordinate, drawn + shift);
                match (start.trim_matches('"'), text.strip_prefix('-')) {
                    ("0", _) => format!("motion = \"{text}\""),
                    (start, Some(text)) => format!("motion = \"{start} - {text}\""),
                    (start, None) => format!("motion = \"{start} + {text}\""),
                }
            }
        };
        if let Some(limits) = driver.limits {
            let [min, max] = limits.map(|limit| self.value(driver.coordinate, limit));
            let _ = write!(keys, ", min = {min}, max = {max}");
        }
        keys
    }

    fn rest(&self, text: &mut String) {
        let draft = self.draft;
        if !draft.outputs.is_empty() {
            let outputs = draft.outputs.iter().map(|point| self.marker(*point));
            let outputs: Vec<String> = outputs.collect();
            let _ = writeln!(text, "\n[outputs]\nmarkers = [{}]", outputs.join(", "));
        }
        if draft.simulation.is_none() && draft.gravity.is_none() {
            return;
        }
        text.push_str("\n[simulation]\n");
        if let Some(times) = draft.simulation {
            for (key, time) in ["start", "stop", "step"].into_iter().zip(times) {
                let _ = writeln!(text, "{key} = {}", shortest(time, 9));
            }
        }
        if let Some([x, y]) = draft.gravity {
            let [x, y] = [x, y].map(|g| self.length(g));
            let _ = writeln!(text, "gravity = [{x}, {y}]");
        }
    }

    fn marker(&self, point: PointRef) -> String {
        let marker = &self.given.markers[point.body.0][point.point];
        match point.body {
            GROUND => format!("\"ground.{marker}\""),
            body => format!("\"{}.{marker}\"", self.given.bodies[body.0]),
        }
    }

    fn pair(&self, from: PointRef, to: PointRef) -> String {
        format!("markers = [{}, {}]", self.marker(from), self.marker(to))
    }

    /// Returns a point in a frame.
    fn local(&self, [x, y, phi]: [f64; 3], at: [f64; 2]) -> [String; 2] {
        let (sin, cos) = phi.sin_cos();
        let way = [at[0] - x, at[1] - y];
        [way[0] * cos + way[1] * sin, way[1] * cos - way[0] * sin].map(|length| self.length(length))
    }

    fn length(&self, length: f64) -> String {
        let number = shortest(length, self.decimals);
        match self.draft.unit {
            LengthUnit::Metre => number,
            unit => in_unit(number, unit.name()),
        }
    }

    /// Returns an angle in degrees, to about the relative accuracy of lengths.
    fn angle(&self, angle: f64) -> String {
        let decimals = usize::try_from(self.draft.digits - 3).unwrap_or(0);
        degrees(angle, decimals)
    }

    fn value(&self, coordinate: Coordinate, value: f64) -> String {
        match coordinate {
            Coordinate::Angle => self.angle(value),
            Coordinate::X | Coordinate::Distance => self.length(value),
        }
    }
}

/// Returns the keys of a stop's limits.
fn limits(stop: &Stop) -> String {
    let mut text = String::new();
    for (key, limit) in [("min", &stop.min), ("max", &stop.max)] {
        if let Some(limit) = limit {
            let _ = write!(text, ", {key} = {}", quoted(limit));
        }
    }
    text
}

/// Returns an expression as a value of the file: a plain number needs no quotes.
fn quoted(expression: &str) -> String {
    match expression.parse::<f64>() {
        Ok(_) => expression.to_owned(),
        Err(_) => format!("\"{expression}\""),
    }
}

/// Returns a comment on the name in the source, if the file has another one.
fn origin(name: &str, source: &str) -> String {
    // A number behind the name only tells it from others.
    let rest = name.strip_prefix(source).filter(|_| !source.is_empty());
    let is_same = rest.is_some_and(|rest| {
        let number = rest.strip_prefix('_').unwrap_or(rest);
        number.bytes().all(|byte| byte.is_ascii_digit())
    });
    if is_same || source.is_empty() {
        return String::new();
    }
    format!("  # {} in the source", plain(source))
}

/// Returns the width of a column of names.
fn widest(names: &[String]) -> usize {
    const MOST: usize = 24;
    let lengths = names.iter().map(String::len);
    lengths.filter(|length| *length <= MOST).max().unwrap_or(0)
}

/// Returns a text for a comment: without control characters, and not too long.
fn plain(text: &str) -> String {
    const LONGEST: usize = 200;
    let start = text.chars().take(LONGEST);
    start
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

/// Writes a comment in lines that are not too long.
fn comment(text: &mut String, bullet: &str, content: &str) {
    let mut line = format!("# {bullet}");
    let indent = " ".repeat(bullet.len());
    for (index, word) in plain_words(content).enumerate() {
        if index > 0 && line.chars().count() + 1 + word.chars().count() > LINE {
            let _ = writeln!(text, "{line}");
            line = format!("# {indent}{word}");
        } else {
            if index > 0 {
                line.push(' ');
            }
            line.push_str(&word);
        }
    }
    let _ = writeln!(text, "{line}");
}

fn plain_words(content: &str) -> impl Iterator<Item = String> {
    content.split_whitespace().map(plain)
}
