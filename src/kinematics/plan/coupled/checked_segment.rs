//! One estimate for many small steps of a large block.
//!
//! The test of [`estimate`](super::estimate) holds for any line near the motion, not only for the
//! chord of a step. A *checked segment* is a line over many steps that passed the test: it begins
//! at the start of one step and follows velocity and acceleration; A belongs to the end of that
//! step. At each place of the segment there is one root within its radius, and this root moves
//! continuously. A step with both ends within the radius keeps to the motion.
//!
//! The unknown that moves most measures the place on the segment, in place of the driver. The
//! block therefore needs a single driver, and upstream unknowns that rest.

use super::CoupledBlock;
use super::estimate::Passed;
use crate::kinematics::linear::nan_or_larger;
use crate::kinematics::plan::choices::CheckedSegment;
use crate::kinematics::plan::step::{BlockState, Extrapolation, Step};

/// Largest sum of c and the norm of K of a single step after which a segment is laid.
const WORTH_A_SEGMENT: f64 = 0.05;
/// The sum of c and the norm of K that a segment is laid for.
const GOOD_CONTRACTION: f64 = 0.25;
/// Most steps that a segment is laid for.
const MOST_STEPS: f64 = 200.0;
/// Largest move of an unknown along a segment, in radians and characteristic lengths.
const LARGEST_MOVE: f64 = 0.2;
/// Ratio of the first trial radius to the distance of the motion from the line.
const WIDE: f64 = 4.0;
/// Ratio of the deviation of a driver from its chord that later steps may have to that of the
/// first.
const LATER_DEVIATION: f64 = 2.0;
/// Part of the radius within which the ends of a step lie in the segment: the place measured on the
/// line differs a little from the driver's place.
const WITHIN: f64 = 0.5;
/// Upstream unknowns that move by less than this, in radians and characteristic lengths, count as
/// stationary: some rounding.
const AT_REST: f64 = 1e-13;

impl CheckedSegment {
    /// Makes the storage for this number of own and upstream unknowns.
    pub(super) fn new(own: usize, known: usize) -> Self {
        Self {
            start: vec![0.0; own + known],
            way: vec![0.0; own],
            ..Self::default()
        }
    }

    /// Forgets the segment.
    pub(super) fn forget(&mut self) {
        self.holds = false;
    }

    /// Returns the place on the segment, from 0 to 1, for a value of the leading unknown. A block
    /// at rest has a segment of length zero and stays at its beginning.
    fn along(&self, leading: f64) -> f64 {
        let moved = leading - self.start[self.leading];
        if moved == 0.0 {
            0.0
        } else {
            moved / self.way[self.leading]
        }
    }
}

impl CoupledBlock {
    /// Returns whether both ends of a sub-step lie in the segment. Then writes the bound of the
    /// deviation from the chord to `next`.
    pub(super) fn certify_in_segment(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
    ) -> bool {
        if !self.segment.holds || !self.rests(state, step) {
            return false;
        }
        let Self {
            equations,
            test,
            segment,
            ..
        } = self;
        let deviates = |&driver: &usize| step.bounds.drivers[driver] > segment.driver_deviation;
        if test.drivers.iter().any(deviates) {
            return false;
        }
        let leading = equations.columns[segment.leading];
        let from = segment.along(step.from[leading]);
        let to = segment.along(state.at.coordinate(leading));
        if !(0.0..=1.0).contains(&from) || !(0.0..=1.0).contains(&to) {
            return false;
        }
        let size = state.at.size();
        let lines = equations
            .columns
            .iter()
            .zip(&segment.start)
            .zip(&segment.way);
        let mut off = 0.0;
        for ((&column, start), way) in lines {
            let off_at = |value: f64, s: f64| (value - (start + s * way)).abs();
            let farther = nan_or_larger(
                off_at(step.from[column], from),
                off_at(state.at.coordinate(column), to),
            );
            off = nan_or_larger(off, farther / state.system.column_scale(column, size));
        }
        if off > WITHIN * segment.radius || off.is_nan() {
            return false;
        }
        let part = to - from;
        test.next
            .fill(segment.off_single + part * part * segment.off);
        step.bounds.checked = true;
        step.bounds.reused = true;
        true
    }

    /// Lays a segment from the start of a sub-step that passed the test with this sum of c and the
    /// norm of K, if it will serve several steps. The bodies are at the end of the sub-step, where
    /// the block is factorised.
    pub(super) fn lay_segment(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
        contraction: f64,
    ) {
        self.segment.holds = false;
        let known = self.equations.columns.len()..;
        for (start, &column) in self.segment.start[known].iter_mut().zip(&self.test.known) {
            *start = step.from[column];
        }
        if contraction > WORTH_A_SEGMENT || self.test.drivers.len() != 1 || !self.rests(state, step)
        {
            return;
        }
        let test = &mut *self.test;
        test.known_radii.fill(AT_REST);
        // The rounding of drivers grows along the path, and the unknowns follow it.
        self.segment.off_single = LATER_DEVIATION * test.next[0];
        self.segment.driver_deviation = LATER_DEVIATION * step.bounds.drivers[test.drivers[0]];
        let steps = (GOOD_CONTRACTION / contraction).min(MOST_STEPS);
        self.lay_line(state, step, steps);
        let passed = self.test_line(state, step);
        self.test.return_to_ends(state);
        self.clear_region(step);
        if let Some(Passed { radius, next, .. }) = passed {
            (self.segment.radius, self.segment.off) = (radius, next);
            self.segment.holds = true;
        }
    }

    /// Writes the line to the segment and to the chord.
    fn lay_line(&mut self, state: &BlockState<'_>, step: &mut Step<'_>, steps: f64) {
        let Self {
            equations, segment, ..
        } = self;
        let size = state.at.size();
        let way = |steps: f64, column: usize| {
            let advance = Extrapolation {
                first: steps * step.extrapolation.first,
                second: steps * steps * step.extrapolation.second,
            };
            advance.predict(column, 0.0, state.tangent)
        };
        let mut most = 0.0_f64;
        for (k, &column) in equations.columns.iter().enumerate() {
            let moved = way(steps, column).abs() / state.system.column_scale(column, size);
            if moved > most {
                (most, segment.leading) = (moved, k);
            }
        }
        let steps = steps * (LARGEST_MOVE / most).min(1.0);
        for (k, &column) in equations.columns.iter().enumerate() {
            segment.start[k] = step.from[column];
            segment.way[k] = way(steps, column);
            step.bounds.chord[column] = segment.way[k];
        }
    }

    /// Tests the line. Returns `None` if it fails.
    fn test_line(&mut self, state: &mut BlockState<'_>, step: &mut Step<'_>) -> Option<Passed> {
        self.test.slack.fill(0.0);
        self.move_to_chord(state, step, 1.0);
        self.evaluate_rows(state);
        let far = [self.drift(), self.farthest()];
        self.test_chord(state, step, far, WIDE).ok()
    }

    /// Returns whether the upstream unknowns are stationary where they were when the segment was
    /// laid.
    fn rests(&self, state: &BlockState<'_>, step: &Step<'_>) -> bool {
        let size = state.at.size();
        let places = &self.segment.start[self.equations.columns.len()..];
        self.test.known.iter().zip(places).all(|(&column, place)| {
            let ends = [step.from[column], state.at.coordinate(column)];
            let off = ends.map(|end| (end - place).abs());
            let most = off[0].max(off[1]) + step.deviation(column);
            most <= AT_REST * state.system.column_scale(column, size)
        })
    }
}
