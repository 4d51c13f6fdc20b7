//! How Newton–Raphson on a part of the position equations (Ec. 3.6.7 and 3.6.8) is judged.

/// How the correction of a prediction went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Correction {
    /// Corrections applied.
    pub(super) iterations: u32,
    /// A cheap measure of how far from singular the Jacobian is where it ended, one at best:
    /// small wherever the reciprocal condition is, not the other way round.
    pub(super) regularity: f64,
}

impl Default for Correction {
    /// Nothing to correct.
    fn default() -> Self {
        Self {
            iterations: 0,
            regularity: 1.0,
        }
    }
}

/// No pose was found, or one that may not be on the motion that led here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rejected;

/// A residual of this many times its estimated rounding error counts as zero.
pub(super) const AT_ROUNDING: f64 = 4.0;
/// So does one that has stopped falling and is below this many times its rounding error: the
/// estimate leaves out what sums and products inside a row add.
pub(super) const STALLED: f64 = 100.0;

/// Newton converges quadratically from a good prediction; one that needs more is halved.
pub(super) const MAX_ITERATIONS: u32 = 8;

/// A reciprocal condition below this is that of a singular position: there Newton ends within
/// the square root of the machine's rounding, and rates mean nothing.
pub(super) const SINGULAR: f64 = 1e-7;
