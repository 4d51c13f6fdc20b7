//! The search for branches of all blocks that go together.
//!
//! A block that does not close can only be helped by another way of the blocks that it reads,
//! directly or through others: the search jumps back to the last of those, and what lies between
//! and has nothing to do with it is not tried again (conflict-directed backjumping).

use std::collections::BTreeSet;

use super::branches::{Branches, SearchEffort};
use crate::kinematics::block::{BlockSolver, SolveBlock};
use crate::kinematics::model::Model;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// Behind a block whose reciprocal condition is less, rounding is no longer small enough for a
/// proof.
const WELL_CONDITIONED: f64 = 1e-5;
/// How much work is spent on other branches once a block has not closed. A block in closed form
/// counts one; this takes well under a second.
const MOST_WORK: f64 = 2_000.0;
/// A block of so many unknowns that is minimised counts one for each start.
const UNIT_OF_WORK: f64 = 9.0;

/// So do so many boxes of angles.
const BOXES_PER_WORK: f64 = 20.0;

/// What is known where the blocks did not all close.
#[derive(Debug)]
pub(in crate::kinematics) struct NoBranch {
    /// A block that did not close.
    pub(in crate::kinematics) block: usize,
    /// Whether all branches are excluded.
    pub(in crate::kinematics) proved: bool,
    /// In how many branches of those before them blocks did not close.
    pub(super) dead_ends: usize,
    /// From how many starts the search has looked.
    pub(super) starts: usize,
    /// Where a block in closed form misses by least.
    pub(super) nearest: Option<Nearest>,
    /// Into how many boxes the angles of `block` were divided to exclude them.
    pub(super) boxes: usize,
}

/// A block in closed form that misses, behind those before it.
#[derive(Debug)]
pub(super) struct Nearest {
    /// \[m\].
    pub(super) gap: f64,
    pub(super) block: usize,
    /// q, of what was found before.
    pub(super) q: Vec<f64>,
}

/// A block that stands in one of its branches.
#[derive(Debug)]
struct Level {
    branches: Branches,
    iterations: u32,
    /// Kernels before it whose branches decide whether those after it close.
    conflict: BTreeSet<usize>,
    /// Whether something behind it was given up without proof.
    in_doubt: bool,
}

/// Assembles block by block, each behind those before it. Returns the most corrections
/// that one needed.
///
/// # Errors
///
/// What is known if they do not all close.
pub(in crate::kinematics) fn search(
    model: &mut Model,
    state: &mut State,
    estimate: &[f64],
) -> Result<u32, NoBranch> {
    let Model { system, plan, .. } = model;
    let unknowns = system.unknowns();
    let mut work = state.block_state(system);
    let blocks = &mut plan.blocks;
    let mut levels: Vec<Level> = Vec::with_capacity(blocks.len());
    let mut reads: Option<Vec<BTreeSet<usize>>> = None;
    let mut work_left = MOST_WORK;
    let mut no_branch = NoBranch {
        block: 0,
        proved: false,
        dead_ends: 0,
        starts: 0,
        nearest: None,
        boxes: 0,
    };
    while levels.len() < blocks.len() {
        let branches = Branches::new(
            &blocks[levels.len()],
            &mut work,
            estimate,
            SearchEffort::Near,
        );
        levels.push(Level {
            branches,
            iterations: 0,
            conflict: BTreeSet::new(),
            in_doubt: false,
        });
        // The last block goes to its next way; where there is none, one before it.
        loop {
            let index = levels.len() - 1;
            let level = &mut levels[index];
            let block = &mut blocks[index];
            let starts = level.branches.starts;
            let corrected = level.branches.next(block, &mut work, estimate);
            if reads.is_some() {
                work_left -= cost(block) * (1 + level.branches.starts - starts) as f64;
            }
            if let Some(correction) = corrected {
                level.iterations = correction.iterations;
                let closed_form =
                    matches!(block, BlockSolver::RrrDyad(_) | BlockSolver::RrpDyad(_));
                level.in_doubt |= closed_form && block.rcond() < WELL_CONDITIONED;
                break;
            }
            let in_doubt = level.in_doubt || !level.branches.is_complete();
            let boxes = level.branches.boxes();
            no_branch.boxes = no_branch.boxes.max(boxes);
            work_left -= boxes as f64 / BOXES_PER_WORK;
            if level.branches.given == 0 {
                if no_branch.dead_ends == 0 {
                    no_branch.block = index;
                }
                no_branch.dead_ends += 1;
                no_branch.starts += level.branches.starts.max(1);
                let gap = level.branches.gap().filter(|gap| gap.is_finite());
                let nearest = no_branch.nearest.as_ref();
                if let Some(gap) = gap
                    && nearest.is_none_or(|nearest| gap < nearest.gap)
                {
                    let mut q = vec![0.0; unknowns];
                    work.at.copy_pose(&mut q);
                    let block = index;
                    no_branch.nearest = Some(Nearest { gap, block, q });
                }
            }
            let reads = reads.get_or_insert_with(|| reads_of(work.system, blocks));
            let mut conflict = std::mem::take(&mut level.conflict);
            conflict.extend(&reads[index]);
            let Some(back) = conflict.pop_last() else {
                no_branch.proved = !in_doubt;
                return Err(no_branch);
            };
            if work_left < 0.0 {
                return Err(no_branch);
            }
            levels.truncate(back + 1);
            levels[back].conflict.extend(conflict);
            levels[back].in_doubt |= in_doubt;
        }
    }
    let iterations = levels.iter().map(|level| level.iterations).max();
    state.accept_bodies();
    Ok(iterations.unwrap_or(0))
}

/// What one start of a block costs, in units of a closed form.
fn cost(block: &BlockSolver) -> f64 {
    match block {
        BlockSolver::PinnedBody(_)
        | BlockSolver::RrrDyad(_)
        | BlockSolver::RrpDyad(_)
        | BlockSolver::InterpolatedBlock(_) => 1.0,
        BlockSolver::CoupledBlock(block) => (block.columns().len() as f64 / UNIT_OF_WORK)
            .powi(3)
            .max(1.0),
    }
}

/// The blocks that each block reads.
fn reads_of(system: &System, blocks: &[BlockSolver]) -> Vec<BTreeSet<usize>> {
    let mut finder = vec![0; system.unknowns()];
    for (index, block) in blocks.iter().enumerate() {
        for &column in block.columns() {
            finder[column] = index;
        }
    }
    let blocks = blocks.iter().enumerate();
    blocks
        .map(|(index, block)| {
            let rows = block.rows().iter();
            let unknowns = rows.flat_map(|&row| system.incidence(row).unknowns);
            let read = unknowns.map(|column| finder[column]);
            read.filter(|&read| read != index).collect()
        })
        .collect()
}
