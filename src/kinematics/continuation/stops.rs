//! Stops: the motion ends where a coordinate reaches a limit, or a point the end of a curve.
//!
//! The gap of a limit is g = c − min or max − c. A sub-step is *clear* of the limit if
//!
//! > min(g0, g1) − D ≥ 0
//!
//! with the gaps at its ends and a bound D of the deviation of g from the straight line between
//! them. The certificate has bounded the deviations of all unknowns from their chords, from which D
//! follows; it shrinks with the square of the sub-step. A motion that goes beyond a limit and comes
//! back within a step is noticed so, and one that comes to a limit ends there after sub-steps whose
//! ends approach it as the iterates of Newton–Raphson do.
//!
//! Gaps are known to rounding. A motion that goes beyond a limit by rounding, such as one that
//! grazes it, goes on.

use super::sub_step::SubStep;
use crate::kinematics::certificate::StepBounds;
use crate::kinematics::constraint::Clearance;
use crate::kinematics::error::Error;
use crate::kinematics::plan::compiled_mechanism::{CompiledMechanism, LimitOwner, StopRelation};
use crate::kinematics::state::State;
use crate::kinematics::stop_limit::StopLimit;

/// Gap up to which the motion is at a limit, in radians and characteristic lengths.
///
/// Some hundred roundings of a coordinate: a pose closes to a few. Halved, more poses next to a limit
/// take another sub-step to it. Doubled, the place of a stop has twice the error.
const AT_LIMIT: f64 = 64.0 * f64::EPSILON;

/// Deviation from a straight line up to which a gap runs straight over a sub-step, in the same scale.
/// Between the ends of a sub-step a motion may go beyond a limit by twice as much.
///
/// Above the rounding in the bounds of unknowns of most mechanisms, which no shorter sub-step takes
/// away. Halved, more of them have to find that rounding by trial. Doubled, a motion may graze a
/// limit twice as deep.
const STRAIGHT: f64 = 32.0 * AT_LIMIT;

/// Largest deviation that counts as rounding, in the same scale, where it shrinks more slowly than
/// the sub-step: in long chains the roundings of all bodies add up.
///
/// Some hundred times that of a chain of a thousand bodies. Halved or doubled, mechanisms of another
/// number of bodies take very short sub-steps beside a limit.
const LARGEST_ROUNDING: f64 = 1e-10;

/// Shortest sub-step towards a limit, as a part of the path: a few roundings of a place on it.
const SHORTEST: f64 = 2e-15;

/// Safety factor on the deviation at the end of the next sub-step: the bound of a shorter one need
/// not shrink quite as its square.
const SAFETY: f64 = 1.5;

/// The entry for a stop before a first sub-step: all shrinks faster.
const NOT_TRIED: [f64; 2] = [1.0, f64::INFINITY];

/// The watch over the limits of all stops along a path.
#[derive(Debug, Default)]
pub(super) struct StopWatch {
    /// The coordinates of the stops at the pose and at the end of the sub-step \[m or rad\].
    here: Vec<f64>,
    ahead: Vec<f64>,
    /// Their least and largest values at both places.
    limits_here: Vec<[f64; 2]>,
    limits_ahead: Vec<[f64; 2]>,
    /// Length of the last sub-step tried from the pose, and the deviation of each stop's coordinate
    /// over it.
    tried: Vec<[f64; 2]>,
    /// Twice the rounding in the deviations, as far as it has shown.
    rounding: Vec<f64>,
    /// The limit that the motion comes to.
    target: Option<LimitAhead>,
    /// The place on the path beyond which the next sub-step must not end.
    pub(super) most: f64,
    /// Whether the motion may go beyond stops, but not beyond the ends of curves.
    pub(super) only_curves: bool,
}

/// A limit, by the index of its stop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Limit {
    stop: usize,
    is_max: bool,
}

/// A limit beyond which the motion leads on its way.
#[derive(Clone, Copy, Debug)]
struct LimitAhead {
    limit: Limit,
    /// Bound of the deviation over a sub-step, divided by the square of its length.
    bend: f64,
}

/// The gap of a limit over a sub-step.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// The gaps at both ends.
    ends: [f64; 2],
    /// Largest deviation from the straight line between them.
    deviation: f64,
    /// Gap up to which the pose is at the limit.
    at_limit: f64,
    /// Deviation up to which the gap runs straight.
    straight: f64,
}

/// The verdict on a sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    /// It is clear of the limit.
    Clear,
    /// A sub-step of this length may be.
    Shorter(f64),
    /// The pose is at the limit, and the motion leads out.
    Reached,
}

impl Gap {
    /// Judges a sub-step of length `h`.
    fn judge(&self, h: f64) -> Verdict {
        let Self {
            ends: [before, after],
            at_limit,
            straight,
            ..
        } = *self;
        let is_shortest = h <= 1.5 * SHORTEST;
        let deviation = if is_shortest { 0.0 } else { self.deviation };
        // From beyond the limit every way back is open.
        let ends_inside = after >= before.min(-at_limit) - at_limit;
        let stays_inside = before < -straight || before.min(after) - deviation >= -2.0 * straight;
        if ends_inside && stays_inside {
            return Verdict::Clear;
        }
        let is_straight = deviation <= straight;
        if is_shortest || is_straight && before <= at_limit {
            return Verdict::Reached;
        }
        let slope = (before - after) / h;
        let part = if !deviation.is_finite() {
            0.5 * h
        } else if is_straight {
            before / slope
        } else if before <= at_limit {
            // Short enough to tell whether the motion leads out.
            0.5 * h * (straight / deviation).sqrt()
        } else {
            // Rounding shows only if the sub-step gets much shorter.
            reach(before, slope, deviation / (h * h)).min(0.7 * h)
        };
        Verdict::Shorter(part.max(SHORTEST))
    }
}

/// Returns the length of a sub-step at whose end the gap, now `gap` and closing at `slope`, is as
/// large as its deviation.
fn reach(gap: f64, slope: f64, bend: f64) -> f64 {
    let slope = slope.max(0.0);
    2.0 * gap / (slope + (slope * slope + 4.0 * SAFETY * bend * gap).sqrt())
}

impl StopWatch {
    /// Makes the storage.
    pub(super) fn new(stops: usize) -> Self {
        Self {
            here: vec![0.0; stops],
            ahead: vec![0.0; stops],
            limits_here: vec![[0.0; 2]; stops],
            limits_ahead: vec![[0.0; 2]; stops],
            tried: vec![NOT_TRIED; stops],
            rounding: vec![0.0; stops],
            target: None,
            most: f64::INFINITY,
            only_curves: false,
        }
    }

    /// Returns whether there is nothing to watch.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.here.is_empty()
    }

    /// Begins a path at the pose.
    pub(super) fn begin(&mut self, compiled: &CompiledMechanism, state: &State) {
        (self.target, self.most) = (None, f64::INFINITY);
        self.rounding.fill(0.0);
        self.look(compiled, state, &state.pose.parameters);
        self.arrive();
    }

    /// Reads all coordinates and limits at the present places of the bodies.
    fn look(&mut self, compiled: &CompiledMechanism, state: &State, parameters: &[f64]) {
        let mechanism = compiled.system.mechanism();
        for (index, watched) in compiled.stops.iter().enumerate() {
            self.ahead[index] = watched.relation.value(&state.at);
            self.limits_ahead[index] = watched.limits(mechanism, parameters);
        }
    }

    /// Makes the end of the sub-step the pose.
    fn arrive(&mut self) {
        std::mem::swap(&mut self.here, &mut self.ahead);
        std::mem::swap(&mut self.limits_here, &mut self.limits_ahead);
        self.tried.fill(NOT_TRIED);
    }

    /// Notes a deviation over a sub-step of length `h`. One that shrinks more slowly than the sub-step
    /// is rounding.
    fn note_rounding(&mut self, stop: usize, h: f64, deviation: f64, scale: f64) {
        let [length, last] = std::mem::replace(&mut self.tried[stop], [h, deviation]);
        if deviation > 1.4 * last * (h / length) && deviation <= LARGEST_ROUNDING * scale {
            self.rounding[stop] = self.rounding[stop].max(2.0 * deviation);
        }
    }

    /// Judges the sub-step from `start` to `end` of the path, at whose end the bodies are and these
    /// parameters are in force. Returns whether it is clear of all limits; otherwise
    /// [`most`](Self::most) is the end to try next.
    ///
    /// # Errors
    ///
    /// The limit that ends the motion at the pose.
    pub(super) fn check(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
        parameters: &[f64],
        bounds: &mut StepBounds,
        [start, end]: [f64; 2],
    ) -> Result<bool, Box<StopLimit>> {
        self.look(compiled, state, parameters);
        let h = end - start;
        let mut shortest = f64::INFINITY;
        for stop in 0..self.here.len() {
            let is_stop = matches!(compiled.stops[stop].owner, LimitOwner::Stop(_));
            if self.only_curves && is_stop {
                continue;
            }
            let mut sub_step = SubStep {
                compiled,
                state,
                bounds,
                part: [start, end],
            };
            let StopRelation {
                relation, columns, ..
            } = &compiled.stops[stop];
            let mechanism = compiled.system.mechanism();
            let coordinate = match compiled.stops[stop].owner {
                LimitOwner::Stop(stop) => Some(&mechanism.stops[stop].coordinate),
                LimitOwner::Curve(..) => None,
            };
            let deviation = sub_step.deviation(&**relation, columns, coordinate);
            let scale = self.scale(compiled, state, stop);
            self.note_rounding(stop, h, deviation, scale);
            for is_max in [false, true] {
                let limit = Limit { stop, is_max };
                if self.limits_here[stop][usize::from(is_max)].is_infinite() {
                    continue;
                }
                let gap = Gap {
                    ends: self.gaps(limit),
                    deviation: deviation + limit_deviation(compiled, limit, bounds),
                    at_limit: AT_LIMIT * scale,
                    straight: self.rounding[stop].max(STRAIGHT * scale),
                };
                match gap.judge(h) {
                    Verdict::Clear => {}
                    Verdict::Shorter(length) => {
                        if length < shortest {
                            shortest = length;
                            let bend = gap.deviation / (h * h);
                            let is_beyond = gap.ends[1] < 0.0 && bend.is_finite();
                            self.target = is_beyond.then_some(LimitAhead { limit, bend });
                        }
                    }
                    Verdict::Reached => return Err(self.describe(compiled, limit)),
                }
            }
        }
        if shortest < f64::INFINITY {
            self.most = start + shortest;
            return Ok(false);
        }
        Ok(true)
    }

    /// Takes the sub-step from `start` to `end`, which is clear. On the way to a limit the next one
    /// ends in front of it.
    pub(super) fn accept(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
        [start, end]: [f64; 2],
    ) {
        self.most = f64::INFINITY;
        if let Some(LimitAhead { limit, bend }) = self.target {
            let [before, now] = self.gaps(limit);
            let slope = (before - now) / (end - start);
            let at_limit = AT_LIMIT * self.scale(compiled, state, limit.stop);
            if slope > 0.0 && now > at_limit {
                self.most = end + reach(now, slope, bend).max(SHORTEST);
            } else {
                self.target = None;
            }
        }
        self.arrive();
    }

    /// Returns the gaps of a limit at the pose and at the end of the sub-step.
    fn gaps(&self, Limit { stop, is_max }: Limit) -> [f64; 2] {
        let gap =
            |value: f64, [least, most]: [f64; 2]| if is_max { most - value } else { value - least };
        [
            gap(self.here[stop], self.limits_here[stop]),
            gap(self.ahead[stop], self.limits_ahead[stop]),
        ]
    }

    /// Returns the scale factor of a stop's coordinate, which counts turns.
    fn scale(&self, compiled: &CompiledMechanism, state: &State, stop: usize) -> f64 {
        let scale = compiled.stops[stop].scale(state.at.size());
        scale.max(self.here[stop].abs())
    }

    fn describe(&self, compiled: &CompiledMechanism, limit: Limit) -> Box<StopLimit> {
        let Limit { stop, is_max } = limit;
        let value = self.limits_here[stop][usize::from(is_max)];
        compiled.stops[stop].describe(compiled.system.mechanism(), is_max, value)
    }
}

/// Bounds the deviation of a limit from its chord over the sub-step.
fn limit_deviation(compiled: &CompiledMechanism, limit: Limit, bounds: &StepBounds) -> f64 {
    let LimitOwner::Stop(stop) = compiled.stops[limit.stop].owner else {
        return 0.0;
    };
    let stop = &compiled.system.mechanism().stops[stop];
    let expression = if limit.is_max { &stop.max } else { &stop.min };
    match expression {
        Some(expression) if bounds.parameters.moving => {
            0.125 * bounds.parameters.bend_of(expression)
        }
        _ => 0.0,
    }
}

/// Checks that the pose is beyond no stop.
///
/// # Errors
///
/// [`Error::BeyondStop`] with the first stop in the file that it is beyond.
pub(in crate::kinematics) fn check_pose(
    compiled: &CompiledMechanism,
    state: &State,
) -> Result<(), Error> {
    let mechanism = compiled.system.mechanism();
    for watched in &compiled.stops {
        let value = watched.relation.value(&state.at);
        let [least, most] = watched.limits(mechanism, &state.pose.parameters);
        let any: &dyn std::any::Any = &*watched.relation;
        if let Some(clearance) = any.downcast_ref::<Clearance>()
            && clearance.is_crossed(mechanism, &state.at, &state.pose.parameters)
        {
            return Err(Error::BeyondStop {
                limit: watched.describe(mechanism, false, least),
                value: value.min(0.0),
            });
        }
        let play = 2.0 * STRAIGHT * watched.scale(state.at.size()).max(value.abs());
        for (is_max, limit, gap) in [(false, least, value - least), (true, most, most - value)] {
            if gap < -play {
                return Err(Error::BeyondStop {
                    limit: watched.describe(mechanism, is_max, limit),
                    value,
                });
            }
        }
    }
    Ok(())
}
