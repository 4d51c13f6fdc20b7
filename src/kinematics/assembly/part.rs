//! The assembly of a part of the mechanism, from several starts.

use std::f64::consts::TAU;

use super::least_squares::{LeastSquares, Pull};
use crate::kinematics::constraint::{Gradient, Relation};
use crate::kinematics::linear::spread;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::plan::{BlockState, SolveBlock};
use crate::kinematics::system::System;

/// The weights r of Eq. 3.6.9, from one where the estimates count as much as the constraints to
/// one where the minimum is within the reach of Newton–Raphson.
const WEIGHTS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];
/// Minimisation steps for each weight; Newton–Raphson follows, so that none needs to converge.
const STEPS_PER_WEIGHT: usize = 20;
/// Number of starts: the estimates, and deterministic shifts of them. Estimates of zero often lie
/// on a symmetry from which no minimisation can choose a side.
pub(in crate::kinematics) const STARTS: usize = 8;
/// Minimisation steps from anywhere; a start that needs more is one of many.
const STEPS_FROM_ANYWHERE: usize = 40;
/// Points nearer than this part of the size of their part of the mechanism coincide.
const COINCIDENT: f64 = 1e-6;
/// Unknowns that differ by less than this, scaled, are the same.
const SAME_UNKNOWN: f64 = 1e-6;
/// Most unknowns of a part that is minimised from several starts.
pub(in crate::kinematics) const SMALL_PART: usize = 120;
/// Most unknowns of a part that is minimised at all.
pub(in crate::kinematics) const LARGEST_PART: usize = 300;

/// A distance between two places of a part, in radians and characteristic lengths.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kinematics) struct Distance {
    /// The sum of the squared differences of its unknowns.
    pub(in crate::kinematics) square: f64,
    /// The largest one.
    pub(in crate::kinematics) largest: f64,
}

impl LeastSquares {
    /// Returns whether these unknowns put the bodies in the same places, whole turns apart.
    pub(in crate::kinematics) fn is_same(
        &self,
        state: &BlockState<'_>,
        a: &[f64],
        b: &[f64],
    ) -> bool {
        let size = state.at.size();
        let mut columns = self.columns.iter().zip(a).zip(b);
        columns.all(|((&column, &a), &b)| is_same(state.system, size, column, a, b))
    }

    /// Returns the distance between two places, of angles with whole turns where rows count them.
    pub(in crate::kinematics) fn distance(
        &self,
        state: &BlockState<'_>,
        [a, b]: [&[f64]; 2],
    ) -> Distance {
        let (system, size) = (state.system, state.at.size());
        let mut distance = Distance::default();
        for ((&column, &a), &b) in self.columns.iter().zip(a).zip(b) {
            let off = if self.counts_turns {
                (a - b) / system.column_scale(column, size)
            } else {
                system.difference(column, size, a, b)
            };
            distance.square += off * off;
            distance.largest = distance.largest.max(off.abs());
        }
        distance
    }

    /// Returns the unknowns at their estimates. A contact is estimated for bodies that are at theirs
    /// altogether: how many of their coordinates earlier blocks have solved depends on the axes.
    pub(in crate::kinematics) fn estimate(
        &self,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Vec<f64> {
        let bodies = state.system.mechanism().bodies.len();
        let mut before = Vec::new();
        let own = self.columns.iter().map(|column| column / 3);
        for body in own.filter(|body| *body < bodies) {
            before.push((body, state.at.frames()[body]));
            for (k, &guess) in estimate[3 * body..3 * body + 3].iter().enumerate() {
                state.at.set_coordinate(3 * body + k, guess);
            }
        }
        self.start_off(state, estimate, |_| 0.0);
        let unknowns = self.read(state);
        // The first place noted of a body is the one that it had.
        for (body, place) in before.into_iter().rev() {
            state.at.frames_mut()[body] = place;
        }
        unknowns
    }

    /// Goes to the estimates, or to one of the starts near them.
    pub(in crate::kinematics) fn start(
        &self,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
    ) {
        self.start_off(state, estimate, |column| shift(attempt, column));
        self.leave_zero_distances(state);
    }

    /// Goes to the distance `off` from the estimates, scaled. Joint unknowns come last and start
    /// where it suits the bodies.
    fn start_off(&self, state: &mut BlockState<'_>, estimate: &[f64], off: impl Fn(usize) -> f64) {
        let size = state.at.size();
        for &column in &self.columns {
            let start = match state.system.estimate_joint_unknown(column, state.at) {
                Some(start) => start,
                None => estimate[column] + off(column) * state.system.column_scale(column, size),
            };
            state.at.set_coordinate(column, start);
        }
    }

    /// Moves bodies a little apart whose points coincide although their distance is held: there the
    /// row has no slope.
    fn leave_zero_distances(&self, state: &mut BlockState<'_>) {
        let size = state.at.size();
        for &row in &self.rows {
            let equation = &state.system.equations()[row];
            let constraint = &equation.constraint;
            if !matches!(Relation::of(&**constraint), Relation::Distance(_))
                || constraint.value(state.at) > COINCIDENT * equation.size(state.at)
            {
                continue;
            }
            let mut gradient = Gradient::new();
            constraint.gradient(state.at, &mut gradient);
            for (column, _) in gradient.entries() {
                if self.columns.binary_search(&column).is_ok() {
                    let off = shift(1, column) * state.system.column_scale(column, size);
                    let value = state.at.coordinate(column) + off;
                    state.at.set_coordinate(column, value);
                }
            }
        }
    }

    /// Tries to close the part, which is that of `block`, by Newton–Raphson from the estimates. One
    /// correction solves linear rows from any start, and estimates as good as that need no more; a
    /// large part is worth more corrections before a minimisation.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if this did not lead to a pose.
    pub(in crate::kinematics) fn close_by_newton(
        &self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Result<Correction, Rejected> {
        self.start(state, estimate, 0);
        let mut limits = Limits::ASSEMBLY;
        if self.columns.len() <= SMALL_PART {
            limits.iterations = 1;
        }
        block.close(state, limits)
    }

    /// Tries to assemble the part, which is that of `block`, by a minimisation from one of
    /// [`STARTS`] at and near the estimates.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if this did not lead to a pose.
    pub(in crate::kinematics) fn attempt(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
    ) -> Result<Correction, Rejected> {
        self.start(state, estimate, attempt);
        let most = if attempt == 0 {
            LARGEST_PART
        } else {
            SMALL_PART
        };
        if self.columns.len() <= most {
            self.minimise_growing(state);
        }
        block.close(state, Limits::ASSEMBLY)
    }

    /// Tries to assemble the part, which is that of `block`, from anywhere: angles all around,
    /// points within about a length of the estimates.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if this did not lead to a pose.
    pub(in crate::kinematics) fn attempt_anywhere(
        &mut self,
        block: &mut dyn SolveBlock,
        state: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
    ) -> Result<Correction, Rejected> {
        let anywhere = |column| TAU * (scattered(attempt, column) - 0.5);
        self.start_off(state, estimate, anywhere);
        self.minimise(state, None, |_| 1.0, STEPS_FROM_ANYWHERE);
        block.close(state, Limits::ASSEMBLY)
    }

    /// Minimises Eq. 3.6.9 for growing r from the present values, which count as the estimates.
    pub(in crate::kinematics) fn minimise_growing(&mut self, state: &mut BlockState<'_>) {
        let start = self.read(state);
        for weight in WEIGHTS {
            let pull = Pull {
                to: &start,
                strength: weight.recip(),
            };
            self.minimise(state, Some(pull), |_| 1.0, STEPS_PER_WEIGHT);
        }
    }
}

/// Returns whether two values of an unknown put a body in the same place, whole turns apart.
pub(in crate::kinematics) fn is_same(
    system: &System,
    size: f64,
    column: usize,
    a: f64,
    b: f64,
) -> bool {
    system.difference(column, size, a, b).abs() < SAME_UNKNOWN
}

/// Returns a number from 0 to 1 for attempt and coordinate, uniformly distributed as if at random
/// (the finalizer of SplitMix64).
fn scattered(attempt: usize, column: usize) -> f64 {
    let mut z = ((attempt as u64) << 32 | column as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// Returns the distance of a start from the estimate of coordinate k, scaled: zero at first, then
/// up to half a length or radian.
fn shift(attempt: usize, k: usize) -> f64 {
    if attempt == 0 {
        0.0
    } else {
        spread(attempt * (k + 1)) - 0.5
    }
}
