//! Newton–Raphson on the position equations (Ec. 3.6.7 and 3.6.8).

use super::solver::Solver;

/// How a Newton iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outcome {
    /// Whether the residual reached its rounding level; the Jacobian is then factorised there.
    pub(super) converged: bool,
    /// Corrections applied.
    pub(super) iterations: u32,
    /// Largest ratio of a correction to the one before: below one while Newton contracts.
    pub(super) contraction: f64,
}

/// A residual of this many times its estimated rounding error counts as zero.
const AT_ROUNDING: f64 = 4.0;
/// So does one that has stopped falling and is below this many times its rounding error: the
/// estimate leaves out what sums and products inside a row add.
const STALLED: f64 = 100.0;

/// A reciprocal condition below this is that of a singular position: there Newton ends within
/// the square root of the machine's rounding, and rates mean nothing.
pub(super) const SINGULAR: f64 = 1e-7;

impl Solver {
    /// Corrects q until Phi(q) = 0 to rounding: solves Phi_q Δq = −Phi and adds Δq, again and
    /// again. The last evaluation leaves the Jacobian factorised at the accepted pose, ready for
    /// rates. Allocates nothing.
    pub(super) fn correct(&mut self, max_iterations: u32) -> Outcome {
        let mut outcome = Outcome {
            converged: false,
            iterations: 0,
            contraction: 0.0,
        };
        let mut last_excess = f64::INFINITY;
        let mut last_correction = f64::INFINITY;
        loop {
            self.evaluate();
            let excess = self.residual.excess();
            if !excess.is_finite() || self.factorise().is_err() {
                return outcome;
            }
            let stalled = excess <= STALLED && excess >= 0.5 * last_excess;
            if excess <= AT_ROUNDING || stalled {
                outcome.converged = true;
                return outcome;
            }
            if outcome.iterations == max_iterations {
                return outcome;
            }
            self.correction.copy_from(&self.residual.value);
            self.lu.solve(&mut self.correction);
            let size = self.at.size();
            for (column, (q, scaled)) in self.pose.q.iter_mut().zip(&self.correction).enumerate() {
                *q -= scaled * self.system.column_scale(column, size);
            }
            let correction = self.correction.amax();
            outcome.contraction = outcome.contraction.max(correction / last_correction);
            // Corrections near rounding level do not shrink any more.
            last_correction = correction.max(1e-8);
            last_excess = excess;
            outcome.iterations += 1;
        }
    }
}
