//! Start values of the FMU's settings.

/// Use of the rate inputs: the FMU's parameter `rates`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RateSource {
    /// Each rate input once it was set, otherwise input derivatives, otherwise an estimate.
    #[default]
    Auto = 1,
    /// The rate inputs.
    Inputs = 2,
    /// Input derivatives, otherwise an estimate.
    Estimated = 3,
}

impl RateSource {
    /// All sources, in the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Inputs, Self::Estimated];

    /// Returns the word for it in the file and in the FMU.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Inputs => "inputs",
            Self::Estimated => "estimated",
        }
    }
}

/// Path of positions without input derivatives: the FMU's parameter `extrapolation`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extrapolation {
    /// Held over a step.
    #[default]
    Hold = 1,
    /// Extrapolated by velocity and acceleration.
    Taylor = 2,
}

impl Extrapolation {
    /// All paths, in the order of their numbers.
    pub const ALL: [Self; 2] = [Self::Hold, Self::Taylor];

    /// Returns the word for it in the file and in the FMU.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Taylor => "taylor",
        }
    }
}
