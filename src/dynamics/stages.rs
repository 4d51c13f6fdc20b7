//! The stages of a step of the integrator: points between its ends, at which the equations were
//! evaluated anyway.
//!
//! They tell how far a function of the motion may be from a polynomial H through what is known of it at
//! both ends: as n derivatives agree there, the difference is near K (s (1 − s))ⁿ, with s from 0 to 1, and
//! each stage tells a K. Bernstein's coefficients of H − K (s (1 − s))ⁿ then bound the function from below.

use super::function::Function;
use super::passive::{Passive, SLOW};

/// Points that are kept: at least the stages of one step.
const MOST_STAGES: usize = 12;
/// Part of a step in which stages tell K: near the ends (s (1 − s))ⁿ is small beside the errors of the
/// first stages.
const MIDDLE: [f64; 2] = [0.2, 0.7];
/// Safety factor on K. Halved, a function that differs from H elsewhere than at the stages may dip unseen.
/// Doubled, steps beside a limit are shorter by a fifth.
const SAFETY: f64 = 2.0;
/// Noise of a function at the stages, in values that are rounding at the ends: stages are points off the
/// motion, at which rounding is that of larger accelerations.
const NOISE: f64 = 8.0;
/// Distance of two stages, as a part of the step, at which one tells how well the other fits.
const APART: f64 = 0.05;
/// Halvings of a step in the search for the least value on a polynomial.
const HALVINGS: u32 = 10;
/// Largest degree of a polynomial.
const DEGREE: usize = 6;

/// A point between the ends of a step.
#[derive(Clone, Debug)]
struct Stage {
    time: f64,
    passive: Vec<Passive>,
}

/// The last points at which the equations were evaluated.
#[derive(Debug)]
pub(super) struct Stages {
    /// The next one to be written, and all.
    next: usize,
    list: Vec<Stage>,
}

impl Stages {
    /// Makes the storage; none is kept where there are no passive forces.
    pub(super) fn new(forces: usize) -> Self {
        let stage = Stage {
            time: f64::NAN,
            passive: vec![Passive::NONE; forces],
        };
        let count = if forces > 0 { MOST_STAGES } else { 0 };
        Self {
            next: 0,
            list: vec![stage; count],
        }
    }

    /// Forgets all points.
    pub(super) fn forget(&mut self) {
        for stage in &mut self.list {
            stage.time = f64::NAN;
        }
    }

    /// Notes the passive forces at a point.
    pub(super) fn note(&mut self, time: f64, passive: &[Passive]) {
        if let Some(stage) = self.list.get_mut(self.next) {
            stage.time = time;
            stage.passive.copy_from_slice(passive);
            self.next = (self.next + 1) % MOST_STAGES;
        }
    }

    /// Returns the stages of a step between two times, each with its place s in it.
    fn between(&self, [start, end]: [f64; 2]) -> impl Iterator<Item = (f64, &Stage)> {
        let places = self.list.iter().map(move |stage| {
            let place = (stage.time - start) / (end - start);
            (place, stage)
        });
        places.filter(|(place, _)| 0.0 < *place && *place < 1.0)
    }

    /// Returns whether a function stays above zero within a step, but for some `slack` that is rounding, as
    /// far as its values at both ends and at the stages tell.
    pub(super) fn tell_clear(
        &self,
        [before, after]: [Function; 2],
        times: [f64; 2],
        slack: f64,
        value: impl Fn(&[Passive]) -> Option<f64>,
    ) -> bool {
        let h = times[1] - times[0];
        let mut noise = NOISE * slack;
        let [f, g] = [before.value, after.value];
        let values = || {
            let stages = self.between(times);
            stages.filter_map(|(place, stage)| Some((place, value(&stage.passive)?)))
        };
        let in_middle = |(place, _): &(f64, f64)| (MIDDLE[0]..MIDDLE[1]).contains(place);
        let mut bound = [0.0; DEGREE + 1];
        let degree = match [before.rates, after.rates] {
            [[Some(v), Some(a)], [Some(w), Some(b)]] => {
                let [v, w] = [v, w].map(|rate| h * rate / 5.0);
                let [a, b] = [a, b].map(|second| h * h * second / 20.0);
                let own = [f, f + v, f + 2.0 * v + a, g - 2.0 * w + b, g - w, g];
                lower(&mut bound, &own, values().filter(in_middle), noise)
            }
            [[Some(v), _], [Some(w), _]] => {
                let own = [f, f + h * v / 3.0, g - h * w / 3.0, g];
                lower(&mut bound, &own, values().filter(in_middle), noise)
            }
            // The rate of a force is not known: a stage in the middle takes its place. A dip below zero is
            // ignored if it is less than the force of a slow acceleration or, for a spring, of the depth to
            // which a gap may close unseen: sums of large forces have such noise.
            _ => {
                noise = noise.max(SLOW * before.rounding.max(after.rounding));
                let by_middle = |(one, _): &(f64, f64), (other, _): &(f64, f64)| {
                    (one - 0.5).abs().total_cmp(&(other - 0.5).abs())
                };
                let Some((place, at)) = values().min_by(by_middle) else {
                    return true;
                };
                let bend = (at - f - place * (g - f)) / (place * (1.0 - place));
                let parabola = |s: f64| f + s * (g - f) + s * (1.0 - s) * bend;
                let others = values().filter(in_middle);
                let others = others.filter(|(other, _)| (other - place).abs() > APART);
                let k = others.fold(0.0, |most: f64, (s, value)| {
                    let off = (value - parabola(s)).abs() - noise;
                    most.max(off / (s * (1.0 - s) * (s - place).abs()))
                });
                let farthest = place.max(1.0 - place);
                bound[0] = f;
                bound[1] = 0.5 * (f + g + bend - SAFETY * k * farthest);
                bound[2] = g;
                2
            }
        };
        stays_above(bound, degree, -noise.max(-2.0 * f), HALVINGS)
    }

    /// Returns whether a gap is closed, but for `slack`, at all stages of a step.
    pub(super) fn tell_closed(
        &self,
        times: [f64; 2],
        slack: f64,
        value: impl Fn(&[Passive]) -> Option<f64>,
    ) -> bool {
        let mut stages = self.between(times);
        stages.all(|(_, stage)| value(&stage.passive).is_some_and(|gap| gap.abs() <= slack))
    }
}

/// Writes the coefficients of a polynomial that a function with some values within a step is above, but for
/// `noise`, and returns its degree: of H − K (s (1 − s))ⁿ with H by its `own` coefficients.
fn lower(
    bound: &mut [f64; DEGREE + 1],
    own: &[f64],
    values: impl Iterator<Item = (f64, f64)>,
    noise: f64,
) -> usize {
    let order = own.len() / 2;
    let k = values.fold(0.0, |most: f64, (place, value)| {
        let off = (value - on_bernstein(own, place)).abs() - noise;
        most.max(off / (place * (1.0 - place)).powi(order as i32))
    });
    bound[..own.len()].copy_from_slice(own);
    let degree = own.len();
    raise(&mut bound[..=degree]);
    // (s (1 − s))ⁿ is the middle one of Bernstein's polynomials by its binomial coefficient.
    let binomial = if order == 3 { 20.0 } else { 6.0 };
    bound[order] -= SAFETY * k / binomial;
    degree
}

/// Returns the value of a polynomial by its coefficients in those of Bernstein, at most [`DEGREE`] and one.
fn on_bernstein(coefficients: &[f64], part: f64) -> f64 {
    let mut own = [0.0; DEGREE + 1];
    own[..coefficients.len()].copy_from_slice(coefficients);
    for last in (1..coefficients.len()).rev() {
        for k in 0..last {
            own[k] += part * (own[k + 1] - own[k]);
        }
    }
    own[0]
}

/// Raises the degree of a polynomial by one; its last coefficient is free before.
fn raise(coefficients: &mut [f64]) {
    let degree = coefficients.len() - 1;
    for k in (1..=degree).rev() {
        let part = k as f64 / degree as f64;
        let own = if k < degree { coefficients[k] } else { 0.0 };
        coefficients[k] = part * coefficients[k - 1] + (1.0 - part) * own;
    }
}

/// Returns whether a polynomial by its coefficients in those of Bernstein stays above a floor between 0
/// and 1, as far as some halvings tell.
fn stays_above(mut right: [f64; DEGREE + 1], degree: usize, floor: f64, halvings: u32) -> bool {
    if right[..=degree].iter().all(|value| *value >= floor) {
        return true;
    }
    if halvings == 0 || right[0] < floor || right[degree] < floor {
        return false;
    }
    let mut left = [0.0; DEGREE + 1];
    for (step, left) in left.iter_mut().enumerate().take(degree + 1) {
        *left = right[0];
        for k in 0..degree - step {
            right[k] = 0.5 * (right[k] + right[k + 1]);
        }
    }
    stays_above(left, degree, floor, halvings - 1)
        && stays_above(right, degree, floor, halvings - 1)
}
