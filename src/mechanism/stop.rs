//! Stops: where a coordinate may not go.

use super::{Coordinate, Expression};

/// Limits that a coordinate does not pass.
#[derive(Clone, Debug)]
pub struct Stop {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Coordinate that is limited.
    pub coordinate: Coordinate,
    /// Name of the measure or driver whose coordinate it is, `None` if the file gives the
    /// coordinate itself.
    pub of: Option<String>,
    /// Least value \[m or rad\]. There is one limit at least.
    pub min: Option<Expression>,
    /// Largest value \[m or rad\], above the least one.
    pub max: Option<Expression>,
}

impl Stop {
    /// Returns least and largest value \[m or rad\] for these parameters, infinite without a limit.
    /// Allocates nothing.
    #[must_use]
    pub fn limits(&self, parameters: &[f64]) -> [f64; 2] {
        let value = |limit: &Option<Expression>, none: f64| {
            limit.as_ref().map_or(none, |limit| limit.value(parameters))
        };
        [
            value(&self.min, f64::NEG_INFINITY),
            value(&self.max, f64::INFINITY),
        ]
    }

    /// Returns the word for the coordinate in messages.
    #[must_use]
    pub fn subject(&self) -> &str {
        self.of
            .as_deref()
            .unwrap_or_else(|| self.coordinate.kind.word())
    }
}
