//! The counters that decide when the other method is worth a trial.
//!
//! The code `dop853.f` calls equations stiff when the product of step and Lipschitz constant stays
//! at the bound of stability, 6.1. With a tight tolerance the error estimate keeps the steps of a
//! fast decay far below it. Here a smaller product makes the equations suspect only; a probing
//! step of the stiff method then decides.

/// Product of step and Lipschitz constant above which the explicit method may be limited by
/// stiffness.
const SUSPECT: f64 = 0.4;

/// Product of step and spectral radius below which the explicit method takes as long steps as the
/// stiff one.
const HARMLESS: f64 = 1.0;

/// Number of steps against a method that lead to a trial of the other, as in `dop853.f`.
const PATIENCE: u64 = 15;

/// Number of steps in a row that clear the count, as in `dop853.f`.
const CLEARING: u64 = 6;

/// Counters of the stiffness detection (Hairer, Wanner II, section IV.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Whether the stiff method is in use.
    pub stiff: bool,
    /// Number of steps that speak for the other method.
    pub against: u64,
    /// Number of steps in a row that speak for the present method.
    pub agreeing: u64,
    /// Number of steps `against` before the next trial. It doubles with each trial that failed.
    pub patience: u64,
}

impl Default for Stiffness {
    fn default() -> Self {
        Self::new(false)
    }
}

impl Stiffness {
    /// Largest patience.
    const LARGEST_PATIENCE: u64 = 64 * PATIENCE;

    /// Starts to count with one of the methods.
    fn new(stiff: bool) -> Self {
        Self {
            stiff,
            against: 0,
            agreeing: 0,
            patience: PATIENCE,
        }
    }

    /// Counts an accepted step with this product of step and Lipschitz constant, or spectral
    /// radius with the stiff method.
    pub(super) fn count(&mut self, product: f64) {
        let against = if self.stiff {
            product < HARMLESS
        } else {
            product > SUSPECT
        };
        if against {
            (self.against, self.agreeing) = (self.against.saturating_add(1), 0);
        } else {
            self.agreeing = self.agreeing.saturating_add(1);
            if self.agreeing >= CLEARING {
                self.against = 0;
            }
        }
    }

    /// Returns whether the other method is worth a trial.
    pub(super) fn is_due(&self) -> bool {
        self.against >= self.patience
    }

    /// Takes over the other method if its trial passed.
    pub(super) fn conclude(&mut self, passed: bool) {
        let patience = (2 * self.patience).min(Self::LARGEST_PATIENCE);
        *self = if passed {
            Self::new(!self.stiff)
        } else {
            Self {
                patience,
                ..Self::new(self.stiff)
            }
        };
    }

    /// Returns whether counters can arise.
    pub(super) fn is_possible(&self) -> bool {
        (1..=Self::LARGEST_PATIENCE).contains(&self.patience)
    }
}
