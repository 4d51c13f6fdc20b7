//! The search for ways of all kernels that go together.
//!
//! A kernel that does not close can only be helped by another way of the kernels that it reads,
//! directly or through others: the search jumps back to the last of those, and what lies between
//! and has nothing to do with it is not tried again (conflict-directed backjumping).

use std::collections::BTreeSet;

use super::branches::{Effort, Ways};
use crate::kinematics::block::Kernel;
use crate::kinematics::constraint::Incidence;
use crate::kinematics::{Solver, System};

/// Behind a kernel whose reciprocal condition is less, rounding is no longer small enough for a
/// proof.
const WELL_CONDITIONED: f64 = 1e-5;
/// How much work is spent on other ways once a kernel has not closed. A kernel in closed form
/// counts one; this takes well under a second.
const MOST_WORK: f64 = 2_000.0;
/// A kernel of so many unknowns that is minimised counts one for each start.
const UNIT_OF_WORK: f64 = 9.0;

/// So do so many boxes of angles.
const BOXES_PER_WORK: f64 = 20.0;

/// What is known where the kernels did not all close.
#[derive(Debug)]
pub(in crate::kinematics) struct Deadlock {
    /// A kernel that did not close.
    pub(in crate::kinematics) kernel: usize,
    /// Whether all ways are excluded.
    pub(in crate::kinematics) proved: bool,
    /// In how many ways of those before them kernels did not close.
    pub(super) dead_ends: usize,
    /// From how many starts the search has looked.
    pub(super) starts: usize,
    /// Where a kernel in closed form misses by least.
    pub(super) nearest: Option<Nearest>,
    /// Into how many boxes the angles of `kernel` were divided to exclude them.
    pub(super) boxes: usize,
}

/// A kernel in closed form that misses, behind those before it.
#[derive(Debug)]
pub(super) struct Nearest {
    /// \[m\].
    pub(super) gap: f64,
    pub(super) kernel: usize,
    /// q, of what was found before.
    pub(super) q: Vec<f64>,
}

/// A kernel that stands in one of its ways.
#[derive(Debug)]
struct Level {
    ways: Ways,
    iterations: u32,
    /// Kernels before it whose ways decide whether those after it close.
    conflict: BTreeSet<usize>,
    /// Whether something behind it was given up without proof.
    in_doubt: bool,
}

impl Solver {
    /// Assembles kernel by kernel, each behind those before it. Returns the most corrections
    /// that one needed.
    ///
    /// # Errors
    ///
    /// What is known if they do not all close.
    pub(in crate::kinematics) fn search(&mut self, estimate: &[f64]) -> Result<u32, Deadlock> {
        let unknowns = self.system.unknowns();
        let (plan, mut work) = self.work();
        let kernels = &mut plan.kernels;
        let mut levels: Vec<Level> = Vec::with_capacity(kernels.len());
        let mut reads: Option<Vec<BTreeSet<usize>>> = None;
        let mut work_left = MOST_WORK;
        let mut deadlock = Deadlock {
            kernel: 0,
            proved: false,
            dead_ends: 0,
            starts: 0,
            nearest: None,
            boxes: 0,
        };
        while levels.len() < kernels.len() {
            let ways = Ways::new(&kernels[levels.len()], &mut work, estimate, Effort::Near);
            levels.push(Level {
                ways,
                iterations: 0,
                conflict: BTreeSet::new(),
                in_doubt: false,
            });
            // The last kernel goes to its next way; where there is none, one before it.
            loop {
                let index = levels.len() - 1;
                let level = &mut levels[index];
                let kernel = &mut kernels[index];
                let starts = level.ways.starts;
                let corrected = level.ways.next(kernel, &mut work, estimate);
                if reads.is_some() {
                    work_left -= cost(kernel) * (1 + level.ways.starts - starts) as f64;
                }
                if let Some(correction) = corrected {
                    level.iterations = correction.iterations;
                    let closed_form = matches!(kernel, Kernel::RrrDyad(_) | Kernel::RrpDyad(_));
                    level.in_doubt |= closed_form && kernel.rcond() < WELL_CONDITIONED;
                    break;
                }
                let in_doubt = level.in_doubt || !level.ways.is_complete();
                let boxes = level.ways.boxes();
                deadlock.boxes = deadlock.boxes.max(boxes);
                work_left -= boxes as f64 / BOXES_PER_WORK;
                if level.ways.given == 0 {
                    if deadlock.dead_ends == 0 {
                        deadlock.kernel = index;
                    }
                    deadlock.dead_ends += 1;
                    deadlock.starts += level.ways.starts.max(1);
                    let gap = level.ways.gap().filter(|gap| gap.is_finite());
                    let nearest = deadlock.nearest.as_ref();
                    if let Some(gap) = gap
                        && nearest.is_none_or(|nearest| gap < nearest.gap)
                    {
                        let mut q = vec![0.0; unknowns];
                        work.at.copy_pose(&mut q);
                        let kernel = index;
                        deadlock.nearest = Some(Nearest { gap, kernel, q });
                    }
                }
                let reads = reads.get_or_insert_with(|| reads_of(work.system, kernels));
                let mut conflict = std::mem::take(&mut level.conflict);
                conflict.extend(&reads[index]);
                let Some(back) = conflict.pop_last() else {
                    deadlock.proved = !in_doubt;
                    return Err(deadlock);
                };
                if work_left < 0.0 {
                    return Err(deadlock);
                }
                levels.truncate(back + 1);
                levels[back].conflict.extend(conflict);
                levels[back].in_doubt |= in_doubt;
            }
        }
        let iterations = levels.iter().map(|level| level.iterations).max();
        self.at.copy_pose(&mut self.pose.q);
        Ok(iterations.unwrap_or(0))
    }
}

/// What one start of a kernel costs, in units of a closed form.
fn cost(kernel: &Kernel) -> f64 {
    match kernel {
        Kernel::Pinned(_) | Kernel::RrrDyad(_) | Kernel::RrpDyad(_) | Kernel::Interpolated(_) => {
            1.0
        }
        Kernel::Coupled(kernel) => (kernel.columns().len() as f64 / UNIT_OF_WORK)
            .powi(3)
            .max(1.0),
    }
}

/// The kernels that each kernel reads.
fn reads_of(system: &System, kernels: &[Kernel]) -> Vec<BTreeSet<usize>> {
    let mut finder = vec![0; system.unknowns()];
    for (index, kernel) in kernels.iter().enumerate() {
        for &column in kernel.columns() {
            finder[column] = index;
        }
    }
    let kernels = kernels.iter().enumerate();
    kernels
        .map(|(index, kernel)| {
            let mut incidence = Incidence::default();
            for &row in kernel.rows() {
                let constraint = &system.equations()[row].constraint;
                constraint.incidence(system.mechanism(), &mut incidence);
            }
            let unknowns = incidence.unknowns.iter();
            let read = unknowns.map(|&column| finder[column]);
            read.filter(|&read| read != index).collect()
        })
        .collect()
}
