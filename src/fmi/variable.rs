//! Scalar variables, as setters, getters and the model description see them (FMI 2.0, 2.2.7).

use super::state::Version;
use crate::unit::Unit;

/// One scalar variable of an FMU. Its place in the model's list decides its
/// [value reference](value_reference).
#[derive(Clone, Debug)]
pub struct Variable<Q> {
    /// Structured name: `crank.phi`, `crank_angle.position`.
    pub name: String,
    /// One line for people, empty if the name says it all.
    pub description: String,
    /// The model's own name for the variable.
    pub quantity: Q,
    /// FMI causality.
    pub causality: Causality,
    /// FMI variability.
    pub variability: Variability,
    /// Type, with the attributes of that type.
    pub kind: Kind,
    /// Place of the variable whose time derivative this one is.
    pub derivative_of: Option<usize>,
}

/// FMI causality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set by the host, constant during a simulation.
    Parameter,
    /// Computed from parameters.
    CalculatedParameter,
    /// Set by the host at each communication point.
    Input,
    /// Computed for the host.
    Output,
    /// An output whose start the host sets.
    StartedOutput,
    /// An output that is a continuous state: the host sets its start and, in model exchange, its value.
    State,
    /// A continuous state that is no output, and whose start is computed.
    LocalState,
    /// Computed; describes the solver rather than the model.
    Local,
    /// Computed; an event happens where it changes its sign.
    EventIndicator,
    /// Time.
    Independent,
}

impl<Q> Variable<Q> {
    /// Returns whether it is an unknown of the continuous equations: an output, a state, or the
    /// derivative of one.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        let is_derivative = self.causality == Causality::Local && self.derivative_of.is_some();
        self.causality.is_output() || self.causality.is_state() || is_derivative
    }
}

impl Causality {
    /// Returns whether the variable is an output.
    #[must_use]
    pub fn is_output(self) -> bool {
        matches!(self, Self::Output | Self::StartedOutput | Self::State)
    }

    /// Returns whether the variable is a continuous state.
    #[must_use]
    pub fn is_state(self) -> bool {
        matches!(self, Self::State | Self::LocalState)
    }
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

/// A variable's type. Booleans and Strings are left out: several hosts fail on them.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A real number.
    Real {
        /// Unit of the values, if they have one.
        unit: Option<Unit>,
        /// Start value of a variable that the host can set.
        start: Option<f64>,
        /// Smallest permitted value.
        min: Option<f64>,
        /// Largest permitted value.
        max: Option<f64>,
        /// Usual magnitude of the values, if it is known.
        nominal: Option<f64>,
    },
    /// A count, which changes at communication points: a discrete Integer in FMI 2.0, a continuous
    /// Float64 in FMI 3.0, where discrete variables change at events only (2.4.7.4).
    Integer,
    /// One of a few named items, counted from 1.
    Enumeration {
        /// The items.
        choices: &'static Enumeration,
        /// Start value.
        start: i32,
    },
}

/// A choice among named items, counted from 1.
#[derive(Debug)]
pub struct Enumeration {
    /// Type name.
    pub name: &'static str,
    /// Name and description of each item.
    pub items: &'static [(&'static str, &'static str)],
}

/// Returns the value reference of the variable at a place in the model's list.
///
/// References count from 1, as the indices of FMI 2.0 do, so that hosts which take a reference for an
/// index find the same variable.
#[must_use]
pub fn value_reference(place: usize) -> u32 {
    place as u32 + 1
}

/// Returns the place of a value reference, which lies outside every list if there is no such variable.
#[inline]
pub(super) fn place(value_reference: u32) -> usize {
    (value_reference as usize).wrapping_sub(1)
}

/// Returns the places of the continuous states.
pub(super) fn states<Q>(variables: &[Variable<Q>]) -> Box<[usize]> {
    let all = variables.iter().enumerate();
    let states = all.filter(|(_, variable)| variable.causality.is_state());
    states.map(|(place, _)| place).collect()
}

/// Returns the places of the event indicators.
pub(super) fn event_indicators<Q>(variables: &[Variable<Q>]) -> Box<[usize]> {
    let all = variables.iter().enumerate();
    let indicators = all.filter(|(_, variable)| variable.causality == Causality::EventIndicator);
    indicators.map(|(place, _)| place).collect()
}

/// Returns the place of each variable's time derivative.
pub(super) fn derivatives<Q>(variables: &[Variable<Q>]) -> Box<[Option<usize>]> {
    let mut derivatives = vec![None; variables.len()];
    for (place, variable) in variables.iter().enumerate() {
        if let Some(of) = variable.derivative_of {
            derivatives[of] = Some(place);
        }
    }
    derivatives.into()
}

impl Kind {
    /// Returns a real number without limits.
    #[must_use]
    pub fn real(unit: Option<Unit>, start: Option<f64>) -> Self {
        Self::Real {
            unit,
            start,
            min: None,
            max: None,
            nominal: None,
        }
    }

    /// Returns whether it is a real number.
    #[must_use]
    pub fn is_real(&self) -> bool {
        matches!(self, Self::Real { .. })
    }

    /// Returns whether host and FMU exchange the values as real numbers in a version of the
    /// standard.
    pub(super) fn is_real_in(&self, version: Version) -> bool {
        self.is_real() || version == Version::Fmi3 && matches!(self, Self::Integer)
    }

    /// Returns the type with its article, for messages.
    pub(super) fn name(&self, version: Version) -> &'static str {
        match (self, version) {
            (Self::Real { .. }, Version::Fmi2) => "a Real",
            (Self::Integer, Version::Fmi2) => "an Integer",
            (Self::Real { .. } | Self::Integer, Version::Fmi3) => "a Float64",
            (Self::Enumeration { .. }, _) => "an Enumeration",
        }
    }
}
