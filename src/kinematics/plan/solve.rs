//! The interface of block solvers.

use super::choices::BlockChoices;
use super::reach::ClosureGap;
use super::step::{BlockState, Step};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::error::Proof;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{System, Targets};
use crate::mechanism::Jet;

/// The branches of a block behind the blocks before it.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum BlockBranches {
    /// One, which is explicit.
    One,
    /// Two, by their angles, nearest the estimates first.
    Two([[f64; 2]; 2]),
    /// None: a gap stays open on all of them.
    None(ClosureGap),
    /// No closed form lists them.
    Unlisted,
}

/// The solver of one block of equations.
pub(in crate::kinematics) trait SolveBlock:
    std::fmt::Debug + Send + Sync
{
    /// Returns the rows of Phi that it satisfies.
    fn rows(&self) -> &[usize];

    /// Returns the unknowns that it finds, as many as rows.
    fn columns(&self) -> &[usize];

    /// Returns an estimate of the work of a sub-step, in that of one row in closed form: some ten
    /// nanoseconds.
    fn work(&self) -> f64 {
        self.rows().len() as f64
    }

    /// Takes over all that depends on the parameters alone, and sets the pivots of its bodies.
    /// Allocates nothing.
    fn set_parameters(
        &mut self,
        system: &System,
        at: &Configuration,
        targets: &Targets,
        pivots: &mut Pivots,
    ) {
        let _ = (system, at, targets, pivots);
    }

    /// Predicts the unknowns at the end of a sub-step, corrects them, and proves that one motion
    /// joins both ends. Starts from the pose at which it is factorised, and leaves it factorised
    /// at the new one. Allocates nothing.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if Newton–Raphson does not converge or the proof fails.
    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected>;

    /// Solves its rows by Newton–Raphson from where the bodies are; the blocks before it are
    /// solved.
    ///
    /// # Errors
    ///
    /// [`Rejected`] without convergence within the limits.
    fn close(&mut self, state: &mut BlockState<'_>, limits: Limits)
    -> Result<Correction, Rejected>;

    /// Returns its branches. May move its bodies.
    fn branches(&self, state: &mut BlockState<'_>, estimate: &[f64]) -> BlockBranches {
        let _ = (state, estimate);
        BlockBranches::One
    }

    /// Closes by Newton–Raphson on the branch with these angles, of those that
    /// [`branches`](Self::branches) lists.
    ///
    /// # Errors
    ///
    /// [`Rejected`] without convergence within the limits.
    fn close_from(
        &mut self,
        state: &mut BlockState<'_>,
        angles: [f64; 2],
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        let _ = angles;
        self.close(state, limits)
    }

    /// Returns whether a closed form lists its branches.
    fn is_closed_form(&self) -> bool {
        true
    }

    /// Puts its bodies at the nearest pose, as far as a closed form gives it, where it has no
    /// branch.
    fn stretch(&self, state: &mut BlockState<'_>, estimate: &[f64]) {
        let _ = (state, estimate);
    }

    /// Returns the proof that it has no branch, if its closed form gives one.
    fn proof(&self, state: &BlockState<'_>) -> Option<Proof> {
        let _ = state;
        None
    }

    /// Factorises its Jacobian at the pose in `state`.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where the Jacobian is singular to the last bit.
    fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        let _ = state;
        Ok(())
    }

    /// Writes the rates of its unknowns for these rates of the drivers (`first` and `second` of
    /// each), by Eq. 3.6.10 and 3.6.11, at the pose at which it is factorised.
    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]);

    /// Solves its columns of Phi_qᵀ λ = `side` for λ of its rows, the blocks after it being solved,
    /// and moves what the bodies before it bear to the other side, at the pose at which it is
    /// factorised. Returns false, with nothing done, if it has no closed form for that. Allocates
    /// nothing.
    fn solve_transposed(
        &self,
        system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> bool {
        let _ = (system, at, side, multipliers);
        false
    }

    /// Returns the scaled reciprocal condition of its Jacobian: 1 is best, 0 singular.
    fn rcond(&mut self) -> f64 {
        1.0
    }

    /// Returns a cheap measure of regularity; see [`Correction::regularity`].
    fn regularity(&self) -> f64 {
        1.0
    }

    /// Returns whether its matrix keeps pivots from one factorisation to the next.
    fn keeps_pivots(&self) -> bool {
        false
    }

    /// Chooses the pivots that it keeps at the pose in `state`; where that is singular, the next
    /// factorisation chooses them.
    fn choose_pivots(&mut self, state: &mut BlockState<'_>) {
        let _ = state;
    }

    /// Copies what it takes over from earlier steps, if it [keeps pivots](Self::keeps_pivots).
    fn copy_choices(&self, to: &mut BlockChoices) {
        let _ = to;
    }

    /// Takes over what another solver of this block has copied. Returns false if it is of another
    /// block.
    fn take_choices(&mut self, from: &BlockChoices) -> bool {
        let _ = from;
        false
    }

    /// Forgets the pivots that it keeps.
    fn forget_pivots(&mut self) {}
}
