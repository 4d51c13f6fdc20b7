//! The FMU's parameters `rates` and `extrapolation`, and the sources of rates.

use crate::fmi::variable::Enumeration;
use crate::mechanism::{Extrapolation, RateSource};

/// Choices of the parameter `rates`.
pub(super) const RATES: &Enumeration = &Enumeration {
    name: "biela.Rates",
    items: &[
        (
            RateSource::Auto.word(),
            "each rate input once it was set to other than zero after initialization, \
             otherwise input derivatives, otherwise an estimate",
        ),
        (RateSource::Inputs.word(), "the rate inputs, always"),
        (
            RateSource::Estimated.word(),
            "input derivatives, otherwise an estimate from the last three positions",
        ),
    ],
};

/// Choices of the parameter `extrapolation`.
pub(super) const EXTRAPOLATION: &Enumeration = &Enumeration {
    name: "biela.Extrapolation",
    items: &[
        (
            Extrapolation::Hold.word(),
            "held over a step: outputs lag the inputs by one step",
        ),
        (
            Extrapolation::Taylor.word(),
            "extrapolated by velocity and acceleration",
        ),
    ],
};

/// The FMU's parameters that decide about paths and rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    pub(super) rates: RateSource,
    pub(super) extrapolation: Extrapolation,
}

/// Source of a rate in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Source {
    /// The rate input.
    Input,
    /// Input derivatives.
    Derivatives,
    /// The backward difference of velocities that are no estimates.
    Difference,
    /// The parabola through the last three positions.
    #[default]
    Estimate,
}

impl Source {
    pub(super) const ALL: [Self; 4] = [
        Self::Input,
        Self::Derivatives,
        Self::Difference,
        Self::Estimate,
    ];
}
