//! The search for the instants at which passive forces change.
//!
//! Each mode lasts while some functions of the motion are positive: the gap of a stop that nothing
//! touches, the force of one that is touched, the speed of what slides, the distance of the force of
//! friction that sticks from its limits. A step ends at the first zero of one of them, to rounding: where
//! the step would go beyond, it is taken again up to the place at which a cubic through values and rates
//! at both ends, or a secant where rates are not known, has its zero.

use super::passive::{Cause, Mode, Passive, PassiveForces};
use crate::mechanism::{Load, Mechanism};

/// Functions per passive force.
pub(super) const FUNCTIONS: usize = 2;

/// Part of a force that is its rounding: that of the equations of motion, of some bodies and joints.
pub(super) const FORCE_ROUNDING: f64 = 1024.0 * f64::EPSILON;
/// Steps that are cut in a row before the end of the last one is taken for the instant: far more than
/// the search takes.
const MOST_CUTS: i32 = 80;

/// A function of the motion that is positive while a mode lasts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Function {
    pub(super) value: f64,
    /// Its rate, unless it is a force.
    rate: Option<f64>,
    /// A value that is rounding.
    rounding: f64,
}

/// The search along a motion.
#[derive(Debug, Default)]
pub(super) struct Watch {
    /// Whether a mode ends at the accepted point.
    pub(super) is_event: bool,
    /// Steps cut in a row.
    cuts: i32,
    beyond: Option<Beyond>,
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

impl PassiveForces {
    /// Returns a function of a passive force at a point; `None` if it cannot end the mode.
    pub(super) fn function(&self, index: usize, at: &Passive, side: usize) -> Option<Function> {
        let mode = self.modes[index];
        let [value, rate] = [at.coordinate.value, at.coordinate.first()];
        let is_max = side == 1;
        let sign = if is_max { -1.0 } else { 1.0 };
        let limit = at.bounds[side];
        let force = |value: f64| Function {
            value,
            rate: None,
            rounding: at.force_rounding,
        };
        let place = |sign: f64, limit: f64| Function {
            value: sign * (value - limit),
            rate: Some(sign * rate),
            rounding: at.rounding,
        };
        let is_elastic = matches!(self.list[index].cause, Cause::Elastic(_));
        Some(match mode {
            Mode::Free if limit.is_finite() => place(sign, limit),
            Mode::AtMin | Mode::AtMax if side == 0 => force(mode.sign() * at.force),
            Mode::AtMin if is_elastic => place(-1.0, at.bounds[0]),
            Mode::AtMax if is_elastic => place(1.0, at.bounds[1]),
            Mode::LooseAtMin | Mode::LooseAtMax if side == 0 => force(-mode.sign() * at.force),
            Mode::LooseAtMin => place(-1.0, at.bounds[0]),
            Mode::LooseAtMax => place(1.0, at.bounds[1]),
            Mode::Growing | Mode::Falling if side == 0 => Function {
                value: mode.sign() * rate,
                rate: Some(mode.sign() * at.coordinate.second()),
                rounding: at.rounding,
            },
            Mode::Sticking => force(sign * (at.force - limit)),
            _ => return None,
        })
    }
}

impl Watch {
    /// Begins at a point.
    pub(super) fn begin(&mut self) {
        *self = Self::default();
    }

    /// Judges a step between two times and points. Returns the time at which it must end instead, if a
    /// mode ends before.
    pub(super) fn judge(
        &mut self,
        forces: &PassiveForces,
        [start, end]: [f64; 2],
        [from, to]: [&[Passive]; 2],
    ) -> Option<f64> {
        let h = end - start;
        let resolution = 4.0 * f64::EPSILON * start.abs().max(end.abs());
        let is_shortest = h <= resolution || self.cuts >= MOST_CUTS;
        let mut first: Option<(f64, Beyond)> = None;
        self.is_event = false;
        for index in 0..forces.list.len() * FUNCTIONS {
            let (force, side) = (index / FUNCTIONS, index % FUNCTIONS);
            let [before, after] = [from, to].map(|at| forces.function(force, &at[force], side));
            let (Some(before), Some(after)) = (before, after) else {
                continue;
            };
            let known = self.beyond.filter(|beyond| beyond.index == index);
            let slack = before.slack(&after, known.map_or(0.0, |beyond| beyond.scale));
            if after.value < -slack || before.dips(&after, h, slack) {
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
            } else if before.ends_at(&after) {
                self.is_event = true;
            }
        }
        let Some((zero, beyond)) = first else {
            self.cuts = 0;
            self.beyond = self.beyond.filter(|beyond| beyond.time > end);
            if let Some(beyond) = &mut self.beyond {
                beyond.value *= 0.5;
            }
            return None;
        };
        let inside = |time: &f64| start < *time && *time < end;
        let cut = [start + zero, start + 0.5 * h].into_iter().find(inside);
        let cut = cut.filter(|_| !is_shortest);
        if cut.is_some() {
            self.cuts += 1;
            self.beyond = Some(beyond);
        } else {
            self.is_event = true;
        }
        cut
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
        let goal = now + (time - now) * (here.value - aim) / (here.value - value);
        (now < goal && goal < time).then_some(goal)
    }
}

/// Returns the event indicators of a mechanism, each by the index of its force.
pub fn event_indicators(mechanism: &Mechanism) -> Vec<usize> {
    let forces = mechanism.forces.iter().enumerate();
    let is_elastic = |load: &Load| load.law().is_some_and(|law| law.stop.is_some());
    let passive = forces
        .filter(|(_, force)| matches!(force.load, Load::Passive { .. }) || is_elastic(&force.load));
    let indicators = passive.flat_map(|(index, _)| [index; FUNCTIONS]);
    match mechanism.has_freedoms() {
        true => indicators.collect(),
        false => Vec::new(),
    }
}

impl Function {
    /// Returns the function as an event indicator: negative beyond rounding.
    pub(super) fn indicator(&self) -> f64 {
        self.value + 2.0 * self.rounding
    }

    /// Returns how far below zero the function may be at an event.
    fn slack(&self, after: &Self, scale: f64) -> f64 {
        let rounding = self.rounding.max(after.rounding);
        match self.rate {
            Some(_) => rounding,
            None => {
                let largest = scale.max(self.value.abs()).max(after.value.abs());
                rounding.max(FORCE_ROUNDING * largest)
            }
        }
    }

    /// Returns whether the function is zero at the end of a step, and falls.
    fn ends_at(&self, after: &Self) -> bool {
        let falls = match after.rate {
            Some(rate) => rate < 0.0,
            None => after.value < self.value,
        };
        after.value <= 0.0 && falls
    }

    /// Returns the coefficients of the cubic through values and rates at both ends of a step, in powers of
    /// a part of it; those of a straight line for a force.
    fn cubic(&self, after: &Self, h: f64) -> [f64; 4] {
        let rise = after.value - self.value;
        let [Some(first), Some(last)] = [self.rate, after.rate] else {
            return [self.value, rise, 0.0, 0.0];
        };
        let (first, last) = (h * first, h * last);
        let third = first + last - 2.0 * rise;
        [self.value, first, rise - first - third, third]
    }

    /// Returns the value on the cubic at a part of a step.
    fn between(&self, after: &Self, h: f64, part: f64) -> f64 {
        let [value, first, second, third] = self.cubic(after, h);
        value + part * (first + part * (second + part * third))
    }

    /// Returns whether the function goes below zero and comes back within a step, as far as values and
    /// rates at its ends tell.
    fn dips(&self, after: &Self, h: f64, slack: f64) -> bool {
        match (self.rate, after.rate) {
            (Some(first), Some(last)) if first < 0.0 && last > 0.0 => {
                self.between(after, h, self.lowest(after, h)) < -slack
            }
            _ => false,
        }
    }

    /// Returns the part of a step at which the cubic is lowest, where it falls at first and rises at
    /// last.
    fn lowest(&self, after: &Self, h: f64) -> f64 {
        let [_, first, second, third] = self.cubic(after, h);
        let slope = |part: f64| first + part * (2.0 * second + 3.0 * part * third);
        bisect(0.0, 1.0, |part| slope(part) < 0.0)
    }

    /// Returns the time from the start of a step at which the function is a little below zero; a secant
    /// counts the value at the start with a weight.
    fn zero(&self, after: &Self, h: f64, slack: f64, weight: f64) -> f64 {
        // A bounce ends where it began, so that it gains no height.
        let aim = (-0.5 * slack).min(self.value);
        if self.rate.is_some() {
            let last = match after.value < -slack {
                true => 1.0,
                false => self.lowest(after, h),
            };
            return h * bisect(1e-6, last, |part| self.between(after, h, part) > aim);
        }
        let value = self.value * weight;
        h * (value - aim) / (value - after.value)
    }
}

/// Returns where a condition that holds at `low` and not at `high` ends.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match holds(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}
