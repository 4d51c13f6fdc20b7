//! Signals of a mechanism that moves, and their names.

use super::id::{BodyId, DriverId, MarkerId};
use super::number::Jet;

/// A scalar signal of the mechanism, which has a velocity and an acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Signal {
    /// A generalized coordinate of a body: x (component 0), y (1) or phi (2).
    Body(BodyId, usize),
    /// A marker's global x (component 0) or y (1).
    Marker(MarkerId, usize),
    /// A measure, by its index in [`Mechanism::measures`](super::Mechanism::measures).
    Measure(usize),
    /// The value of a driver.
    Motion(DriverId),
}

/// Order of a time derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Order {
    /// The quantity itself.
    Position,
    /// Its first derivative.
    Velocity,
    /// Its second derivative.
    Acceleration,
}

impl Order {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Acceleration];

    /// Returns the derivative of this order.
    #[inline]
    #[must_use]
    pub fn of(self, jet: Jet) -> f64 {
        match self {
            Self::Position => jet.value,
            Self::Velocity => jet.first(),
            Self::Acceleration => jet.second(),
        }
    }

    /// Returns the last part of the name of a driver's or measure's variable.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        SUFFIXES[self as usize]
    }
}

/// Last parts of the names of a driver's or measure's variables, by order.
pub(crate) const SUFFIXES: [&str; 3] = ["position", "velocity", "acceleration"];

/// Last parts of the names of a body's variables: of x, y and phi, each by order. Those of a marker
/// are the first two.
pub const COMPONENTS: [[&str; 3]; 3] = [
    ["x", "vx", "ax"],
    ["y", "vy", "ay"],
    ["phi", "omega", "alpha"],
];
