//! The state of a mechanism: the pose, and all that is derived from it.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::constraint::configuration::Configuration;
use super::constraint::{Constraint, Gradient, point_acceleration, point_velocity};
use super::error::Error;
use super::newton::Rejected;
use super::path::{DriverPath, Motions, Path, Rates};
use super::plan::compiled_mechanism::CompiledMechanism;
use super::plan::{BlockChoices, BlockState, Crossing, JacobianFactors};
use super::system::{System, Targets, Values};
use crate::mechanism::{DriverId, Jet, MarkerId};

/// The pose of a mechanism: all numbers on which its further motion depends.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Time \[s\].
    pub time: f64,
    /// All parameters, derived ones included \[SI\].
    pub parameters: Vec<f64>,
    /// The values u of all drivers \[m or rad\].
    pub drivers: Vec<f64>,
    /// Generalized coordinates, \[m, m, rad\] for each body, then the joint unknowns.
    pub q: Vec<f64>,
    /// Whole turns of the angle rows, one per row of the system.
    pub turns: Vec<i32>,
    /// The change points near which the mechanism is, none as a rule.
    pub crossings: Vec<Arc<Crossing>>,
}

impl Pose {
    /// Sets a path on which nothing moves but prescribed motions, at this pose.
    pub fn set_path(&self, path: &mut Path) {
        path.start = self.time;
        path.duration = 0.0;
        path.from.clone_from(&self.parameters);
        path.to.clone_from(&self.parameters);
        for (driver_path, value) in path.driver_paths.iter_mut().zip(&self.drivers) {
            if let DriverPath::Input { .. } = driver_path {
                *driver_path = DriverPath::held(*value, *value);
            }
        }
    }

    /// Copies another pose of the same mechanism. Allocates only for crossings.
    pub(in crate::kinematics) fn copy_from(&mut self, other: &Self) {
        self.crossings.clone_from(&other.crossings);
        self.copy_place(other);
    }

    /// Copies all but the crossings.
    pub(in crate::kinematics) fn copy_place(&mut self, other: &Self) {
        self.time = other.time;
        self.parameters.copy_from_slice(&other.parameters);
        self.drivers.copy_from_slice(&other.drivers);
        self.q.copy_from_slice(&other.q);
        self.turns.copy_from_slice(&other.turns);
    }
}

/// Choices of a solver that its pose does not determine. A choice is kept until it is no longer
/// fit, so that earlier motion has an effect on later results, in their last bits only.
#[derive(Debug, Default, PartialEq)]
pub struct SolverChoices {
    /// The rows set aside as redundant, ascending.
    pub set_aside: Vec<usize>,
    /// One entry per block with a sparse matrix, in the order of solution.
    pub blocks: Vec<BlockChoices>,
}

impl Clone for SolverChoices {
    fn clone(&self) -> Self {
        Self {
            set_aside: self.set_aside.clone(),
            blocks: self.blocks.clone(),
        }
    }

    /// Copies without allocation where the sizes agree.
    fn clone_from(&mut self, source: &Self) {
        self.set_aside.clone_from(&source.set_aside);
        self.blocks.clone_from(&source.blocks);
    }
}

/// The pose of a mechanism with all that is derived from it. A search for another pose changes what
/// is derived and leaves the pose alone; [`return_to_pose`](Self::return_to_pose) derives it again.
#[derive(Debug)]
pub(super) struct State {
    pub(super) pose: Pose,
    /// The bodies, at the pose outside of a search for another one.
    pub(super) at: Configuration,
    pub(super) targets: Targets,
    /// The prescribed motions with the parameters in force.
    pub(super) motions: Motions,
    /// Rates of q. With a single driver they are derivatives with respect to its value, from which
    /// all other rates follow; otherwise they are derivatives along a path.
    pub(super) tangent: Rates,
    /// The least regularity of all blocks, which are factorised at the pose.
    pub(super) regularity: f64,
    /// Whether the parameters in force are those of the pose.
    has_parameters: bool,
    /// Whether the plan is factorised at the pose and, with a single driver, `tangent` belongs to
    /// it.
    factorised: bool,
    /// Rates of the drivers for which rates of q are solved.
    driver_rates: Vec<Jet>,
    /// Storage for factors of the Jacobian, with the rows that these leave out; made at first use.
    factors: Option<(Vec<usize>, JacobianFactors)>,
}

/// The error of rates at a singular pose.
pub(super) const SINGULAR_HERE: Error = Error::Singular {
    rcond: 0.0,
    bodies: Vec::new(),
    aside: None,
};

/// A driver with a larger velocity, or an acceleration above the square of it, may make rates of
/// bodies overflow far from any singular position \[SI\].
const TOO_FAST: f64 = 1e100;

/// Two poses are the same if no unknown differs by more, scaled and whole turns apart: after some
/// thousand sub-steps, and up to a thousand turns, rounding is below that.
const SAME_POSE: f64 = 1e-9;

/// The rates of a single driver with respect to its own value.
pub(super) const UNIT_RATE: [Jet; 1] = [Jet::new(0.0, [1.0, 0.0])];

impl State {
    /// Makes the storage; there is no pose yet.
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let drivers = mechanism.drivers.len();
        let path = Path::new(mechanism);
        Self {
            pose: Pose {
                time: path.start,
                parameters: path.from,
                drivers: vec![0.0; drivers],
                q: vec![0.0; system.unknowns()],
                turns: vec![0; system.equations().len()],
                crossings: Vec::new(),
            },
            at: system.configuration(),
            targets: system.targets(),
            motions: Motions::new(mechanism),
            tangent: Rates::new(system.unknowns()),
            regularity: 0.0,
            has_parameters: false,
            factorised: false,
            driver_rates: vec![Jet::constant(0.0); drivers],
            factors: None,
        }
    }

    /// Takes the storage for factors of the rows that are solved.
    pub(super) fn take_factors(&mut self, compiled: &CompiledMechanism) -> JacobianFactors {
        let kept = self.factors.take();
        let fitting = kept.filter(|(set_aside, _)| *set_aside == compiled.redundant.now);
        fitting.map_or_else(
            || JacobianFactors::new(&compiled.system, &compiled.structure, &compiled.plan),
            |(_, factors)| factors,
        )
    }

    /// Keeps the storage for the next use.
    pub(super) fn keep_factors(&mut self, compiled: &CompiledMechanism, factors: JacobianFactors) {
        self.factors = Some((compiled.redundant.now.clone(), factors));
    }

    /// Returns the mechanism as block solvers see it.
    pub(super) fn block_state<'a>(&'a mut self, system: &'a System) -> BlockState<'a> {
        BlockState {
            system,
            targets: &self.targets,
            drivers: &self.pose.drivers,
            at: &mut self.at,
            tangent: &mut self.tangent,
        }
    }

    /// Returns whether one driver alone moves the mechanism.
    pub(super) fn has_single_driver(&self) -> bool {
        self.pose.drivers.len() == 1
    }

    /// Puts parameters in force that are not those of the pose.
    ///
    /// # Errors
    ///
    /// Those of [`System::set_parameters`].
    pub(super) fn try_parameters(
        &mut self,
        compiled: &mut CompiledMechanism,
        parameters: &[f64],
    ) -> Result<(), Error> {
        self.has_parameters = false;
        let CompiledMechanism { system, plan, .. } = compiled;
        system.set_parameters(parameters, &mut self.at, &mut self.targets)?;
        plan.set_parameters(system, &self.at, &self.targets);
        self.motions
            .set_parameters(|p| Jet::constant(parameters[p.index()]));
        Ok(())
    }

    /// Makes parameters those of the pose and puts them in force.
    ///
    /// # Errors
    ///
    /// Those of [`System::set_parameters`].
    pub(super) fn set_parameters(
        &mut self,
        compiled: &mut CompiledMechanism,
        parameters: &[f64],
    ) -> Result<(), Error> {
        self.try_parameters(compiled, parameters)?;
        self.accept_parameters(parameters);
        Ok(())
    }

    /// Makes the parameters in force those of the pose.
    pub(super) fn accept_parameters(&mut self, parameters: &[f64]) {
        self.pose.parameters.copy_from_slice(parameters);
        self.has_parameters = true;
    }

    /// Makes the present places of the bodies those of the pose.
    pub(super) fn accept_bodies(&mut self) {
        self.at.copy_pose(&mut self.pose.q);
    }

    /// Derives the parameters in force and the bodies from the pose again.
    pub(super) fn return_to_pose(&mut self, compiled: &mut CompiledMechanism) {
        if !self.has_parameters {
            let parameters = std::mem::take(&mut self.pose.parameters);
            let set = self.try_parameters(compiled, &parameters);
            set.expect("the parameters of a pose were valid when it was found");
            self.pose.parameters = parameters;
            self.has_parameters = true;
        }
        self.move_to_pose(&compiled.system);
    }

    /// Moves the bodies to the pose.
    pub(super) fn move_to_pose(&mut self, system: &System) {
        self.factorised = false;
        self.at.set_pose(system.mechanism(), &self.pose.q);
    }

    /// Factorises the plan at the pose and, with a single driver, solves the tangent there, unless
    /// both are up to date.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where a Jacobian is singular to the last bit.
    #[inline]
    pub(super) fn refresh(&mut self, compiled: &mut CompiledMechanism) -> Result<(), Error> {
        if self.factorised {
            return Ok(());
        }
        self.factorise(compiled)
    }

    #[inline(never)]
    fn factorise(&mut self, compiled: &mut CompiledMechanism) -> Result<(), Error> {
        let single = self.has_single_driver();
        let CompiledMechanism { system, plan, .. } = compiled;
        let mut state = self.block_state(system);
        plan.factorise(&mut state)
            .map_err(|Rejected| SINGULAR_HERE)?;
        if single {
            plan.solve_rates(&mut state, &UNIT_RATE);
        }
        self.regularity = plan.regularity();
        self.factorised = true;
        Ok(())
    }

    /// Notes that the plan is not factorised at the pose.
    pub(super) fn invalidate(&mut self) {
        self.factorised = false;
    }

    /// Compiles the plan again, for the rows that the mechanism has now.
    pub(super) fn compile(&mut self, compiled: &mut CompiledMechanism) {
        compiled.compile(&self.at, &self.targets);
        self.factorised = false;
    }

    /// Sets these redundant rows aside. If other rows were set aside before, removes the crossings
    /// from the pose. Returns false if the rows are of another mechanism; the rows set aside then
    /// stay.
    pub(super) fn set_aside(&mut self, compiled: &mut CompiledMechanism, rows: &[usize]) -> bool {
        if compiled.redundant.now == rows {
            return true;
        }
        self.release_crossings(compiled);
        let fits = compiled.set_aside(rows);
        if fits {
            self.compile(compiled);
        }
        fits
    }

    /// Goes to a pose that this mechanism was at. If the pose has crossings, sets aside the rows
    /// that they require.
    pub(super) fn restore(&mut self, compiled: &mut CompiledMechanism, pose: &Pose) {
        self.has_parameters &= self.pose.parameters == pose.parameters;
        self.release_crossings(compiled);
        self.pose.copy_place(pose);
        self.targets.turns.copy_from_slice(&self.pose.turns);
        self.return_to_pose(compiled);
        if let Some(crossing) = pose.crossings.first() {
            let fits = self.set_aside(compiled, &crossing.set_aside);
            debug_assert!(fits, "the mechanism was at the pose");
        }
        for crossing in &pose.crossings {
            self.add_crossing(compiled, crossing);
        }
    }

    /// Goes to a pose and restores the choices that were in use there. Returns false if the choices
    /// are of another mechanism; row choice and pivots are then unspecified.
    pub(super) fn resume(
        &mut self,
        compiled: &mut CompiledMechanism,
        pose: &Pose,
        choices: &SolverChoices,
    ) -> bool {
        if !self.set_aside(compiled, &choices.set_aside) {
            return false;
        }
        self.restore(compiled, pose);
        compiled.plan.take_choices(&choices.blocks)
    }

    /// Adds a crossing to the pose; it gives the unknowns of its block from now on.
    pub(super) fn add_crossing(
        &mut self,
        compiled: &mut CompiledMechanism,
        crossing: &Arc<Crossing>,
    ) {
        compiled.plan.interpolate(crossing);
        self.pose.crossings.push(Arc::clone(crossing));
    }

    /// Removes the crossing with this index from the pose.
    pub(super) fn remove_crossing(&mut self, compiled: &mut CompiledMechanism, index: usize) {
        let crossing = self.pose.crossings.remove(index);
        compiled.plan.release(crossing.block);
    }

    /// Removes all crossings from the pose.
    pub(super) fn release_crossings(&mut self, compiled: &mut CompiledMechanism) {
        while let Some(crossing) = self.pose.crossings.pop() {
            compiled.plan.release(crossing.block);
        }
    }

    /// Returns the whole turns of each unknown from a pose to the present one, zero for places;
    /// `None` for one that is elsewhere.
    pub(super) fn whole_turns_since(
        &self,
        system: &System,
        before: &Pose,
    ) -> impl Iterator<Item = Option<f64>> {
        let size = self.at.size();
        let unknowns = self.pose.q.iter().zip(&before.q).enumerate();
        unknowns.map(move |(column, (&now, &before))| {
            let difference = system.difference(column, size, now, before);
            let turns = if system.is_angle(column) {
                ((now - before) / TAU).round()
            } else {
                0.0
            };
            (difference.abs() < SAME_POSE).then_some(turns)
        })
    }

    /// Returns the numbers in the equations at the present places of the bodies.
    pub(super) fn values(&self) -> Values<'_> {
        Values {
            at: &self.at,
            targets: &self.targets,
            drivers: &self.pose.drivers,
        }
    }

    /// Returns the ratio of the least to the largest singular value of a part of the Jacobian at
    /// the present places of the bodies: these rows and columns, the columns ascending.
    pub(super) fn dense_rcond(&self, system: &System, rows: &[usize], columns: &[usize]) -> f64 {
        let place = |column: usize| columns.binary_search(&column).ok();
        let (_, jacobian) = system.dense_rows(rows, columns.len(), place, self.values());
        let singular = jacobian.singular_values();
        singular.min() / singular.max()
    }

    /// Returns the largest scaled residual of Phi at the pose.
    pub(super) fn residual(&self, system: &System) -> f64 {
        system.largest_residual(&self.at, &self.targets, &self.pose.drivers)
    }

    /// Returns the smallest scaled reciprocal condition of a block at the pose; zero in a singular
    /// position.
    pub(super) fn rcond(&mut self, compiled: &mut CompiledMechanism) -> f64 {
        match self.refresh(compiled) {
            Ok(()) => compiled.plan.rcond(),
            Err(_) => 0.0,
        }
    }

    /// Solves the rates of q at the pose for these rates of the drivers.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular, [`Error::NoMotion`] for rates of a driver
    /// that are not finite, [`Error::TooFast`] where they make those of bodies overflow.
    pub(super) fn solve_rates(
        &mut self,
        compiled: &mut CompiledMechanism,
        driver: impl Fn(DriverId) -> Jet,
        rates: &mut Rates,
    ) -> Result<(), Error> {
        self.refresh(compiled)?;
        let finite = if self.has_single_driver() {
            let [first, second] = driver(DriverId(0)).derivatives;
            self.tangent.scale(first, second, rates)
        } else {
            for (index, jet) in self.driver_rates.iter_mut().enumerate() {
                *jet = driver(DriverId(index));
            }
            let mut state = BlockState {
                system: &compiled.system,
                targets: &self.targets,
                drivers: &self.pose.drivers,
                at: &mut self.at,
                tangent: rates,
            };
            compiled.plan.solve_rates(&mut state, &self.driver_rates);
            rates.is_finite()
        };
        if finite {
            Ok(())
        } else {
            Err(self.explain_rates(&compiled.system, driver))
        }
    }

    /// Returns value, rate and acceleration of a measure at the pose.
    pub(super) fn measure(&self, measure: &dyn Constraint, rates: &Rates) -> Jet {
        let mut gradient = Gradient::new();
        measure.gradient(&self.at, &mut gradient);
        let (q_dot, q_ddot) = (rates.velocity(), rates.acceleration());
        let velocity = gradient.dot(q_dot);
        let acceleration = gradient.dot(q_ddot) + measure.quadratic(&self.at, q_dot);
        Jet::new(measure.value(&self.at), [velocity, acceleration])
    }

    /// Returns bounds of the rounding errors of value, rate and acceleration of a measure at the pose: each
    /// is a sum, such as ċ = Σ ∂c/∂q q̇, and its error is some roundings of the magnitudes in it, which may
    /// cancel. A rate is that at the time of the pose, which is rounded too.
    pub(super) fn measure_roundings(&self, measure: &dyn Constraint, rates: &Rates) -> [f64; 3] {
        /// Roundings of a term: those of the bodies that it depends on, some ten operations each. Halved,
        /// rates at rest of deep chains may count as motion. Doubled, motion twice as slow counts as rest.
        const TERM_ROUNDING: f64 = 64.0 * f64::EPSILON;
        let mut gradient = Gradient::new();
        measure.gradient(&self.at, &mut gradient);
        let (q_dot, q_ddot) = (rates.velocity(), rates.acceleration());
        let size = |vector: &[f64]| -> f64 {
            let products = gradient.entries().map(|(k, partial)| partial * vector[k]);
            products.map(f64::abs).sum()
        };
        let quadratic = measure.quadratic(&self.at, q_dot);
        let acceleration = gradient.dot(q_ddot) + quadratic;
        let sizes = [
            size(&self.pose.q),
            size(q_dot) + (acceleration * self.pose.time).abs(),
            size(q_ddot) + quadratic.abs(),
        ];
        sizes.map(|size| TERM_ROUNDING * size)
    }

    /// Returns point, velocity and acceleration of a marker: the x component, then the y component.
    pub(super) fn marker(&self, marker: MarkerId, rates: &Rates) -> [Jet; 2] {
        let marker = self.at.marker(marker);
        let velocity = point_velocity(marker, rates.velocity());
        let acceleration = point_acceleration(marker, rates.velocity(), rates.acceleration());
        [0, 1].map(|k| Jet::new(marker.point[k], [velocity[k], acceleration[k]]))
    }

    /// Returns the cause of rates that are not finite.
    #[cold]
    fn explain_rates(&self, system: &System, driver: impl Fn(DriverId) -> Jet) -> Error {
        let mut drivers = (0..self.pose.drivers.len()).map(DriverId);
        let endless =
            drivers.find(|&id| !driver(id).derivatives.iter().all(|rate| rate.is_finite()));
        if let Some(id) = endless {
            return Error::NoMotion {
                driver: system.describe_driver(id),
                quantity: "velocity or acceleration",
            };
        }
        let is_too_fast = |jet: Jet| jet.first().abs().max(jet.second().abs().sqrt()) > TOO_FAST;
        let mut drivers = (0..self.pose.drivers.len()).map(DriverId);
        let too_fast = drivers.find(|&id| is_too_fast(driver(id)));
        too_fast.map_or(SINGULAR_HERE, |id| Error::TooFast {
            driver: system.describe_driver(id),
        })
    }
}
