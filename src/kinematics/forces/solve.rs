//! All forces at a pose.

use std::mem;
use std::sync::Arc;

use super::applied::{AppliedForces, Circumstances};
use super::inertial::{Masses, add, by_body, virtual_power};
use super::quantity::{ForceQuantity, input_places};
use super::self_stress::SelfStresses;
use super::wrench::{Contact, ReactionRows};
use crate::kinematics::block::{BlockState, JacobianFactors};
use crate::kinematics::configuration::Configuration;
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
    pub(super) masses: Masses<f64>,
    pub(super) applied: AppliedForces,
    inputs: usize,
    pub(super) factors: JacobianFactors,
    /// Rows that the factors leave out.
    set_aside: Vec<usize>,
    pub(super) rows: ReactionRows,
    pub(super) contacts: Vec<Contact>,
    self_stresses: SelfStresses,
    /// Drivers that are inputs.
    input_drivers: Vec<usize>,
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
    /// w, one entry per unknown.
    demand: Vec<f64>,
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
            input_drivers: (0..drivers)
                .filter(|&driver| mechanism.drivers[driver].is_input)
                .collect(),
            results: Results {
                drivers: vec![DriverForces::default(); drivers],
                multipliers: vec![0.0; system.equations().len()],
                reactions: vec![[0.0; 3]; mechanism.joints.len()],
                sizes: vec![[0.0; 3]; mechanism.forces.len()],
                energies: [0.0; 2],
            },
            work: Work {
                demand: vec![0.0; unknowns],
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
        let found = &self.results;
        match quantity {
            ForceQuantity::Effort(driver) => found.drivers[driver.index()].effort,
            ForceQuantity::Power(driver) => found.drivers[driver.index()].power,
            ForceQuantity::Inertia(driver) => found.drivers[driver.index()].inertia,
            ForceQuantity::Bias(driver) => found.drivers[driver.index()].bias,
            ForceQuantity::Reaction(joint, component) => found.reactions[joint][component],
            ForceQuantity::Held(constraint) => found.multipliers[self.rows.constraints[constraint]],
            ForceQuantity::Applied(force, component) => found.sizes[force][component],
            ForceQuantity::KineticEnergy => found.energies[0],
            ForceQuantity::PotentialEnergy => found.energies[1],
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
        self.apply_forces(state, motion)?;
        // Reactions have the same bits with efforts and without.
        if parts.efforts || parts.reactions {
            state.refresh(model)?;
            self.solve_efforts(model, state, motion)?;
        } else {
            let q_ddot = by_body(motion.rates.acceleration());
            self.load_bodies(&state.at, motion, |body| q_ddot[body]);
        }
        if parts.reactions {
            self.solve_reactions(model, state)?;
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

    /// Evaluates the sizes of forces, and with them begins w and the energies.
    fn apply_forces(&mut self, state: &State, motion: KnownMotion<'_>) -> Result<(), Error> {
        self.work.demand.fill(0.0);
        self.results.energies = [0.0; 2];
        if self.applied.list.is_empty() {
            return Ok(());
        }
        let parameters = &state.pose.parameters;
        let around = Circumstances {
            parameter: &|p: ParameterId| parameters[p.index()],
            time: state.pose.time,
            inputs: motion.inputs,
        };
        self.results.energies[1] = self.applied.apply(
            &self.mechanism,
            &state.at,
            motion.rates.velocity(),
            &around,
            &mut self.results.sizes,
            &mut self.work.demand,
        )?;
        Ok(())
    }

    /// Completes w for the accelerations that only prescribed motions and velocities cause, then for
    /// those of inputs, and with both the efforts.
    ///
    /// # Errors
    ///
    /// [`SINGULAR_HERE`] for values that are not finite.
    fn solve_efforts(
        &mut self,
        model: &mut Model,
        state: &mut State,
        motion: KnownMotion<'_>,
    ) -> Result<(), Error> {
        self.work.solve_units(model, state);
        self.load_coasting_bodies(model, state, motion);
        let Work { demand, units, .. } = &mut self.work;
        let drivers = &mut self.results.drivers;
        for (forces, unit) in drivers.iter_mut().zip(&*units) {
            forces.bias = virtual_power(unit, demand);
        }
        for &input in &self.input_drivers {
            let acceleration = motion.driver_rates[input].second();
            drivers[input].inertia = self.masses.load(&units[input], acceleration, demand);
        }
        let mut sum = 0.0;
        for ((forces, unit), rates) in drivers.iter_mut().zip(units).zip(motion.driver_rates) {
            forces.effort = virtual_power(unit, demand);
            forces.power = forces.effort * rates.first();
            sum += forces.power + forces.inertia + forces.bias;
        }
        if sum.is_finite() {
            Ok(())
        } else {
            Err(SINGULAR_HERE)
        }
    }

    /// Loads the bodies by the accelerations that only prescribed motions and velocities cause.
    fn load_coasting_bodies(
        &mut self,
        model: &mut Model,
        state: &mut State,
        motion: KnownMotion<'_>,
    ) {
        let drivers = self.mechanism.drivers.iter().zip(motion.driver_rates);
        let mut coasting = drivers.map(|(driver, rates)| match driver.is_input {
            true => Jet::new(0.0, [rates.first(), 0.0]),
            false => *rates,
        });
        if state.has_single_driver()
            && let Some(coasting) = coasting.next()
        {
            let [first, second] = coasting.derivatives;
            let [units, curvatures] =
                [state.tangent.velocity(), state.tangent.acceleration()].map(by_body);
            let square = first * first;
            let q_ddot = |body: usize| {
                let (unit, curvature) = (units[body], curvatures[body]);
                [0, 1, 2].map(|k| curvature[k] * square + unit[k] * second)
            };
            self.load_bodies(&state.at, motion, q_ddot);
        } else {
            self.work.driver_rates.clear();
            self.work.driver_rates.extend(coasting);
            let mut rates = mem::take(&mut self.work.rates);
            solve_rates(model, state, &self.work.driver_rates, &mut rates);
            let q_ddot = by_body(rates.acceleration());
            self.load_bodies(&state.at, motion, |body| q_ddot[body]);
            self.work.rates = rates;
        }
    }

    /// Adds the demand of masses to w and the energies, for these accelerations of each body.
    fn load_bodies(
        &mut self,
        at: &Configuration,
        motion: KnownMotion<'_>,
        q_ddot: impl Fn(usize) -> [f64; 3],
    ) {
        let (demand, _) = self.work.demand.as_chunks_mut();
        let velocities = by_body(motion.rates.velocity());
        let energies = &mut self.results.energies;
        let gravity = self.masses.gravity;
        for of_body in &mut self.masses.bodies {
            let body = of_body.body;
            let frame = &at.frames()[body];
            of_body.turn([frame.cos, frame.sin]);
            let velocity = velocities[body];
            let own = of_body.energies(frame.origin.into(), velocity, gravity);
            *energies = [energies[0] + own[0], energies[1] + own[1]];
            let force = of_body.demand(velocity[2], q_ddot(body), gravity);
            add(&mut demand[body], force);
        }
    }

    /// Solves Phi_qᵀ λ = w. Uses up w.
    fn solve_reactions(&mut self, model: &Model, state: &State) -> Result<(), Error> {
        let system = &model.system;
        // Item by item: `memcmp` of two empty lists takes as long as a dyad.
        if !self.set_aside.iter().eq(&model.redundant.now) {
            self.factors = JacobianFactors::new(system, &model.structure, &model.plan);
            self.set_aside.clone_from(&model.redundant.now);
        }
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
        let Results {
            multipliers,
            reactions,
            ..
        } = &mut self.results;
        for (joint, reaction) in reactions.iter_mut().enumerate() {
            self.rows
                .write_reaction(system, &state.at, joint, multipliers, reaction);
            sum += reaction[0] + reaction[1] + reaction[2];
        }
        for &row in &self.rows.constraints {
            sum += multipliers[row];
        }
        if sum.is_finite() {
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

impl Work {
    /// Writes ∂q/∂u of each driver.
    fn solve_units(&mut self, model: &mut Model, state: &mut State) {
        if state.has_single_driver() {
            self.units[0].copy_from_slice(state.tangent.velocity());
            return;
        }
        for (driver, unit) in self.units.iter_mut().enumerate() {
            self.driver_rates.fill(Jet::constant(0.0));
            self.driver_rates[driver].derivatives[0] = 1.0;
            solve_rates(model, state, &self.driver_rates, &mut self.rates);
            unit.copy_from_slice(self.rates.velocity());
        }
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
