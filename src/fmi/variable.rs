//! Scalar variables, as setters, getters and the model description see them (FMI 2.0, 2.2.7).

use crate::unit::Unit;

/// One scalar variable of an FMU. Its value reference is its place in the model's list.
#[derive(Clone, Debug)]
pub struct Variable<Q> {
    /// Structured name: `crank.phi`, `crank_angle.position`.
    pub name: String,
    /// One line for people, empty if there is nothing to add to the name.
    pub description: String,
    /// What it stands for, as the model calls it.
    pub quantity: Q,
    /// FMI causality.
    pub causality: Causality,
    /// FMI variability.
    pub variability: Variability,
    /// Type, with what depends on it.
    pub kind: Kind,
}

/// FMI causality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Can be set, does not depend on anything.
    Parameter,
    /// Computed from parameters.
    CalculatedParameter,
    /// Set by the host at each communication point.
    Input,
    /// Computed for the host.
    Output,
    /// Computed, about the solver rather than the model.
    Local,
    /// Time.
    Independent,
}

/// FMI variability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// Fixed after initialization.
    Fixed,
    /// May change between steps.
    Tunable,
    /// Changes at communication points only.
    Discrete,
    /// Changes at any time.
    Continuous,
}

/// A variable's type. There are no Booleans and no Strings: several hosts stumble over them.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A real number.
    Real {
        /// Unit of the values, if they have one.
        unit: Option<Unit>,
        /// Start value, for what the host can set.
        start: Option<f64>,
        /// Smallest permitted value.
        min: Option<f64>,
        /// Largest permitted value.
        max: Option<f64>,
    },
    /// A whole number.
    Integer,
    /// One of a few named choices, counted from 1; the start value is 1.
    Enumeration(&'static Enumeration),
}

/// A choice among named items, counted from 1.
#[derive(Debug)]
pub struct Enumeration {
    /// Type name.
    pub name: &'static str,
    /// Name and description of each item.
    pub items: &'static [(&'static str, &'static str)],
}

impl Kind {
    /// A real number that may have any value.
    #[must_use]
    pub fn real(unit: Option<Unit>, start: Option<f64>) -> Self {
        Self::Real {
            unit,
            start,
            min: None,
            max: None,
        }
    }

    /// Whether it is a real number.
    #[must_use]
    pub fn is_real(&self) -> bool {
        matches!(self, Self::Real { .. })
    }

    /// The type for people.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Real { .. } => "a Real",
            Self::Integer => "an Integer",
            Self::Enumeration(_) => "an Enumeration",
        }
    }
}
