//! All forces at a pose.

use std::sync::Arc;

use super::applied::{AppliedForces, Circumstances};
use super::inertial::{BodyMotion, Masses};
use super::quantity::{ForceQuantity, input_places};
use super::self_stress::SelfStresses;
use super::wrench::{Contact, ReactionRows};
use crate::kinematics::block::{BlockState, JacobianFactors};
use crate::kinematics::error::Error;
use crate::kinematics::model::Model;
use crate::kinematics::newton::Rejected;
use crate::kinematics::path::Rates;
use crate::kinematics::state::{SINGULAR_HERE, State};
use crate::mechanism::{DriverId, Indeterminate, Jet, Mechanism, ParameterId};

/// The forces of a mechanism with dynamics at one pose.
///
/// Made by [`Solver::forces`](crate::kinematics::Solver::forces), brought up to date by
/// [`Solver::solve_forces`](crate::kinematics::Solver::solve_forces).
#[derive(Debug)]
pub struct Forces {
    pub(super) mechanism: Arc<Mechanism>,
    /// Parameters for which the masses are evaluated.
    parameters: Vec<f64>,
    /// Whether the masses are valid for them.
    has_parameters: bool,
    masses: Masses<f64>,
    pub(super) applied: AppliedForces,
    inputs: usize,
    pub(super) factors: JacobianFactors,
    /// Rows that the factors leave out.
    set_aside: Vec<usize>,
    pub(super) rows: ReactionRows,
    pub(super) contacts: Vec<Contact>,
    self_stresses: SelfStresses,
    pub(super) results: Results,
    work: Work,
}

/// The results.
#[derive(Debug)]
pub(super) struct Results {
    /// Per driver.
    pub(super) drivers: Vec<DriverForces>,
    /// λ, one per row.
    pub(super) multipliers: Vec<f64>,
    /// Per joint.
    pub(super) reactions: Vec<[f64; 3]>,
    /// Size of each force.
    pub(super) sizes: Vec<[f64; 3]>,
    /// Kinetic and potential energy \[J\].
    pub(super) energies: [f64; 2],
}

/// The forces of one driver.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DriverForces {
    pub(super) effort: f64,
    pub(super) power: f64,
    pub(super) inertia: f64,
    pub(super) bias: f64,
}

#[derive(Debug)]
struct Work {
    /// −Q of the forces, one entry per unknown.
    loads: Vec<f64>,
    demand: Vec<f64>,
    momentum: Vec<f64>,
    /// ∂q/∂u of each driver.
    units: Vec<Vec<f64>>,
    rates: Rates,
    driver_rates: Vec<Jet>,
}

/// The motion for which forces are sought, at the pose of the solver.
#[derive(Clone, Copy, Debug)]
pub struct KnownMotion<'a> {
    /// Rates of q.
    pub rates: &'a Rates,
    /// Rates of the drivers (`first` and `second`), to which those of q belong.
    pub driver_rates: &'a [Jet],
    /// Sizes of the forces that are inputs, in the order of their variables.
    pub inputs: &'a [f64],
}

/// The results that are sought, besides sizes of forces and energies.
#[derive(Clone, Copy, Debug)]
pub struct ForceParts {
    /// Efforts, powers and inertias of drivers.
    pub efforts: bool,
    /// Reactions of joints and efforts of constraints.
    pub reactions: bool,
}

impl ForceParts {
    /// All results.
    pub const ALL: Self = Self {
        efforts: true,
        reactions: true,
    };
}

impl Forces {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(model: &Model) -> Self {
        let system = &model.system;
        let mechanism = Arc::clone(system.mechanism());
        let places = input_places(&mechanism);
        let inputs = mechanism.force_inputs().len();
        let (unknowns, drivers) = (system.unknowns(), mechanism.drivers.len());
        let rows = ReactionRows::new(system);
        Self {
            parameters: Vec::with_capacity(mechanism.parameters.len()),
            has_parameters: false,
            masses: Masses::new(&mechanism, &|p: ParameterId| {
                mechanism.parameters[p.index()].default
            }),
            applied: AppliedForces::new(&mechanism, &places),
            inputs,
            factors: JacobianFactors::new(system, &model.structure, &model.plan),
            set_aside: model.redundant.now.clone(),
            contacts: Contact::all(&mechanism, &rows),
            rows,
            self_stresses: SelfStresses::default(),
            results: Results {
                drivers: vec![DriverForces::default(); drivers],
                multipliers: vec![0.0; system.equations().len()],
                reactions: vec![[0.0; 3]; mechanism.joints.len()],
                sizes: vec![[0.0; 3]; mechanism.forces.len()],
                energies: [0.0; 2],
            },
            work: Work {
                loads: vec![0.0; unknowns],
                demand: vec![0.0; unknowns],
                momentum: vec![0.0; unknowns],
                units: vec![vec![0.0; unknowns]; drivers],
                rates: Rates::new(unknowns),
                driver_rates: vec![Jet::constant(0.0); drivers],
            },
            mechanism,
        }
    }

    /// Returns the number of inputs of forces.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Returns a result; it has a meaning if the last call of
    /// [`Solver::solve_forces`](crate::kinematics::Solver::solve_forces) sought its part.
    #[must_use]
    pub fn value(&self, quantity: ForceQuantity) -> f64 {
        let Results {
            drivers,
            multipliers,
            reactions,
            sizes,
            energies,
        } = &self.results;
        match quantity {
            ForceQuantity::Effort(driver) => drivers[driver.index()].effort,
            ForceQuantity::Power(driver) => drivers[driver.index()].power,
            ForceQuantity::Inertia(driver) => drivers[driver.index()].inertia,
            ForceQuantity::Bias(driver) => drivers[driver.index()].bias,
            ForceQuantity::Reaction(joint, component) => reactions[joint][component],
            ForceQuantity::Held(constraint) => multipliers[self.rows.constraints[constraint]],
            ForceQuantity::Applied(force, component) => sizes[force][component],
            ForceQuantity::KineticEnergy => energies[0],
            ForceQuantity::PotentialEnergy => energies[1],
        }
    }

    /// Returns the number of joints that can only push.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// Solves the forces at the pose. Allocates nothing, unless other rows have become redundant.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::Mass`] for masses without a meaning, [`Error::NoForce`] for
    /// a force without direction or size, [`Error::Singular`] where the pose is singular.
    pub(in crate::kinematics) fn solve(
        &mut self,
        model: &mut Model,
        state: &mut State,
        motion: KnownMotion<'_>,
        parts: ForceParts,
    ) -> Result<(), Error> {
        self.set_parameters(state)?;
        self.solve_loads(state, motion)?;
        if parts.efforts {
            self.solve_efforts(model, state, motion)?;
        }
        if parts.reactions {
            self.solve_reactions(model, state, motion)?;
        }
        Ok(())
    }

    /// Evaluates the masses, if parameters have changed.
    fn set_parameters(&mut self, state: &State) -> Result<(), Error> {
        let now = &state.pose.parameters;
        if self.has_parameters && self.parameters == *now {
            return Ok(());
        }
        self.masses
            .set_parameters(&self.mechanism, &|p: ParameterId| now[p.index()]);
        self.parameters.clear();
        self.parameters.extend_from_slice(now);
        self.has_parameters = false;
        self.masses.check(&self.mechanism)?;
        self.has_parameters = true;
        Ok(())
    }

    /// Evaluates the sizes of forces, what they load bodies with, and the energies.
    fn solve_loads(&mut self, state: &State, motion: KnownMotion<'_>) -> Result<(), Error> {
        let parameters = &state.pose.parameters;
        let parameter = |p: ParameterId| parameters[p.index()];
        let around = Circumstances {
            parameter: &parameter,
            time: state.pose.time,
            inputs: motion.inputs,
        };
        self.work.loads.fill(0.0);
        let q_dot = motion.rates.velocity();
        let mut energies = [0.0, 0.0];
        energies[1] += self.applied.apply(
            &self.mechanism,
            &state.at,
            q_dot,
            &around,
            &mut self.results.sizes,
            &mut self.work.loads,
        )?;
        for masses in &self.masses.bodies {
            let frame = &state.at.frames()[masses.body];
            let k = 3 * masses.body;
            let motion = BodyMotion {
                position: [frame.origin.x, frame.origin.y, frame.phi],
                direction: [frame.cos, frame.sin],
                velocity: [q_dot[k], q_dot[k + 1], q_dot[k + 2]],
            };
            let own = masses.energies(motion, self.masses.gravity);
            energies = [energies[0] + own[0], energies[1] + own[1]];
        }
        self.results.energies = energies;
        Ok(())
    }

    /// Writes w for these rates.
    fn demand(&mut self, state: &State, q_dot: &[f64], q_ddot: &[f64]) {
        let Work { loads, demand, .. } = &mut self.work;
        demand.copy_from_slice(loads);
        for masses in &self.masses.bodies {
            let frame = &state.at.frames()[masses.body];
            let k = 3 * masses.body;
            let acceleration = [q_ddot[k], q_ddot[k + 1], q_ddot[k + 2]];
            let direction = [frame.cos, frame.sin];
            let own = masses.demand(direction, q_dot[k + 2], acceleration, self.masses.gravity);
            for (demand, own) in demand[k..k + 3].iter_mut().zip(own) {
                *demand += own;
            }
        }
    }

    /// Solves the efforts by virtual power: bias from accelerations that only prescribed motions
    /// and velocities cause, then the share of the accelerations of inputs.
    fn solve_efforts(
        &mut self,
        model: &mut Model,
        state: &mut State,
        motion: KnownMotion<'_>,
    ) -> Result<(), Error> {
        state.refresh(model)?;
        let mechanism = Arc::clone(&self.mechanism);
        let is_input = |driver: usize| mechanism.drivers[driver].motion().is_none();
        let mut rates = std::mem::replace(&mut self.work.rates, Rates::new(0));
        self.solve_units(model, state, &mut rates);
        self.solve_coasting(model, state, motion, &mut rates);
        self.demand(state, motion.rates.velocity(), rates.acceleration());
        self.work.rates = rates;
        let Work {
            demand,
            momentum,
            units,
            ..
        } = &mut self.work;
        let drivers = &mut self.results.drivers;
        for (forces, unit) in drivers.iter_mut().zip(&*units) {
            forces.bias = dot(unit, demand);
            forces.effort = forces.bias;
        }
        for input in (0..drivers.len()).filter(|&driver| is_input(driver)) {
            let acceleration = motion.driver_rates[input].second();
            momentum.fill(0.0);
            for masses in &self.masses.bodies {
                let frame = &state.at.frames()[masses.body];
                let k = 3 * masses.body;
                let unit = [0, 1, 2].map(|c| units[input][k + c]);
                let own = masses.momentum([frame.cos, frame.sin], unit);
                momentum[k..k + 3].copy_from_slice(&own);
            }
            drivers[input].inertia = dot(&units[input], momentum);
            if acceleration != 0.0 {
                for (forces, unit) in drivers.iter_mut().zip(&*units) {
                    forces.effort += dot(unit, momentum) * acceleration;
                }
            }
        }
        let mut sum = 0.0;
        for (forces, rates) in drivers.iter_mut().zip(motion.driver_rates) {
            forces.power = forces.effort * rates.first();
            sum += forces.power + forces.inertia + forces.bias;
        }
        if sum.is_finite() {
            Ok(())
        } else {
            Err(SINGULAR_HERE)
        }
    }

    /// Writes ∂q/∂u of each driver.
    fn solve_units(&mut self, model: &mut Model, state: &mut State, rates: &mut Rates) {
        let Work {
            units,
            driver_rates,
            ..
        } = &mut self.work;
        if state.has_single_driver() {
            units[0].copy_from_slice(state.tangent.velocity());
            return;
        }
        for (driver, unit) in units.iter_mut().enumerate() {
            driver_rates.fill(Jet::constant(0.0));
            driver_rates[driver].derivatives[0] = 1.0;
            solve_rates(model, state, driver_rates, rates);
            unit.copy_from_slice(rates.velocity());
        }
    }

    /// Writes the rates of q if the accelerations of all inputs were zero.
    fn solve_coasting(
        &mut self,
        model: &mut Model,
        state: &mut State,
        motion: KnownMotion<'_>,
        rates: &mut Rates,
    ) {
        let drivers = self.mechanism.drivers.iter().zip(motion.driver_rates);
        let coasting = drivers.map(|(driver, rates)| match driver.motion() {
            Some(_) => *rates,
            None => Jet::new(0.0, [rates.first(), 0.0]),
        });
        for (rates, coasting) in self.work.driver_rates.iter_mut().zip(coasting) {
            *rates = coasting;
        }
        if state.has_single_driver() {
            let [first, second] = self.work.driver_rates[0].derivatives;
            state.tangent.scale(first, second, rates);
        } else {
            solve_rates(model, state, &self.work.driver_rates, rates);
        }
    }

    /// Solves Phi_qᵀ λ = w.
    fn solve_reactions(
        &mut self,
        model: &Model,
        state: &State,
        motion: KnownMotion<'_>,
    ) -> Result<(), Error> {
        let system = &model.system;
        if self.set_aside != model.redundant.now {
            self.factors = JacobianFactors::new(system, &model.structure, &model.plan);
            self.set_aside.clone_from(&model.redundant.now);
        }
        self.demand(state, motion.rates.velocity(), motion.rates.acceleration());
        let is_of_least_norm = self.is_of_least_norm();
        let (demand, multipliers) = (&mut self.work.demand, &mut self.results.multipliers);
        if is_of_least_norm {
            self.factors
                .factorise(system, &state.at)
                .map_err(|Rejected| SINGULAR_HERE)?;
            self.factors
                .solve_transposed(system, &state.at, demand, multipliers);
            self.self_stresses.minimise_norm(
                system,
                (&self.rows, &mut self.factors),
                &state.at,
                &self.set_aside,
                multipliers,
            );
        } else {
            self.factors
                .solve_transposed_at(&model.plan, system, &state.at, demand, multipliers)
                .map_err(|Rejected| SINGULAR_HERE)?;
        }
        let mut sum = 0.0;
        for (joint, reaction) in self.results.reactions.iter_mut().enumerate() {
            *reaction = self
                .rows
                .reaction(system, &state.at, joint, &self.results.multipliers);
            sum += reaction.iter().sum::<f64>();
        }
        if sum.is_finite() && self.results.multipliers.iter().all(|l| l.is_finite()) {
            Ok(())
        } else {
            Err(SINGULAR_HERE)
        }
    }

    /// Returns whether reactions that are indeterminate are those of least norm.
    pub(super) fn is_of_least_norm(&self) -> bool {
        let wanted = self.mechanism.outputs.indeterminate == Indeterminate::MinimumNorm;
        wanted && !self.set_aside.is_empty()
    }

    /// Returns ∂q/∂u of a driver.
    pub(super) fn unit(&self, driver: DriverId) -> &[f64] {
        &self.work.units[driver.index()]
    }
}

/// Solves the rates of q for these rates of the drivers, at the pose at which the plan is
/// factorised.
fn solve_rates(model: &mut Model, state: &mut State, driver_rates: &[Jet], rates: &mut Rates) {
    let mut block_state = BlockState {
        system: &model.system,
        targets: &state.targets,
        drivers: &state.pose.drivers,
        at: &mut state.at,
        tangent: rates,
    };
    model.plan.solve_rates(&mut block_state, driver_rates);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
