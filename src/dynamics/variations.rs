//! The changes of a free motion along directions: the variational equations of Haug's independent
//! coordinates, δu̇ = δv and J δv̇ = −δeffort.
//!
//! They are integrated beside the motion, with its steps, and so are the exact derivatives of what the
//! integrator computes.

use nalgebra::DMatrix;

use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::passive::PassiveForces;
use super::triangular::{ascend, descend};
use crate::kinematics::{
    Direction, ForceQuantity, ForceSensitivity, KnownMotion, Rates, Sensitivity, Solver,
};
use crate::mechanism::{DriverId, Jet};

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

    /// Returns the directions with the changes in x, and those of accelerations and passive forces that
    /// follow, at the point at which accelerations were solved last. Solves its rates.
    pub(super) fn varied(
        &mut self,
        solver: &mut Solver,
        x: &[f64],
        rates: &mut Rates,
    ) -> Result<Vec<Direction>, Error> {
        let count = self.freedoms.len();
        solver.solve_rates(|driver| self.point.drivers[driver.index()], rates)?;
        let mut varied = self.directions.clone();
        let changes = x[2 * count + 1..].chunks_exact(2 * count);
        for (direction, changes) in varied.iter_mut().zip(changes) {
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let change = Jet::new(changes[k], [changes[count + k], 0.0]);
                direction.drivers[freedom.index()] = change;
            }
        }
        if self.complete_all(solver, rates, &mut varied)? {
            return Ok(varied);
        }
        for direction in &mut varied {
            self.complete(solver, rates, direction)?;
        }
        Ok(varied)
    }

    /// Completes directions along which the inputs of forces stay, as [`complete`](Self::complete) does,
    /// with one factorisation for all. Returns whether it has done so: not next to a change point, and
    /// not for friction in joints, which depends on the changes of reactions.
    fn complete_all(
        &mut self,
        solver: &mut Solver,
        rates: &Rates,
        directions: &mut [Direction],
    ) -> Result<bool, Error> {
        let Self {
            passive,
            point,
            forces,
            factor,
            accelerations,
            freedoms,
            ..
        } = self;
        if passive.friction.slides_in_joints() {
            return Ok(false);
        }
        let motion = KnownMotion {
            rates,
            driver_rates: &point.drivers,
            inputs: &point.loads,
        };
        let (loads, of_passive) = (point.loads.len(), point.loads.len() - passive.loads());
        let mut found = Vec::with_capacity(directions.len());
        let mut efforts = Vec::with_capacity(directions.len() * freedoms.len());
        let inputs = |_: usize, sensitivity: &Sensitivity<'_>| {
            let mut changes = vec![0.0; loads];
            let coordinates = if passive.is_empty() {
                Vec::new()
            } else {
                passive.changes(sensitivity, None, &mut changes[of_passive..])
            };
            found.push((coordinates, changes.clone()));
            changes
        };
        let sought = (&**freedoms, &*directions);
        let done = solver.effort_changes(motion, sought, forces, inputs, |_, changes| {
            efforts.extend_from_slice(changes);
        })?;
        if !done {
            return Ok(false);
        }
        let efforts = efforts.chunks_exact(freedoms.len()).zip(found);
        for (direction, (efforts, (coordinates, loads))) in directions.iter_mut().zip(efforts) {
            direction.loads = loads;
            for (change, effort) in accelerations.iter_mut().zip(efforts) {
                *change = -effort;
            }
            let holding = &mut direction.loads[of_passive..];
            solve_changes(passive, &coordinates, factor, accelerations, holding);
            for (change, freedom) in accelerations.iter().zip(&*freedoms) {
                direction.drivers[freedom.index()].derivatives[1] = *change;
            }
        }
        Ok(true)
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

    /// Completes a direction by the changes of the freedoms' accelerations, for which their efforts
    /// stay zero: J δü = −δeffort, and by those of passive forces. The point is that at which
    /// accelerations were solved last, and `rates` are those of q there.
    pub(super) fn complete(
        &mut self,
        solver: &mut Solver,
        rates: &Rates,
        direction: &mut Direction,
    ) -> Result<(), Error> {
        self.complete_with(solver, rates, direction, None)?;
        if !self.passive.friction.slides_in_joints() {
            return Ok(());
        }
        let motion = KnownMotion {
            rates,
            driver_rates: &self.point.drivers,
            inputs: &self.point.loads,
        };
        let stays = solver.force_sensitivity(motion, direction, &mut self.forces)?;
        self.complete_with(solver, rates, direction, Some(&stays))
    }

    /// Completes a direction, with friction in joints from the changes of the forces where it stays as it
    /// is: without these it does.
    fn complete_with(
        &mut self,
        solver: &mut Solver,
        rates: &Rates,
        direction: &mut Direction,
        stays: Option<&ForceSensitivity>,
    ) -> Result<(), Error> {
        for freedom in &self.freedoms {
            direction.drivers[freedom.index()].derivatives[1] = 0.0;
        }
        let Self {
            passive,
            point,
            forces,
            factor,
            accelerations,
            freedoms,
            ..
        } = self;
        let of_passive = point.loads.len() - passive.loads();
        let mut coordinates = Vec::new();
        if !passive.is_empty() {
            let sensitivity = solver.sensitivity(rates, &point.drivers, direction)?;
            let loads = &mut direction.loads[of_passive..];
            coordinates = passive.changes(&sensitivity, stays, loads);
        }
        let motion = KnownMotion {
            rates,
            driver_rates: &point.drivers,
            inputs: &point.loads,
        };
        let changes = solver.force_sensitivity(motion, direction, forces)?;
        for (change, freedom) in accelerations.iter_mut().zip(&*freedoms) {
            *change = -changes.change(ForceQuantity::Effort(*freedom))?;
        }
        let holding = &mut direction.loads[of_passive..];
        solve_changes(passive, &coordinates, factor, accelerations, holding);
        for (change, freedom) in accelerations.iter().zip(&*freedoms) {
            direction.drivers[freedom.index()].derivatives[1] = *change;
        }
        Ok(())
    }

    /// Writes the derivatives of accelerations by values, velocities and time at an accepted point.
    pub(super) fn differentiate(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        (t, x): (f64, &[f64]),
        jacobian: &mut DMatrix<f64>,
        dx_dt: &mut [f64],
    ) -> Result<(), Error> {
        let count = self.freedoms.len();
        let mut scratch = vec![0.0; x.len()];
        self.set_drivers(solver, given, t, x);
        self.go(solver, t, None)?;
        self.write(solver, &mut scratch)?;
        let mut rates = Rates::new(solver.pose().q.len());
        solver.solve_rates(|driver| self.point.drivers[driver.index()], &mut rates)?;
        jacobian.fill(0.0);
        dx_dt.fill(0.0);
        for column in 0..2 * count {
            let mut direction = Direction::zero(solver.mechanism());
            let state = &mut direction.drivers[self.freedoms[column % count].index()];
            if column < count {
                state.value = 1.0;
            } else {
                state.derivatives[0] = 1.0;
                jacobian[(column - count, column)] = 1.0;
            }
            self.complete(solver, &rates, &mut direction)?;
            for (row, change) in self.accelerations.iter().enumerate() {
                jacobian[(count + row, column)] = *change;
            }
        }
        let mut direction = self.drift(solver, given, t);
        self.complete(solver, &rates, &mut direction)?;
        dx_dt[count..2 * count].copy_from_slice(&self.accelerations);
        Ok(())
    }

    /// Returns the direction of all that is given, as time goes on.
    pub(super) fn drift(&self, solver: &Solver, given: &impl Given, t: f64) -> Direction {
        /// Part of the time, or of a second, over which loads and accelerations are differenced: they are
        /// polynomials of low degree, so that rounding decides.
        const INCREMENT: f64 = 1e-6;
        let mut direction = Direction::zero(solver.mechanism());
        direction.time = 1.0;
        let later = t + INCREMENT * t.abs().max(1.0);
        let definitions = solver.mechanism().drivers.iter().enumerate();
        for (index, driver) in definitions {
            if driver.is_given() {
                let [velocity, acceleration] = self.point.drivers[index].derivatives;
                let rise = given.driver(DriverId(index), later).second() - acceleration;
                direction.drivers[index] = Jet::new(velocity, [acceleration, rise / (later - t)]);
            }
        }
        let inputs = &mut direction.loads[..self.inputs()];
        given.loads(later, inputs);
        for (load, now) in inputs.iter_mut().zip(&self.point.loads) {
            *load = (*load - now) / (later - t);
        }
        direction
    }
}

/// Solves J δü = −δeffort, whose right side stands in `accelerations`, and writes the changes of the
/// passive forces that hold coordinates.
fn solve_changes(
    passive: &mut PassiveForces,
    coordinates: &[Jet],
    factor: &DMatrix<f64>,
    accelerations: &mut [f64],
    holding: &mut [f64],
) {
    descend(factor, accelerations);
    passive.hold_changes(coordinates, accelerations, holding);
    ascend(factor, accelerations);
}
