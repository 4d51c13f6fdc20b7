//! The last samples of one driver's inputs, and the rates estimated from them.

use super::rule::Source;
use crate::fmi::codec::{Codec, Unreadable};
use crate::mechanism::{Order, RateSource};

/// The inputs at one communication point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sample {
    pub(super) time: f64,
    pub(super) position: f64,
    /// Velocity in force, unless it is an estimate.
    pub(super) velocity: Option<f64>,
    /// Acceleration in force, if it is an input.
    pub(super) acceleration: Option<f64>,
}

/// The last three samples, newest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct History([Option<Sample>; 3]);

/// Ratio of two consecutive steps below which the shorter one is left out of estimates. Hosts mark
/// a jump by a step of 1e-12 s; step size controls change steps by a factor of ten at most.
const SHORT_STEP: f64 = 0.01;

impl History {
    pub(super) fn is_empty(&self) -> bool {
        self.0[0].is_none()
    }

    /// Returns the newest sample.
    pub(super) fn newest(&self) -> Option<&Sample> {
        self.0[0].as_ref()
    }

    /// Returns the change of the position between the last two samples.
    pub(super) fn last_change(&self) -> f64 {
        match self.0 {
            [Some(newest), Some(before), _] => newest.position - before.position,
            _ => 0.0,
        }
    }

    /// Adds a sample, from which a step of size `h` starts. Leaves out the earlier end of a step that
    /// is short beside the one before or after.
    pub(super) fn push(&mut self, sample: Sample, h: f64) {
        let is_short = |step: f64, neighbour: f64| step < SHORT_STEP * neighbour;
        let [newest, before, oldest] = &mut self.0;
        if let Some(last) = newest {
            let step = sample.time - last.time;
            let step_before = before.map(|before| last.time - before.time);
            let replaces = step <= 0.0 || is_short(step, step_before.unwrap_or(h));
            if !replaces {
                if oldest.is_some() || !step_before.is_some_and(|before| is_short(before, step)) {
                    *oldest = *before;
                }
                *before = *newest;
            }
        }
        *newest = Some(sample);
    }

    /// Returns first and second derivative, at the newest sample, of the polynomial through all.
    pub(super) fn estimate(&self) -> [f64; 2] {
        let slope = |a: Sample, b: Sample| (a.position - b.position) / (a.time - b.time);
        match self.0 {
            [Some(newest), Some(before), Some(oldest)] => {
                let last = slope(newest, before);
                let curvature = (last - slope(before, oldest)) / (newest.time - oldest.time);
                let velocity = last + curvature * (newest.time - before.time);
                [velocity, 2.0 * curvature]
            }
            [Some(newest), Some(before), None] => [slope(newest, before), 0.0],
            _ => [0.0; 2],
        }
    }

    /// Returns the derivatives of position, velocity and acceleration at the newest sample by one of
    /// the three inputs there. With `auto` a rate input counts as in use unless derivatives replace
    /// it: it is once it is not zero.
    pub(super) fn change(&self, rates: RateSource, sources: [Source; 2], order: Order) -> [f64; 3] {
        let unit = |of: Order| if of == order { 1.0 } else { 0.0 };
        // Estimates are linear in the positions.
        let mut by_newest = *self;
        for (index, sample) in by_newest.0.iter_mut().enumerate() {
            let position = if index == 0 {
                unit(Order::Position)
            } else {
                0.0
            };
            *sample = sample.map(|sample| Sample { position, ..sample });
        }
        let [first, second] = by_newest.estimate();
        let given = |of: Order, source: Source| match (source, rates) {
            (Source::Input, _) | (Source::Estimate | Source::Difference, RateSource::Auto) => {
                unit(of)
            }
            _ => 0.0,
        };
        let mut velocity = given(Order::Velocity, sources[0]);
        let mut acceleration = given(Order::Acceleration, sources[1]);
        if sources[0] == Source::Estimate {
            velocity += first;
        }
        match (sources, self.0) {
            ([_, Source::Estimate], _) => acceleration += second,
            ([Source::Input, Source::Difference], [Some(newest), Some(before), _]) => {
                acceleration += unit(Order::Velocity) / (newest.time - before.time);
            }
            _ => {}
        }
        [unit(Order::Position), velocity, acceleration]
    }

    /// Returns the backward difference of the last two velocities, if both are no estimates.
    pub(super) fn difference(&self) -> Option<f64> {
        let [Some(newest), Some(before), _] = self.0 else {
            return None;
        };
        Some((newest.velocity? - before.velocity?) / (newest.time - before.time))
    }

    /// Visits all fields.
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        codec.each(&mut self.0, |codec, sample| {
            codec.option(sample, Sample::default(), |codec, sample| {
                codec.each([&mut sample.time, &mut sample.position], Codec::finite)?;
                codec.each(
                    [&mut sample.velocity, &mut sample.acceleration],
                    |codec, rate| codec.option(rate, 0.0, Codec::finite),
                )
            })
        })
    }
}
