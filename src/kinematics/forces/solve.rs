//! All forces at a pose.

use std::iter;
use std::sync::Arc;

use super::applied::AppliedForces;
use super::inertial::{DriverLoads, Masses, by_body};
use super::results::{DriverForces, Results};
use super::self_stress::SelfStresses;
use super::wrench::{Contact, ReactionRows};
use crate::kinematics::error::{Error, NoLimit};
use crate::kinematics::newton::Rejected;
use crate::kinematics::path::Rates;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockState, JacobianFactors};
use crate::kinematics::singular::{Kind, MotionPoint, NearPoint, near_point};
use crate::kinematics::state::{Pose, SINGULAR_HERE, State};
use crate::mechanism::{
    BeyondPoints, Corner, Driver, DriverId, ForceQuantity, Indeterminate, Jet, Load, Mechanism,
    ParameterId,
};

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
    loads: usize,
    pub(super) factors: JacobianFactors,
    /// Rows that the factors leave out.
    set_aside: Vec<usize>,
    pub(super) rows: ReactionRows,
    pub(super) contacts: Vec<Contact>,
    self_stresses: SelfStresses,
    pub(super) results: Results,
    work: Work,
}

/// Work space for mechanisms with several drivers.
#[derive(Debug)]
struct Work {
    /// Per driver: its rates, without the acceleration of an input.
    coasting: Vec<Jet>,
    /// Per driver: the acceleration of an input, zero for a prescribed motion.
    free: Vec<f64>,
    /// ∂q/∂u: the first three unknowns for each driver, the next three, …
    units: Vec<[f64; 3]>,
    unit_rates: Vec<Jet>,
    rates: Rates,
}

/// The motion for which forces are sought, at the pose of the solver.
#[derive(Clone, Copy, Debug)]
pub struct KnownMotion<'a> {
    /// Rates of q.
    pub rates: &'a Rates,
    /// Rates of the drivers (`first` and `second`), to which those of q belong.
    pub driver_rates: &'a [Jet],
    /// Sizes of the forces without a law: [loads](Forces::loads).
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
    /// Reactions alone, which tell whether contacts pull.
    pub const REACTIONS: Self = Self {
        efforts: false,
        reactions: true,
    };
}

impl Forces {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(compiled: &CompiledMechanism) -> Self {
        let system = &compiled.system;
        let mechanism = Arc::clone(system.mechanism());
        let (_, loads) = mechanism.load_places();
        let (unknowns, drivers) = (system.unknowns(), mechanism.drivers.len());
        let rows = ReactionRows::new(system);
        Self {
            parameters: Vec::with_capacity(mechanism.parameters.len()),
            has_parameters: false,
            masses: Masses::new(&mechanism, &|p: ParameterId| {
                mechanism.parameters[p.index()].default
            }),
            applied: AppliedForces::new(system),
            loads,
            factors: JacobianFactors::new(system, &compiled.structure, &compiled.plan),
            set_aside: compiled.redundant.now.clone(),
            contacts: Contact::all(&mechanism, &rows),
            rows,
            self_stresses: SelfStresses::default(),
            results: Results::new(&mechanism, unknowns, system.equations().len()),
            work: Work {
                coasting: vec![Jet::constant(0.0); drivers],
                free: vec![0.0; drivers],
                units: vec![[0.0; 3]; unknowns.div_ceil(3) * drivers],
                unit_rates: vec![Jet::constant(0.0); drivers],
                rates: Rates::new(unknowns),
            },
            mechanism,
        }
    }

    /// Returns the number of loads: [inputs and sizes of forces that are inputs](Mechanism::load_inputs),
    /// then the sizes of passive forces, in file order.
    #[must_use]
    pub fn loads(&self) -> usize {
        self.loads
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
            ForceQuantity::Share(joint, place) => found.shares[joint][place],
            ForceQuantity::Held(constraint) => found.multipliers[self.rows.constraints[constraint]],
            ForceQuantity::Applied(force, component) => found.sizes[force][component],
            ForceQuantity::Pushes(first, end) => {
                found.sizes[first..end].iter().map(|[push, ..]| push).sum()
            }
            ForceQuantity::KineticEnergy => found.energies[0],
            ForceQuantity::PotentialEnergy => found.energies[1],
        }
    }

    /// Returns the arguments of functions on whose points the sizes of forces have corners or jump, at the
    /// pose for which these were evaluated last.
    #[must_use]
    pub fn corners(&self) -> &[Corner] {
        &self.applied.corners
    }

    /// Shows `meet` the functions that sizes of forces have called beyond their points, at the pose for
    /// which these were evaluated last, with the parameters and the time of it and these loads. Allocates
    /// nothing.
    pub fn visit_beyond(&self, pose: &Pose, loads: &[f64], meet: &mut dyn FnMut(BeyondPoints)) {
        let parameter = |p: ParameterId| pose.parameters[p.index()];
        let around = (&parameter, pose.time, loads);
        self.applied.visit_beyond(&self.mechanism, around, meet);
    }

    /// Returns force and torque that a joint exerts at its second marker \[N and N m\].
    #[must_use]
    pub fn reaction(&self, joint: usize) -> [f64; 3] {
        self.results.reactions[joint]
    }

    /// Returns the number of joints that can only push.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// Solves the forces at the pose. Allocates nothing, unless other rows have become redundant or
    /// reactions are sought next to a change point.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::Mass`] for masses without a meaning, [`Error::NoForce`] for
    /// a force without direction or size, [`Error::Singular`] where the pose is singular,
    /// [`Error::ChangePoint`] where reactions have no limit at a change point.
    pub(in crate::kinematics) fn solve(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
        parts: ForceParts,
    ) -> Result<(), Error> {
        if parts.reactions
            && !state.pose.crossings.is_empty()
            && let Some(point) = near_point(compiled, state)
        {
            return self.solve_near(&point, compiled, state, motion);
        }
        self.solve_directly(compiled, state, motion, parts)
    }

    /// Solves the forces with the Jacobian at the pose.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](Self::solve).
    pub(super) fn solve_directly(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
        parts: ForceParts,
    ) -> Result<(), Error> {
        self.set_parameters(state)?;
        self.apply_forces(state, motion.rates.velocity(), motion.inputs)?;
        // Reactions have the same bits with efforts and without.
        if parts.efforts || parts.reactions {
            state.refresh(compiled)?;
            self.solve_efforts(compiled, state, motion)?;
        } else {
            self.add_energies(state, motion);
        }
        if parts.reactions {
            self.solve_reactions(compiled, state)?;
        }
        Ok(())
    }

    /// Solves all forces next to a change point: reactions as limits along the motion.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](Self::solve).
    #[cold]
    fn solve_near(
        &mut self,
        point: &NearPoint,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
    ) -> Result<(), Error> {
        let efforts = ForceParts {
            efforts: true,
            reactions: false,
        };
        self.solve_directly(compiled, state, motion, efforts)?;
        let mut loads = Loads::new(motion.inputs, &self.results.demand);
        let found = point.interpolate(
            compiled,
            state,
            motion.driver_rates,
            |_| Kind { group: 0, level: 0 },
            |compiled, state, place, values| {
                let motion = loads.motion(place);
                self.solve_directly(compiled, state, motion, ForceParts::ALL)?;
                let rows = compiled.system.equations().iter();
                let scaled = rows
                    .zip(&self.results.multipliers)
                    .map(|(row, multiplier)| multiplier / row.row_scale(&state.at));
                values.extend(scaled);
                Ok(())
            },
        );
        self.solve_directly(compiled, state, motion, efforts)?;
        let none = || {
            found
                .as_ref()
                .is_none_or(|all| all.iter().any(|value| value.is_nan()))
        };
        if point.is_at && none() {
            return Err(point.no_limit(compiled, NoLimit::Reactions));
        }
        if none() {
            self.solve_multipliers(compiled, state)?;
        }
        let rows = compiled
            .system
            .equations()
            .iter()
            .zip(found.iter().flatten());
        for (multiplier, (row, value)) in self.results.multipliers.iter_mut().zip(rows) {
            if !value.is_nan() {
                *multiplier = value * row.row_scale(&state.at);
            }
        }
        self.write_reactions(compiled, state)
    }

    /// Evaluates the masses, if parameters have changed.
    pub(super) fn set_parameters(&mut self, state: &State) -> Result<(), Error> {
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
        for force in &self.mechanism.forces {
            if let Load::Passive { cause, .. } = &force.load
                && let Some(reason) = cause.fault(&self.mechanism, now)
            {
                let force = force.name.clone();
                return Err(Error::NoForce { force, reason });
            }
        }
        self.has_parameters = true;
        Ok(())
    }

    /// Evaluates the sizes of forces, and with them begins w and the energies.
    pub(super) fn apply_forces(
        &mut self,
        state: &State,
        q_dot: &[f64],
        inputs: &[f64],
    ) -> Result<(), Error> {
        self.results.demand.fill(0.0);
        self.results.energies = [0.0; 2];
        if self.applied.list.is_empty() {
            return Ok(());
        }
        let parameters = &state.pose.parameters;
        let parameter = |p: ParameterId| parameters[p.index()];
        self.results.energies[1] = self.applied.apply(
            &self.mechanism,
            &state.at,
            q_dot,
            (&parameter, state.pose.time, inputs),
            &mut self.results.sizes,
            &mut self.results.demand,
        )?;
        Ok(())
    }

    /// Adds the energies of bodies. Leaves w without meaning.
    fn add_energies(&mut self, state: &State, motion: KnownMotion<'_>) {
        let Results {
            demand, energies, ..
        } = &mut self.results;
        let drivers = DriverLoads {
            units: &[],
            free: &[],
            forces: &mut [],
        };
        let unused = iter::repeat([0.0; 3]);
        let velocity = motion.rates.velocity();
        self.masses
            .load(&state.at, velocity, unused, drivers, demand, energies);
    }

    /// Completes w and the energies, and finds the forces of drivers.
    ///
    /// # Errors
    ///
    /// [`SINGULAR_HERE`] for values that are not finite.
    fn solve_efforts(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
    ) -> Result<(), Error> {
        let Self {
            work,
            masses,
            results,
            ..
        } = self;
        let Results {
            demand,
            drivers,
            energies,
            ..
        } = results;
        let velocity = motion.rates.velocity();
        if let [driver] = &mut drivers[..] {
            let (coasting, free) =
                coasting_and_free(&self.mechanism.drivers[0], &motion.driver_rates[0]);
            let [first, second] = coasting.derivatives;
            let tangent = [state.tangent.velocity(), state.tangent.acceleration()];
            let [units, curvatures] = tangent.map(by_body);
            let square = first * first;
            let accelerations = units.iter().zip(curvatures).map(|(unit, curvature)| {
                [0, 1, 2].map(|k| curvature[k] * square + unit[k] * second)
            });
            let mut forces = [DriverForces::default()];
            let driven = DriverLoads {
                units,
                free: &[free],
                forces: &mut forces,
            };
            masses.load(&state.at, velocity, accelerations, driven, demand, energies);
            [*driver] = forces;
        } else {
            work.solve_units(compiled, state);
            for (driver, definition) in self.mechanism.drivers.iter().enumerate() {
                (work.coasting[driver], work.free[driver]) =
                    coasting_and_free(definition, &motion.driver_rates[driver]);
            }
            solve_rates(compiled, state, &work.coasting, &mut work.rates);
            let accelerations = by_body(work.rates.acceleration()).iter().copied();
            drivers.fill(DriverForces::default());
            let driven = DriverLoads {
                units: &work.units,
                free: &work.free,
                forces: drivers,
            };
            masses.load(&state.at, velocity, accelerations, driven, demand, energies);
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

    /// Solves Phi_qᵀ λ = w and the reactions. Uses up w.
    fn solve_reactions(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
    ) -> Result<(), Error> {
        self.solve_multipliers(compiled, state)?;
        self.write_reactions(compiled, state)
    }

    /// Solves Phi_qᵀ λ = w. Uses up w.
    fn solve_multipliers(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
    ) -> Result<(), Error> {
        let system = &compiled.system;
        // Item by item: `memcmp` of two empty lists takes as long as a dyad.
        if !self.set_aside.iter().eq(&compiled.redundant.now) {
            self.factors = JacobianFactors::new(system, &compiled.structure, &compiled.plan);
            self.set_aside.clone_from(&compiled.redundant.now);
            // The solution leaves λ of rows set aside as it is.
            self.results.multipliers.fill(0.0);
        }
        let is_of_least_norm = self.is_of_least_norm();
        let Results {
            demand,
            multipliers,
            ..
        } = &mut self.results;
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
                .solve_transposed_at(&compiled.plan, system, &state.at, demand, multipliers)
                .map_err(|Rejected| SINGULAR_HERE)?;
        }
        Ok(())
    }

    /// Writes the reactions that λ makes.
    fn write_reactions(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
    ) -> Result<(), Error> {
        let Results {
            multipliers,
            reactions,
            shares,
            sizes,
            ..
        } = &mut self.results;
        for (joint, row, coupling) in self.rows.couplings(&compiled.system) {
            let partials = coupling.partials(&state.at);
            for (share, partial) in shares[joint].iter_mut().zip(partials) {
                *share = multipliers[row] * partial;
            }
        }
        for (joint, force, coupling) in self.rows.open_couplings() {
            let partials = coupling.partials(&state.at);
            for (share, partial) in shares[joint].iter_mut().zip(partials) {
                *share = sizes[force][0] * partial;
            }
        }
        let mut held = self.rows.constraints.iter();
        let finite =
            self.rows
                .write_reactions(&compiled.system, &state.at, multipliers, sizes, reactions)
                && held.all(|&row| multipliers[row].is_finite());
        if finite { Ok(()) } else { Err(SINGULAR_HERE) }
    }

    /// Returns whether reactions that are indeterminate are those of least norm.
    pub(super) fn is_of_least_norm(&self) -> bool {
        let wanted = self.mechanism.outputs.indeterminate == Indeterminate::MinimumNorm;
        wanted && !self.set_aside.is_empty()
    }

    /// Returns ∂q/∂u of a driver at the pose of the last efforts, at which `state` still is.
    pub(super) fn unit(&self, state: &State, driver: DriverId) -> Vec<f64> {
        if state.has_single_driver() {
            return state.tangent.velocity().to_vec();
        }
        let of_driver = self.work.units.iter().skip(driver.index());
        let of_driver = of_driver.step_by(self.mechanism.drivers.len());
        let mut unit: Vec<f64> = of_driver.flatten().copied().collect();
        unit.truncate(self.results.demand.len());
        unit
    }
}

/// The inputs of forces at the places of a motion.
pub(super) struct Loads<'a> {
    here: &'a [f64],
    there: Vec<f64>,
    /// Natural change per radian: the largest force that bodies demand.
    change: f64,
}

impl<'a> Loads<'a> {
    pub(super) fn new(here: &'a [f64], demand: &[f64]) -> Self {
        let change = demand.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
        Self {
            there: here.to_vec(),
            change: if change > 0.0 { change } else { 1.0 },
            here,
        }
    }

    /// Returns the largest force that bodies demand.
    pub(super) fn natural(&self) -> f64 {
        self.change
    }

    /// Returns the motion at a place.
    pub(super) fn motion<'b>(&'b mut self, place: &MotionPoint<'b>) -> KnownMotion<'b> {
        for (there, here) in self.there.iter_mut().zip(self.here) {
            *there = here + place.drift * self.change;
        }
        KnownMotion {
            rates: place.rates,
            driver_rates: place.driver_rates,
            inputs: &self.there,
        }
    }
}

impl Work {
    /// Writes ∂q/∂u of each of several drivers.
    fn solve_units(&mut self, compiled: &mut CompiledMechanism, state: &mut State) {
        let count = self.unit_rates.len();
        for driver in 0..count {
            self.unit_rates.fill(Jet::constant(0.0));
            self.unit_rates[driver].derivatives[0] = 1.0;
            solve_rates(compiled, state, &self.unit_rates, &mut self.rates);
            let own = self.units.iter_mut().skip(driver).step_by(count);
            for (own, solved) in own.zip(self.rates.velocity().chunks(3)) {
                own[..solved.len()].copy_from_slice(solved);
            }
        }
    }
}

/// Returns the rates of a driver without the acceleration of an input, and this acceleration; zero
/// for a prescribed motion.
fn coasting_and_free(driver: &Driver, rates: &Jet) -> (Jet, f64) {
    let [first, second] = rates.derivatives;
    let [coasting, free] = if driver.has_open_acceleration() {
        [0.0, second]
    } else {
        [second, 0.0]
    };
    (Jet::new(0.0, [first, coasting]), free)
}

/// Solves the rates of q for these rates of the drivers, at the pose at which the plan is
/// factorised.
pub(super) fn solve_rates(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    driver_rates: &[Jet],
    rates: &mut Rates,
) {
    let mut block_state = BlockState {
        system: &compiled.system,
        targets: &state.targets,
        drivers: &state.pose.drivers,
        at: &mut state.at,
        tangent: rates,
    };
    compiled.plan.solve_rates(&mut block_state, driver_rates);
}
