//! Gestures: what is drawn by hand, as changes of the mechanism's file.
//!
//! | file | gesture |
//! |---|---|
//! | `link` | a bar or plate through points |
//! | `pivot` | a point is fixed to ground |
//! | `weld` | a pin is fixed, or a body is fixed to ground |
//! | `join` | a point is moved onto another one and pinned there |
//! | `slider` | a point slides along a line of ground or along a bar |
//! | `cylinder` | a driver of the distance between two points |
//! | `wheels`, `wheel` | two wheels in mesh or on a belt; where a wheel has its centre |
//! | `rack` | a pinion on a rack |
//! | `cam` | a cam with its follower |
//! | `curve` | a point runs in a track through points |
//! | `rope` | a rope over points |
//! | `coupling` | the coordinates of two joints are in proportion |
//! | `shape` | a shape of a body; a contact between two shapes |
//! | `spring` | a spring or a damper between two points |
//! | `load` | a force at a point |
//! | `mass` | the mass of a body |
//! | `friction` | friction in a joint |
//! | `drive` | a joint is driven, or moves freely |
//! | `stop` | limits of a coordinate |
//! | `shift` | points are moved: the geometry changes |
//! | `length` | the distance between two points is set |
//! | `parameter` | a number becomes a parameter |
//! | `put` | a value of the file is set or taken away |
//! | `rename` | a thing gets another name, everywhere |
//! | `delete` | things are taken away, with what needs them |
//! | `copy` | bodies are duplicated or mirrored |
//! | `trace` | the path of a point is shown |
//!
//! A gesture says where it acts: at a point of the sheet, of ground, of a body or at a marker
//! ([`Target`]). Its file changes the text by way of [`Editing`], and knows nothing of TOML.

mod cam;
mod copy;
mod coupling;
mod curve;
mod cylinder;
mod delete;
mod drive;
mod friction;
mod join;
mod length;
mod link;
mod load;
mod mass;
mod parameter;
mod pivot;
mod put;
mod rack;
mod rename;
mod rope;
mod shape;
mod shift;
mod slider;
mod spring;
mod stop;
mod trace;
mod weld;
mod wheel;
mod wheels;

use super::drawn::{Drawn, inside, neat, outside};
use super::new_names::Names;
use super::request::{Follower, Gesture, Onto, ShapeKind, Target, Through, WheelPair};
use crate::write::{TomlText, in_braces, in_lines, in_unit, written};
use biela::mechanism::{
    Body, Coordinate, Diagnostic, Joint, MarkerId, Mechanism, Severity, Source, shortest,
};

/// Part of a number, and of the lengths from which it follows, within which it is the same to rounding:
/// some turns of frames, each of which rounds a few times.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The reason why a gesture changes nothing, for the reader.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Refusal {
    /// A sentence.
    Because(String),
    /// A number of the file is an expression of this parameter: is that to change, or the number?
    /// With the parameter's new value \[SI\].
    Ask {
        /// Name of the parameter.
        parameter: String,
        /// The expression in the file.
        formula: String,
        /// The value of the parameter that fits; `None` where no single one does.
        value: Option<f64>,
    },
}

impl From<&str> for Refusal {
    fn from(reason: &str) -> Self {
        Self::Because(reason.to_owned())
    }
}

impl From<String> for Refusal {
    fn from(reason: String) -> Self {
        Self::Because(reason)
    }
}

/// A file that a gesture changes.
pub(super) struct Editing<'a> {
    pub(super) text: TomlText,
    pub(super) drawn: &'a Drawn,
    pub(super) names: Names,
    /// The files beside the mechanism's, with their contents.
    files: &'a [(String, String)],
    /// Decimals of points \[m\].
    decimals: usize,
}

/// Does a gesture.
///
/// # Errors
///
/// The reason why it cannot be done.
pub(super) fn act(gesture: &Gesture, editing: &mut Editing) -> Result<(), Refusal> {
    match gesture {
        Gesture::Link { points } => link::link(editing, points),
        Gesture::Pivot { marker } => pivot::pivot(editing, marker),
        Gesture::Weld { joint } => weld::weld_joint(editing, joint),
        Gesture::WeldToGround { marker } => weld::weld_to_ground(editing, marker),
        Gesture::Join {
            marker,
            onto,
            through,
        } => join::join(editing, [marker, onto], *through),
        Gesture::Slider { target, angle } => slider::slider(editing, target, *angle),
        Gesture::Slot { marker, body } => slider::slot(editing, marker, body),
        Gesture::Cylinder { points } => cylinder::cylinder(editing, points),
        Gesture::Wheels {
            r#type,
            points,
            fixed,
            contact,
            radii,
        } => wheels::wheels(editing, *r#type, points, *fixed, *contact, *radii),
        Gesture::Rack { point, contact } => rack::rack(editing, point, *contact),
        Gesture::Cam {
            point,
            contact: _,
            of: Some(of),
            follower: _,
        } => cam::followed(editing, point, of),
        Gesture::Cam {
            point,
            contact,
            of: None,
            follower,
        } => cam::cam(editing, point, *contact, *follower),
        Gesture::Curve { marker, points } => curve::curve(editing, marker, points),
        Gesture::Rope { points } => rope::rope(editing, points),
        Gesture::Coupling { joints } => coupling::coupling(editing, joints),
        Gesture::Shape {
            shape,
            body,
            points,
            rim,
        } => shape::shape(editing, *shape, body.as_deref(), points, *rim),
        Gesture::Contact { points } => shape::contact(editing, points),
        Gesture::Spring { points } => spring::spring(editing, points),
        Gesture::Damper { points } => spring::damper(editing, points),
        Gesture::Load { marker } => load::load(editing, marker),
        Gesture::Mass { body, mass } => mass::mass(editing, body, *mass),
        Gesture::Friction { joint } => friction::friction(editing, joint),
        Gesture::Driver { joint } => drive::driver(editing, joint),
        Gesture::Freedom { joint } => drive::freedom(editing, joint),
        Gesture::Stop {
            driver,
            joint,
            min,
            max,
        } => stop::stop(editing, driver.as_deref(), joint.as_deref(), [*min, *max]),
        Gesture::Shift {
            markers,
            by,
            through,
        } => shift::shift(editing, markers, *by, *through),
        Gesture::Length {
            markers,
            value,
            name,
            through,
        } => length::length(editing, markers, *value, name.as_deref(), *through),
        Gesture::Parameter {
            path,
            element,
            name,
        } => parameter::parameter(editing, path, *element, name),
        Gesture::Put {
            path,
            element,
            value,
        } => put::put(editing, path, *element, value),
        Gesture::Rename { old, new } => rename::rename(editing, old, new),
        Gesture::Delete { names } => delete::delete(editing, names),
        Gesture::Duplicate { bodies, by } => copy::duplicate(editing, bodies, *by),
        Gesture::Mirror { bodies, at, angle } => copy::mirror(editing, bodies, *at, *angle),
        Gesture::Trace { marker } => trace::trace(editing, marker),
    }
}

/// Returns whether the places of bodies are to be written anew after a gesture.
pub(super) fn moves(gesture: &Gesture) -> bool {
    matches!(
        gesture,
        Gesture::Shift { .. } | Gesture::Join { .. } | Gesture::Length { .. }
    )
}

impl<'a> Editing<'a> {
    /// Begins to change a text, whose lengths have these decimals.
    pub(super) fn new(
        text: TomlText,
        drawn: &'a Drawn,
        files: &'a [(String, String)],
        decimals: usize,
    ) -> Self {
        Self {
            names: Names::of(&text),
            text,
            drawn,
            files,
            decimals,
        }
    }

    /// Begins once more with the text as it is now.
    pub(super) fn again(&self) -> Self {
        Self::new(self.text.clone(), self.drawn, self.files, self.decimals)
    }

    /// Returns the errors of the text as it is now; a file without bodies has none by that.
    pub(super) fn errors(&self) -> Vec<Diagnostic> {
        let source = Source::new("", self.text.as_str()).with_files(self.files.to_vec());
        let problems = Mechanism::parse(&source).err().unwrap_or_default();
        let is_error = |problem: &Diagnostic| {
            problem.severity == Severity::Error && problem.code != "no-bodies"
        };
        problems.into_iter().filter(is_error).collect()
    }

    /// Returns the global point of a target, without the noise of the pose.
    pub(super) fn settled(&self, target: &Target) -> Result<[f64; 2], Refusal> {
        match &target.onto {
            Onto::Marker(path) => Ok(self.drawn.point(self.marker(path)?)),
            Onto::Body(body) => {
                let frame = self.frame(body)?;
                let [x, y] = inside(frame, target.at).map(|x| self.drawn.settled(x));
                let [x, y, _] = outside(frame, [x, y, 0.0]);
                Ok([x, y])
            }
            Onto::Ground | Onto::Sheet => Ok(target.at),
        }
    }

    /// Returns the mechanism that is drawn.
    ///
    /// # Errors
    ///
    /// The sheet is empty.
    pub(super) fn mechanism(&self) -> Result<&'a Mechanism, Refusal> {
        let mechanism = self.drawn.mechanism.as_deref();
        mechanism.ok_or_else(|| "the sheet is empty".into())
    }

    /// Returns a marker by its path.
    pub(super) fn marker(&self, path: &str) -> Result<MarkerId, Refusal> {
        let marker = self.drawn.marker(path);
        marker.ok_or_else(|| format!("there is no marker `{path}`").into())
    }

    /// Returns a joint by its name.
    pub(super) fn joint(&self, name: &str) -> Result<&'a Joint, Refusal> {
        let mut joints = self.mechanism()?.joints.iter();
        let joint = joints.find(|joint| joint.name == name);
        joint.ok_or_else(|| format!("there is no joint `{name}`").into())
    }

    /// Returns a body by its name.
    pub(super) fn body(&self, name: &str) -> Result<&'a Body, Refusal> {
        let mechanism = self.mechanism()?;
        let id = mechanism.body_id(name);
        let id = id.ok_or_else(|| Refusal::Because(format!("there is no body `{name}`")))?;
        Ok(&mechanism.bodies[id.index()])
    }

    /// Returns the body that has a marker, `ground` for ground.
    pub(super) fn body_of(&self, marker: MarkerId) -> Result<&'a str, Refusal> {
        let mechanism = self.mechanism()?;
        let body = mechanism.markers[marker.index()].body;
        Ok(body.map_or("ground", |body| &mechanism.bodies[body.index()].name))
    }

    /// Returns the frame of a body, by its name.
    pub(super) fn frame(&self, body: &str) -> Result<[f64; 3], Refusal> {
        if body == "ground" {
            return Ok([0.0; 3]);
        }
        let id = self.mechanism()?.body_id(body);
        let id = id.ok_or_else(|| Refusal::Because(format!("there is no body `{body}`")))?;
        Ok(self.drawn.frame(Some(id)))
    }

    /// Writes a length \[m\] to rounding, so that what closes on the sheet closes in the file: the
    /// shortest decimal that is the same to rounding, or all digits.
    pub(super) fn length(&self, value: f64) -> String {
        written(self.exact(value, 1.0))
    }

    /// Returns a length \[m\] in a unit, short where that is the same to rounding.
    fn exact(&self, value: f64, unit: f64) -> f64 {
        let scale = self.drawn.size() + value.abs();
        neat(value / unit, ROUNDING * scale / unit)
    }

    /// Writes a length \[m\] on which nothing else depends, a little finer than the sheet shows it.
    pub(super) fn usual(&self, value: f64) -> String {
        shortest(value, self.decimals + 1)
    }

    /// Returns a coordinate of a point \[m\] as fine as the sheet shows it.
    pub(super) fn rounded(&self, value: f64) -> f64 {
        shortest(value, self.decimals).parse().unwrap_or(value)
    }

    /// Writes an angle within half a turn \[rad\].
    pub(super) fn angle(value: f64) -> String {
        Self::turns(super::drawn::within_turn(value))
    }

    /// Writes an angle, which may count turns \[rad\], to rounding.
    pub(super) fn turns(value: f64) -> String {
        in_unit(written(exact_angle(value, 1.0_f64.to_radians())), "deg")
    }

    /// Writes a value of a coordinate \[m or rad\].
    pub(super) fn value(&self, value: f64, is_angle: bool) -> String {
        if is_angle {
            Self::angle(value)
        } else {
            self.length(value)
        }
    }

    /// Writes a marker in the frame of its body.
    pub(super) fn place(&self, [x, y, turn]: [f64; 3]) -> String {
        let [x, y] = [x, y].map(|x| self.length(x));
        match &*Self::angle(turn) {
            "0" => format!("[{x}, {y}]"),
            turn => format!("[{x}, {y}, {turn}]"),
        }
    }

    /// Writes an estimate.
    pub(super) fn estimate(&self, frame: [f64; 3]) -> String {
        let [x, y, phi] = self.drawn.settled_frame(frame);
        let [x, y] = [x, y].map(|x| self.length(x));
        format!("[{x}, {y}, {}]", Self::turns(phi))
    }

    /// Adds a marker to a body or to ground, in its frame; returns its path.
    pub(super) fn add_marker(&mut self, body: &str, name: &str, inside: [f64; 3]) -> String {
        let place = self.place(inside);
        match body {
            "ground" => self.text.set(&["ground", "markers", name], &place),
            body => self.text.set(&["bodies", body, "markers", name], &place),
        }
        format!("{body}.{name}")
    }

    /// Returns a name for a marker of ground: the word, or the word with a number.
    pub(super) fn ground_name(&self, word: &str) -> String {
        let numbered = (2..).map(|number| format!("{word}_{number}"));
        let mut names = std::iter::once(word.to_owned()).chain(numbered);
        let free = names.find(|name| !self.text.has(&["ground", "markers", name]));
        free.unwrap_or_default()
    }

    /// Returns the marker of a target, which is added if it is none yet; a target on the bare sheet
    /// becomes a point of ground.
    pub(super) fn marker_at(&mut self, target: &Target) -> Result<String, Refusal> {
        let body = match &target.onto {
            Onto::Marker(path) => {
                self.marker(path)?;
                return Ok(path.clone());
            }
            Onto::Body(body) => body.clone(),
            Onto::Ground | Onto::Sheet => "ground".to_owned(),
        };
        let [x, y] = inside(self.frame(&body)?, target.at);
        let letter = self.names.new_letter();
        Ok(self.add_marker(&body, &letter, [x, y, 0.0]))
    }

    /// Adds a body with markers in its frame, whose estimate is given; returns its name.
    pub(super) fn add_body(
        &mut self,
        word: &str,
        markers: &[(String, [f64; 3])],
        frame: [f64; 3],
    ) -> String {
        let name = self.names.new_name(word);
        let entries: Vec<(String, String)> = (markers.iter())
            .map(|(marker, inside)| (marker.clone(), self.place(*inside)))
            .collect();
        let estimate = format!("estimate = {}", self.estimate(frame));
        self.write_body(&name, &entries, vec![estimate]);
        name
    }

    /// Writes a new body: markers with their places, and further lines.
    pub(super) fn write_body(
        &mut self,
        name: &str,
        markers: &[(String, String)],
        mut lines: Vec<String>,
    ) {
        let braces = in_braces("markers", markers).filter(|_| !markers.is_empty());
        if let Some(braces) = &braces {
            lines.insert(0, format!("markers = {braces}"));
        }
        self.text.add_section(&["bodies", name], &lines.join("\n"));
        if braces.is_none() && !markers.is_empty() {
            let section = ["bodies", name, "markers"];
            self.text.add_section(&section, &in_lines(markers));
        }
    }

    /// Writes the keys of a coordinate.
    pub(super) fn coordinate_keys(&self, coordinate: Coordinate) -> Result<String, Refusal> {
        let mechanism = self.mechanism()?;
        let [from, to] = [coordinate.from, coordinate.to].map(|id| mechanism.marker_path(id));
        let kind = coordinate.kind.word();
        Ok(format!(
            "coordinate = \"{kind}\", markers = [\"{from}\", \"{to}\"]"
        ))
    }

    /// Adds a joint between two markers; returns its name.
    pub(super) fn join(&mut self, word: &str, kind: &str, [from, to]: [&str; 2]) -> String {
        let name = self.names.new_name(word);
        let value = format!("{{ type = \"{kind}\", markers = [\"{from}\", \"{to}\"] }}");
        self.text.set(&["joints", &name], &value);
        name
    }

    /// Returns the distance within which two points are one \[m\].
    pub(super) fn same(&self) -> f64 {
        self.drawn.same()
    }
}

/// Returns an angle \[rad\] in a unit, short where that is the same to rounding.
fn exact_angle(value: f64, unit: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    neat(value / unit, ROUNDING * (turn + value.abs()) / unit)
}

/// Returns the last part of a marker's path.
pub(super) fn marker_name(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Writes the places at which the mechanism is drawn as estimates, so that it closes the same way
/// again.
pub(super) fn settle(editing: &mut Editing) {
    /// Part of the drawing's size, and angle \[rad\], from which an estimate is far from the drawing.
    const FAR: f64 = 0.02;
    shift::refresh_estimates(editing, FAR);
}
