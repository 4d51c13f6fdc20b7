//! The plan: the blocks of the mechanism in the order of solution, each with its own solver.
//!
//! The plan is compiled once from the equations and their structure. A block solver reads only
//! the unknowns of those before it. Position, velocity and acceleration go through the list once,
//! so that the work is proportional to the number of bodies.
//!
//! | block solver | unknowns | method |
//! |---|---|---|
//! | [`PinnedBody`] | x, y, phi of a body with a revolute and a known angle | explicit |
//! | [`RrrDyad`] | x, y, phi of two bodies between three revolutes | Newton on two angles, 2×2 in closed form |
//! | [`RrpDyad`] | x, y, phi of one or two bodies, one point on a line | Newton on one angle |
//! | [`ExplicitUnknown`] | one, in a linear row | explicit |
//! | [`CoupledBlock`] | those of any block | Newton on all rows |
//! | [`InterpolatedBlock`] | those of any block near a change point | interpolation of the motion |
//!
//! A new kind is a file with its `impl SolveBlock`, a variant of [`BlockSolver`], and its
//! recognition in [`compile`].

mod anchor;
mod anchor_path;
mod choices;
mod compile;
pub(super) mod compiled_mechanism;
mod coupled;
mod crossing;
mod elimination;
mod explicit;
mod factors;
mod interpolated;
mod load;
mod pinned;
mod reach;
mod revolute;
mod revolute_graph;
mod rrp_dyad;
mod rrr_dyad;
mod solve;
mod step;
mod watched;

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use super::certificate::{Pivots, StepBounds};
use super::constraint::configuration::Configuration;
use super::path::Rates;
use super::system::{System, Targets};
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::mechanism::Jet;

pub use choices::BlockChoices;
pub(super) use coupled::CoupledBlock;
pub use crossing::{Crossing, Polynomial};
pub(super) use crossing::{INNER, SEAM, divided_differences};
use explicit::ExplicitUnknown;
pub(super) use factors::JacobianFactors;
pub(super) use interpolated::InterpolatedBlock;
use pinned::PinnedBody;
pub(super) use reach::ClosureGap;
use rrp_dyad::RrpDyad;
use rrr_dyad::RrrDyad;
pub(super) use solve::{BlockBranches, SolveBlock};
pub(super) use step::{BlockState, Extrapolation, Step};
pub(super) use watched::Watched;

/// The blocks in the order of solution.
#[derive(Debug, Default)]
pub(super) struct BlockPlan {
    pub(super) blocks: Vec<BlockSolver>,
    /// The blocks that each block reads.
    pub(super) reads: Vec<Vec<usize>>,
    pub(super) pivots: Pivots,
    /// Whether sparse matrices have chosen their pivots.
    has_pivots: bool,
}

/// The solver of one block.
#[derive(Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "most blocks are dyads, which lie side by side as they are"
)]
pub(super) enum BlockSolver {
    PinnedBody(Box<PinnedBody>),
    RrrDyad(RrrDyad),
    RrpDyad(Box<RrpDyad>),
    ExplicitUnknown(ExplicitUnknown),
    CoupledBlock(Box<CoupledBlock>),
    InterpolatedBlock(Box<InterpolatedBlock>),
}

impl Deref for BlockSolver {
    type Target = dyn SolveBlock;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::PinnedBody(block) => &**block,
            Self::RrrDyad(block) => block,
            Self::RrpDyad(block) => &**block,
            Self::ExplicitUnknown(block) => block,
            Self::CoupledBlock(block) => &**block,
            Self::InterpolatedBlock(block) => &**block,
        }
    }
}

impl DerefMut for BlockSolver {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::PinnedBody(block) => &mut **block,
            Self::RrrDyad(block) => block,
            Self::RrpDyad(block) => &mut **block,
            Self::ExplicitUnknown(block) => block,
            Self::CoupledBlock(block) => &mut **block,
            Self::InterpolatedBlock(block) => &mut **block,
        }
    }
}

impl BlockPlan {
    /// Returns whether no block is solved by iteration.
    pub(super) fn is_explicit(&self) -> bool {
        self.blocks.iter().all(|block| {
            matches!(
                block,
                BlockSolver::PinnedBody(_) | BlockSolver::ExplicitUnknown(_)
            )
        })
    }

    /// Returns an estimate of the work of a sub-step, in that of one row in closed form.
    pub(super) fn work(&self) -> f64 {
        self.blocks.iter().map(|block| block.work()).sum()
    }

    /// Takes over all that depends on the parameters alone. Allocates nothing, but the first time.
    pub(super) fn set_parameters(
        &mut self,
        system: &System,
        at: &Configuration,
        targets: &Targets,
    ) {
        for block in &mut self.blocks {
            block.set_parameters(system, at, targets, &mut self.pivots);
        }
        if !std::mem::replace(&mut self.has_pivots, true) {
            self.choose_pivots(system, at, targets);
        }
    }

    /// Lets the unknowns of a block come from a crossing.
    pub(super) fn interpolate(&mut self, crossing: &Arc<Crossing>) {
        self.replace(crossing.block, |block| {
            let block = InterpolatedBlock::new(block, Arc::clone(crossing));
            BlockSolver::InterpolatedBlock(Box::new(block))
        });
    }

    /// Lets a block solve its equations again.
    pub(super) fn release(&mut self, block: usize) {
        self.replace(block, |block| match block {
            BlockSolver::InterpolatedBlock(interpolated) => interpolated.block,
            block => block,
        });
    }

    /// Replaces the block with this index.
    fn replace(&mut self, index: usize, make: impl FnOnce(BlockSolver) -> BlockSolver) {
        let block = self.blocks.swap_remove(index);
        self.blocks.push(make(block));
        let last = self.blocks.len() - 1;
        self.blocks.swap(index, last);
    }

    /// Chooses the pivots of sparse matrices at a fixed pose that belongs to no motion: the same
    /// pivots result wherever the mechanism has been.
    fn choose_pivots(&mut self, system: &System, at: &Configuration, targets: &Targets) {
        let mut sparse = self.blocks.iter_mut().filter(|block| block.keeps_pivots());
        let Some(first) = sparse.next() else {
            return;
        };
        let mut anywhere = system.anywhere(at);
        let mut state = BlockState {
            system,
            targets,
            drivers: &vec![1.0; system.mechanism().drivers.len()],
            at: &mut anywhere,
            tangent: &mut Rates::new(0),
        };
        for block in std::iter::once(first).chain(sparse) {
            block.choose_pivots(&mut state);
        }
    }

    /// Chooses the pivots of sparse matrices again, as if the plan had not been used.
    pub(super) fn reset_pivots(&mut self, system: &System, at: &Configuration, targets: &Targets) {
        self.forget_pivots();
        self.choose_pivots(system, at, targets);
    }

    /// Saves the choices of all blocks with sparse matrices. Allocates at the first call, and after
    /// pivots were chosen again.
    pub(super) fn copy_choices(&self, to: &mut Vec<BlockChoices>) {
        let blocks = || self.blocks.iter().filter(|block| block.keeps_pivots());
        to.resize_with(blocks().count(), BlockChoices::default);
        for (block, to) in blocks().zip(to) {
            block.copy_choices(to);
        }
    }

    /// Restores the choices that [`copy_choices`](Self::copy_choices) saved, perhaps from another
    /// plan for the same rows. Returns false if they do not fit this plan.
    pub(super) fn take_choices(&mut self, from: &[BlockChoices]) -> bool {
        let blocks = self.blocks.iter_mut();
        let mut blocks = blocks.filter(|block| block.keeps_pivots());
        let fits = from
            .iter()
            .all(|from| blocks.next().is_some_and(|block| block.take_choices(from)));
        fits && blocks.next().is_none()
    }

    /// Lets sparse matrices choose their pivots again at the next factorisation.
    fn forget_pivots(&mut self) {
        for block in &mut self.blocks {
            block.forget_pivots();
        }
    }

    /// Goes from the pose at which all blocks are factorised to the pose for the drivers' values
    /// in `state`, block by block: predicts along the tangent, corrects, and certifies. With
    /// `unit_rates`, the tangent becomes the one for these rates of the drivers at the new pose.
    /// Returns the most corrections of a block, and the least regularity.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if a block cannot prove that it kept to its motion;
    /// [`StepBounds::step_ratio`] tells by how much the step is too long. The bodies, the tangent
    /// and the factorisations are then somewhere on the way.
    pub(super) fn step(
        &mut self,
        state: &mut BlockState<'_>,
        extrapolation: Extrapolation,
        from: &[f64],
        bounds: &mut StepBounds,
        unit_rates: Option<&[Jet]>,
    ) -> Result<Correction, Rejected> {
        let mut step = Step {
            extrapolation,
            from,
            pivots: &self.pivots,
            bounds,
        };
        let mut worst = Correction::default();
        for block in &mut self.blocks {
            // The two most frequent ones are compiled into this loop.
            let correction = match block {
                BlockSolver::PinnedBody(block) => {
                    step_block(&mut **block, state, &mut step, unit_rates)
                }
                BlockSolver::RrrDyad(block) => step_block(block, state, &mut step, unit_rates),
                block => step_block(&mut **block, state, &mut step, unit_rates),
            }?;
            worst.iterations = worst.iterations.max(correction.iterations);
            worst.regularity = worst.regularity.min(correction.regularity);
        }
        Ok(worst)
    }

    /// Factorises every block at the pose in `state`.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where a Jacobian is singular to the last bit.
    pub(super) fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        let mut blocks = self.blocks.iter_mut();
        blocks.try_for_each(|block| block.factorise(state))
    }

    /// Solves the tangent for these rates of the drivers (`first` and `second` of each) at the
    /// pose at which all blocks are factorised.
    pub(super) fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        for block in &mut self.blocks {
            block.solve_rates(state, drivers);
        }
    }

    /// Closes block by block with Newton–Raphson from where the bodies are. Returns the most
    /// corrections of a block.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if a block does not close.
    pub(super) fn close(
        &mut self,
        state: &mut BlockState<'_>,
        limits: Limits,
    ) -> Result<u32, Rejected> {
        self.blocks.iter_mut().try_fold(0, |most: u32, block| {
            let correction = block.close(state, limits)?;
            Ok(most.max(correction.iterations))
        })
    }

    /// Returns the least [regularity](Correction::regularity) of all blocks, which are factorised.
    pub(super) fn regularity(&self) -> f64 {
        let blocks = self.blocks.iter();
        blocks.fold(1.0, |least: f64, block| least.min(block.regularity()))
    }

    /// Returns the smallest scaled reciprocal condition of all blocks, which are factorised.
    pub(super) fn rcond(&mut self) -> f64 {
        let blocks = self.blocks.iter_mut();
        blocks.fold(1.0, |smallest: f64, block| smallest.min(block.rcond()))
    }
}

/// Steps one block, then solves its part of the tangent.
#[inline(always)]
fn step_block<B: SolveBlock + ?Sized>(
    block: &mut B,
    state: &mut BlockState<'_>,
    step: &mut Step<'_>,
    unit_rates: Option<&[Jet]>,
) -> Result<Correction, Rejected> {
    let correction = block.step(state, step)?;
    if let Some(rates) = unit_rates {
        block.solve_rates(state, rates);
    }
    Ok(correction)
}

#[cfg(test)]
mod tests {
    use super::{BlockSolver, SolveBlock};
    use crate::kinematics::reference::{assembled, shipped};

    /// Returns a letter per block, `C` with the number of its unknowns.
    fn blocks(name: &str) -> String {
        let (solver, _) = assembled(&shipped(name));
        let letters = solver.compiled.plan.blocks.iter().map(|block| match block {
            BlockSolver::PinnedBody(_) => "P".to_owned(),
            BlockSolver::RrrDyad(_) => "D".to_owned(),
            BlockSolver::RrpDyad(_) => "S".to_owned(),
            BlockSolver::ExplicitUnknown(_) => "E".to_owned(),
            BlockSolver::CoupledBlock(coupled) => format!("C{}", coupled.columns().len()),
            BlockSolver::InterpolatedBlock(_) => "B".to_owned(),
        });
        letters.collect::<Vec<_>>().join(" ")
    }

    /// A mechanism that falls back to a slower solver fails here.
    #[test]
    fn shipped_mechanisms_get_the_fast_block_solvers() {
        for (name, expected) in [
            ("four_bar", "P D"),
            ("slider_crank", "P S"),
            ("tlv_crank", "P S"),
            ("slotted_lever", "P S S"),
            ("jansen_leg", "P D D D"),
            ("toggle_press", "P D S"),
            ("watt_six_bar", "P D D"),
            ("five_bar_robot", "P P D"),
            ("hart_inversor", "P D D"),
            // Driven between coupler and rocker: all three angles at once.
            ("double_rocker", "E E E E C5"),
            ("cam_roller", "E E P C2"),
            ("cam_knife", "E E P C1"),
        ] {
            assert_eq!(blocks(name), expected, "{name}");
        }
    }
}
