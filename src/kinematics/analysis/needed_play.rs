//! The play that a joint needs for the motion of a mechanism whose constraints contradict each
//! other.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::range::is_within;
use crate::kinematics::assembly::closure::is_small;
use crate::kinematics::assembly::estimate::go_to_estimate;
use crate::kinematics::assembly::gaps::{CLOSED, gather, open_joints};
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::error::{Error, OpenJoint};
use crate::kinematics::origin::Origin;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::mechanism::{DriverId, Mechanism};

/// The play that one joint or constraint needs for a motion, all others being exact.
#[derive(Clone, Debug, PartialEq)]
pub struct NeededPlay {
    /// The driver that moves; the others are held.
    pub driver: DriverId,
    /// The driver's values between which all others close \[m or rad\].
    pub range: [f64; 2],
    /// The largest gap on the way.
    pub open: OpenJoint,
}

/// Poses per turn of an angle; those of a length are this part of twice the mechanism's size apart.
const POSES: usize = 180;

impl NeededPlay {
    /// Moves a mechanism whose constraints contradict each other from its start values over the
    /// range of its first driver of an angle, or else of its first driver: up to a turn, or a
    /// change by twice the mechanism's size. The joint or constraint of the contradictory set that
    /// is declared last stays open there, as little as possible. `error` is that of the assembly.
    ///
    /// `None` if the error is another one than [`Error::Contradiction`], or the mechanism has no
    /// driver or more than 40 bodies.
    #[must_use]
    pub fn find(mechanism: &Arc<Mechanism>, error: &Error) -> Option<Self> {
        let Error::Contradiction { open, nearest, .. } = error else {
            return None;
        };
        let (mut compiled, _) = CompiledMechanism::new(Arc::clone(mechanism));
        if !is_small(&compiled.system) {
            return None;
        }
        let mut state = State::new(&compiled.system);
        go_to_estimate(&mut compiled, &mut state, &Path::new(mechanism)).ok()?;
        state.at.set_pose(mechanism, &nearest.q);
        let drivers = &mechanism.drivers;
        let is_angle = |driver: &usize| drivers[*driver].coordinate.kind.is_angle();
        let first = (!drivers.is_empty()).then_some(0);
        let driver = (0..drivers.len()).find(is_angle).or(first)?;
        let all: Vec<_> = (0..compiled.system.equations().len()).collect();
        let extent = if is_angle(&driver) {
            TAU
        } else {
            2.0 * compiled.system.driver_row(DriverId(driver)).size(&state.at)
        };
        let start = state.pose.drivers[driver];
        let mut sweep = Sweep {
            problem: LeastSquares::of_all(&compiled.system, &all),
            own: compiled.system.rows_of(&[nearest.open]),
            origin: nearest.open,
            driver,
            start,
            step: extent / POSES as f64,
            home: &nearest.q,
            most: OpenJoint {
                gap: 0.0,
                angle: 0.0,
                ..open.clone()
            },
            compiled: &compiled,
            state: &mut state,
        };
        let up = sweep.follow(1.0)?;
        let is_whole = is_angle(&driver) && up == POSES;
        let down = if is_whole { 0 } else { sweep.follow(-1.0)? };
        let reached = |places: usize| sweep.step * places as f64;
        Some(Self {
            driver: DriverId(driver),
            range: [start - reached(down), start + reached(up)],
            open: sweep.most,
        })
    }
}

/// A motion of one driver with one joint or constraint open.
struct Sweep<'a> {
    compiled: &'a CompiledMechanism,
    state: &'a mut State,
    problem: LeastSquares,
    origin: Origin,
    /// Its rows.
    own: Vec<usize>,
    driver: usize,
    /// The driver's value at the start, and from one place to the next \[m or rad\].
    start: f64,
    step: f64,
    /// q at the start.
    home: &'a [f64],
    /// The largest gap so far.
    most: OpenJoint,
}

impl Sweep<'_> {
    /// Moves the driver from the start, up (1) or down (−1), as far as all others close and the
    /// driver's limits permit. Returns the number of places behind the start; `None` if the others
    /// do not close there.
    fn follow(&mut self, sign: f64) -> Option<usize> {
        let mechanism = Arc::clone(self.compiled.system.mechanism());
        let driver = &mechanism.drivers[self.driver];
        let mut here = self.home.to_vec();
        let mut before: Option<Vec<f64>> = None;
        for place in 0..=POSES {
            let value = self.start + sign * self.step * place as f64;
            if place > 0 && !is_within(value, [driver.min, driver.max]) {
                return Some(place - 1);
            }
            self.state.pose.drivers[self.driver] = value;
            let ahead: Vec<f64> = match &before {
                // Straight on, so that parallel links stay parallel.
                Some(before) => here
                    .iter()
                    .zip(before)
                    .map(|(q, old)| 2.0 * q - old)
                    .collect(),
                None => here.clone(),
            };
            self.state.at.set_pose(&mechanism, &ahead);
            gather(self.compiled, self.state, &mut self.problem, self.origin);
            if !self.others_close() {
                return place.checked_sub(1);
            }
            self.note_gap();
            let mut there = here.clone();
            self.state.at.copy_pose(&mut there);
            // From the start itself the first way is not that of a step.
            before = (place > 0).then_some(here);
            here = there;
        }
        Some(POSES)
    }

    /// Returns whether all other rows hold.
    fn others_close(&self) -> bool {
        let system = &self.compiled.system;
        let mut others = (0..system.equations().len()).filter(|row| !self.own.contains(row));
        others.all(|row| {
            let value = system.evaluate_row(row, self.state.values(), |_, _| {});
            value.value.abs() <= CLOSED
        })
    }

    fn note_gap(&mut self) {
        let open = open_joints(self.compiled, self.state, &self.own, 0.0);
        for (_, joint) in open {
            self.most.gap = self.most.gap.max(joint.gap);
            self.most.angle = self.most.angle.max(joint.angle);
        }
    }
}
