//! Gestures that fit what is selected.

use serde::Deserialize as _;
use serde_json::{Value, json};

use super::super::gesture::{self, Editing, Refusal};
use super::super::request::Gesture;
use biela::kinematics::{Error, Fit};
use biela::mechanism::rounded;

/// Digits of a length that lets a mechanism close: more end in the rounding of the pose from which it follows.
const FIT_DIGITS: usize = 10;
/// Part of the drawing's size by which a duplicate is beside its body.
const BESIDE: f64 = 0.2;

/// Actions that are collected.
pub(super) struct Actions<'a> {
    editing: &'a Editing<'a>,
    pub(super) list: Vec<Value>,
}

impl<'a> Actions<'a> {
    pub(super) fn new(editing: &'a Editing<'a>) -> Self {
        Self {
            editing,
            list: Vec::new(),
        }
    }

    /// Offers the length with which a mechanism closes that does not close now.
    pub(super) fn mechanism(&mut self) {
        let Some(Error::Contradiction { fit: Some(fit), .. }) = &self.editing.drawn.open else {
            return;
        };
        if let Fit::Length {
            origin,
            between: Some(ends),
            length,
            ..
        } = &**fit
            && let Some(body) = origin.split('`').nth(1)
        {
            let markers = ends.each_ref().map(|end| format!("{body}.{end}"));
            let value = rounded(*length, FIT_DIGITS);
            let label = format!(
                "Let it fit: {} to {}, {} mm",
                markers[0],
                markers[1],
                1e3 * value
            );
            self.offer(
                &label,
                &json!({ "kind": "length", "markers": markers, "value": value }),
            );
        }
    }

    /// Offers what can be done at the point of these markers.
    pub(super) fn point(&mut self, markers: &[&str]) -> Result<(), Refusal> {
        let mechanism = self.editing.mechanism()?;
        let own = markers.iter().find(|path| !path.starts_with("ground."));
        let first = own.or(markers.first()).copied().unwrap_or_default();
        let [x, y, _] = self.editing.drawn.place(self.editing.marker(first)?);
        let pinned = self.editing.drawn.pinned_to(self.editing.marker(first)?);
        for path in markers {
            if !pinned.contains(&self.editing.marker(path)?) {
                let join = json!({ "kind": "join", "marker": first, "onto": path });
                self.offer(&format!("Pin to {path}"), &join);
            }
        }
        self.offer(
            "Fix to ground",
            &json!({ "kind": "pivot", "marker": first }),
        );
        let target = json!({ "at": [x, y], "marker": first });
        let slide = json!({ "kind": "slider", "target": target, "angle": 0 });
        self.offer("Slide on a guide", &slide);
        let joints = mechanism.joints.iter().filter(|joint| {
            let mut at = joint.markers().map(|id| mechanism.marker_path(id));
            at.any(|path| markers.contains(&&*path))
        });
        let joints: Vec<&str> = joints.map(|joint| &*joint.name).collect();
        for joint in &joints {
            self.motion(joint, joints.len() > 1);
        }
        let is_traced = |id: &biela::mechanism::MarkerId| mechanism.marker_path(*id) == first;
        let label = if mechanism.outputs.markers.iter().any(is_traced) {
            "Hide its path"
        } else {
            "Show its path"
        };
        self.offer(label, &json!({ "kind": "trace", "marker": first }));
        self.offer("Add a force", &json!({ "kind": "load", "marker": first }));
        self.rename(first);
        for joint in &joints {
            let delete = json!({ "kind": "delete", "names": [joint] });
            self.add(&format!("Delete joint {joint}"), &delete, None);
        }
        self.add(
            "Delete the point",
            &json!({ "kind": "delete", "names": markers }),
            None,
        );
        Ok(())
    }

    /// Offers what can be done with a body.
    pub(super) fn body(&mut self, name: &str) -> Result<(), Refusal> {
        let mechanism = self.editing.mechanism()?;
        self.offer("Add a mass", &json!({ "kind": "mass", "body": name }));
        let markers = &self.editing.body(name)?.markers;
        if let [from, to] = markers[..] {
            let ends = [from, to].map(|id| mechanism.marker_path(id));
            let named = json!({ "kind": "length", "markers": ends, "name": "fresh_length" });
            let mut asks = named.clone();
            asks["name"] = Value::Null;
            let why = self.why(&named);
            self.add("Name its length", &asks, why);
        }
        self.copies(&[name])?;
        self.rename(name);
        for shape in self.editing.text.keys(&["bodies", name, "shapes"]) {
            let delete = json!({ "kind": "delete", "names": [format!("{name}.{shape}")] });
            self.add(&format!("Delete shape {shape}"), &delete, None);
        }
        self.delete(&[name]);
        Ok(())
    }

    /// Offers what can be done with several bodies.
    pub(super) fn bodies(&mut self, names: &[&str]) -> Result<(), Refusal> {
        self.copies(names)?;
        self.delete(names);
        Ok(())
    }

    /// Offers copies of bodies: beside them, and mirrored at the first point of the first one.
    fn copies(&mut self, names: &[&str]) -> Result<(), Refusal> {
        let way = self.editing.rounded(BESIDE * self.editing.drawn.size());
        let duplicate = json!({ "kind": "duplicate", "bodies": names, "by": [way, -way] });
        self.offer("Duplicate", &duplicate);
        let first = names.first().map(|name| self.editing.body(name));
        if let Some(first) = first.transpose()?.and_then(|body| body.markers.first()) {
            let [x, y, _] = self.editing.drawn.place(*first);
            let angle = std::f64::consts::FRAC_PI_2;
            let mirror = json!({ "kind": "mirror", "bodies": names, "at": [x, y], "angle": angle });
            self.offer("Mirror", &mirror);
        }
        Ok(())
    }

    /// Offers what can be done with a joint, a driver or any other thing that has a name.
    pub(super) fn thing(&mut self, section: &str, name: &str) {
        match section {
            "joints" => {
                self.motion(name, false);
                self.offer("Fix it", &json!({ "kind": "weld", "joint": name }));
                self.offer(
                    "Add friction",
                    &json!({ "kind": "friction", "joint": name }),
                );
                self.offer("Add stops", &json!({ "kind": "stop", "joint": name }));
            }
            "drivers" | "freedoms" | "measures" => {
                self.offer("Add stops", &json!({ "kind": "stop", "driver": name }));
            }
            _ => {}
        }
        self.rename(name);
        self.delete(&[name]);
    }

    /// Offers to drive a joint and to let it move freely.
    fn motion(&mut self, joint: &str, is_named: bool) {
        let of = if is_named {
            format!(" {joint}")
        } else {
            String::new()
        };
        self.offer(
            &format!("Drive{of}"),
            &json!({ "kind": "driver", "joint": joint }),
        );
        let free = json!({ "kind": "freedom", "joint": joint });
        self.offer(
            &format!("Let{} move freely", if is_named { &*of } else { " it" }),
            &free,
        );
    }

    fn rename(&mut self, name: &str) {
        self.add("Rename", &json!({ "kind": "rename", "old": name }), None);
    }

    fn delete(&mut self, names: &[&str]) {
        let delete = json!({ "kind": "delete", "names": names });
        self.add("Delete", &delete, None);
    }

    /// Offers a gesture, with the reason if it cannot be done.
    fn offer(&mut self, label: &str, gesture: &Value) {
        let why = self.why(gesture);
        self.add(label, gesture, why);
    }

    fn why(&self, gesture: &Value) -> Option<String> {
        let mut editing = self.editing.again();
        let gesture = Gesture::deserialize(gesture).map_err(|error| error.to_string().into());
        match gesture.and_then(|gesture| gesture::act(&gesture, &mut editing)) {
            Err(Refusal::Because(why)) => Some(why),
            _ => None,
        }
    }

    fn add(&mut self, label: &str, gesture: &Value, why: Option<String>) {
        self.list
            .push(json!({ "label": label, "gesture": gesture, "why": why }));
    }
}
