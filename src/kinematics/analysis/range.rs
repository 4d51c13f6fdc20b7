//! The range of motion of one driver, the others being held.

use std::f64::consts::TAU;

use crate::kinematics::continuation::{PathTracker, Reason};
use crate::kinematics::model::Model;
use crate::kinematics::path::{Curve, Path};
use crate::kinematics::singular::{SingularPoint, bodies_in_line};
use crate::kinematics::state::{Pose, State};
use crate::kinematics::system::System;
use crate::mechanism::DriverId;

/// The range of a driver from one pose, in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The end below the start.
    pub lower: End,
    /// The end above the start.
    pub upper: End,
    /// The change points passed, by the driver's value, ascending.
    pub crossings: Vec<ChangePoint>,
    /// The motion, by the driver's value, ascending; one of them is the start.
    pub samples: Vec<Sample>,
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
    /// Generalized coordinates.
    pub q: Vec<f64>,
    /// Scaled reciprocal condition; see [`Solver::rcond`](crate::kinematics::Solver::rcond).
    pub rcond: f64,
    /// Scaled residual; see [`Solver::residual`](crate::kinematics::Solver::residual).
    pub residual: f64,
    /// The smallest transmission angle, from 0 at a dead point to π/2 at best \[rad\]: the angle
    /// between the two links of an RRR dyad, or between a link and the normal of the line along
    /// which its end slides. `None` if the mechanism has no such pair.
    pub transmission: Option<f64>,
}

/// The resolution and the extent of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSettings {
    /// Samples per turn of an angle. Samples of a length are two characteristic lengths of the
    /// mechanism divided by this apart, and farther beyond one length from the start.
    pub samples: u32,
    /// Most turns of an angle after which the mechanism may be at its start again.
    pub turns: u32,
    /// Largest change of a length, in characteristic lengths of the mechanism.
    pub lengths: f64,
}

impl Default for RangeSettings {
    /// Returns one sample per degree, gears of up to 64 teeth, a hundred lengths.
    fn default() -> Self {
        Self {
            samples: 360,
            turns: 64,
            lengths: 100.0,
        }
    }
}

/// A mechanism is at its start if no unknown differs by more, scaled and whole turns apart: after
/// some thousand sub-steps, and up to a thousand turns, rounding is below that.
const SAME_PLACE: f64 = 1e-9;

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
    let mut explorer = Explorer {
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
    let mut crossings = explorer.crossings;
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
    Range {
        lower,
        upper,
        crossings,
        samples,
    }
}

/// The exploration of a driver's range.
struct Explorer<'a> {
    model: &'a mut Model,
    state: &'a mut State,
    tracker: &'a mut PathTracker,
    driver: DriverId,
    settings: &'a RangeSettings,
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
        let size = self.state.at.size();
        let per_turn = self.settings.samples.max(1);
        let mut path = held_path(self.start);
        let mut count = 0_u32;
        let mut off = 0.0_f64;
        loop {
            count += 1;
            off = if is_angle {
                TAU * f64::from(count) / f64::from(per_turn)
            } else {
                off + 2.0 * size.max(off) / f64::from(per_turn)
            };
            let value = from + sign * off;
            path.curves[index] = Curve::held(value, self.state.pose.drivers[index]);
            let tracked = self.tracker.track(self.model, self.state, &path);
            let crossed = self.tracker.crossed().iter();
            self.crossings.extend(crossed.map(|crossing| ChangePoint {
                value: crossing.center,
                bodies: bodies_in_line(self.model, crossing),
            }));
            samples.push(self.sample());
            match tracked.map_err(|blocked| blocked.reason) {
                Err(Reason::Singular(point)) => return End::Singular(point),
                Err(reason) => {
                    return End::Blocked {
                        value: self.state.pose.drivers[index],
                        reason,
                    };
                }
                Ok(_) => {}
            }
            if !is_angle {
                if off > self.settings.lengths * size {
                    return End::NotFound { value };
                }
            } else if count.is_multiple_of(per_turn) {
                let turns = count / per_turn;
                if is_same_place(&self.model.system, self.state, self.start) {
                    return End::Turns(turns);
                }
                if turns >= self.settings.turns {
                    return End::NotFound { value };
                }
            }
        }
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
            q: self.state.pose.q.clone(),
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
