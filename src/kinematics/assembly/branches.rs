//! The branches of one block: the ways in which it closes behind the blocks before it.

use std::f64::consts::TAU;

use super::least_squares::LeastSquares;
use super::loops::{AllBranches, all_branches};
use super::part::{Distance, STARTS};
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::plan::{BlockBranches, BlockState, ClosureGap, SolveBlock};

/// Starts anywhere for a small block whose branches bounds do not list.
const STARTS_ANYWHERE: usize = 24;
/// Most unknowns of such a block.
const FEW_UNKNOWNS: usize = 12;
/// Largest difference of an unknown from its estimate, in radians and characteristic lengths, at
/// which a branch found from the estimates is taken for the nearest one.
const NEAR_ESTIMATE: f64 = 0.25;
/// Largest such difference of a branch where rows count turns; [`SearchEffort::AnyTurn`] has none.
const FARTHEST_BRANCH: f64 = TAU;
/// Branches whose squared distances from the estimates differ by less than this part are equally
/// far.
const EQUALLY_FAR: f64 = 1e-9;

/// The effort of the search where neither a closed form nor bounds list all branches.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum SearchEffort {
    /// Starts at and near the estimates, without bounds.
    Quick,
    /// Bounds, or starts at and near the estimates and a few anywhere; where turns are counted
    /// branches within a turn of the estimates.
    Near,
    /// As `Near`, on any turn.
    AnyTurn,
    /// Bounds, or starts at and near the estimates and this many anywhere.
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
    /// Number of branches that were promised and not found.
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
    /// The unknowns at their estimates, in the order of the part's columns.
    estimate: Vec<f64>,
    /// Whether it has so few unknowns that starts anywhere find all of its branches, as a rule.
    is_small: bool,
    effort: SearchEffort,
    /// The starts to be tried next.
    next: Option<Stage>,
    /// Whether the rows are linear, once another branch has been asked for.
    is_linear: Option<bool>,
    /// All branches found.
    found: Vec<Branch>,
    /// The branches that bounds list, once they are asked.
    all: Option<AllBranches>,
    /// Whether a branch was left out because it is some turns away.
    leaves_out: bool,
}

/// A branch that was found.
#[derive(Debug)]
struct Branch {
    /// The unknowns, in the order of the part's columns.
    unknowns: Vec<f64>,
    correction: Correction,
    distance: Distance,
    is_given: bool,
}

/// Starts that are tried together.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Newton–Raphson from the estimates.
    Newton,
    /// A minimisation from the estimates.
    Estimates,
    /// The branches that bounds list.
    Bounds,
    /// Starts near the estimates.
    Near,
    /// Starts anywhere.
    Anywhere,
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
            BlockBranches::Unlisted => {
                Source::Starts(Box::new(Starts::new(block, state, estimate, effort)))
            }
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
                if starts.leaves_out {
                    return false;
                }
                let listed = all.is_some_and(|all| all.branches.is_some());
                starts.is_linear == Some(true) || listed && self.failures == 0
            }
        }
    }

    /// Returns whether a branch was left out because it is some turns away.
    pub(super) fn leaves_out(&self) -> bool {
        matches!(&self.source, Source::Starts(starts) if starts.leaves_out)
    }

    /// Returns the branches that bounds list, if they were asked.
    pub(super) fn listed(&self) -> Option<&AllBranches> {
        match &self.source {
            Source::Starts(starts) => starts.all.as_ref(),
            _ => None,
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
                    if let Some(correction) = starts.give(state) {
                        self.given += 1;
                        return Some(correction);
                    }
                    let tried = starts.look(block, state, estimate)?;
                    self.starts += tried.starts;
                    self.failures += tried.failures;
                    continue;
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

/// The starts tried, and the failures to find a branch that was promised.
#[derive(Clone, Copy, Debug, Default)]
struct Tried {
    starts: usize,
    failures: usize,
}

impl Starts {
    fn new(
        block: &dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        effort: SearchEffort,
    ) -> Self {
        let (rows, columns) = (block.rows(), block.columns());
        let part = LeastSquares::new(state.system, rows, columns);
        Self {
            estimate: part.estimate(state, estimate),
            part,
            is_small: columns.len() <= FEW_UNKNOWNS,
            effort,
            next: Some(Stage::Newton),
            is_linear: None,
            found: Vec::new(),
            all: None,
            leaves_out: false,
        }
    }

    /// Puts the block on the nearest of the branches found that was not given yet; on none while a
    /// nearer one may be found.
    fn give(&mut self, state: &mut BlockState<'_>) -> Option<Correction> {
        let left = self.found.iter().filter(|branch| !branch.is_given);
        let nearest = left.map(|branch| branch.distance.square);
        let most = nearest.fold(f64::INFINITY, f64::min) * (1.0 + EQUALLY_FAR);
        // The one found first precedes others that are equally far.
        let mut found = self.found.iter();
        let place = found.position(|b| !b.is_given && b.distance.square <= most)?;
        let may_find_nearer = match self.next {
            Some(Stage::Newton | Stage::Estimates | Stage::Bounds) => true,
            Some(Stage::Near | Stage::Anywhere) => self.is_small,
            None => false,
        };
        let distance = self.found[place].distance.largest;
        if may_find_nearer && distance > NEAR_ESTIMATE {
            return None;
        }
        let counts = matches!(self.effort, SearchEffort::Near) && self.part.counts_turns;
        if counts && distance > FARTHEST_BRANCH && !self.is_linear(state) {
            self.leaves_out = true;
            return None;
        }
        let branch = &mut self.found[place];
        branch.is_given = true;
        self.part.write(state, &branch.unknowns);
        Some(branch.correction)
    }

    /// Looks for branches from the next starts; `None` if there are none.
    fn look(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Option<Tried> {
        let stage = self.next?;
        if !self.found.is_empty() && self.is_linear(state) {
            self.next = None;
            return Some(Tried::default());
        }
        let is_quick = matches!(self.effort, SearchEffort::Quick);
        self.next = match stage {
            Stage::Newton => Some(Stage::Estimates),
            Stage::Estimates if is_quick => Some(Stage::Near),
            Stage::Estimates => Some(Stage::Bounds),
            Stage::Near if !is_quick => Some(Stage::Anywhere),
            Stage::Bounds | Stage::Near | Stage::Anywhere => None,
        };
        let attempts = match stage {
            Stage::Newton | Stage::Estimates => 0..1,
            Stage::Bounds => return Some(self.ask_bounds(block, state, estimate)),
            Stage::Near => 1..STARTS,
            Stage::Anywhere => 0..self.starts_anywhere(),
        };
        let starts = attempts.len();
        for attempt in attempts {
            let closed = match stage {
                Stage::Newton => self.part.close_by_newton(block, state, estimate),
                Stage::Anywhere => self.part.attempt_anywhere(block, state, estimate, attempt),
                _ => self.part.attempt(block, state, estimate, attempt),
            };
            if let Ok(correction) = closed {
                self.note(state, correction);
            }
        }
        Some(Tried {
            starts,
            failures: 0,
        })
    }

    /// Looks for the branches that bounds list.
    fn ask_bounds(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Tried {
        let mut tried = Tried::default();
        let LeastSquares { rows, columns, .. } = &self.part;
        let all = all_branches(rows, columns, state, estimate);
        if all.branches.is_none() {
            self.next = Some(Stage::Near);
        }
        for unknowns in all.branches.iter().flatten() {
            self.part.write(state, unknowns);
            tried.starts += 1;
            match block.close(state, Limits::ASSEMBLY) {
                Ok(correction) => self.note(state, correction),
                Err(Rejected) => tried.failures += 1,
            }
        }
        self.all = Some(all);
        tried
    }

    /// Returns the number of starts anywhere.
    fn starts_anywhere(&self) -> usize {
        match self.effort {
            SearchEffort::Anywhere(starts) => starts,
            _ if self.is_small => STARTS_ANYWHERE,
            _ => 0,
        }
    }

    /// Notes the branch on which the block is, unless it is known.
    fn note(&mut self, state: &BlockState<'_>, correction: Correction) {
        let unknowns = self.part.read(state);
        let mut found = self.found.iter();
        if !found.any(|known| self.part.is_same(state, &known.unknowns, &unknowns)) {
            let ends = [&self.estimate[..], &unknowns];
            self.found.push(Branch {
                distance: self.part.distance(state, ends),
                unknowns,
                correction,
                is_given: false,
            });
        }
    }

    /// Returns whether the rows are linear in the unknowns, so that there is one branch at most.
    fn is_linear(&mut self, state: &BlockState<'_>) -> bool {
        *self
            .is_linear
            .get_or_insert_with(|| self.part.is_linear(state))
    }
}
