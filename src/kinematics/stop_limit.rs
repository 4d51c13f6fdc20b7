//! A limit of a stop, or the end of a curve, for messages.

use std::fmt;

use crate::mechanism::{CoordinateKind, Mechanism, Stop, rounded, shown};

/// One of the two limits of a [`Stop`], or one of the two ends of an open curve.
#[derive(Clone, Debug, PartialEq)]
pub struct StopLimit {
    /// Name of the stop, or of the joint with the curve.
    pub stop: String,
    /// The coordinate's word, or the measure or driver whose coordinate it is.
    pub subject: String,
    /// Names of the two shapes of a contact.
    pub shapes: Option<[String; 2]>,
    /// Kind of the coordinate, `None` for a place on a curve.
    pub kind: Option<CoordinateKind>,
    /// Whether it is the largest value or the last end, not the least value or the first end.
    pub is_max: bool,
    /// The limit \[m or rad\].
    pub value: f64,
}

impl StopLimit {
    /// Makes a limit of a stop with this value.
    pub(crate) fn new(mechanism: &Mechanism, stop: &Stop, is_max: bool, value: f64) -> Self {
        let shapes = stop.coordinate.shapes();
        Self {
            stop: stop.name.clone(),
            subject: stop.subject().to_owned(),
            shapes: shapes.map(|shapes| shapes.map(|id| mechanism.shape_path(id))),
            kind: Some(stop.coordinate.kind),
            is_max,
            value,
        }
    }

    /// Makes an end of the curve of a joint, with the curve's own variable there.
    pub(in crate::kinematics) fn of_curve(joint: &str, is_max: bool, value: f64) -> Self {
        Self {
            stop: joint.to_owned(),
            subject: String::new(),
            shapes: None,
            kind: None,
            is_max,
            value,
        }
    }

    /// Describes a start pose whose coordinate is at a value beyond the limit.
    pub(in crate::kinematics) fn describe_beyond(&self, value: f64) -> String {
        let Some(kind) = self.kind else {
            let end = if self.is_max { "last" } else { "first" };
            return format!("beyond the {end} end of the curve of joint `{}`", self.stop);
        };
        if let Some([a, b]) = &self.shapes {
            let depth = if value < 0.0 {
                format!(" by {} mm", shown(rounded(-1e3 * value, 4)))
            } else {
                String::new()
            };
            return format!(
                "beyond contact `{}`: `{a}` and `{b}` overlap{depth}",
                self.stop
            );
        }
        let [value, limit] = kind.show_apart(value, self.value);
        let (side, key) = if self.is_max {
            ("above", "max")
        } else {
            ("below", "min")
        };
        format!(
            "beyond stop `{}`: {} = {value} is {side} its `{key}` = {limit}",
            self.stop, self.subject
        )
    }
}

impl fmt::Display for StopLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(kind) = self.kind else {
            return write!(f, "the curve of joint `{}` ends here", self.stop);
        };
        if let Some([a, b]) = &self.shapes {
            return write!(f, "contact `{}` reached: `{a}` touches `{b}`", self.stop);
        }
        let value = kind.show(self.value);
        write!(
            f,
            "stop `{}` reached: {} = {value}",
            self.stop, self.subject
        )
    }
}
