//! The instants at which forces have corners or jump: where an argument of a function passes a point of it.
//!
//! While no argument passes such a point the motion is smooth. A step that goes beyond ends at the passage,
//! to rounding, and the next one sets out from behind it.

use crate::mechanism::Corner;

/// Distance of an argument from a point that is rounding, relative to both. Halved or doubled, a passage
/// takes as many steps; the motion up to there differs by rounding.
const POINT_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Least part of a step that a cut leaves: where an argument begins to move from rest next to a point, the
/// chord is far too steep. Halved, such a start takes fewer trials and more steps; doubled, the reverse.
const LEAST_CUT: f64 = 0.1;
/// Steps that are cut in a row before the end of the last one is taken for the instant: far more than the
/// search takes.
const MOST_CUTS: i32 = 80;
/// Passages in a row, each within [`SHORT`] of the one before, after which steps are not cut any more: a
/// force that jumps so as to turn the motion back has no solution that steps could follow. Halved or
/// doubled, the refusal of such a motion takes half or twice the time.
const MOST_PASSAGES: u32 = 50;
/// Part of the time, or of a second, between two passages in a row.
const SHORT: f64 = 1e-9;

/// The watch over the arguments of functions with corners or jumps.
#[derive(Debug, Default)]
pub(super) struct Turns {
    /// At the accepted point.
    pub(super) accepted: Vec<Corner>,
    /// Whether an argument passes a point at the end of the last step.
    pub(super) is_event: bool,
    /// Whether the value of a function jumps there.
    pub(super) jumps: bool,
    cuts: i32,
    /// Time of the last passage, and of how many in a row.
    last: (f64, u32),
}

impl Turns {
    /// Makes the storage for a number of arguments.
    pub(super) fn new(count: usize) -> Self {
        let unknown = Corner {
            argument: f64::NAN,
            nearest: [f64::NEG_INFINITY, f64::INFINITY],
            jumps: false,
        };
        Self {
            accepted: vec![unknown; count],
            ..Self::default()
        }
    }

    /// Begins at a point.
    pub(super) fn begin(&mut self) {
        (self.is_event, self.cuts) = (false, 0);
    }

    /// Accepts a point.
    pub(super) fn accept(&mut self, at: &[Corner]) {
        self.cuts = 0;
        // Before forces have been evaluated there are none.
        if at.len() == self.accepted.len() {
            self.accepted.copy_from_slice(at);
        }
    }

    /// Judges a step between two times up to a point; returns the time at which it must end, if an argument
    /// passes a point before.
    pub(super) fn judge(&mut self, [start, end]: [f64; 2], at: &[Corner]) -> Option<f64> {
        (self.is_event, self.jumps) = (false, false);
        let h = end - start;
        let is_close = start - self.last.0 <= SHORT * start.abs().max(1.0);
        if self.last.1 >= MOST_PASSAGES && is_close {
            return None;
        }
        let is_shortest = h <= 4.0 * f64::EPSILON * start.abs().max(end.abs());
        let mut first: Option<f64> = None;
        let mut passes = false;
        for (before, after) in self.accepted.iter().zip(at) {
            let sides = [(1.0, before.nearest[0]), (-1.0, before.nearest[1])];
            for (sign, point) in sides {
                let [from, to] = [before, after].map(|corner| sign * (corner.argument - point));
                if !to.is_finite() || to >= 0.0 && (sign > 0.0 || to > 0.0) {
                    continue;
                }
                let size = before.argument.abs().max(after.argument.abs());
                let slack = POINT_ROUNDING * size.max(point.abs());
                if to >= -slack || is_shortest || self.cuts >= MOST_CUTS {
                    passes = true;
                    self.jumps |= before.jumps;
                    continue;
                }
                // After cuts in a row the start counts as nearer (the Illinois method).
                let value = from.max(0.0) * 0.5_f64.powi(self.cuts);
                let aim = -0.5 * slack;
                let part = (value - aim) / (value - to);
                let time = start + h * part.max(LEAST_CUT);
                first = Some(first.map_or(time, |first: f64| first.min(time)));
            }
        }
        let Some(time) = first else {
            self.is_event = passes;
            if passes {
                let in_a_row = if is_close { self.last.1 + 1 } else { 1 };
                self.last = (end, in_a_row);
            }
            return None;
        };
        self.cuts += 1;
        let inside = |time: &f64| start < *time && *time < end;
        let cut = [time, start + 0.5 * h].into_iter().find(inside);
        if cut.is_none() {
            self.is_event = true;
        }
        cut
    }

    /// Returns an event indicator at a point, positive while an argument stays between its points: that of
    /// the lower one, then that of the upper one, of each argument.
    pub(super) fn indicator(&self, index: usize, at: &[Corner]) -> f64 {
        let (place, side) = (index / 2, index % 2);
        let (Some(before), Some(after)) = (self.accepted.get(place), at.get(place)) else {
            return 1.0;
        };
        let point = before.nearest[side];
        if !point.is_finite() {
            return 1.0;
        }
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let slack = POINT_ROUNDING * after.argument.abs().max(point.abs());
        sign * (after.argument - point) + 2.0 * slack
    }
}
