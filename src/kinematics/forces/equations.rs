//! The equations of motion in the coordinates of the drivers.
//!
//! With u for the coordinates, what each of them has to exert is
//!
//! > effort = J ü + bias, J_ij = (∂q/∂u_i)ᵀ M ∂q/∂u_j, bias_i = (∂q/∂u_i)ᵀ w
//!
//! with w for the accelerations q̈ where all ü are zero. By virtual power no reaction takes part.

use nalgebra::DMatrix;

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
    pub weighted_rest: Vec<f64>,
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
            weighted_rest: vec![0.0; unknowns],
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
        self.inertia.fill(0.0);
        self.bias.fill(0.0);
        self.applied.fill(0.0);
        self.applied_power = 0.0;
        let (mut energies, mut at_unit_speeds) = ([0.0; 2], [0.0; 2]);
        let gravity = masses.gravity;
        let rates = [self.coasting.velocity(), self.coasting.acceleration()];
        let [velocities, accelerations] = rates.map(by_body);
        let frames = state.at.frames();
        for (k, body) in masses.bodies.iter_mut().enumerate() {
            body.turn([frames[k].cos, frames[k].sin]);
            let own = body.energies(frames[k].origin.into(), velocities[k], gravity);
            energies = [energies[0] + own[0], energies[1] + own[1]];
            let own = body.at_unit_speeds();
            at_unit_speeds = [at_unit_speeds[0] + own[0], at_unit_speeds[1] + own[1]];
            let exerted = by_body(exerted)[k];
            self.applied_power -= power(velocities[k], exerted);
            let rest = body.weighted(body.felt(velocities[k][2], accelerations[k], gravity));
            self.weighted_rest[3 * k..3 * k + 3].copy_from_slice(&rest);
            for (i, unit) in self.units.iter().enumerate() {
                let unit = by_body(unit.velocity())[k];
                let weighted = body.weighted(unit);
                let effort = power(unit, exerted);
                self.applied[i] += effort;
                self.bias[i] += power(weighted, rest) + effort;
                for (row, entry) in weighted.into_iter().enumerate() {
                    self.weighted[(3 * k + row, i)] = entry;
                }
                for j in 0..=i {
                    let other = self.weighted.fixed_view::<3, 1>(3 * k, j);
                    let product = power(weighted, [other[0], other[1], other[2]]);
                    self.inertia[(i, j)] += product;
                    if j < i {
                        self.inertia[(j, i)] += product;
                    }
                }
            }
        }
        self.energy = energies[0] + energies[1];
        self.kinetic_energy = energies[0];
        self.at_unit_speeds = at_unit_speeds;
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
