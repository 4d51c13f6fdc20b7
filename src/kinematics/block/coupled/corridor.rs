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

use super::Coupled;
use super::estimate::Passed;
use crate::kinematics::block::work::{Advance, Substep, Work};
use crate::kinematics::linear::nan_or_larger;

/// A corridor is laid where a single step has c and a norm of K of up to this.
const WORTH_A_CORRIDOR: f64 = 0.05;
/// The same for the corridor, about.
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
pub(super) struct Corridor {
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

impl Corridor {
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

impl Coupled {
    /// Whether both ends of a sub-step are in the corridor; writes its tube to `next` then.
    pub(super) fn certify_in_corridor(
        &mut self,
        work: &Work<'_>,
        substep: &mut Substep<'_>,
    ) -> bool {
        if !self.corridor.holds || !self.rests(work, substep) {
            return false;
        }
        let Self {
            block,
            proof,
            corridor,
            ..
        } = self;
        let strays = |&driver: &usize| substep.tubes.drivers[driver] > corridor.stray;
        if proof.drivers.iter().any(strays) {
            return false;
        }
        let leading = block.columns[corridor.leading];
        let from = corridor.along(substep.from[leading]);
        let to = corridor.along(work.at.coordinate(leading));
        if !(0.0..=1.0).contains(&from) || !(0.0..=1.0).contains(&to) {
            return false;
        }
        let size = work.at.size();
        let lines = block.columns.iter().zip(&corridor.start).zip(&corridor.way);
        let mut off = 0.0;
        for ((&column, start), way) in lines {
            let off_at = |value: f64, s: f64| (value - (start + s * way)).abs();
            let farther = nan_or_larger(
                off_at(substep.from[column], from),
                off_at(work.at.coordinate(column), to),
            );
            off = nan_or_larger(off, farther / work.system.column_scale(column, size));
        }
        if off > WITHIN * corridor.radius || off.is_nan() {
            return false;
        }
        let part = to - from;
        proof
            .next
            .fill(corridor.off_single + part * part * corridor.off);
        substep.tubes.checked = true;
        substep.tubes.relied_on_box = true;
        true
    }

    /// Lays a corridor from the start of a sub-step that was taken with this c and norm of K, where
    /// that is worth it. The bodies are at the end, where the block is factorised.
    pub(super) fn lay_corridor(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
        contraction: f64,
    ) {
        self.corridor.holds = false;
        let known = self.block.columns.len()..;
        for (start, &column) in self.corridor.start[known].iter_mut().zip(&self.proof.known) {
            *start = substep.from[column];
        }
        if contraction > WORTH_A_CORRIDOR
            || self.proof.drivers.len() != 1
            || !self.rests(work, substep)
        {
            return;
        }
        let proof = &mut *self.proof;
        proof.known_radii.fill(AT_REST);
        // The rounding of drivers grows on the way; what it moves does so no more than that.
        self.corridor.off_single = STRAYS * proof.next[0];
        self.corridor.stray = STRAYS * substep.tubes.drivers[proof.drivers[0]];
        let steps = (GOOD_CONTRACTION / contraction).min(MOST_STEPS);
        self.lay_line(work, substep, steps);
        let passed = self.test_line(work, substep);
        self.proof.put_back(work);
        for &column in self.block.columns.iter().chain(&self.proof.known) {
            substep.tubes.region[column] = 0.0;
            substep.tubes.chord[column] = 0.0;
        }
        if let Some(Passed { radius, next, .. }) = passed {
            (self.corridor.radius, self.corridor.off) = (radius, next);
            self.corridor.holds = true;
        }
    }

    /// Writes the line to the corridor and as chord.
    fn lay_line(&mut self, work: &Work<'_>, substep: &mut Substep<'_>, steps: f64) {
        let Self {
            block, corridor, ..
        } = self;
        let size = work.at.size();
        let way = |steps: f64, column: usize| {
            let advance = Advance {
                first: steps * substep.advance.first,
                second: steps * steps * substep.advance.second,
            };
            advance.predict(column, 0.0, work.flow)
        };
        let mut most = 0.0_f64;
        for (k, &column) in block.columns.iter().enumerate() {
            let moved = way(steps, column).abs() / work.system.column_scale(column, size);
            if moved > most {
                (most, corridor.leading) = (moved, k);
            }
        }
        let steps = steps * (LARGEST_MOVE / most).min(1.0);
        for (k, &column) in block.columns.iter().enumerate() {
            corridor.start[k] = substep.from[column];
            corridor.way[k] = way(steps, column);
            substep.tubes.chord[column] = corridor.way[k];
        }
    }

    /// How the line passes the test, if it does.
    fn test_line(&mut self, work: &mut Work<'_>, substep: &mut Substep<'_>) -> Option<Passed> {
        self.proof.slack.fill(0.0);
        self.stand_on_chord(work, substep, 1.0);
        self.evaluate_rows(work);
        let far = [self.drift(), self.farthest()];
        self.test_chord(work, substep, far, WIDE).ok()
    }

    /// Whether unknowns found before stand where they do in the corridor.
    fn rests(&self, work: &Work<'_>, substep: &Substep<'_>) -> bool {
        let size = work.at.size();
        let places = &self.corridor.start[self.block.columns.len()..];
        self.proof.known.iter().zip(places).all(|(&column, place)| {
            let ends = [substep.from[column], work.at.coordinate(column)];
            let off = ends.map(|end| (end - place).abs());
            let most = off[0].max(off[1]) + substep.tubes.radius(column);
            most <= AT_REST * work.system.column_scale(column, size)
        })
    }
}
