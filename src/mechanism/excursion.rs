//! Drivers beyond their limits.

use std::fmt;

use super::wording::show_time;
use super::{CoordinateKind, Driver};

/// A driver that has gone beyond a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excursion<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Name of the driver.
    pub driver: &'a str,
    /// Kind of its coordinate.
    pub kind: CoordinateKind,
    /// Its value \[m or rad\].
    pub value: f64,
    /// Key and value of the limit \[m or rad\].
    pub limit: (&'static str, f64),
}

impl fmt::Display for Excursion<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, limit) = self.limit;
        let [value, limit] = self.kind.show_apart(self.value, limit);
        write!(
            out,
            "t = {} s: driver `{}` is at {value}, beyond its `{key}` = {limit}; the mechanism follows \
             it",
            show_time(self.time),
            self.driver
        )
    }
}

impl Driver {
    /// Returns the limit beyond which a value \[m or rad\] at `time` \[s\] has gone. `beyond`, which
    /// this sets, tells whether the value before was beyond one: an excursion is told once.
    pub fn excursion(&self, value: f64, time: f64, beyond: &mut bool) -> Option<Excursion<'_>> {
        let above = self.max.filter(|max| value > *max).map(|max| ("max", max));
        let below = self.min.filter(|min| value < *min).map(|min| ("min", min));
        let exceeded = above.or(below);
        let was_beyond = std::mem::replace(beyond, exceeded.is_some());
        let limit = exceeded.filter(|_| !was_beyond)?;
        Some(Excursion {
            time,
            driver: &self.name,
            kind: self.coordinate.kind,
            value,
            limit,
        })
    }
}
