//! The text of a mechanism that moves freely, section by section.

use std::fmt::Write as _;

use crate::mutation::Chance;

/// Part by which numbers differ in a text that is nudged: far more than the error of an integration,
/// far less than any length of a mechanism.
pub const NUDGE: f64 = 1e-7;

/// The sections of a file, in their order there.
const SECTIONS: [&str; 10] = [
    "parameters",
    "ground.markers",
    "bodies",
    "joints",
    "drivers",
    "freedoms",
    "measures",
    "stops",
    "friction",
    "forces",
];

/// The text of a mechanism.
pub struct Text {
    /// Decides which way each number is nudged; `None` where they stay.
    nudge: Option<Chance>,
    gravity: [f64; 2],
    sections: [String; SECTIONS.len()],
}

impl Text {
    /// Begins a mechanism; with a seed, one with numbers that are nudged as the seed has it.
    pub fn new(nudge: Option<u64>) -> Self {
        Self {
            nudge: nudge.map(|seed| Chance::new(seed.wrapping_mul(0xa076_1d64_78bd_642f))),
            gravity: [0.0, -9.81],
            sections: Default::default(),
        }
    }

    /// Returns a physical number as this text has it: lengths that parts have in common stay as they
    /// are.
    pub fn nudged(&mut self, value: f64) -> f64 {
        match &mut self.nudge {
            None => value,
            Some(chance) => value * (1.0 + NUDGE * chance.between(-1.0, 1.0).signum()),
        }
    }

    /// Sets gravity.
    pub fn gravity(&mut self, [x, y]: [f64; 2]) {
        self.gravity = [self.nudged(x), self.nudged(y)];
    }

    /// Adds an entry to a section.
    pub fn add(&mut self, section: &str, name: &str, entry: &str) {
        let index = SECTIONS.iter().position(|name| *name == section);
        let index = index.expect("the kinds name sections that exist");
        let _ = writeln!(self.sections[index], "{name} = {entry}");
    }

    /// Adds a marker on ground.
    pub fn ground(&mut self, name: &str, [x, y]: [f64; 2], angle: f64) {
        self.add(
            "ground.markers",
            name,
            &format!("[{x:?}, {y:?}, {angle:?}]"),
        );
    }

    /// Adds a body with its mass, its inertia and the centre of its mass on its x-axis.
    pub fn body(&mut self, name: &str, markers: &str, estimate: [f64; 3], mass: [f64; 3]) {
        let [mass, inertia, center] = mass.map(|value| self.nudged(value));
        let entry = format!(
            "{{ markers = {{ {markers} }}, estimate = {estimate:?}, mass = {mass:?}, \
             inertia = {inertia:?}, center = [{center:?}, 0] }}"
        );
        self.add("bodies", name, &entry);
    }

    /// Adds a joint of two markers.
    pub fn joint(&mut self, name: &str, kind: &str, [i, j]: [&str; 2], more: &str) {
        let entry = format!("{{ type = '{kind}', markers = ['{i}', '{j}']{more} }}");
        self.add("joints", name, &entry);
    }

    /// Adds a driver with a prescribed motion, or a part that is held.
    pub fn driver(&mut self, name: &str, kind: &str, [i, j]: [&str; 2], motion: &str) {
        let entry =
            format!("{{ coordinate = '{kind}', markers = ['{i}', '{j}'], motion = '{motion}' }}");
        self.add("drivers", name, &entry);
    }

    /// Adds a freedom with its start and its velocity there.
    pub fn freedom(&mut self, name: &str, kind: &str, markers: [&str; 2], start: [f64; 2]) {
        let [i, j] = markers;
        let velocity = self.nudged(start[1]);
        let entry = format!(
            "{{ coordinate = '{kind}', markers = ['{i}', '{j}'], start = {:?}, velocity = {velocity:?} }}",
            start[0]
        );
        self.add("freedoms", name, &entry);
    }

    /// Adds an entry of a coordinate to a section: a measure, a stop, friction, a force.
    pub fn along(&mut self, section: &str, name: &str, kind: &str, [i, j]: [&str; 2], more: &str) {
        let entry = format!("{{ coordinate = '{kind}', markers = ['{i}', '{j}']{more} }}");
        self.add(section, name, &entry);
    }

    /// Returns the text of the file.
    pub fn end(self, duration: f64) -> String {
        let mut text = "format = 1\nname = 'attack'\n".to_owned();
        for (name, section) in SECTIONS.iter().zip(&self.sections) {
            if !section.is_empty() {
                let _ = write!(text, "[{name}]\n{section}");
            }
        }
        let [x, y] = self.gravity;
        let _ = write!(
            text,
            "[simulation]\ngravity = [{x:?}, {y:?}]\nstop = {duration:?}\nstep = {:?}\n",
            duration / 140.0
        );
        text
    }
}
