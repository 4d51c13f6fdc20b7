//! The FMU's parameters `rates` and `extrapolation`, and the sources of rates.

use crate::fmi::variable::Enumeration;

/// Use of the rate inputs: the FMU's parameter `rates`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RateSource {
    Auto = 1,
    Inputs = 2,
    Estimated = 3,
}

impl RateSource {
    pub(super) const ALL: [Self; 3] = [Self::Auto, Self::Inputs, Self::Estimated];
    pub(super) const CHOICES: &Enumeration = &Enumeration {
        name: "biela.Rates",
        items: &[
            (
                "auto",
                "each rate input once it was set to other than zero after initialization, \
                 otherwise input derivatives, otherwise an estimate",
            ),
            ("inputs", "the rate inputs, always"),
            (
                "estimated",
                "input derivatives, otherwise an estimate from the last three positions",
            ),
        ],
    };
}

/// Path of positions without input derivatives: the FMU's parameter `extrapolation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extrapolation {
    Hold = 1,
    Taylor = 2,
}

impl Extrapolation {
    pub(super) const ALL: [Self; 2] = [Self::Hold, Self::Taylor];
    pub(super) const CHOICES: &Enumeration = &Enumeration {
        name: "biela.Extrapolation",
        items: &[
            (
                "hold",
                "held over a step: outputs lag the inputs by one step",
            ),
            ("taylor", "extrapolated by velocity and acceleration"),
        ],
    };
}

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
