//! The changes of a free motion along directions: the variational equations of Haug's independent
//! coordinates, δu̇ = δv and J δv̇ = −δeffort.
//!
//! They are integrated beside the motion, with its steps, and so are the exact derivatives of what the
//! integrator computes.

use super::equations::Equations;
use super::error::Error;
use crate::kinematics::{Direction, Rates, Solver};
use crate::mechanism::Jet;

impl Equations {
    /// Returns the number of changes that stand behind the values of x.
    pub(super) fn variations(&self) -> usize {
        2 * self.freedoms.len() * self.directions.len()
    }

    /// Writes the changes at the start, which the directions give, behind the values of x.
    pub(super) fn write_variations(&self, x: &mut [f64]) {
        let count = self.freedoms.len();
        let changes = x[2 * count + 1..].chunks_exact_mut(2 * count);
        for (changes, direction) in changes.zip(&self.directions) {
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let start = direction.drivers[freedom.index()];
                [changes[k], changes[count + k]] = [start.value, start.first()];
            }
        }
    }

    /// Returns the directions with the changes in x, and those of the accelerations that follow, at the
    /// point at which accelerations were solved last. Solves its rates.
    pub(super) fn varied(
        &mut self,
        solver: &mut Solver,
        x: &[f64],
        rates: &mut Rates,
    ) -> Result<Vec<Direction>, Error> {
        let count = self.freedoms.len();
        solver.solve_rates(|driver| self.point.drivers[driver.index()], rates)?;
        let mut still = vec![0.0; self.point.loads.len()];
        let mut varied = self.directions.clone();
        let changes = x[2 * count + 1..].chunks_exact(2 * count);
        for (direction, changes) in varied.iter_mut().zip(changes) {
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let change = Jet::new(changes[k], [changes[count + k], 0.0]);
                direction.drivers[freedom.index()] = change;
            }
            self.complete(solver, rates, direction, &mut still)?;
        }
        Ok(varied)
    }

    /// Writes the derivatives of the changes in x at the point at which accelerations were solved last.
    pub(super) fn vary(
        &mut self,
        solver: &mut Solver,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Error> {
        if self.directions.is_empty() {
            return Ok(());
        }
        let count = self.freedoms.len();
        let mut rates = Rates::new(solver.pose().q.len());
        let varied = self.varied(solver, x, &mut rates)?;
        let changes = dx[2 * count + 1..].chunks_exact_mut(2 * count);
        for (changes, direction) in changes.zip(&varied) {
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let rates = direction.drivers[freedom.index()].derivatives;
                [changes[k], changes[count + k]] = rates;
            }
        }
        Ok(())
    }
}
