//! A part of the mechanism near a change point.

use std::sync::Arc;

use super::Kernel;
use super::crossing::{Crossing, SEAM};
use super::work::{Substep, Work};
use crate::kinematics::certificate::Tube;
use crate::kinematics::newton::{Correction, Rejected};
use crate::mechanism::Jet;

/// Any kernel while its unknowns come from a [`Crossing`].
#[derive(Debug)]
pub(in crate::kinematics) struct Interpolated {
    pub(in crate::kinematics) kernel: Kernel,
    pub(in crate::kinematics) crossing: Arc<Crossing>,
    /// The driver's value where it stands.
    value: f64,
    /// Whether the kernel could not be factorised where it stands.
    singular: bool,
}

/// Rounding of the polynomials, in eps of the values.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Interpolated {
    pub(in crate::kinematics) fn new(kernel: Kernel, crossing: Arc<Crossing>) -> Self {
        Self {
            kernel,
            value: crossing.center,
            crossing,
            singular: false,
        }
    }

    /// Puts the unknowns where the driver's value says.
    ///
    /// # Errors
    ///
    /// [`Rejected`] outside of the crossing.
    pub(super) fn close(&mut self, work: &mut Work<'_>) -> Result<Correction, Rejected> {
        let value = work.drivers[self.crossing.driver.index()];
        let place = self.crossing.place(value).abs();
        if place.is_nan() || place > SEAM {
            return Err(Rejected);
        }
        for (local, &column) in self.kernel.columns().iter().enumerate() {
            let [position, ..] = self.crossing.evaluate(local, value);
            work.at.set_coordinate(column, position);
        }
        Ok(Correction {
            iterations: 1,
            ..Correction::default()
        })
    }

    /// Goes to the driver's value; there is nothing to predict. The crossing is one motion from
    /// end to end, so that there is nothing to prove either: it strays from its chord by an eighth
    /// of what it bends, and by what the driver strays.
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<Correction, Rejected> {
        let correction = match self.close(work) {
            Ok(correction) => correction,
            Err(Rejected) => return Err(substep.tubes.break_off()),
        };
        self.note_tubes(work, substep);
        self.factorise(work);
        Ok(correction)
    }

    fn note_tubes(&self, work: &Work<'_>, substep: &mut Substep<'_>) {
        let Substep { from, tubes, .. } = substep;
        let driver = self.crossing.driver.index();
        let way = work.drivers[driver] - self.value;
        let bodies = 3 * work.system.mechanism().bodies.len();
        let straight = !matches!(self.kernel, Kernel::Coupled(_));
        let strays = tubes.drivers[driver];
        // Angles first: points are turned by them.
        for phi in [true, false] {
            for (local, &column) in self.kernel.columns().iter().enumerate() {
                let (before, now) = (from[column], work.at.coordinate(column));
                let [slope, bend] = self.crossing.steepest(local);
                let radius = 0.125 * bend * way * way
                    + slope * strays
                    + ROUNDING * (1.0 + before.abs() + now.abs());
                if column >= bodies {
                    tubes.set_joint_unknown(column, radius);
                } else if column % 3 == 2 {
                    if phi {
                        let (sin, cos) = before.sin_cos();
                        let tube = tubes.body_mut(column / 3);
                        *tube = Tube {
                            cos,
                            sin,
                            turn: now - before,
                            radius,
                            stray: 0.0,
                        };
                    }
                } else if !phi && straight {
                    let place = column / 3;
                    let arm = tubes.pivot(place).norm();
                    let tube = tubes.body_mut(place);
                    tube.stray = tube.stray.max(1.5 * radius + tube.arc(arm));
                } else if !phi {
                    tubes.set_component(column / 3, column % 3, radius);
                }
            }
        }
    }

    /// Factorises the kernel for its condition alone; at the point itself that is zero.
    pub(super) fn factorise(&mut self, work: &mut Work<'_>) {
        self.value = work.drivers[self.crossing.driver.index()];
        self.singular = self.kernel.factorise(work).is_err();
    }

    /// That of the kernel's own equations.
    pub(super) fn rcond(&mut self) -> f64 {
        if self.singular {
            0.0
        } else {
            self.kernel.rcond()
        }
    }

    /// The derivatives in the driver's value times the driver's rates.
    pub(super) fn solve_rates(&self, work: &mut Work<'_>, drivers: &[Jet]) {
        let driver = self.crossing.driver.index();
        let (value, rates) = (work.drivers[driver], drivers[driver]);
        let (velocity, acceleration) = work.flow.both_mut();
        for (local, &column) in self.kernel.columns().iter().enumerate() {
            let [_, first, second] = self.crossing.evaluate(local, value);
            velocity[column] = first * rates.first();
            acceleration[column] = first * rates.second() + second * rates.first() * rates.first();
        }
    }
}
