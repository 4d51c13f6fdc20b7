//! The search for branches of all blocks that fit together.
//!
//! Only another branch of the blocks that a block reads, directly or through others, can help a
//! block that does not close. The search jumps back to the last of these; blocks in between, which
//! have no influence, are not tried again (conflict-directed backjumping).

use std::collections::BTreeSet;

use super::branches::{Branches, SearchEffort};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockSolver, BlockState};
use crate::kinematics::state::State;

/// Least reciprocal condition of a block in closed form behind which rounding is small enough for a
/// proof.
const WELL_CONDITIONED: f64 = 1e-5;
/// Most work on further branches once a block has not closed. A start of a block in closed form
/// counts one; this takes well under a second.
const WORK_OF_SEARCH: f64 = 2_000.0;
/// Number of unknowns of a block whose minimisation from one start counts one.
const UNIT_OF_WORK: f64 = 9.0;
/// Number of terms of bounds over intervals that count one.
const TERMS_PER_WORK: f64 = 5_000.0;

/// The failure of a search.
#[derive(Debug)]
pub(in crate::kinematics) struct NoBranch {
    /// A block that did not close.
    pub(in crate::kinematics) block: usize,
    /// Whether all branches are excluded.
    pub(in crate::kinematics) proved: bool,
    /// Number of branches of earlier blocks behind which a block did not close.
    pub(super) dead_ends: usize,
    /// Number of starts tried in these.
    pub(super) starts: usize,
    /// The least gap of a block in closed form.
    pub(super) nearest: Option<Nearest>,
    /// Number of boxes into which bounds divided the angles of a block to exclude them.
    pub(super) boxes: usize,
}

/// A block in closed form that leaves a gap behind those before it.
#[derive(Debug)]
pub(super) struct Nearest {
    /// \[m\]
    pub(super) gap: f64,
    pub(super) block: usize,
    /// q of the blocks before it.
    pub(super) q: Vec<f64>,
}

/// A block on one of its branches.
#[derive(Debug)]
struct Level {
    branches: Branches,
    iterations: u32,
    /// Earlier blocks whose branches decide whether the blocks behind this one close.
    conflict: BTreeSet<usize>,
    /// Whether a block behind this one was given up without proof.
    in_doubt: bool,
}

/// A search over the branches of all blocks.
pub(in crate::kinematics) struct BranchSearch<'a> {
    blocks: &'a mut [BlockSolver],
    state: BlockState<'a>,
    estimate: &'a [f64],
    effort: SearchEffort,
    /// The blocks that are on a branch, in order.
    levels: Vec<Level>,
    /// The blocks that each block reads.
    reads: &'a [Vec<usize>],
    /// Whether a block has not closed.
    goes_back: bool,
    /// Whether a branch was left out because it is some turns away.
    leaves_out: bool,
    work_left: f64,
    failure: NoBranch,
    /// Whether the blocks given up have no other branches than those tried.
    pub(in crate::kinematics) is_complete: bool,
    /// Most starts of a block of which not all branches are known.
    pub(in crate::kinematics) starts: usize,
}

/// Assembles block by block, each behind those before it: within a turn of the estimates where turns
/// are counted, or, if that does not fit together, on any turn. Returns the most corrections of a
/// block.
///
/// # Errors
///
/// [`NoBranch`] if no branches fit together.
pub(in crate::kinematics) fn search(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Result<u32, NoBranch> {
    let mut search = BranchSearch::new(
        compiled,
        state,
        estimate,
        SearchEffort::Near,
        WORK_OF_SEARCH,
    );
    let mut found = search.next();
    if !found && search.leaves_out {
        state.at.set_pose(compiled.system.mechanism(), estimate);
        search = BranchSearch::new(
            compiled,
            state,
            estimate,
            SearchEffort::AnyTurn,
            WORK_OF_SEARCH,
        );
        found = search.next();
    }
    if !found {
        return Err(search.failure);
    }
    let iterations = search.levels.iter().map(|level| level.iterations).max();
    state.accept_bodies();
    Ok(iterations.unwrap_or(0))
}

impl<'a> BranchSearch<'a> {
    /// Begins a search. `most_work` limits the work after the first block that does not close.
    pub(in crate::kinematics) fn new(
        compiled: &'a mut CompiledMechanism,
        state: &'a mut State,
        estimate: &'a [f64],
        effort: SearchEffort,
        most_work: f64,
    ) -> Self {
        let CompiledMechanism { system, plan, .. } = compiled;
        Self {
            levels: Vec::with_capacity(plan.blocks.len()),
            blocks: &mut plan.blocks,
            state: state.block_state(system),
            estimate,
            effort,
            reads: &plan.reads,
            goes_back: false,
            leaves_out: false,
            work_left: most_work,
            failure: NoBranch {
                block: 0,
                proved: false,
                dead_ends: 0,
                starts: 0,
                nearest: None,
                boxes: 0,
            },
            is_complete: true,
            starts: 0,
        }
    }

    /// Returns q of the branches found.
    pub(in crate::kinematics) fn pose(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.state.system.unknowns()];
        self.state.at.copy_pose(&mut q);
        q
    }

    /// Goes to the next branches of all blocks that fit together. Returns false if there are none,
    /// or the work is used up.
    pub(in crate::kinematics) fn next(&mut self) -> bool {
        if let Some(last) = self.levels.len().checked_sub(1) {
            // All branches so far fit together: backtracking leaves none of their blocks out.
            self.levels[last].conflict = (0..last).collect();
            if !self.next_of_last() {
                return false;
            }
        }
        while self.levels.len() < self.blocks.len() {
            let block = &*self.blocks[self.levels.len()];
            self.levels.push(Level {
                branches: Branches::new(block, &mut self.state, self.estimate, self.effort),
                iterations: 0,
                conflict: BTreeSet::new(),
                in_doubt: false,
            });
            if !self.next_of_last() {
                return false;
            }
        }
        true
    }

    /// Puts the last block on its next branch, or, where it has none, one before it. Returns false
    /// if none has, or the work is used up.
    fn next_of_last(&mut self) -> bool {
        loop {
            let index = self.levels.len() - 1;
            let level = &mut self.levels[index];
            let block = &mut *self.blocks[index];
            let starts = level.branches.starts;
            let corrected = level.branches.next(block, &mut self.state, self.estimate);
            if self.goes_back {
                let size = block.columns().len() as f64 / UNIT_OF_WORK;
                let cost = if block.is_closed_form() {
                    1.0
                } else {
                    size.powi(3).max(1.0)
                };
                self.work_left -= cost * (1 + level.branches.starts - starts) as f64;
            }
            if let Some(correction) = corrected {
                level.iterations = correction.iterations;
                level.in_doubt |= block.is_closed_form() && block.rcond() < WELL_CONDITIONED;
                return true;
            }
            self.leaves_out |= level.branches.leaves_out();
            let in_doubt = level.in_doubt || !level.branches.is_complete();
            if !level.branches.is_complete() {
                self.is_complete = false;
                self.starts = self.starts.max(level.branches.starts);
            }
            self.note_dead_end(index);
            self.goes_back = true;
            let mut conflict = std::mem::take(&mut self.levels[index].conflict);
            conflict.extend(&self.reads[index]);
            let Some(back) = conflict.pop_last() else {
                self.failure.proved = !in_doubt;
                self.levels.clear();
                return false;
            };
            if self.work_left < 0.0 {
                self.is_complete = false;
                return false;
            }
            self.levels.truncate(back + 1);
            self.levels[back].conflict.extend(conflict);
            self.levels[back].in_doubt |= in_doubt;
        }
    }

    /// Notes that the last block has no other branch.
    fn note_dead_end(&mut self, index: usize) {
        let branches = &self.levels[index].branches;
        let failure = &mut self.failure;
        if let Some(all) = branches.listed() {
            failure.boxes = failure.boxes.max(all.boxes);
            self.work_left -= all.terms as f64 / TERMS_PER_WORK;
        }
        if branches.given > 0 {
            return;
        }
        if failure.dead_ends == 0 {
            failure.block = index;
        }
        failure.dead_ends += 1;
        failure.starts += branches.starts.max(1);
        let gap = branches.gap().filter(|gap| gap.is_finite());
        let nearest = failure.nearest.as_ref();
        if let Some(gap) = gap
            && nearest.is_none_or(|nearest| gap < nearest.gap)
        {
            self.failure.nearest = Some(Nearest {
                gap,
                block: index,
                q: self.pose(),
            });
        }
    }
}
