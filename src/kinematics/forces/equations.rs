//! The equations of motion in the coordinates of the drivers.
//!
//! With u for the coordinates, what each of them has to exert is
//!
//! > effort = J ü + bias, J_ij = (∂q/∂u_i)ᵀ M ∂q/∂u_j, bias_i = (∂q/∂u_i)ᵀ w
//!
//! with w for the accelerations q̈ where all ü are zero. By virtual power no reaction takes part.

use nalgebra::{DMatrix, DVector};

use super::inertial::{Masses, by_body, power};
use super::solve::{Forces, solve_rates};
use crate::kinematics::error::Error;
use crate::kinematics::path::Rates;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::{SINGULAR_HERE, State};
use crate::mechanism::{DriverId, Jet};

/// The equations of motion at a pose, for velocities.
#[derive(Clone, Debug)]
pub struct EquationsOfMotion {
    /// J, a row and a column per driver \[kg, kg m or kg m²\].
    pub inertia: DMatrix<f64>,
    /// Effort of each driver where none accelerates \[N or N m\].
    pub bias: Vec<f64>,
    /// √M ∂q/∂u, a column per driver: J is the product of its transpose with itself.
    pub weighted: DMatrix<f64>,
    /// √M q̈ where no driver accelerates, with gravity; bias is its product with the columns and the
    /// efforts against the applied forces.
    pub weighted_rest: DVector<f64>,
    /// Effort of each driver against all applied forces but gravity \[N or N m\].
    pub applied: Vec<f64>,
    /// Power of all applied forces but gravity \[W\].
    pub applied_power: f64,
    /// Energy of the bodies without that of springs: kinetic, and potential of gravity \[J\].
    pub energy: f64,
    /// Its kinetic part \[J\].
    pub kinetic_energy: f64,
    /// Kinetic energies of all bodies at 1 m/s without turning, and at 1 rad/s about their centres of
    /// mass \[J\].
    pub at_unit_speeds: [f64; 2],
    /// Rates of q where no driver accelerates.
    coasting: Rates,
    /// ∂q/∂u of each driver.
    units: Vec<Rates>,
    /// Rates of the drivers.
    driver_rates: Vec<Jet>,
}

impl EquationsOfMotion {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(unknowns: usize, drivers: usize) -> Self {
        Self {
            inertia: DMatrix::zeros(drivers, drivers),
            bias: vec![0.0; drivers],
            weighted: DMatrix::zeros(unknowns, drivers),
            weighted_rest: DVector::zeros(unknowns),
            applied: vec![0.0; drivers],
            applied_power: 0.0,
            energy: 0.0,
            kinetic_energy: 0.0,
            at_unit_speeds: [0.0; 2],
            coasting: Rates::new(unknowns),
            units: vec![Rates::new(unknowns); drivers],
            driver_rates: vec![Jet::constant(0.0); drivers],
        }
    }

    /// Returns ∂q/∂u of a driver, as velocities.
    #[must_use]
    pub fn unit(&self, driver: DriverId) -> &Rates {
        &self.units[driver.index()]
    }

    /// Returns the rates of q where no driver accelerates.
    #[must_use]
    pub fn coasting(&self) -> &Rates {
        &self.coasting
    }

    /// Adds a generalized force along a coordinate, whose partial derivatives by the drivers are
    /// `partials` and whose rate is `rate`.
    pub fn exert(&mut self, partials: impl Iterator<Item = f64>, force: f64, rate: f64) {
        let efforts = self.bias.iter_mut().zip(&mut self.applied);
        for ((bias, applied), partial) in efforts.zip(partials) {
            *bias -= force * partial;
            *applied -= force * partial;
        }
        self.applied_power += force * rate;
    }

    /// Solves ∂q/∂u of each driver at the pose, at which the plan is factorised.
    fn solve_units(&mut self, compiled: &mut CompiledMechanism, state: &mut State) {
        if let ([unit], true) = (&mut self.units[..], state.has_single_driver()) {
            unit.copy_from(&state.tangent);
            return;
        }
        for (driver, unit) in self.units.iter_mut().enumerate() {
            self.driver_rates.fill(Jet::constant(0.0));
            self.driver_rates[driver].derivatives[0] = 1.0;
            solve_rates(compiled, state, &self.driver_rates, unit);
        }
    }

    /// Adds up inertia, bias, power and energies over the bodies; `exerted` is what the applied forces
    /// have bodies demand.
    fn add_bodies(&mut self, masses: &mut Masses<f64>, exerted: &[f64], state: &State) {
        self.applied_power = 0.0;
        let (mut energies, mut at_unit_speeds) = ([0.0; 2], [0.0; 2]);
        let gravity = masses.gravity;
        let velocities = by_body(self.coasting.velocity()).iter();
        let rates = velocities.zip(by_body(self.coasting.acceleration()));
        let loads = by_body(exerted)
            .iter()
            .zip(self.weighted_rest.as_mut_slice().as_chunks_mut().0);
        let places = masses.bodies.iter_mut().zip(state.at.frames());
        for ((body, frame), ((velocity, acceleration), (exerted, rest))) in
            places.zip(rates.zip(loads))
        {
            body.turn([frame.cos, frame.sin]);
            let own = body.energies(frame.origin.into(), *velocity, gravity);
            energies = [energies[0] + own[0], energies[1] + own[1]];
            let own = body.at_unit_speeds();
            at_unit_speeds = [at_unit_speeds[0] + own[0], at_unit_speeds[1] + own[1]];
            self.applied_power -= power(*velocity, *exerted);
            *rest = body.weighted(body.felt(velocity[2], *acceleration, gravity));
        }
        self.energy = energies[0] + energies[1];
        self.kinetic_energy = energies[0];
        self.at_unit_speeds = at_unit_speeds;
        let efforts = self.bias.iter_mut().zip(&mut self.applied);
        for (driver, (unit, (bias, applied))) in self.units.iter().zip(efforts).enumerate() {
            let (before, mut column) = self.weighted.columns_range_pair_mut(..driver, driver);
            (*bias, *applied) = (0.0, 0.0);
            let loads = by_body(exerted)
                .iter()
                .zip(by_body(self.weighted_rest.as_slice()));
            let bodies = masses
                .bodies
                .iter()
                .zip(by_body(unit.velocity()))
                .zip(loads);
            let entries = column.as_mut_slice().as_chunks_mut().0.iter_mut();
            for (to, ((body, unit), (exerted, rest))) in entries.zip(bodies) {
                *to = body.weighted(*unit);
                *applied += power(*unit, *exerted);
                *bias += power(*to, *rest);
            }
            *bias += *applied;
            self.inertia[(driver, driver)] = column.norm_squared();
            for (other, of_other) in before.column_iter().enumerate() {
                let product = column.dot(&of_other);
                self.inertia[(driver, other)] = product;
                self.inertia[(other, driver)] = product;
            }
        }
    }
}

impl Forces {
    /// Writes the equations of motion at the pose for these velocities of the drivers and these
    /// inputs of forces. Allocates nothing.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::solve_forces`](crate::kinematics::Solver::solve_forces) and of
    /// [`Solver::solve_rates`](crate::kinematics::Solver::solve_rates).
    pub(in crate::kinematics) fn write_equations(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        velocity: impl Fn(DriverId) -> f64,
        inputs: &[f64],
        to: &mut EquationsOfMotion,
    ) -> Result<(), Error> {
        self.set_parameters(state)?;
        let coasting = |driver: DriverId| Jet::new(0.0, [velocity(driver), 0.0]);
        state.solve_rates(compiled, coasting, &mut to.coasting)?;
        self.apply_forces(state, to.coasting.velocity(), inputs)?;
        to.solve_units(compiled, state);
        to.add_bodies(&mut self.masses, &self.results.demand, state);
        let all = to.bias.iter().chain(&to.inertia);
        if all.fold(0.0, |sum, value| sum + 0.0 * value) == 0.0 {
            Ok(())
        } else {
            Err(SINGULAR_HERE)
        }
    }
}
