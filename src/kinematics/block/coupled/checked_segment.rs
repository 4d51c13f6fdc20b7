//! One estimate for many small steps of a large block.
//!
//! The test of [`estimate`](super::estimate) holds for any line near the motion, not only for the
//! chord of a step that was taken. Tried along a line that goes on for many steps, from where one
//! starts to where velocity and acceleration lead, with A where that one ended, it makes a corridor: for each place on the line
//! there is one root within its radius, and that moves continuously. A step both of whose ends are
//! in the corridor keeps to the motion.
//!
//! The place on the line is told by the unknown that moves most. That stands for the driver, so
//! that there may be one only, and nothing else that moves the block.

use super::CoupledBlock;
use super::estimate::Passed;
use crate::kinematics::block::step::{BlockState, Extrapolation, Step};
use crate::kinematics::linear::nan_or_larger;

/// A corridor is laid where a single step has c and a norm of K of up to this.
const WORTH_A_CORRIDOR: f64 = 0.05;
/// The same for the segment, about.
const GOOD_CONTRACTION: f64 = 0.25;
/// The most steps that it is laid for, and the largest move of an unknown along it, in radians and
/// characteristic lengths.
const MOST_STEPS: f64 = 200.0;
const LARGEST_MOVE: f64 = 0.2;
/// Its radius at first, in parts of how far the motion may be off its line.
const WIDE: f64 = 4.0;
/// How much more a driver may stray from its chord in later steps than in the first one.
const STRAYS: f64 = 2.0;
/// Ends of steps are in it up to this part of its radius: the place on the line is not quite that
/// of the driver.
const WITHIN: f64 = 0.5;

/// What is found before rests if it keeps to its place by this, in radians and characteristic
/// lengths: some rounding.
const AT_REST: f64 = 1e-13;

/// A line along which a block is known to be regular.
#[derive(Debug, Default)]
pub(super) struct CheckedSegment {
    holds: bool,
    /// Where the block's own unknowns are at its beginning, then those found before; and what the
    /// own ones move by.
    start: Vec<f64>,
    way: Vec<f64>,
    /// Which of them moves most.
    leading: usize,
    /// The scaled radius within which there is one root.
    radius: f64,
    /// How far that is off the line, and off the chord of the step that the corridor begins with.
    off: f64,
    off_single: f64,
    /// How far the driver may be off the chord of a step.
    stray: f64,
}

impl CheckedSegment {
    pub(super) fn new(own: usize, known: usize) -> Self {
        Self {
            start: vec![0.0; own + known],
            way: vec![0.0; own],
            ..Self::default()
        }
    }

    pub(super) fn forget(&mut self) {
        self.holds = false;
    }

    /// How far along it the leading unknown is. A block at rest has a line of no length, at whose
    /// beginning it stays.
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
    /// Whether both ends of a sub-step are in the corridor; writes its bound to `next` then.
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
        let strays = |&driver: &usize| step.bounds.drivers[driver] > segment.stray;
        if test.drivers.iter().any(strays) {
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

    /// Lays a corridor from the start of a sub-step that was taken with this c and norm of K, where
    /// that is worth it. The bodies are at the end, where the block is factorised.
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
        if contraction > WORTH_A_CORRIDOR
            || self.test.drivers.len() != 1
            || !self.rests(state, step)
        {
            return;
        }
        let test = &mut *self.test;
        test.known_radii.fill(AT_REST);
        // The rounding of drivers grows on the way; what it moves does so no more than that.
        self.segment.off_single = STRAYS * test.next[0];
        self.segment.stray = STRAYS * step.bounds.drivers[test.drivers[0]];
        let steps = (GOOD_CONTRACTION / contraction).min(MOST_STEPS);
        self.lay_line(state, step, steps);
        let passed = self.test_line(state, step);
        self.test.return_to_ends(state);
        for &column in self.equations.columns.iter().chain(&self.test.known) {
            step.bounds.region[column] = 0.0;
            step.bounds.chord[column] = 0.0;
        }
        if let Some(Passed { radius, next, .. }) = passed {
            (self.segment.radius, self.segment.off) = (radius, next);
            self.segment.holds = true;
        }
    }

    /// Writes the line to the corridor and as chord.
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

    /// How the line passes the test, if it does.
    fn test_line(&mut self, state: &mut BlockState<'_>, step: &mut Step<'_>) -> Option<Passed> {
        self.test.slack.fill(0.0);
        self.move_to_chord(state, step, 1.0);
        self.evaluate_rows(state);
        let far = [self.drift(), self.farthest()];
        self.test_chord(state, step, far, WIDE).ok()
    }

    /// Whether unknowns found before stand where they do in the segment.
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
