//! Drivers and inputs beyond their limits.

use std::fmt;

use super::wording::{show_time, shown_apart};
use super::{CoordinateKind, Driver, Input, Unit};

/// A driver or an input that has gone beyond a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excursion<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Name of the driver or input.
    pub name: &'a str,
    /// The thing itself.
    pub of: Excursive,
    /// Its value \[SI\].
    pub value: f64,
    /// Key and value of the limit \[SI\].
    pub limit: (&'static str, f64),
}

/// A thing with limits that it may leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Excursive {
    /// A driver, by the kind of its coordinate.
    Driver(CoordinateKind),
    /// An input, by the unit of its values.
    Input(Option<Unit>),
}

impl fmt::Display for Excursion<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, limit) = self.limit;
        let (noun, [value, limit], then) = match self.of {
            Excursive::Driver(kind) => (
                "driver",
                kind.show_apart(self.value, limit),
                "; the mechanism follows it",
            ),
            Excursive::Input(unit) => {
                let unit = unit.map_or_else(String::new, Unit::suffix);
                let shown = shown_apart(self.value, limit);
                ("input", shown.map(|number| format!("{number}{unit}")), "")
            }
        };
        write!(
            out,
            "t = {} s: {noun} `{}` is at {value}, beyond its `{key}` = {limit}{then}",
            show_time(self.time),
            self.name
        )
    }
}

impl Driver {
    /// Returns the limit beyond which a value \[m or rad\] at `time` \[s\] has gone. `beyond`, which
    /// this sets, tells whether the value before was beyond one: an excursion is told once.
    pub fn excursion(&self, value: f64, time: f64, beyond: &mut bool) -> Option<Excursion<'_>> {
        Some(Excursion {
            time,
            name: &self.name,
            of: Excursive::Driver(self.coordinate.kind),
            value,
            limit: left([self.min, self.max], value, beyond)?,
        })
    }
}

impl Input {
    /// Returns the limit beyond which a value at `time` \[s\] has gone, as that of a
    /// [driver](Driver::excursion).
    pub fn excursion(&self, value: f64, time: f64, beyond: &mut bool) -> Option<Excursion<'_>> {
        Some(Excursion {
            time,
            name: &self.name,
            of: Excursive::Input(self.unit),
            value,
            limit: left([self.min, self.max], value, beyond)?,
        })
    }
}

/// Returns key and value of the limit that a value has left, unless it was beyond one before.
fn left(
    [min, max]: [Option<f64>; 2],
    value: f64,
    beyond: &mut bool,
) -> Option<(&'static str, f64)> {
    let above = max.filter(|max| value > *max).map(|max| ("max", max));
    let below = min.filter(|min| value < *min).map(|min| ("min", min));
    let exceeded = above.or(below);
    let was_beyond = std::mem::replace(beyond, exceeded.is_some());
    exceeded.filter(|_| !was_beyond)
}
