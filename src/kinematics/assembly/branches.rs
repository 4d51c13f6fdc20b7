//! The branches of one block: the ways in which it closes behind the blocks before it.

use super::least_squares::LeastSquares;
use super::loops::{AllBranches, all_branches};
use super::part::ATTEMPTS;
use crate::kinematics::block::{BlockBranches, BlockState, ClosureGap, SolveBlock};
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::newton::{Correction, Limits, Rejected};

/// The effort of the search where neither a closed form nor bounds list all branches.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum SearchEffort {
    /// Starts at and near the estimates, without bounds.
    Quick,
    /// Starts at and near the estimates, then bounds.
    Near,
    /// This many starts anywhere as well.
    Anywhere(usize),
}

/// The branches of a block, nearest the estimates first as far as that is known.
#[derive(Debug)]
pub(in crate::kinematics) struct Branches {
    source: Source,
    /// Number of branches given.
    pub(super) given: usize,
    /// Number of starts tried.
    pub(super) starts: usize,
    /// Number of starts without a branch.
    failures: usize,
}

/// The source of branches.
#[derive(Debug)]
enum Source {
    /// One branch, explicit in the unknowns found before.
    Explicit,
    /// The angles of the two branches of a dyad.
    ClosedForm([[f64; 2]; 2]),
    /// A closed form without a branch.
    Gap(ClosureGap),
    /// Minimisation and Newton–Raphson from several starts, then bounds over intervals.
    Starts(Box<Starts>),
}

/// The search for branches from several starts.
#[derive(Debug)]
struct Starts {
    part: LeastSquares,
    most: usize,
    /// Whether bounds are asked for branches that no start has found.
    bounded: bool,
    /// Whether the rows are linear, once another branch has been asked for.
    is_linear: Option<bool>,
    found: Vec<Vec<f64>>,
    /// The branches that bounds list, once the starts near the estimates are used up.
    all: Option<AllBranches>,
}

impl Branches {
    /// Prepares the branches of a block; the blocks before it are solved.
    pub(in crate::kinematics) fn new(
        block: &dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        effort: SearchEffort,
    ) -> Self {
        let source = match block.branches(state, estimate) {
            BlockBranches::One => Source::Explicit,
            BlockBranches::Two(angles) => Source::ClosedForm(angles),
            BlockBranches::None(gap) => Source::Gap(gap),
            BlockBranches::Unlisted => Source::Starts(Box::new(Starts {
                part: LeastSquares::new(state.system, block.rows(), block.columns()),
                bounded: !matches!(effort, SearchEffort::Quick),
                most: match effort {
                    SearchEffort::Quick | SearchEffort::Near => ATTEMPTS,
                    SearchEffort::Anywhere(starts) => ATTEMPTS + starts,
                },
                is_linear: None,
                found: Vec::new(),
                all: None,
            })),
        };
        Self {
            source,
            given: 0,
            starts: 0,
            failures: 0,
        }
    }

    /// Returns whether there are no others than those given, once it gives no more.
    pub(in crate::kinematics) fn is_complete(&self) -> bool {
        match &self.source {
            Source::Explicit => true,
            // A branch that a closed form promises has to be found.
            Source::ClosedForm(_) => self.failures == 0,
            Source::Gap(gap) => gap.certain,
            Source::Starts(starts) => {
                let all = starts.all.as_ref();
                let listed = all.is_some_and(|all| all.branches.is_some());
                starts.is_linear == Some(true) || listed && self.failures == 0
            }
        }
    }

    /// Returns the number of boxes into which bounds divided the angles.
    pub(super) fn boxes(&self) -> usize {
        match &self.source {
            Source::Starts(starts) => starts.all.as_ref().map_or(0, |all| all.boxes),
            _ => 0,
        }
    }

    /// Returns the gap that a closed form without a branch leaves \[m\].
    pub(super) fn gap(&self) -> Option<f64> {
        match &self.source {
            Source::Explicit | Source::Starts(_) => None,
            // The gap is within rounding.
            Source::ClosedForm(_) => Some(0.0),
            Source::Gap(gap) => Some(gap.gap),
        }
    }

    /// Puts the block on the next of its branches; `None` if there is no other.
    pub(in crate::kinematics) fn next(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Option<Correction> {
        loop {
            let attempt = self.starts;
            let corrected = match &mut self.source {
                Source::Explicit if attempt == 0 => block.close(state, Limits::ASSEMBLY),
                Source::ClosedForm(angles) if attempt < angles.len() => {
                    block.close_from(state, angles[attempt], Limits::ASSEMBLY)
                }
                Source::Explicit | Source::ClosedForm(_) | Source::Gap(_) => return None,
                Source::Starts(starts) => {
                    if self.given > 0 && starts.is_linear(state) {
                        return None;
                    }
                    if attempt == ATTEMPTS && starts.bounded {
                        starts.list_all(state, estimate);
                        // From here on a failure is one to close where a branch was promised.
                        self.failures = 0;
                    }
                    let corrected = starts.close(block, state, estimate, attempt)?;
                    if corrected.is_ok() && starts.is_known(state) {
                        self.starts += 1;
                        continue;
                    }
                    corrected
                }
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

impl Starts {
    /// Lists all branches by bounds over intervals, if the block has few enough angles.
    fn list_all(&mut self, state: &BlockState<'_>, estimate: &[f64]) {
        let problem = &self.part;
        self.all = Some(all_branches(
            &problem.rows,
            &problem.columns,
            state,
            estimate,
        ));
    }

    /// Tries to close the block from the next start; `None` if there is no other.
    fn close(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
    ) -> Option<Result<Correction, Rejected>> {
        let Some(far) = attempt.checked_sub(ATTEMPTS) else {
            return Some(self.part.attempt(block, state, estimate, attempt));
        };
        let listed = self.all.as_ref().and_then(|all| all.branches.as_ref());
        if let Some(listed) = listed {
            self.part.write(state, listed.get(far)?);
            return Some(block.close(state, Limits::ASSEMBLY));
        }
        (attempt < self.most).then(|| self.part.attempt_anywhere(block, state, estimate, far))
    }

    /// Returns whether the present branch was found before, and notes it otherwise.
    fn is_known(&mut self, state: &BlockState<'_>) -> bool {
        let unknowns = self.part.read(state);
        let mut found = self.found.iter();
        let is_known = found.any(|known| self.part.is_same(state, known, &unknowns));
        if !is_known {
            self.found.push(unknowns);
        }
        is_known
    }

    /// Returns whether the rows are linear in the unknowns, so that there is one branch at most.
    fn is_linear(&mut self, state: &BlockState<'_>) -> bool {
        let problem = &self.part;
        *self.is_linear.get_or_insert_with(|| {
            let size = state.at.size();
            let unknowns = state.system.unknowns();
            let (mut radii, mut direction) = (vec![0.0; unknowns], vec![0.0; unknowns]);
            for &column in &problem.columns {
                let scale = state.system.column_scale(column, size);
                (radii[column], direction[column]) = (scale, scale);
            }
            let region = Region::around(&radii);
            problem.rows.iter().all(|&row| {
                let constraint = &state.system.equations()[row].constraint;
                let bend = constraint.bend(state.at, &region, &direction, &mut Gradient::new());
                bend.is_some_and(|bend| bend <= 0.0)
            })
        })
    }
}
