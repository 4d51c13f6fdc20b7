//! Corners of prescribed motions, at which velocities of drivers jump.

use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::triangular::{ascend, descend};
use crate::kinematics::Solver;

impl Equations {
    /// Passes a corner of prescribed motions, from the accepted point before it to `time` behind it. The
    /// drivers take the impulses of their jumps Δv, and the freedoms none: with the inertia J of the
    /// freedoms and J_v between them and the drivers
    ///
    /// > J Δu̇ + J_v Δv = 0
    ///
    /// whatever coordinates the freedoms are. What is touched is not held: contacts that close are to
    /// [bounce](Self::settle) then. Changes velocities and work in `x`.
    pub(super) fn pass_corner(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
    ) -> Result<(), Error> {
        let count = self.freedoms.len();
        self.evaluate(solver, given, time, x)?;
        let drivers = self.point.drivers.iter().zip(&self.accepted.drivers);
        let jumps: Vec<f64> = drivers
            .map(|(after, before)| after.first() - before.first())
            .collect();
        let inertia = &self.motion().inertia;
        let is_free = |driver: usize| self.freedoms.iter().any(|id| id.index() == driver);
        let momentum = |freedom: usize| {
            let driven = jumps.iter().enumerate();
            let driven = driven.filter(|(driver, _)| !is_free(*driver));
            driven
                .map(|(driver, jump)| inertia[(freedom, driver)] * jump)
                .sum::<f64>()
        };
        let changes = self.freedoms.iter().map(|id| -momentum(id.index()));
        let mut changes: Vec<f64> = changes.collect();
        descend(self.factor(), &mut changes);
        ascend(self.factor(), &mut changes);
        for (velocity, change) in x[count..2 * count].iter_mut().zip(&changes) {
            *velocity += change;
        }
        let energy = self.accepted.energy;
        self.evaluate(solver, given, time, x)?;
        x[2 * count] += self.point.energy - energy;
        Ok(())
    }
}
