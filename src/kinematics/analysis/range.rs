//! The range of motion of one driver, the others being held.

use std::f64::consts::{PI, TAU};

use super::transmission::Passages;
use crate::kinematics::continuation::{PathTracker, Reason};
use crate::kinematics::newton::Limits;
use crate::kinematics::path::{DriverPath, Path, Rates};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::singular::SingularPoint;
use crate::kinematics::state::{Pose, State};
use crate::kinematics::stop_limit::StopLimit;
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
    /// The motion, by the driver's value, ascending; more where bodies move fast. One of them is the
    /// start, unless the bounds leave it out; others are the change points, and the limits that are
    /// located.
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
    /// of its bodies apart, and no nearer to a limit of a coordinate that counts turns.
    Turns(u32),
    /// A singular position, located to rounding; as a rule a dead point.
    Singular(Box<SingularPoint>),
    /// A stop, which is located to rounding.
    Stop {
        /// The driver's value there \[m or rad\].
        value: f64,
        /// The limit that ends the motion.
        limit: Box<StopLimit>,
    },
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
    /// Kind and name of the bodies and connections in `geometry`.
    pub bodies: Vec<String>,
    /// The lines that meet there, in words.
    pub geometry: String,
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
    /// The smallest transmission angle of all joints, from 0 at a dead point to π/2 at best \[rad\]:
    /// a unit force on a point of a joint loads the joint with 1/sin of it at most. Between two links
    /// it is their angle, between a link and a slide the angle of the link and the normal of the
    /// guide. `None` if the mechanism has no loop, and unless the settings ask for it.
    pub transmission: Option<f64>,
    /// Values of the measures \[m or rad\].
    pub measures: Vec<f64>,
}

/// The resolution and the extent of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSettings {
    /// Samples per turn of an angle. Samples of a length are two characteristic lengths of the
    /// mechanism divided by this apart, and farther beyond one length from the start. Where bodies
    /// move by several times as much there are more.
    pub samples: u32,
    /// Most turns of an angle after which the mechanism may be at its start again.
    pub turns: u32,
    /// Largest change of a length, in characteristic lengths of its part of the mechanism.
    pub lengths: f64,
    /// Values of the driver between which the range is sought \[m or rad\]; in place of one left
    /// out the driver's own `min` or `max` bounds it, if it has one.
    pub bounds: [Option<f64>; 2],
    /// Whether samples have their transmission angles: each takes a solution per row.
    pub transmission: bool,
}

impl Default for RangeSettings {
    /// Returns one sample per degree, gears of up to 64 teeth, a hundred lengths.
    fn default() -> Self {
        Self {
            samples: 360,
            turns: 64,
            lengths: 100.0,
            bounds: [None; 2],
            transmission: true,
        }
    }
}

/// Largest motion between two samples, in turns over the samples per turn: bodies that move as
/// much turn a little only, so that a measure has one extreme there at most.
const LARGEST_MOTION: f64 = 4.0;
/// Most halvings between two samples.
const MOST_DIVISIONS: u32 = 6;
/// Most samples between the last one and a limit.
const MOST_BEFORE_LIMIT: f64 = 64.0;
/// A change point this near to a sample, as part of the step there, is none of its own.
const AT_SAMPLE: f64 = 1e-6;
/// Most steps towards an extreme: bisection alone takes one per bit, Newton–Raphson four from a
/// sample a degree away.
const MOST_STEPS: usize = 64;

/// Returns whether a value lies within bounds, as far as there are any.
pub(super) fn is_within(value: f64, [below, above]: [Option<f64>; 2]) -> bool {
    below.is_none_or(|below| value >= below) && above.is_none_or(|above| value <= above)
}

/// Finds the range of one driver from the present pose, with the other drivers, time and
/// parameters held. See [`Solver::range`](crate::kinematics::Solver::range).
pub(in crate::kinematics) fn range(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    tracker: &mut PathTracker,
    driver: DriverId,
    settings: &RangeSettings,
) -> Range {
    let start = state.pose.clone();
    let of_driver = &compiled.system.mechanism().drivers[driver.index()];
    let [from, to] = settings.bounds;
    let mut explorer = Explorer {
        bounds: [from.or(of_driver.min), to.or(of_driver.max)],
        tracker,
        driver,
        settings,
        start: &start,
        ends_behind: false,
        passages: Passages::new(compiled),
        rates: Rates::new(start.q.len()),
        compiled,
        state,
        crossings: Vec::new(),
    };
    let mut up = Vec::new();
    let upper = explorer.explore(1.0, &mut up);
    explorer.restore();
    let here = explorer.place();
    let mut samples = Vec::new();
    let lower = match upper {
        End::Turns(turns) if !explorer.ends_behind => End::Turns(turns),
        _ => {
            let lower = explorer.explore(-1.0, &mut samples);
            explorer.restore();
            lower
        }
    };
    samples.reverse();
    samples.push(here);
    samples.extend(up);
    samples.retain(|place| is_within(place.sample.driver, explorer.bounds));
    let measures = explorer.extremes(&samples);
    let mut crossings = explorer.crossings;
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
    Range {
        lower,
        upper,
        crossings,
        samples: samples.into_iter().map(|place| place.sample).collect(),
        measures,
    }
}

/// A sample with the derivatives of the measures by the driver's value, not numbers where there are
/// none. At a limit they are those just in front of it, which have the same signs.
struct SampleWithSlopes {
    sample: Sample,
    slopes: Vec<f64>,
}

/// The exploration of a driver's range.
struct Explorer<'a> {
    compiled: &'a mut CompiledMechanism,
    state: &'a mut State,
    tracker: &'a mut PathTracker,
    driver: DriverId,
    settings: &'a RangeSettings,
    /// Values of the driver that end the range, if there are any.
    bounds: [Option<f64>; 2],
    start: &'a Pose,
    /// Whether turns the other way would come to a limit: a bound, or a stop of a coordinate that
    /// counts turns.
    ends_behind: bool,
    passages: Passages,
    rates: Rates,
    crossings: Vec<ChangePoint>,
}

impl Explorer<'_> {
    /// Moves the driver in one direction from the start, up (1) or down (−1).
    fn explore(&mut self, sign: f64, samples: &mut Vec<SampleWithSlopes>) -> End {
        let index = self.driver.index();
        let from = self.start.drivers[index];
        let driver = &self.compiled.system.mechanism().drivers[index];
        let is_angle = driver.coordinate.kind.is_angle();
        let size = self
            .compiled
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
        let at_start = self.stop_values();
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
                let system = &self.compiled.system;
                let mut turned = self.state.whole_turns_since(system, self.start);
                let is_back = end.is_none() && turned.all(|turns| turns.is_some());
                let [ends_ahead, ends_behind] = self.comes_to_stops(&at_start);
                if is_back && !ends_ahead {
                    self.ends_behind = behind.is_some() || ends_behind;
                    return End::Turns(turns);
                }
                if turns >= self.settings.turns {
                    return End::NotFound { value };
                }
            }
        }
    }

    /// Returns the coordinates of all stops \[m or rad\].
    fn stop_values(&self) -> Vec<f64> {
        let stops = self.compiled.stops.iter();
        stops
            .map(|stop| stop.relation.value(&self.state.at))
            .collect()
    }

    /// Returns whether whole turns that go on as those since `start` come to a stop, and whether whole
    /// turns the other way do: a coordinate that counts turns has its limits once only.
    fn comes_to_stops(&self, start: &[f64]) -> [bool; 2] {
        let mechanism = self.compiled.system.mechanism();
        let stops = self
            .compiled
            .stops
            .iter()
            .zip(self.stop_values())
            .zip(start);
        stops.fold([false; 2], |[ahead, behind], ((stop, now), start)| {
            let [least, most] = stop.limits(mechanism, &self.start.parameters);
            let [below, above] = [least.is_finite(), most.is_finite()];
            let gained = now - start;
            if gained.abs() < PI {
                [ahead, behind]
            } else if gained > 0.0 {
                [ahead || above, behind || below]
            } else {
                [ahead || below, behind || above]
            }
        })
    }

    /// Moves the driver to a value and adds the poses on the way to the samples. Returns the end of
    /// the range if it lies before the value.
    fn move_to(&mut self, value: f64, samples: &mut Vec<SampleWithSlopes>) -> Option<End> {
        let before = self.state.pose.clone();
        let tracked = self.track(value);
        let reached = self.state.pose.clone();
        let from = self.pass_crossings(&before, &reached, samples);
        let end = match tracked {
            Ok(()) => None,
            Err(Reason::Singular(point)) => Some(End::Singular(point)),
            Err(Reason::Stop(limit)) => Some(End::Stop {
                value: self.value_of(&reached),
                limit,
            }),
            Err(reason) => Some(End::Blocked {
                value: self.value_of(&reached),
                reason,
            }),
        };
        if let Some(End::Singular(point)) = &end {
            let limit = point.drivers[self.driver.index()];
            self.approach_limit(&from, &reached, limit, samples);
        } else {
            self.divide(&from, &reached, MOST_DIVISIONS, samples);
        }
        self.state.restore(self.compiled, &reached);
        let place = self.place();
        let limit = match &end {
            Some(End::Singular(point)) => self.place_at(point, &place),
            _ => None,
        };
        samples.push(limit.unwrap_or(place));
        end
    }

    /// Adds the change points that the last path passed, and samples in front of them. Returns the
    /// pose of the last one, or that before the path.
    fn pass_crossings(
        &mut self,
        before: &Pose,
        reached: &Pose,
        samples: &mut Vec<SampleWithSlopes>,
    ) -> Pose {
        let mut from = before.clone();
        let [start, end] = [before, reached].map(|pose| self.value_of(pose));
        for crossing in self.tracker.crossed().to_vec() {
            let mechanism = self.compiled.system.mechanism();
            let center = crossing.center;
            self.crossings.push(ChangePoint {
                value: center,
                bodies: crossing.alignment.names(mechanism),
                geometry: crossing.alignment.describe(mechanism, ""),
            });
            let off = AT_SAMPLE * (end - start).abs();
            let last = self.value_of(&from);
            if (center - last).abs() <= off || (center - end).abs() <= off {
                continue;
            }
            self.state.restore(self.compiled, &from);
            if self.track(center).is_ok() {
                let (place, pose) = (self.place(), self.state.pose.clone());
                self.divide(&from, &pose, MOST_DIVISIONS, samples);
                samples.push(place);
                from = pose;
            }
        }
        from
    }

    /// Adds samples between two poses until bodies move little from one to the next.
    fn divide(
        &mut self,
        from: &Pose,
        to: &Pose,
        halvings: u32,
        samples: &mut Vec<SampleWithSlopes>,
    ) {
        if halvings == 0 || self.motion(from, to) <= 1.0 {
            return;
        }
        self.state.restore(self.compiled, from);
        let middle = 0.5 * (self.value_of(from) + self.value_of(to));
        if self.track(middle).is_ok() {
            let (place, pose) = (self.place(), self.state.pose.clone());
            self.divide(from, &pose, halvings - 1, samples);
            samples.push(place);
            self.divide(&pose, to, halvings - 1, samples);
        }
    }

    /// Adds samples between a pose and a limit, in front of which the motion has stopped. Bodies move
    /// there as the root of the distance from the limit.
    fn approach_limit(
        &mut self,
        from: &Pose,
        stopped: &Pose,
        limit: f64,
        samples: &mut Vec<SampleWithSlopes>,
    ) {
        let parts = self
            .motion(from, stopped)
            .ceil()
            .clamp(1.0, MOST_BEFORE_LIMIT);
        let ahead = limit - self.value_of(from);
        self.state.restore(self.compiled, from);
        let mut part = 1.0;
        while part < parts {
            let left = 1.0 - part / parts;
            if self.track(limit - ahead * (left * left)).is_err() {
                break;
            }
            samples.push(self.place());
            part += 1.0;
        }
    }

    /// Returns the largest motion of an unknown from one pose to another, as part of the largest
    /// between two samples.
    fn motion(&self, from: &Pose, to: &Pose) -> f64 {
        let largest = LARGEST_MOTION * TAU / f64::from(self.settings.samples.max(1));
        let (system, size) = (&self.compiled.system, self.state.at.size());
        let unknowns = from.q.iter().zip(&to.q).enumerate();
        let moved = unknowns.map(|(column, (from, to))| {
            (to - from).abs() / (largest * system.column_scale(column, size))
        });
        moved.fold(0.0, f64::max)
    }

    fn value_of(&self, pose: &Pose) -> f64 {
        pose.drivers[self.driver.index()]
    }

    /// Returns the limit as a sample, with the slopes of the place where the motion stopped in front
    /// of it; `None` if other blocks do not close there. The pose stays.
    fn place_at(
        &mut self,
        point: &SingularPoint,
        stopped: &SampleWithSlopes,
    ) -> Option<SampleWithSlopes> {
        let mut pose = stopped.sample.pose.clone();
        pose.q.clone_from(&point.q);
        pose.drivers.clone_from(&point.drivers);
        self.state.restore(self.compiled, &pose);
        let Self {
            compiled, state, ..
        } = self;
        let mut block_state = state.block_state(&compiled.system);
        // The block itself, and those that it reads, are there.
        let is_singular = |columns: &[usize]| columns.iter().any(|&k| point.free[k] != 0.0);
        let blocks = compiled.plan.blocks.iter_mut();
        let mut others = blocks.filter(|block| !is_singular(block.columns()));
        let closed = others.all(|block| block.close(&mut block_state, Limits::STEP).is_ok());
        state.accept_bodies();
        let is_near = closed && self.motion(&stopped.sample.pose, &self.state.pose) <= 1.0;
        let place = is_near.then(|| SampleWithSlopes {
            sample: self.sample(),
            slopes: stopped.slopes.clone(),
        });
        self.state.restore(self.compiled, &stopped.sample.pose);
        place
    }

    /// Moves the driver to a value.
    fn track(&mut self, value: f64) -> Result<(), Reason> {
        let index = self.driver.index();
        let mut path = held_path(self.start);
        path.driver_paths[index] = DriverPath::held(value, self.state.pose.drivers[index]);
        let tracked = self.tracker.track(self.compiled, self.state, &path, false);
        tracked.map(drop).map_err(|blocked| blocked.reason)
    }

    /// Returns the least and the greatest value of each measure: the best of the samples, and of the
    /// places between two of them where the derivative by the driver changes its sign.
    fn extremes(&mut self, places: &[SampleWithSlopes]) -> Vec<[Extreme; 2]> {
        let count = if places.is_empty() {
            0
        } else {
            self.compiled.measures.len()
        };
        let measures =
            (0..count).map(|measure| [1.0, -1.0].map(|sign| self.extreme(measure, sign, places)));
        let extremes = measures.collect();
        self.restore();
        extremes
    }

    /// Returns the minimum (`sign` 1) or maximum (−1) of a measure.
    fn extreme(&mut self, measure: usize, sign: f64, places: &[SampleWithSlopes]) -> Extreme {
        let value = |place: &SampleWithSlopes| sign * place.sample.measures[measure];
        let mut best = (places.iter())
            .map(|place| Extreme {
                value: place.sample.measures[measure],
                driver: place.sample.driver,
            })
            .min_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)))
            .expect("there are samples");
        let pairs = places.windows(2).filter_map(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let [slope_a, slope_b] = [a, b].map(|place| sign * place.slopes[measure]);
            let way = b.sample.driver - a.sample.driver;
            // A measure that bends one way is beyond its tangents.
            let bound = (value(a) + slope_a * way).max(value(b) - slope_b * way);
            (slope_a < 0.0 && slope_b > 0.0).then_some((bound, [a, b]))
        });
        let mut pairs: Vec<_> = pairs.collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (bound, pair) in pairs {
            let rounding = 4.0 * f64::EPSILON * best.value.abs();
            if bound >= sign * best.value - rounding {
                break;
            }
            if let Some(found) = self.refine(measure, sign, pair)
                && sign * found.value < sign * best.value
            {
                best = found;
            }
        }
        best
    }

    /// Finds the minimum (`sign` 1) or maximum (−1) of a measure between two places, by
    /// Newton–Raphson on its derivative and by bisection where that leaves the interval or converges
    /// slowly.
    fn refine(
        &mut self,
        measure: usize,
        sign: f64,
        [a, b]: [&SampleWithSlopes; 2],
    ) -> Option<Extreme> {
        let [mut low, mut high] = [a, b].map(|place| place.sample.driver);
        let width = high - low;
        // At most one of them is a limit.
        let is_limit = a.sample.rcond < b.sample.rcond;
        let from = if is_limit { b } else { a };
        self.state.restore(self.compiled, &from.sample.pose);
        let mut best: Option<Extreme> = None;
        let mut at = 0.5 * (low + high);
        let mut last = [width; 2];
        for _ in 0..MOST_STEPS {
            if self.track(at).is_err() || !self.solve_rates() {
                break;
            }
            let jet = (self.state).measure(&*self.compiled.measures[measure], &self.rates);
            if best.is_none_or(|best| sign * jet.value <= sign * best.value) {
                best = Some(Extreme {
                    value: jet.value,
                    driver: at,
                });
            }
            if sign * jet.first() < 0.0 {
                low = at;
            } else {
                high = at;
            }
            let newton = at - jet.first() / jet.second();
            let is_fast = (newton - at).abs() <= 0.5 * last[0];
            let next = if is_fast && (low..=high).contains(&newton) {
                newton
            } else {
                0.5 * (low + high)
            };
            let step = (next - at).abs();
            if step <= f64::EPSILON * at.abs().max(width) {
                break;
            }
            last = [last[1], step];
            at = next;
        }
        best
    }

    /// Solves the rates for a unit rate of the driver. Returns false at a singular pose.
    fn solve_rates(&mut self) -> bool {
        let of_driver = self.driver;
        let unit = |driver| {
            let rate = f64::from(u8::from(driver == of_driver));
            Jet::new(0.0, [rate, 0.0])
        };
        let solved = self.state.solve_rates(self.compiled, unit, &mut self.rates);
        solved.is_ok()
    }

    /// Returns to the start.
    fn restore(&mut self) {
        self.state.restore(self.compiled, self.start);
    }

    /// Returns the present pose as a sample with the slopes of the measures.
    fn place(&mut self) -> SampleWithSlopes {
        let sample = self.sample();
        let has_rates = self.solve_rates();
        let slopes = (self.compiled.measures.iter()).map(|measure| {
            if has_rates {
                self.state.measure(&**measure, &self.rates).first()
            } else {
                f64::NAN
            }
        });
        SampleWithSlopes {
            slopes: slopes.collect(),
            sample,
        }
    }

    /// Returns the present pose as a sample.
    fn sample(&mut self) -> Sample {
        Sample {
            driver: self.state.pose.drivers[self.driver.index()],
            rcond: self.state.rcond(self.compiled),
            residual: self.state.residual(&self.compiled.system),
            transmission: (self.settings.transmission)
                .then(|| self.passages.smallest(self.compiled, self.state))
                .flatten(),
            measures: (self.compiled.measures.iter())
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
        driver_paths: drivers
            .map(|&value| DriverPath::held(value, value))
            .collect(),
    }
}
