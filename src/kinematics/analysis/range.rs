//! The range of motion of one driver, the others being held.

use std::f64::consts::TAU;

use crate::kinematics::Reason;
use crate::kinematics::singular::SingularPoint;
use crate::kinematics::solver::{Pose, Solver};
use crate::kinematics::{Curve, Path};
use crate::mechanism::{CoordinateKind, DriverId};

/// How far a driver moves a mechanism either way from one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The way down from the start.
    pub lower: End,
    /// The way up.
    pub upper: End,
    /// The change points passed, by the driver's value, ascending.
    pub crossings: Vec<ChangePoint>,
    /// The motion, by the driver's value, ascending; one of them is the start.
    pub samples: Vec<Sample>,
}

/// How the way of a driver in one direction ends.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// It does not: after this many turns of the driver the mechanism is where it was, whole
    /// turns of its bodies apart.
    Turns(u32),
    /// At a singular position, located to rounding; as a rule a dead point.
    Singular(Box<SingularPoint>),
    /// At a value beyond which the motion could not be followed, for another reason.
    Blocked {
        /// The driver's value that was reached \[m or rad\].
        value: f64,
        /// What is in the way.
        reason: Reason,
    },
    /// It was followed to this value and was not blocked \[m or rad\].
    NotFound {
        /// The driver's value that was reached \[m or rad\].
        value: f64,
    },
}

/// A change point on the way of a driver.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangePoint {
    /// The driver's value \[m or rad\].
    pub value: f64,
    /// The bodies that line up.
    pub bodies: Vec<String>,
}

/// One pose on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The driver's value \[m or rad\].
    pub driver: f64,
    /// Generalized coordinates.
    pub q: Vec<f64>,
    /// Scaled reciprocal condition, as [`Solver::rcond`] has it.
    pub rcond: f64,
    /// Scaled residual, as [`Solver::residual`] has it.
    pub residual: f64,
    /// The smallest transmission angle, from 0 at a dead point to π/2 at best \[rad\]: that between
    /// the two links of a dyad of revolutes, or between a link and the normal of the line along
    /// which its end slides. `None` if the mechanism has no such pair.
    pub transmission: Option<f64>,
}

/// How closely and how far a range is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSettings {
    /// Samples a turn of an angle. Those of a length are as far apart as two characteristic
    /// lengths of the mechanism divided by this, and farther when it has gone farther.
    pub samples: u32,
    /// The most turns of an angle that the mechanism may take to come back to where it was.
    pub turns: u32,
    /// How far a length is followed, in characteristic lengths of the mechanism.
    pub lengths: f64,
}

impl Default for RangeSettings {
    /// One sample a degree, gears of up to 64 teeth, a hundred lengths.
    fn default() -> Self {
        Self {
            samples: 360,
            turns: 64,
            lengths: 100.0,
        }
    }
}

/// A mechanism is where it was if no unknown is further off, scaled and whole turns apart: after
/// some thousand sub-steps, and up to a thousand turns, rounding is below that.
const SAME_PLACE: f64 = 1e-9;

impl Solver {
    /// Follows one driver up and down from the present pose, the other drivers, time and
    /// parameters being held, until it is blocked, has turned the mechanism to where it was, or
    /// has gone far enough. A prescribed motion is taken for a driver that can be set. Leaves the
    /// mechanism where it was.
    ///
    /// # Panics
    ///
    /// If the driver is none of the mechanism's.
    pub fn range(&mut self, driver: DriverId, settings: &RangeSettings) -> Range {
        let start = self.pose().clone();
        let from = start.drivers[driver.index()];
        let mut crossings = Vec::new();
        let mut up = Vec::new();
        let upper = self.explore(driver, 1.0, settings, &mut up, &mut crossings);
        self.restore(&start);
        let here = self.sample(from);
        let mut samples = Vec::new();
        let lower = if let End::Turns(turns) = upper {
            End::Turns(turns)
        } else {
            let lower = self.explore(driver, -1.0, settings, &mut samples, &mut crossings);
            self.restore(&start);
            lower
        };
        samples.reverse();
        samples.push(here);
        samples.extend(up);
        crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
        Range {
            lower,
            upper,
            crossings,
            samples,
        }
    }

    /// One way, away from the start.
    fn explore(
        &mut self,
        driver: DriverId,
        sign: f64,
        settings: &RangeSettings,
        samples: &mut Vec<Sample>,
        crossings: &mut Vec<ChangePoint>,
    ) -> End {
        let start = self.pose().clone();
        let from = start.drivers[driver.index()];
        let kind = self.mechanism().drivers[driver.index()].coordinate.kind;
        let size = self.at.size();
        let per_turn = settings.samples.max(1);
        let mut path = self.held_path();
        let mut count = 0_u32;
        let mut off = 0.0_f64;
        loop {
            count += 1;
            off = if kind == CoordinateKind::Angle {
                TAU * f64::from(count) / f64::from(per_turn)
            } else {
                // Further away it is looked at less closely.
                off + 2.0 * size.max(off) / f64::from(per_turn)
            };
            let value = from + sign * off;
            let now = self.pose().drivers[driver.index()];
            path.curves[driver.index()] = Curve::Input {
                position: value,
                velocity: 0.0,
                acceleration: 0.0,
                jump: now - value,
            };
            let followed = self.follow(&path);
            crossings.extend(self.crossed().iter().map(|crossing| ChangePoint {
                value: crossing.center,
                bodies: self.bodies_in_line(crossing),
            }));
            let reached = self.pose().drivers[driver.index()];
            samples.push(self.sample(reached));
            match followed.map_err(|blocked| blocked.reason) {
                Err(Reason::Singular(point)) => return End::Singular(point),
                Err(reason) => {
                    return End::Blocked {
                        value: reached,
                        reason,
                    };
                }
                Ok(_) => {}
            }
            if kind != CoordinateKind::Angle {
                if off > settings.lengths * size {
                    return End::NotFound { value };
                }
            } else if count.is_multiple_of(per_turn) {
                let turns = count / per_turn;
                if self.is_where_it_was(&start) {
                    return End::Turns(turns);
                }
                if turns >= settings.turns {
                    return End::NotFound { value };
                }
            }
        }
    }

    /// A path from the pose on which nothing moves yet, all drivers taken for inputs.
    pub(in crate::kinematics) fn held_path(&self) -> Path {
        let pose = self.pose();
        Path {
            start: pose.time,
            duration: 0.0,
            from: pose.parameters.clone(),
            to: pose.parameters.clone(),
            curves: pose
                .drivers
                .iter()
                .map(|&position| Curve::Input {
                    position,
                    velocity: 0.0,
                    acceleration: 0.0,
                    jump: 0.0,
                })
                .collect(),
        }
    }

    /// Whether all bodies are where they were at a pose, whole turns apart.
    fn is_where_it_was(&self, before: &Pose) -> bool {
        let size = self.at.size();
        let unknowns = self.pose().q.iter().zip(&before.q).enumerate();
        unknowns.fold(true, |same, (column, (now, before))| {
            let mut off = now - before;
            if self.system.is_angle(column) {
                off -= TAU * (off / TAU).round();
            }
            same && (off / self.system.column_scale(column, size)).abs() < SAME_PLACE
        })
    }

    fn sample(&mut self, driver: f64) -> Sample {
        Sample {
            driver,
            rcond: self.rcond(),
            residual: self.residual(),
            transmission: self.plan.transmission(),
            q: self.pose().q.clone(),
        }
    }
}
