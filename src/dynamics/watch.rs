//! The search for the instants at which passive forces change.
//!
//! Each mode lasts while some functions of the motion are positive: the gap of a stop that nothing
//! touches, the force of one that is touched, the speed of what slides, the distance of the force of
//! friction that sticks from its limits. A step ends at the first zero of one of them, to rounding: where
//! the step would go beyond, it is taken again up to the place at which a cubic through values and rates
//! at both ends, or a secant where rates are not known, has its zero.
//!
//! A step is accepted only if no function goes below zero and comes back between its ends, as far as the
//! [stages](super::stages) of the step tell. Gaps, which follow from the places of the bodies, are
//! [proved](super::gaps) to stay open also between the stages.

use super::function::FUNCTIONS;
use super::gaps::Gaps;
use super::passive::{Passive, PassiveForces};
use super::stages::Stages;
use crate::mechanism::{Force, Load, Mechanism, PassiveCause};

/// Steps that are cut in a row before the end of the last one is taken for the instant: far more than
/// the search takes.
const MOST_CUTS: i32 = 80;

/// Length of a step within which nothing is told apart, in roundings of the time: far below any flight.
const INSTANT: f64 = 64.0;

/// Ratio of the next step to one over which the function has not changed.
const LONGER: f64 = 2.0;
/// Longest step over which places that move may be the same to rounding, as a part of the time: that of
/// wheels some hundred turns from zero. Doubled or halved, an instant is known to 1e-9 of the time or half of
/// that where a function is the same over so long a step.
const STALLED: f64 = 1e-9;

/// The search along a motion.
#[derive(Debug)]
pub(super) struct Watch {
    /// The functions that end modes at the accepted point.
    pub(super) ended: Vec<usize>,
    /// Steps cut in a row.
    cuts: i32,
    /// Length of the last step on the way to a zero if the function was the same to the bit at both ends
    /// \[s\]: places have not changed in such a step, and shorter ones tell nothing.
    stall: f64,
    beyond: Option<Beyond>,
    pub(super) stages: Stages,
    pub(super) gaps: Gaps,
}

/// A function that is below zero at a time.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    index: usize,
    time: f64,
    /// Its value, halved at each step that ends before the zero (the Illinois method).
    value: f64,
    /// Its largest size on the way.
    scale: f64,
}

/// The verdict on a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// All modes last up to its end, as far as gaps are open between.
    Lasts,
    /// It must end at this time, as a mode ends before \[s\].
    Ends(f64),
    /// A mode may end between its ends: shorter steps tell.
    Unclear,
}

impl Watch {
    /// Makes the storage.
    pub(super) fn new(forces: &PassiveForces) -> Self {
        Self {
            ended: Vec::with_capacity(forces.list.len() * FUNCTIONS),
            cuts: 0,
            stall: 0.0,
            beyond: None,
            stages: Stages::new(forces.list.len()),
            gaps: Gaps::default(),
        }
    }

    /// Begins at a point.
    pub(super) fn begin(&mut self) {
        self.ended.clear();
        (self.cuts, self.stall, self.beyond) = (0, 0.0, None);
        self.stages.forget();
    }

    /// Judges a step between two times and points.
    pub(super) fn judge(
        &mut self,
        forces: &PassiveForces,
        [start, end]: [f64; 2],
        [from, to]: [&[Passive]; 2],
    ) -> Verdict {
        let h = end - start;
        let is_shortest = self.is_shortest([start, end]);
        let mut first: Option<(f64, Beyond)> = None;
        let mut is_clear = true;
        self.ended.clear();
        for index in 0..forces.list.len() * FUNCTIONS {
            let (force, side) = (index / FUNCTIONS, index % FUNCTIONS);
            let [before, after] = [from, to].map(|at| forces.function(force, &at[force], side));
            let (Some(before), Some(after)) = (before, after) else {
                // A limit that is gone at the end was passed on the way.
                is_clear &= before.is_none();
                continue;
            };
            let known = self.beyond.filter(|beyond| beyond.index == index);
            let slack = before.slack(&after, known.map_or(0.0, |beyond| beyond.scale));
            if after.value < -slack {
                // After cuts in a row the start counts as nearer (the Illinois method).
                let cuts = known.map_or(0, |_| self.cuts);
                let zero = before.zero(&after, h, slack, 0.5_f64.powi(cuts));
                if first.is_none_or(|(time, _)| zero < time) {
                    let scale = known.map_or(0.0, |beyond| beyond.scale);
                    let beyond = Beyond {
                        index,
                        time: end,
                        value: after.value,
                        scale: scale.max(before.value.abs()).max(after.value.abs()),
                    };
                    first = Some((zero, beyond));
                }
                continue;
            }
            if before.ends_at(&after) {
                self.ended.push(index);
            }
            if known.is_some() {
                // Over a longer step the function is the same as nothing moves.
                let is_short = h <= STALLED * start.abs().max(end.abs());
                let is_stalled = is_short && after.value.to_bits() == before.value.to_bits();
                self.stall = if is_stalled { h } else { 0.0 };
            }
            let value = |at: &[Passive]| {
                let function = forces.function(force, &at[force], side);
                function.map(|function| function.value)
            };
            let ends = [before, after];
            is_clear &= self.stages.tell_clear(ends, [start, end], slack, value);
        }
        if !is_clear && first.is_none() && h > INSTANT * resolution([start, end]) {
            return Verdict::Unclear;
        }
        let Some((zero, beyond)) = first else {
            return Verdict::Lasts;
        };
        let inside = |time: &f64| start < *time && *time < end;
        let zero = zero.max(LONGER * self.stall);
        let cut = [start + zero, start + 0.5 * h].into_iter().find(inside);
        match cut.filter(|_| !is_shortest) {
            Some(time) => {
                self.cuts += 1;
                self.beyond = Some(beyond);
                Verdict::Ends(time)
            }
            None => {
                self.ended.push(beyond.index);
                Verdict::Lasts
            }
        }
    }

    /// Returns whether a step may not be cut any more.
    pub(super) fn is_shortest(&self, [start, end]: [f64; 2]) -> bool {
        let h = end - start;
        // The ends of a step that is to be longer than a stall are rounded, by less than half of one.
        let is_stalled = h <= 1.5 * LONGER * self.stall;
        is_stalled || h <= resolution([start, end]) || self.cuts >= MOST_CUTS
    }

    /// Counts a step that is cut for a gap.
    pub(super) fn cut(&mut self) {
        self.ended.clear();
        self.cuts += 1;
    }

    /// Accepts a step with this end.
    pub(super) fn accept(&mut self, end: f64) {
        self.cuts = 0;
        self.beyond = self.beyond.filter(|beyond| beyond.time > end);
        if let Some(beyond) = &mut self.beyond {
            beyond.value *= 0.5;
        }
    }

    /// Returns the time at which the next step from an accepted point had better end: on the way to a
    /// zero whose other side is known.
    pub(super) fn goal(&self, forces: &PassiveForces, now: f64, at: &[Passive]) -> Option<f64> {
        let Beyond {
            index,
            time,
            value,
            scale,
        } = self.beyond?;
        let (force, side) = (index / FUNCTIONS, index % FUNCTIONS);
        let here = forces.function(force, &at[force], side)?;
        let aim = -0.5 * here.slack(&here, scale);
        let part = (here.value - aim) / (here.value - value);
        let goal = now + ((time - now) * part).max(LONGER * self.stall);
        (now < goal && goal < time).then_some(goal)
    }
}

/// Returns what the event indicators of a passive force watch, in words.
fn cause_indicators(cause: &PassiveCause) -> [&'static str; FUNCTIONS] {
    match cause {
        PassiveCause::Stop(_) | PassiveCause::Play(_) => [
            "gap above the least value while nothing touches, then the push",
            "gap below the largest value while nothing touches",
        ],
        PassiveCause::Friction(_) => [
            "speed while friction slides, force above the least that sticks",
            "force below the largest that sticks",
        ],
    }
}

/// Returns what each event indicator of a mechanism watches, in words; of a contact the least of its elements.
pub fn event_indicators(mechanism: &Mechanism) -> Vec<String> {
    if !mechanism.has_freedoms() {
        return Vec::new();
    }
    let forces = mechanism.forces.iter();
    let all = forces.clone().enumerate();
    let first = all.filter(|(index, _)| mechanism.elements_with(*index).start == *index);
    let watched = |[above, below]: [&str; FUNCTIONS], force: &Force| {
        [above, below].map(|watched| format!("`{}`: {watched}", force.name))
    };
    let passive = first.clone().filter_map(|(_, force)| match &force.load {
        Load::Passive { cause, .. } => Some(watched(cause_indicators(cause), force)),
        _ => None,
    });
    let elastic = first.filter(|(_, force)| force.load.law().is_some_and(|law| law.stop.is_some()));
    let elastic = elastic.map(|(_, force)| {
        let words = [
            "gap above the least value while nothing touches, then the force of spring and damper",
            "gap below the largest value while nothing touches, then the depth",
        ];
        watched(words, force)
    });
    let passive = passive.chain(elastic).flatten();
    let turns = forces.flat_map(|force| {
        let sides = ["above the point before", "below the point after"];
        let corners =
            (1..=force.load.corners()).flat_map(move |corner| sides.map(|side| (corner, side)));
        corners.map(|(corner, side)| {
            format!(
                "`{}`: argument {corner} of its functions {side}",
                force.name
            )
        })
    });
    passive.chain(turns).collect()
}

/// Returns the difference of two times that is rounding \[s\].
fn resolution([start, end]: [f64; 2]) -> f64 {
    4.0 * f64::EPSILON * start.abs().max(end.abs())
}
