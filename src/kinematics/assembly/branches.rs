//! The branches in which one block closes behind those before it, one after the other.

use nalgebra::DVector;

use super::least_squares::{ATTEMPTS, Part};
use super::loops::{AllBranches, all_branches};
use crate::kinematics::block::{BlockSolver, BlockState, ClosureGap, SolveBlock};
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::newton::{Correction, MAX_ASSEMBLY_ITERATIONS};

/// How hard to look for branches where neither a closed form nor bounds give them all.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum SearchEffort {
    /// At and near the estimates.
    Near,
    /// From so many places anywhere as well.
    Anywhere(usize),
}

/// The branches in which a block closes, nearest the estimates first as far as that is known.
#[derive(Debug)]
pub(in crate::kinematics) struct Branches {
    source: Source,
    /// How many it has given.
    pub(super) given: usize,
    /// From how many starts it has looked for them.
    pub(in crate::kinematics) starts: usize,
    /// How many of them led to none.
    failures: usize,
}

/// Where branches come from.
#[derive(Debug)]
enum Source {
    /// Unknowns that follow from what was found before.
    Explicit,
    /// The angles of a dyad, or that of a slide.
    ClosedForm([[f64; 2]; 2]),
    /// Minimisation and Newton–Raphson from several starts.
    Starts {
        part: Part,
        most: usize,
        /// Whether the rows are linear, once another way has been asked for.
        linear: Option<bool>,
        found: Vec<DVector<f64>>,
        /// The branches that bounds give, once the starts near the estimates are used up.
        all: Option<AllBranches>,
    },
    /// A closed form that misses: there are none.
    None(ClosureGap),
}

impl Branches {
    /// Those of a block; all that it reads is found in `work`.
    pub(in crate::kinematics) fn new(
        block: &BlockSolver,
        work: &mut BlockState<'_>,
        estimate: &[f64],
        effort: SearchEffort,
    ) -> Self {
        let found = match block {
            BlockSolver::PinnedBody(_) | BlockSolver::InterpolatedBlock(_) => Ok(Source::Explicit),
            BlockSolver::RrrDyad(dyad) => dyad.branches(work, estimate).map(Source::ClosedForm),
            BlockSolver::RrpDyad(slide) => {
                let branches = slide.branches(work, estimate);
                branches.map(|[first, second]| Source::ClosedForm([[first, 0.0], [second, 0.0]]))
            }
            BlockSolver::CoupledBlock(block) => Ok(Source::Starts {
                part: Part::new(block.rows(), block.columns()),
                linear: None,
                most: match effort {
                    SearchEffort::Near => ATTEMPTS,
                    SearchEffort::Anywhere(starts) => ATTEMPTS + starts,
                },
                found: Vec::new(),
                all: None,
            }),
        };
        Self {
            source: found.unwrap_or_else(Source::None),
            given: 0,
            starts: 0,
            failures: 0,
        }
    }

    /// Whether there are no others than those it has given, once it gives no more.
    pub(in crate::kinematics) fn is_complete(&self) -> bool {
        match &self.source {
            Source::Explicit => true,
            // What a closed form promises has to be there.
            Source::ClosedForm(_) => self.failures == 0,
            Source::Starts { linear, all, .. } => {
                let listed = all.as_ref().is_some_and(|all| all.branches.is_some());
                *linear == Some(true) || listed && self.failures == 0
            }
            Source::None(miss) => miss.certain,
        }
    }

    /// Into how many boxes angles were divided for bounds.
    pub(in crate::kinematics) fn boxes(&self) -> usize {
        match &self.source {
            Source::Starts { all: Some(all), .. } => all.boxes,
            _ => 0,
        }
    }

    /// By how much a block in closed form misses that gave no way \[m\].
    pub(super) fn gap(&self) -> Option<f64> {
        match &self.source {
            Source::Explicit | Source::Starts { .. } => None,
            // It was close enough for rounding to decide.
            Source::ClosedForm(_) => Some(0.0),
            Source::None(miss) => Some(miss.gap),
        }
    }

    /// Puts the block, in `work`, in the next of its branches; `None` if there is no other.
    pub(in crate::kinematics) fn next(
        &mut self,
        block: &mut BlockSolver,
        work: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Option<Correction> {
        loop {
            let attempt = self.starts;
            let corrected = match (&mut self.source, &mut *block) {
                (Source::Explicit, block) if attempt == 0 => {
                    block.close(work, MAX_ASSEMBLY_ITERATIONS)
                }
                (Source::ClosedForm(branches), BlockSolver::RrrDyad(block))
                    if attempt < branches.len() =>
                {
                    block.close_from(work, branches[attempt], MAX_ASSEMBLY_ITERATIONS)
                }
                (Source::ClosedForm(branches), BlockSolver::RrpDyad(block))
                    if attempt < branches.len() =>
                {
                    block.close_from(work, branches[attempt][0], MAX_ASSEMBLY_ITERATIONS)
                }
                (
                    Source::Starts {
                        part,
                        most,
                        linear,
                        found,
                        all,
                    },
                    BlockSolver::CoupledBlock(block),
                ) => {
                    if self.given > 0
                        && *linear
                            .get_or_insert_with(|| is_linear(block.rows(), block.columns(), work))
                    {
                        return None;
                    }
                    let far = attempt.checked_sub(ATTEMPTS);
                    if far.is_some() && all.is_none() {
                        let (rows, columns) = (&part.rows, part.columns());
                        *all = Some(all_branches(rows, columns, work, estimate));
                        // From here on a failure is one to close where a way was promised.
                        self.failures = 0;
                    }
                    let listed = all.as_ref().and_then(|all| all.branches.as_ref());
                    let mut correct = |work: &mut BlockState<'_>, most| block.close(work, most);
                    let corrected = match (far, listed) {
                        (None, _) => part.attempt(work, estimate, attempt, correct),
                        (Some(far), Some(listed)) => {
                            let way = listed.get(far)?;
                            part.write(work, &DVector::from_column_slice(way));
                            correct(work, MAX_ASSEMBLY_ITERATIONS)
                        }
                        (Some(far), None) if attempt < *most => {
                            part.attempt_anywhere(work, estimate, far, correct)
                        }
                        _ => return None,
                    };
                    if corrected.is_ok() {
                        let unknowns = part.read(work);
                        if found
                            .iter()
                            .any(|known| part.is_same(work, known, &unknowns))
                        {
                            self.starts += 1;
                            continue;
                        }
                        found.push(unknowns);
                    }
                    corrected
                }
                _ => return None,
            };
            self.starts += 1;
            match corrected {
                Ok(correction) => {
                    self.given += 1;
                    return Some(correction);
                }
                Err(_) => self.failures += 1,
            }
        }
    }
}

/// Whether the rows are linear in the unknowns, so that there is one way at the most.
fn is_linear(rows: &[usize], columns: &[usize], work: &BlockState<'_>) -> bool {
    let size = work.at.size();
    let unknowns = work.system.unknowns();
    let (mut radii, mut direction) = (vec![0.0; unknowns], vec![0.0; unknowns]);
    for &column in columns {
        let scale = work.system.column_scale(column, size);
        (radii[column], direction[column]) = (scale, scale);
    }
    let region = Region { radii: &radii };
    rows.iter().all(|&row| {
        let constraint = &work.system.equations()[row].constraint;
        let bend = constraint.bend(work.at, &region, &direction, &mut Gradient::new());
        bend.is_some_and(|bend| bend <= 0.0)
    })
}
