//! Observation of one driver's inputs: finds what deserves a message, each once.

use std::f64::consts::PI;

use super::history::Sample;
use super::rule::Source;
use crate::fmi::codec::{Codec, Unreadable};
use crate::mechanism::Order;

/// Observations of one driver.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Monitor {
    /// Sources of velocity and acceleration at the last communication point.
    pub(super) sources: [Source; 2],
    /// Consecutive steps in which the motion contradicted velocity and acceleration, up to
    /// [`STEPS`].
    contradictions: [u8; 2],
    /// Whether the driver has fallen by more than half a turn within one step.
    fell: bool,
}

/// A given rate that contradicts the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contradiction {
    /// Order of the rate.
    pub(super) order: Order,
    /// Mean of the given rate over the last step.
    pub(super) given: f64,
    /// Mean rate of the motion over the last step.
    pub(super) actual: f64,
}

/// Consecutive steps that make a contradiction.
const STEPS: u8 = 5;
/// Difference between given and actual change in such a step, relative to the larger one.
const DIFFERENCE: f64 = 0.5;
/// Largest change that may be rounding, relative to 1 plus the larger value.
const NO_CHANGE: f64 = 1e-9;

impl Monitor {
    /// Compares given rates with the motion from one sample to the next. Returns a contradiction
    /// once, after some consecutive steps.
    pub(super) fn compare(&mut self, before: &Sample, now: &Sample) -> Option<Contradiction> {
        let positions = [Some(before.position), Some(now.position)];
        let velocities = [before.velocity, now.velocity];
        let accelerations = [before.acceleration, now.acceleration];
        let h = now.time - before.time;
        let mut found = None;
        for (order, values, rates) in [
            (Order::Velocity, positions, velocities),
            (Order::Acceleration, velocities, accelerations),
        ] {
            let count = &mut self.contradictions[order as usize - 1];
            if *count >= STEPS {
                continue;
            }
            let ([Some(v0), Some(v1)], [Some(r0), Some(r1)]) = (values, rates) else {
                *count = 0;
                continue;
            };
            let (actual, given) = (v1 - v0, 0.5 * h * (r0 + r1));
            let largest = actual.abs().max(given.abs());
            if largest <= NO_CHANGE * (1.0 + v0.abs().max(v1.abs())) {
                continue;
            }
            let contradicts = (actual - given).abs() > DIFFERENCE * largest;
            *count = if contradicts { *count + 1 } else { 0 };
            if *count == STEPS {
                found = Some(Contradiction {
                    order,
                    given: given / h,
                    actual: actual / h,
                });
            }
        }
        found
    }

    /// Returns once whether an angle falls by more than half a turn, or rises by as much after it
    /// has fallen; `by` and `last` are its changes in this step and in the step before.
    pub(super) fn falls(&mut self, by: f64, last: f64) -> bool {
        let falls = by < -PI || by > PI && last < 0.0;
        falls && !std::mem::replace(&mut self.fell, true)
    }

    /// Returns the order and the source of each rate that comes from another one than at the last
    /// communication point.
    pub(super) fn changes(&self, sources: [Source; 2]) -> impl Iterator<Item = (Order, Source)> {
        let orders = [Order::Velocity, Order::Acceleration].into_iter();
        let changed = orders.zip(sources).zip(self.sources);
        changed.filter_map(|((order, now), before)| (now != before).then_some((order, now)))
    }

    /// Visits all fields.
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            sources,
            contradictions,
            fell,
        } = self;
        codec.each(sources, |codec, source| codec.one_of(source, &Source::ALL))?;
        let counts = [0, 1, 2, 3, 4, STEPS];
        codec.each(contradictions, |codec, count| codec.one_of(count, &counts))?;
        codec.flag(fell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(time: f64, position: f64, velocity: f64) -> Sample {
        Sample {
            time,
            position,
            velocity: Some(velocity),
            acceleration: None,
        }
    }

    /// Contradictions while a host gives `velocity(t)` for `position(t)`.
    fn contradictions(
        position: impl Fn(f64) -> f64,
        velocity: impl Fn(f64) -> f64,
        h: f64,
    ) -> Vec<Contradiction> {
        let mut monitor = Monitor::default();
        let at = |step: u32| {
            let t = h * f64::from(step);
            sample(t, position(t), velocity(t))
        };
        (0..50)
            .filter_map(|step| monitor.compare(&at(step), &at(step + 1)))
            .collect()
    }

    #[test]
    fn a_wrong_velocity_is_reported_once() {
        let found = contradictions(|t| 10.0 * t, |_| 2.0, 0.01);
        let [contradiction] = found[..] else {
            panic!("{found:?}")
        };
        assert_eq!(contradiction.order, Order::Velocity);
        assert!((contradiction.given - 2.0).abs() < 1e-12);
        assert!((contradiction.actual - 10.0).abs() < 1e-12);
    }

    /// Ten steps per period; between them the trapezoid is off by 3 %.
    #[test]
    fn a_right_velocity_is_not_reported_at_coarse_steps_and_at_rest() {
        assert_eq!(contradictions(f64::sin, f64::cos, 0.6), []);
        assert_eq!(contradictions(|_| 1.0, |_| 0.0, 0.1), []);
        // A jump of the position contradicts in one step only.
        let jump = |t: f64| t + f64::from(u8::from(t > 1.0));
        assert_eq!(contradictions(jump, |_| 1.0, 0.1), []);
    }
}
