//! The range of motion of one driver, the others being held.

use std::f64::consts::TAU;

use crate::kinematics::continuation::{PathTracker, Reason};
use crate::kinematics::model::Model;
use crate::kinematics::path::{Curve, Path, Rates};
use crate::kinematics::singular::{SingularPoint, bodies_in_line};
use crate::kinematics::state::{Pose, State};
use crate::kinematics::system::System;
use crate::mechanism::{DriverId, Jet};

/// The range of a driver from one pose, in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The end below the start.
    pub lower: End,
    /// The end above the start.
    pub upper: End,
    /// The change points passed, by the driver's value, ascending.
    pub crossings: Vec<ChangePoint>,
    /// The motion, by the driver's value, ascending; one of them is the start, unless the bounds
    /// leave it out.
    pub samples: Vec<Sample>,
    /// The least and the greatest value of each measure, located to rounding where the measure is
    /// smooth.
    pub measures: Vec<[Extreme; 2]>,
}

/// An extreme value of a measure in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Value of the measure \[m or rad\].
    pub value: f64,
    /// The driver's value there \[m or rad\].
    pub driver: f64,
}

/// The end of the range in one direction.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// None: after this many turns of the driver the mechanism is at its start again, whole turns
    /// of its bodies apart.
    Turns(u32),
    /// A singular position, located to rounding; as a rule a dead point.
    Singular(Box<SingularPoint>),
    /// A value beyond which the tracker stopped for another reason.
    Blocked {
        /// The driver's value that was reached \[m or rad\].
        value: f64,
        /// The cause of the stop.
        reason: Reason,
    },
    /// A bound of the search, or the driver's own `min` or `max`, at this value \[m or rad\].
    Bound {
        /// The driver's value that was reached \[m or rad\].
        value: f64,
    },
    /// None up to this value \[m or rad\].
    NotFound {
        /// The driver's value that was reached \[m or rad\].
        value: f64,
    },
}

/// A change point in the range of a driver.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangePoint {
    /// The driver's value \[m or rad\].
    pub value: f64,
    /// The bodies that line up.
    pub bodies: Vec<String>,
}

/// One pose in the range.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The driver's value \[m or rad\].
    pub driver: f64,
    /// The pose.
    pub pose: Pose,
    /// Scaled reciprocal condition; see [`Solver::rcond`](crate::kinematics::Solver::rcond).
    pub rcond: f64,
    /// Scaled residual; see [`Solver::residual`](crate::kinematics::Solver::residual).
    pub residual: f64,
    /// The smallest transmission angle, from 0 at a dead point to π/2 at best \[rad\]: the angle
    /// between the two links of an RRR dyad, or between a link and the normal of the line along
    /// which its end slides. `None` if the mechanism has no such pair.
    pub transmission: Option<f64>,
    /// Values of the measures \[m or rad\].
    pub measures: Vec<f64>,
}

/// The resolution and the extent of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSettings {
    /// Samples per turn of an angle. Samples of a length are two characteristic lengths of the
    /// mechanism divided by this apart, and farther beyond one length from the start.
    pub samples: u32,
    /// Most turns of an angle after which the mechanism may be at its start again.
    pub turns: u32,
    /// Largest change of a length, in characteristic lengths of its part of the mechanism.
    pub lengths: f64,
    /// Values of the driver between which the range is sought \[m or rad\]; in place of one left
    /// out the driver's own `min` or `max` bounds it, if it has one.
    pub bounds: [Option<f64>; 2],
}

impl Default for RangeSettings {
    /// Returns one sample per degree, gears of up to 64 teeth, a hundred lengths.
    fn default() -> Self {
        Self {
            samples: 360,
            turns: 64,
            lengths: 100.0,
            bounds: [None; 2],
        }
    }
}

/// A mechanism is at its start if no unknown differs by more, scaled and whole turns apart: after
/// some thousand sub-steps, and up to a thousand turns, rounding is below that.
const SAME_PLACE: f64 = 1e-9;

/// Most steps of Newton–Raphson towards an extreme; from a sample a degree away four are enough.
const NEWTON_STEPS: usize = 12;

/// Returns whether a value lies within bounds, as far as there are any.
pub(super) fn is_within(value: f64, [below, above]: [Option<f64>; 2]) -> bool {
    below.is_none_or(|below| value >= below) && above.is_none_or(|above| value <= above)
}

/// Finds the range of one driver from the present pose, with the other drivers, time and
/// parameters held. See [`Solver::range`](crate::kinematics::Solver::range).
pub(in crate::kinematics) fn range(
    model: &mut Model,
    state: &mut State,
    tracker: &mut PathTracker,
    driver: DriverId,
    settings: &RangeSettings,
) -> Range {
    let start = state.pose.clone();
    let of_driver = &model.system.mechanism().drivers[driver.index()];
    let [from, to] = settings.bounds;
    let mut explorer = Explorer {
        bounds: [from.or(of_driver.min), to.or(of_driver.max)],
        model,
        state,
        tracker,
        driver,
        settings,
        start: &start,
        crossings: Vec::new(),
    };
    let mut up = Vec::new();
    let upper = explorer.explore(1.0, &mut up);
    explorer.restore();
    let here = explorer.sample();
    let mut samples = Vec::new();
    let lower = if let End::Turns(turns) = upper {
        End::Turns(turns)
    } else {
        let lower = explorer.explore(-1.0, &mut samples);
        explorer.restore();
        lower
    };
    samples.reverse();
    samples.push(here);
    samples.extend(up);
    samples.retain(|sample| is_within(sample.driver, explorer.bounds));
    let measures = explorer.extremes(&samples);
    let mut crossings = explorer.crossings;
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
    Range {
        lower,
        upper,
        crossings,
        samples,
        measures,
    }
}

/// The exploration of a driver's range.
struct Explorer<'a> {
    model: &'a mut Model,
    state: &'a mut State,
    tracker: &'a mut PathTracker,
    driver: DriverId,
    settings: &'a RangeSettings,
    /// Values of the driver that end the range, if there are any.
    bounds: [Option<f64>; 2],
    start: &'a Pose,
    crossings: Vec<ChangePoint>,
}

impl Explorer<'_> {
    /// Moves the driver in one direction from the start, up (1) or down (−1).
    fn explore(&mut self, sign: f64, samples: &mut Vec<Sample>) -> End {
        let index = self.driver.index();
        let from = self.start.drivers[index];
        let driver = &self.model.system.mechanism().drivers[index];
        let is_angle = driver.coordinate.kind.is_angle();
        let size = self
            .model
            .system
            .driver_row(self.driver)
            .size(&self.state.at);
        let per_turn = self.settings.samples.max(1);
        let [behind, end] = if sign > 0.0 {
            self.bounds
        } else {
            let [below, above] = self.bounds;
            [above, below]
        };
        let is_beyond = |value: f64, bound: f64| sign * (value - bound) >= 0.0;
        if let Some(end) = end.filter(|end| is_beyond(from, *end)) {
            return End::Bound { value: end };
        }
        let mut count = 0_u32;
        let mut off = 0.0_f64;
        loop {
            let before = self.state.pose.drivers[index];
            count += 1;
            off = if is_angle {
                TAU * f64::from(count) / f64::from(per_turn)
            } else {
                off + 2.0 * size.max(off) / f64::from(per_turn)
            };
            let next = from + sign * off;
            // A start before the bounds: their first value is a sample of its own.
            if let Some(first) = behind.filter(|b| is_beyond(*b, before) && !is_beyond(*b, next))
                && let Some(end) = self.move_to(first, samples)
            {
                return end;
            }
            let value = end.map_or(next, |end| if is_beyond(next, end) { end } else { next });
            if let Some(end) = self.move_to(value, samples) {
                return end;
            }
            if end == Some(value) {
                return End::Bound { value };
            }
            if !is_angle {
                if off > self.settings.lengths * size {
                    return End::NotFound { value };
                }
            } else if count.is_multiple_of(per_turn) {
                let turns = count / per_turn;
                if end.is_none() && is_same_place(&self.model.system, self.state, self.start) {
                    return End::Turns(turns);
                }
                if turns >= self.settings.turns {
                    return End::NotFound { value };
                }
            }
        }
    }

    /// Moves the driver to a value and adds the pose that is reached to the samples. Returns the
    /// end of the range if it lies before the value.
    fn move_to(&mut self, value: f64, samples: &mut Vec<Sample>) -> Option<End> {
        let tracked = self.track(value);
        let crossed = self.tracker.crossed().iter();
        self.crossings.extend(crossed.map(|crossing| ChangePoint {
            value: crossing.center,
            bodies: bodies_in_line(self.model, crossing),
        }));
        samples.push(self.sample());
        Some(match tracked {
            Ok(()) => return None,
            Err(Reason::Singular(point)) => End::Singular(point),
            Err(reason) => End::Blocked {
                value: self.state.pose.drivers[self.driver.index()],
                reason,
            },
        })
    }

    /// Moves the driver to a value.
    fn track(&mut self, value: f64) -> Result<(), Reason> {
        let index = self.driver.index();
        let mut path = held_path(self.start);
        path.curves[index] = Curve::held(value, self.state.pose.drivers[index]);
        let tracked = self.tracker.track(self.model, self.state, &path, false);
        tracked.map(drop).map_err(|blocked| blocked.reason)
    }

    /// Returns the least and the greatest value of each measure: the best of the samples, then the
    /// place nearby where the derivative by the driver is zero.
    fn extremes(&mut self, samples: &[Sample]) -> Vec<[Extreme; 2]> {
        let count = if samples.is_empty() {
            0
        } else {
            self.model.measures.len()
        };
        let mut extremes = Vec::with_capacity(count);
        for measure in 0..count {
            extremes.push([1.0, -1.0].map(|sign| {
                let value = |sample: &Sample| sign * sample.measures[measure];
                let best = (0..samples.len())
                    .min_by(|a, b| value(&samples[*a]).total_cmp(&value(&samples[*b])))
                    .expect("there are samples");
                let found = Extreme {
                    value: samples[best].measures[measure],
                    driver: samples[best].driver,
                };
                let interior = best > 0 && best + 1 < samples.len();
                let refined = interior.then(|| {
                    let around = [best - 1, best + 1].map(|k| samples[k].driver);
                    self.refine(measure, sign, &samples[best], around)
                });
                let refined = refined.flatten();
                refined
                    .filter(|refined| sign * refined.value <= sign * found.value)
                    .unwrap_or(found)
            }));
        }
        self.restore();
        extremes
    }

    /// Finds the minimum (`sign` 1) or maximum (−1) of a measure between two values of the driver
    /// by Newton–Raphson on its derivative, from a sample. `None` where it is not smooth.
    fn refine(
        &mut self,
        measure: usize,
        sign: f64,
        from: &Sample,
        [low, high]: [f64; 2],
    ) -> Option<Extreme> {
        self.state.restore(self.model, &from.pose);
        let mut rates = Rates::new(self.state.pose.q.len());
        let mut at = from.driver;
        for _ in 0..NEWTON_STEPS {
            self.track(at).ok()?;
            let unit = |driver| {
                let rate = f64::from(u8::from(driver == self.driver));
                Jet::new(0.0, [rate, 0.0])
            };
            (self.state.solve_rates(self.model, unit, &mut rates)).ok()?;
            let jet = (self.state).measure(&*self.model.measures[measure], &rates);
            let next = (at - jet.first() / jet.second()).clamp(low, high);
            if next.is_nan() || sign * jet.second() <= 0.0 {
                return None;
            }
            if (next - at).abs() <= f64::EPSILON * at.abs().max(high - low) {
                return Some(Extreme {
                    value: jet.value,
                    driver: at,
                });
            }
            at = next;
        }
        None
    }

    /// Returns to the start.
    fn restore(&mut self) {
        self.state.restore(self.model, self.start);
    }

    /// Returns the present pose as a sample.
    fn sample(&mut self) -> Sample {
        Sample {
            driver: self.state.pose.drivers[self.driver.index()],
            rcond: self.state.rcond(self.model),
            residual: self.state.residual(&self.model.system),
            transmission: self.model.plan.transmission(),
            measures: (self.model.measures.iter())
                .map(|measure| measure.value(&self.state.at))
                .collect(),
            pose: self.state.pose.clone(),
        }
    }
}

/// Returns a path from a pose on which nothing moves, with all drivers as inputs.
fn held_path(pose: &Pose) -> Path {
    let drivers = pose.drivers.iter();
    Path {
        start: pose.time,
        duration: 0.0,
        from: pose.parameters.clone(),
        to: pose.parameters.clone(),
        curves: drivers.map(|&value| Curve::held(value, value)).collect(),
    }
}

/// Returns whether all bodies are where they were at a pose, whole turns apart.
fn is_same_place(system: &System, state: &State, before: &Pose) -> bool {
    let size = state.at.size();
    let unknowns = state.pose.q.iter().zip(&before.q).enumerate();
    let mut differences =
        unknowns.map(|(column, (&now, &before))| system.difference(column, size, now, before));
    differences.all(|difference| difference.abs() < SAME_PLACE)
}
