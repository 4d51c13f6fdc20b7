//! The origin of an equation: what in the mechanism file it comes from.

use crate::mechanism::{DriverId, Mechanism};

/// The joint, constraint or driver of an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Origin {
    /// Index into [`Mechanism::joints`].
    Joint(usize),
    /// Index into [`Mechanism::constraints`].
    Constraint(usize),
    /// A driver.
    Driver(DriverId),
}

impl Origin {
    /// Returns the name in the mechanism file.
    #[must_use]
    pub fn name(self, mechanism: &Mechanism) -> &str {
        match self {
            Self::Joint(index) => &mechanism.joints[index].name,
            Self::Constraint(index) => &mechanism.constraints[index].name,
            Self::Driver(driver) => &mechanism.drivers[driver.index()].name,
        }
    }

    /// Returns kind and name: ``joint `B` ``.
    #[must_use]
    pub fn describe(self, mechanism: &Mechanism) -> String {
        let kind = match self {
            Self::Joint(_) => "joint",
            Self::Constraint(_) => "constraint",
            Self::Driver(driver) => mechanism.drivers[driver.index()].noun(),
        };
        format!("{kind} `{}`", self.name(mechanism))
    }
}
