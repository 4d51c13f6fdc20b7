//! Limits of Newton–Raphson on the position equations (Eq. 3.6.7 and 3.6.8), and its outcome.

use crate::kinematics::tolerances::AT_ROUNDING;

/// The outcome of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct Correction {
    /// Corrections applied.
    pub(in crate::kinematics) iterations: u32,
    /// A cheap measure of the distance from a singular position, one at best: it is small wherever
    /// the reciprocal condition is, not the other way round.
    pub(in crate::kinematics) regularity: f64,
}

impl Default for Correction {
    /// Returns the outcome where nothing had to be corrected.
    fn default() -> Self {
        Self {
            iterations: 0,
            regularity: 1.0,
        }
    }
}

/// A correction without a pose, or with one that may be off the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::kinematics) struct Rejected;

/// Limits of Newton–Raphson.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Limits {
    /// Most corrections.
    pub(in crate::kinematics) iterations: u32,
    /// A residual up to this many times its estimated rounding error counts as zero.
    pub(in crate::kinematics) residual: f64,
}

impl Limits {
    /// Limits in a step: Newton–Raphson converges quadratically from a good prediction.
    pub(in crate::kinematics) const STEP: Self = Self {
        iterations: 8,
        residual: AT_ROUNDING,
    };
    /// Limits in an assembly, which may also creep into a nearly singular position.
    pub(in crate::kinematics) const ASSEMBLY: Self = Self {
        iterations: 30,
        ..Self::STEP
    };
    /// Limits of corrections that go on until the residual stops falling.
    pub(in crate::kinematics) const TO_THE_LAST_BIT: Self = Self {
        residual: 0.0,
        ..Self::STEP
    };
}
