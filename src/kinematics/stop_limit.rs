//! A limit of a stop, for messages.

use std::fmt;

use crate::mechanism::{CoordinateKind, Stop};

/// One of the two limits of a [`Stop`], with the value that it has.
#[derive(Clone, Debug, PartialEq)]
pub struct StopLimit {
    /// Name of the stop.
    pub stop: String,
    /// The coordinate's word, or the measure or driver whose coordinate it is.
    pub subject: String,
    /// Kind of the coordinate.
    pub kind: CoordinateKind,
    /// Whether it is the largest value, not the least one.
    pub is_max: bool,
    /// The limit \[m or rad\].
    pub value: f64,
}

impl StopLimit {
    /// Makes a limit of a stop with this value.
    pub(in crate::kinematics) fn new(stop: &Stop, is_max: bool, value: f64) -> Self {
        Self {
            stop: stop.name.clone(),
            subject: stop.subject().to_owned(),
            kind: stop.coordinate.kind,
            is_max,
            value,
        }
    }

    /// Describes a value beyond the limit.
    pub(in crate::kinematics) fn describe_beyond(&self, value: f64) -> String {
        let [value, limit] = self.kind.show_apart(value, self.value);
        let (side, key) = match self.is_max {
            true => ("above", "max"),
            false => ("below", "min"),
        };
        format!("{} = {value} is {side} its `{key}` = {limit}", self.subject)
    }
}

impl fmt::Display for StopLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.kind.show(self.value);
        write!(
            f,
            "stop `{}` reached: {} = {value}",
            self.stop, self.subject
        )
    }
}
