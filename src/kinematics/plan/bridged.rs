//! A part of the mechanism near a change point.

use std::sync::Arc;

use super::{Advance, Kernel, Work};
use crate::kinematics::newton::{Correction, Rejected};
use crate::kinematics::singular::{Crossing, SEAM};
use crate::mechanism::Jet;

/// Any kernel while its unknowns come from a [`Crossing`].
#[derive(Debug)]
pub(in crate::kinematics) struct Bridged {
    pub(in crate::kinematics) kernel: Kernel,
    pub(in crate::kinematics) crossing: Arc<Crossing>,
    /// Whether the kernel could not be factorised where it stands.
    singular: bool,
}

impl Bridged {
    pub(in crate::kinematics) fn new(kernel: Kernel, crossing: Arc<Crossing>) -> Self {
        Self {
            kernel,
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
        if !(self.crossing.place(value).abs() <= SEAM) {
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

    /// Goes to the driver's value; there is nothing to predict.
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        _advance: Advance,
    ) -> Result<Correction, Rejected> {
        let correction = self.close(work)?;
        self.factorise(work);
        Ok(correction)
    }

    /// Factorises the kernel for its condition alone; at the point itself that is zero.
    pub(super) fn factorise(&mut self, work: &mut Work<'_>) {
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
            velocity[column] = first * rates.first;
            acceleration[column] = first * rates.second + second * rates.first * rates.first;
        }
    }
}
