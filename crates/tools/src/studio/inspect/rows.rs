//! The rows of a form: numbers and texts of the file.

use serde_json::{Value, json};

use super::super::gesture::{Editing, Refusal};
use super::super::unit_of::unit_of;
use super::form::{Field, FieldKind, fields};
use biela::mechanism::{CoordinateKind, MarkerId, Measure, rounded};

/// Significant digits of values that are shown beside those of the file.
const DIGITS: usize = 6;

/// Rows that are collected.
pub(super) struct Rows<'a> {
    editing: &'a Editing<'a>,
    pub(super) list: Vec<Value>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(editing: &'a Editing<'a>) -> Self {
        Self {
            editing,
            list: Vec::new(),
        }
    }

    /// Adds the drivers, lengths and measures of the mechanism; folded away, its texts and its default
    /// experiment.
    pub(super) fn mechanism(&mut self) -> Result<(), Refusal> {
        for section in ["drivers", "freedoms"] {
            for name in self.editing.text.keys(&[section]) {
                let path = [section, &*name, "start"];
                if self.editing.text.has(&path) {
                    self.number(&name, &path, None, "value at which the file starts it");
                }
            }
        }
        if let Some(mechanism) = &self.editing.drawn.mechanism {
            for body in &mechanism.bodies {
                // The last side of a plate leads back.
                let count = body.markers.len();
                let sides = if count > 2 {
                    count
                } else {
                    count.saturating_sub(1)
                };
                for k in 0..sides {
                    let ends = [body.markers[k], body.markers[(k + 1) % count]];
                    self.length(&format!("{} {}", body.name, self.pair(ends)?), ends)?;
                }
            }
            let is_placed = |measure: &&Measure| {
                !matches!(measure.coordinate.kind, CoordinateKind::Clearance(..))
            };
            for measure in mechanism.measures.iter().filter(is_placed) {
                let unit = if measure.coordinate.kind.is_angle() {
                    "rad"
                } else {
                    "m"
                };
                let value = self.editing.drawn.value(measure.coordinate);
                self.read(&measure.name, "", Some((value, unit)));
            }
        }
        let first = self.list.len();
        for field in fields(&self.editing.text, &[]) {
            if field.kind == FieldKind::Text {
                self.field(&[], &field);
            }
        }
        self.group(first, "About the mechanism");
        let first = self.list.len();
        self.table(&["simulation"]);
        self.group(first, "Simulation");
        Ok(())
    }

    /// Folds away the rows from one on.
    fn group(&mut self, first: usize, name: &str) {
        for row in &mut self.list[first..] {
            row["group"] = json!(name);
        }
    }

    /// Adds all keys of a table; a parameter may be a number alone.
    pub(super) fn table(&mut self, path: &[&str]) {
        let text = &self.editing.text;
        let is_number = path[0] == "parameters" && !text.has(&[path, &["value"]].concat());
        for field in fields(text, path) {
            if is_number && field.key == "value" {
                self.number(&field.key, path, None, &field.help);
            } else {
                self.field(path, &field);
            }
        }
        // Without a schema, which knows the key `value`.
        if is_number && self.list.is_empty() {
            self.number("value", path, None, "");
        }
    }

    /// Adds the numbers of a body, its markers with the lengths between them, and its joints.
    pub(super) fn body(&mut self, name: &str) -> Result<(), Refusal> {
        let own = ["bodies", name];
        let (late, early): (Vec<_>, Vec<_>) = (fields(&self.editing.text, &own).into_iter())
            .filter(|field| field.key != "markers")
            .partition(|field| field.key == "estimate");
        for field in early {
            self.field(&own, &field);
        }
        let mechanism = self.editing.mechanism()?;
        let markers = &self.editing.body(name)?.markers;
        for id in markers {
            let label = &mechanism.markers[id.index()].name;
            self.marker(label, &mechanism.marker_path(*id));
        }
        for (index, from) in markers.iter().enumerate() {
            for to in &markers[index + 1..] {
                let ends = [*from, *to];
                self.length(&format!("length {}", self.pair(ends)?), ends)?;
            }
        }
        for shape in self.editing.text.keys(&["bodies", name, "shapes"]) {
            for key in ["radius", "fillet", "depth"] {
                let path = ["bodies", name, "shapes", &*shape, key];
                if self.editing.text.has(&path) {
                    self.number(&format!("{shape} {key}"), &path, None, "of the shape");
                }
            }
        }
        let joints = mechanism.joints.iter();
        for joint in joints.filter(|joint| joint.markers().any(|id| markers.contains(&id))) {
            self.joint(&joint.name)?;
        }
        for field in late {
            self.field(&own, &field);
        }
        Ok(())
    }

    /// Adds the distance of two markers of a body, which can be set.
    fn length(&mut self, label: &str, ends: [MarkerId; 2]) -> Result<(), Refusal> {
        let mechanism = self.editing.mechanism()?;
        let [a, b] = ends.map(|id| self.editing.drawn.inside(id));
        let paths = ends.map(|id| mechanism.marker_path(id));
        self.read(label, "", Some((f64::hypot(b[0] - a[0], b[1] - a[1]), "m")));
        if let Some(row) = self.list.last_mut() {
            row["type"] = json!("length");
            row["markers"] = json!(paths);
            row["help"] = json!("the second point moves along the line; all other lengths stay");
        }
        Ok(())
    }

    fn pair(&self, markers: [MarkerId; 2]) -> Result<String, Refusal> {
        let mechanism = self.editing.mechanism()?;
        let [from, to] = markers.map(|id| &mechanism.markers[id.index()].name);
        Ok(format!("{from}–{to}"))
    }

    /// Adds the point and the angle of a marker.
    pub(super) fn marker(&mut self, label: &str, path: &str) {
        let Some((body, marker)) = path.split_once('.') else {
            return;
        };
        let path = match body {
            "ground" => vec!["ground", "markers", marker],
            _ => vec!["bodies", body, "markers", marker],
        };
        if self.editing.text.element(&path, 0).is_some() {
            let parts = [
                ("x", "x in the frame of the body"),
                ("y", "y in the frame of the body"),
                ("angle", "angle of its x-axis; zero if left out"),
            ];
            for (index, (part, help)) in parts.into_iter().enumerate() {
                self.number(&format!("{label} {part}"), &path, Some(index), help);
            }
            return;
        }
        let parts = [
            ("r", "distance from the origin of the body"),
            ("angle", "direction from the origin of the body"),
        ];
        for (part, help) in parts {
            let own: Vec<&str> = path.iter().copied().chain([part]).collect();
            self.number(&format!("{label} {part}"), &own, None, help);
        }
    }

    /// Adds the joints that have one of these markers.
    pub(super) fn joints_at(&mut self, paths: &[&str]) -> Result<(), Refusal> {
        let mechanism = self.editing.mechanism()?;
        for joint in &mechanism.joints {
            let mut markers = joint.markers().map(|id| mechanism.marker_path(id));
            if markers.any(|path| paths.contains(&&*path)) {
                self.joint(&joint.name)?;
            }
        }
        Ok(())
    }

    /// Adds what a joint is between.
    fn joint(&mut self, name: &str) -> Result<(), Refusal> {
        let mechanism = self.editing.mechanism()?;
        let joint = self.editing.joint(name)?;
        let kind = self.editing.text.get(&["joints", name, "type"]);
        let kind = kind.unwrap_or_default().trim_matches('"').replace('_', " ");
        let [from, to] = [joint.from, joint.to].map(|id| mechanism.marker_path(id));
        self.read(
            &format!("joint {name}"),
            &format!("{kind}: {from}, {to}"),
            None,
        );
        Ok(())
    }

    /// Adds a key of a table.
    fn field(&mut self, owner: &[&str], field: &Field) {
        let path: Vec<&str> = owner.iter().copied().chain([&*field.key]).collect();
        let value = self.editing.text.get(&path).unwrap_or_default().to_owned();
        let label = &*field.key;
        match &field.kind {
            FieldKind::Number if value.starts_with('{') => self.read(label, &value, None),
            FieldKind::Number => self.number(label, &path, None, &field.help),
            FieldKind::Numbers(count) => {
                // A list whose default is zeros can be given by its elements.
                let is_there =
                    !value.is_empty() || matches!(label, "center" | "estimate" | "gravity");
                for index in (0..*count).filter(|_| is_there) {
                    let names = match label {
                        "radii" | "teeth" | "scale" => ["i", "j", ""],
                        _ => ["x", "y", "angle"],
                    };
                    let part = names.get(index).unwrap_or(&"");
                    self.number(&format!("{label} {part}"), &path, Some(index), &field.help);
                }
            }
            FieldKind::Other if value.is_empty() => {}
            FieldKind::Other => self.read(label, &value, None),
            FieldKind::Text | FieldKind::Flag | FieldKind::Choice(_) => {
                let (kind, choices) = match &field.kind {
                    FieldKind::Choice(words) => {
                        let words = words.iter().map(|word| format!("\"{word}\""));
                        let mut words: Vec<String> = words.collect();
                        // The file may have another unit than those that are proposed.
                        if !value.is_empty() && !words.contains(&value) {
                            words.push(value.clone());
                        }
                        ("choice", Some(words))
                    }
                    FieldKind::Flag => ("flag", None),
                    _ => ("text", None),
                };
                self.list.push(json!({
                    "label": label, "path": path, "value": value, "type": kind,
                    "choices": choices, "help": field.help,
                }));
            }
        }
    }

    /// Adds a number, or an element of a list.
    fn number(&mut self, label: &str, path: &[&str], element: Option<usize>, help: &str) {
        let editing = self.editing;
        let place = editing.text.number(path, element);
        let value = place.map(|place| editing.text.as_str()[place].to_owned());
        let value = value.unwrap_or_default();
        let unit = unit_of(editing.drawn, path, element);
        let mechanism = editing.drawn.mechanism.as_deref();
        let number = mechanism.and_then(|mechanism| {
            let expression = mechanism.parse_expression(value.trim_matches(['"', '\'']), None);
            Some(expression.ok()?.value(&editing.drawn.parameters))
        });
        let is_plain = value.parse::<f64>().is_ok();
        let shown = number.and_then(|number| match unit {
            Some("m" | "rad") => None,
            _ if is_plain => None,
            unit => Some(format!(
                "{} {}",
                rounded(number, DIGITS),
                unit.unwrap_or_default()
            )),
        });
        let shown = shown.map(|shown| shown.trim_end().to_owned());
        self.list.push(json!({
            "label": label, "path": path, "element": element, "value": value, "shown": shown,
            "number": number, "unit": unit, "type": "number", "help": help,
        }));
    }

    /// Adds what is only read: a text, or a number with its unit.
    fn read(&mut self, label: &str, value: &str, number: Option<(f64, &str)>) {
        let (number, unit) = number.unzip();
        self.list.push(json!({
            "label": label, "path": [], "value": value, "number": number, "unit": unit, "type": "read",
        }));
    }
}
