//! The right-hand side: accelerations of freedoms at a trial point.

use nalgebra::DMatrix;

use super::error::Error;
use super::free_state::FreeState;
use super::gaps::GapWatch;
use super::given::Given;
use super::passive::{Passive, PassiveForces};
use super::strike::Strike;
use super::triangular::{ascend, descend};
use super::turns::Turns;
use super::watch::{Verdict, Watch};
use crate::kinematics::{
    Blocked, Direction, DriverPath, EquationsOfMotion, ForceParts, Forces, KnownMotion, Path, Pose,
    Rates, Reason, Solution, Solver, SolverChoices,
};
use crate::mechanism::{BeyondPoints, DriverId, Jet, Mechanism, Order};

/// A freedom feels no inertia of its own if this part of √M ∂q/∂u is left of it where those of others
/// are taken out: some hundred roundings.
const NO_INERTIA: f64 = 1e-13;

/// The part of the forces on which friction in joints depends.
const REACTIONS: ForceParts = ForceParts {
    efforts: false,
    reactions: true,
};

/// The equations of a mechanism, and the accepted pose from which trials set out.
#[derive(Debug)]
pub(super) struct Equations {
    /// The freedoms among the drivers, ascending.
    pub(super) freedoms: Vec<DriverId>,
    /// Directions along which the motion is differentiated, with the changes of freedoms at the start.
    pub(super) directions: Vec<Direction>,
    pub(super) forces: Forces,
    motion: EquationsOfMotion,
    /// From the solver's pose straight to the values at a trial point.
    path: Path,
    /// The parts of √M q̈ where no freedom accelerates along the columns √M ∂q/∂u, made orthonormal.
    along: Vec<f64>,
    /// L of J = L Lᵀ.
    pub(super) factor: DMatrix<f64>,
    pub(super) accelerations: Vec<f64>,
    pub(super) passive: PassiveForces,
    /// Whether steps need no proof where no gap is open: a single driver, and no open curves.
    is_plain: bool,
    /// Rates of q for the reactions of joints with friction.
    rates: Rates,
    pub(super) watch: Watch,
    /// The strikes at the last event, where the motion has directions.
    pub(super) strikes: Vec<Strike>,
    pub(super) turns: Turns,
    /// Per function of the file: the first time \[s\] of an accepted point at which a force has called it
    /// beyond its points, since this was asked last.
    pub(super) beyond: Vec<Option<(f64, BeyondPoints)>>,
    /// The trial point at which the equations are.
    pub(super) point: Point,
    /// The last point accepted, with the solver's pose and choices there.
    pub(super) accepted: Point,
    pose: Pose,
    choices: SolverChoices,
    /// The pose at the end of a step, while the step is proved.
    end: Pose,
    /// Whether the solver may be anywhere, after a trial that failed.
    is_astray: bool,
}

/// A point of the motion.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Value, velocity and acceleration of each driver.
    pub(super) drivers: Vec<Jet>,
    /// Sizes of the forces that are inputs, then of passive forces.
    pub(super) loads: Vec<f64>,
    pub(super) passive: Vec<Passive>,
    /// Kinetic energy, and potential energy of gravity \[J\].
    pub(super) energy: f64,
    /// Kinetic energy alone \[J\].
    pub(super) kinetic_energy: f64,
    /// Work of all that acts on the bodies but gravity since the energy was noted \[J\].
    pub(super) work: f64,
}

impl Point {
    fn copy_from(&mut self, other: &Self) {
        self.drivers.copy_from_slice(&other.drivers);
        self.loads.copy_from_slice(&other.loads);
        self.passive.copy_from_slice(&other.passive);
        self.energy = other.energy;
        self.kinetic_energy = other.kinetic_energy;
        self.work = other.work;
    }

    /// Returns whether a motion goes on smoothly from one point to another at the same place: with
    /// the same rates of what is given.
    fn joins(&self, other: &Self, inputs: usize, mechanism: &Mechanism) -> bool {
        let pairs = self.drivers.iter().zip(&other.drivers);
        let mut pairs = pairs.zip(&mechanism.drivers);
        self.loads[..inputs] == other.loads[..inputs]
            && pairs.all(|((one, other), driver)| driver.is_free() || one == other)
    }
}

impl Equations {
    /// Makes the storage for a solver's mechanism; its pose is accepted.
    pub(super) fn new(solver: &Solver, directions: Vec<Direction>) -> Self {
        let drivers = solver.mechanism().drivers.iter().enumerate();
        let freedoms = drivers.filter(|(_, driver)| driver.is_free());
        let freedoms: Vec<_> = freedoms.map(|(index, _)| DriverId(index)).collect();
        let forces = solver.forces();
        let (count, unknowns) = (freedoms.len(), solver.pose().q.len());
        let passive = PassiveForces::new(solver, count);
        let drivers = solver.pose().drivers.iter();
        let mut loads = vec![0.0; forces.loads()];
        solver.mechanism().write_load_starts(&mut loads);
        let point = Point {
            drivers: drivers.map(|value| Jet::constant(*value)).collect(),
            loads,
            passive: vec![Passive::NONE; passive.list.len()],
            energy: 0.0,
            kinetic_energy: 0.0,
            work: 0.0,
        };
        let mut equations = Self {
            freedoms,
            directions,
            motion: solver.equations_of_motion(),
            path: Path::new(solver.mechanism()),
            forces,
            along: vec![0.0; count],
            factor: DMatrix::zeros(count, count),
            accelerations: vec![0.0; count],
            watch: Watch::new(&passive),
            strikes: Vec::new(),
            turns: Turns::new(
                solver
                    .mechanism()
                    .forces
                    .iter()
                    .map(|f| f.load.corners())
                    .sum(),
            ),
            beyond: vec![None; solver.mechanism().functions.list().len()],
            passive,
            is_plain: solver.pose().drivers.len() < 2 && !solver.has_ends_of_curves(),
            rates: Rates::new(unknowns),
            accepted: point.clone(),
            point,
            pose: solver.pose().clone(),
            end: solver.pose().clone(),
            choices: SolverChoices::default(),
            is_astray: false,
        };
        equations.keep(solver);
        equations
    }

    /// Returns whether the freedoms move the coordinate of a passive force where the equations are.
    pub(super) fn moves(&self, force: usize) -> bool {
        let mut freedoms = self.freedoms.iter();
        freedoms.any(|id| self.passive.rows[(force, id.index())] != 0.0)
    }

    /// Returns the number of forces that are inputs.
    pub(super) fn inputs(&self) -> usize {
        self.point.loads.len() - self.passive.loads()
    }

    /// Accepts the point at which the equations and the solver are, with its forces.
    pub(super) fn accept(&mut self, solver: &Solver) {
        let (pose, beyond) = (solver.pose(), &mut self.beyond);
        self.forces
            .visit_beyond(pose, &self.point.loads, &mut |found| {
                beyond[found.function].get_or_insert((pose.time, found));
            });
        self.keep(solver);
    }

    /// Takes the point at which the equations and the solver are for the accepted one.
    fn keep(&mut self, solver: &Solver) {
        self.accepted.copy_from(&self.point);
        self.watch.accept(solver.pose().time);
        self.turns.accept(self.forces.corners());
        solver.save(&mut self.pose);
        solver.copy_choices(&mut self.choices);
        self.is_astray = false;
    }

    /// Takes the solver's pose for that of an accepted point.
    pub(super) fn resume(&mut self, solver: &Solver, state: &FreeState) {
        self.point.drivers.copy_from_slice(&state.drivers);
        self.point.loads.copy_from_slice(&state.loads);
        self.point.passive.copy_from_slice(&state.passive);
        [self.point.energy, self.point.kinetic_energy, _] = state.energies;
        self.point.work = state.integrator.x[2 * self.freedoms.len()];
        self.passive.resume(&state.modes);
        self.watch.begin();
        self.turns.begin();
        self.keep(solver);
        self.turns.accept(&state.corners);
    }

    /// Solves accelerations and passive forces at the solver's pose for the rates and inputs of a
    /// solution; for the inputs at the accepted point where the solution seeks no forces.
    pub(super) fn solve_at(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
    ) -> Result<(), Error> {
        self.point.drivers.copy_from_slice(&solution.driver_rates);
        let seeks_forces = solution.forces().is_some();
        let loads = if seeks_forces {
            &solution.loads
        } else {
            &self.accepted.loads
        };
        self.point.loads.copy_from_slice(loads);
        self.solve(solver)?;
        for freedom in &self.freedoms {
            let index = freedom.index();
            solution.driver_rates[index].derivatives[1] = self.point.drivers[index].second();
        }
        if seeks_forces {
            solution.loads.copy_from_slice(&self.point.loads);
        }
        Ok(())
    }

    /// Returns the time at which an event is expected from the accepted point on, if one was found beyond.
    pub(super) fn expected(&self, now: f64) -> Option<f64> {
        self.watch.goal(&self.passive, now, &self.accepted.passive)
    }

    /// Notes the present point, of a stage of a step, for [`judge`](Self::judge).
    pub(super) fn note(&mut self, time: f64) {
        self.watch.stages.note(time, &self.point.passive);
    }

    /// Looks for events between the accepted point and the present one.
    pub(super) fn judge(&mut self, solver: &Solver) -> Verdict {
        let times = [self.pose.time, solver.pose().time];
        let points = [&*self.accepted.passive, &*self.point.passive];
        let verdict = self.watch.judge(&self.passive, times, points);
        let Some(turn) = self.turns.judge(times, self.forces.corners()) else {
            return verdict;
        };
        self.watch.ended.clear();
        match verdict {
            Verdict::Ends(time) => Verdict::Ends(time.min(turn)),
            Verdict::Lasts | Verdict::Unclear => Verdict::Ends(turn),
        }
    }

    /// Returns whether the motion ceases to be smooth at the accepted point.
    pub(super) fn is_at_event(&self) -> bool {
        !self.watch.ended.is_empty() || self.turns.is_event
    }

    /// Proves that one motion joins the accepted pose and that at the present point, and that no gap closes
    /// on the way; [`ended`](Watch::ended) and the time at which the step must end tell otherwise.
    ///
    /// Without gaps a mechanism with one driver needs no proof. With several, or with open curves, trials on
    /// the way may have led round a place at which two assembly modes meet, or to the end of a curve.
    pub(super) fn prove(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
    ) -> Result<Option<f64>, Error> {
        let (start, end) = (self.pose.time, solver.pose().time);
        let h = (end - start).max(0.0);
        let times = [start, end];
        let has_gaps = h > 0.0 && self.passive.has_gaps(&self.accepted.passive);
        if self.is_plain && !has_gaps {
            return Ok(None);
        }
        self.set_curves(solver, given, times);
        let Self {
            watch,
            passive,
            accepted,
            point,
            path,
            ..
        } = self;
        solver.save(&mut self.end);
        let resumed = solver.resume(&self.pose, &self.choices);
        debug_assert!(resumed, "the choices are the solver's own");
        let Watch { gaps, stages, .. } = watch;
        let ends = [&*accepted.passive, &*point.passive];
        gaps.begin(passive, solver, stages, (times, ends));
        self.is_astray = true;
        let mut gap_watch = GapWatch {
            forces: passive,
            gaps,
        };
        let tracked = solver.track_past_stops(path, has_gaps.then_some(&mut gap_watch as _));
        let is_same = tracked.is_ok() && solver.is_near(&self.end);
        let closes = gaps.end.map(|part| start + part * h);
        solver.restore(&self.end);
        if let Some(time) = closes.filter(|time| start < *time && *time < end)
            && !watch.is_shortest(times)
        {
            watch.cut();
            return Ok(Some(time));
        }
        if let Err(Blocked {
            reason: Reason::Spent(most),
            ..
        }) = tracked
        {
            return Err(Error::spent(most, start));
        }
        if let Err(Blocked {
            s,
            reason: Reason::Stop(limit),
            ..
        }) = tracked
        {
            let time = start + s * h;
            return Err(Error::Stop { limit, time });
        }
        if is_same {
            self.is_astray = false;
            return Ok(None);
        }
        Err(Error::Blocked(
            "the step leads round a position at which assembly modes meet".to_owned(),
        ))
    }

    /// Sets the curves of the path from the accepted point to the present one: freedoms on polynomials of
    /// degree 5 through both, what is given on its own, which is a cubic over a step or a prescribed motion.
    fn set_curves(&mut self, solver: &Solver, given: &impl Given, [start, end]: [f64; 2]) {
        let h = (end - start).max(0.0);
        (self.path.start, self.path.duration) = (start, h);
        self.path.from.copy_from_slice(&self.pose.parameters);
        self.path.to.copy_from_slice(&self.pose.parameters);
        let ends = self.accepted.drivers.iter().zip(&self.point.drivers);
        let definitions = solver.mechanism().drivers.iter().enumerate();
        for ((driver_path, ends), (index, driver)) in
            self.path.driver_paths.iter_mut().zip(ends).zip(definitions)
        {
            let by_part = |jet: &Jet| Jet::new(jet.value, [h * jet.first(), h * h * jet.second()]);
            *driver_path = if h == 0.0 {
                DriverPath::held(ends.1.value, ends.0.value)
            } else if driver.is_free() {
                DriverPath::through(by_part(ends.0), by_part(ends.1))
            } else if driver.motion().is_some() {
                DriverPath::Motion
            } else {
                let at = |part: f64| given.driver(DriverId(index), start + part * h).value;
                DriverPath::cubic([ends.0.value, at(1.0 / 3.0), at(2.0 / 3.0), ends.1.value])
            };
        }
    }

    /// Puts the solver back to the accepted pose.
    pub(super) fn return_to_accepted(&mut self, solver: &mut Solver) {
        let resumed = solver.resume(&self.pose, &self.choices);
        debug_assert!(resumed, "the choices are the solver's own");
        self.is_astray = false;
    }

    /// Returns the equations of motion at the last trial point.
    pub(super) fn motion(&self) -> &EquationsOfMotion {
        &self.motion
    }

    /// Returns whether the point goes on smoothly from the accepted one.
    pub(super) fn goes_on(&self, mechanism: &Mechanism) -> bool {
        self.point.joins(&self.accepted, self.inputs(), mechanism)
    }

    /// Returns whether the solver's pose has the values of all drivers at the point.
    pub(super) fn is_at_point(&self, pose: &Pose) -> bool {
        let values = self.point.drivers.iter().map(|driver| driver.value);
        values.eq(pose.drivers.iter().copied())
    }

    /// Writes the values of all drivers at a point of the motion.
    pub(super) fn set_drivers(
        &mut self,
        solver: &Solver,
        given: &impl Given,
        time: f64,
        x: &[f64],
    ) {
        self.point.work = x[2 * self.freedoms.len()];
        let (positions, velocities) = x.split_at(self.freedoms.len());
        let mut free = positions.iter().zip(velocities);
        let definitions = solver.mechanism().drivers.iter().enumerate();
        for (to, (index, driver)) in self.point.drivers.iter_mut().zip(definitions) {
            let driver_id = DriverId(index);
            *to = if driver.is_free() {
                let (position, velocity) = free.next().expect("x has each freedom");
                Jet::new(*position, [*velocity, 0.0])
            } else if driver.motion().is_some() {
                solver.motion(driver_id, time)
            } else {
                given.driver(driver_id, time)
            };
        }
        let inputs = self.inputs();
        given.loads(time, &mut self.point.loads[..inputs]);
    }

    /// Moves the solver straight to the drivers' values and to `parameters` at a time.
    pub(super) fn go(
        &mut self,
        solver: &mut Solver,
        time: f64,
        parameters: Option<&[f64]>,
    ) -> Result<(), Error> {
        if self.is_astray {
            self.return_to_accepted(solver);
        }
        let pose = solver.pose();
        (self.path.start, self.path.duration) = (time, 0.0);
        self.path.from.copy_from_slice(&pose.parameters);
        let to = parameters.unwrap_or(&pose.parameters);
        self.path.to.copy_from_slice(to);
        let driver_paths = self.path.driver_paths.iter_mut().zip(&self.point.drivers);
        for ((driver_path, driver), now) in driver_paths.zip(&pose.drivers) {
            *driver_path = DriverPath::held(driver.value, *now);
        }
        // A trial may lie beyond a stop; only what is accepted is part of the motion.
        let tracked = match parameters {
            Some(_) => solver.track_past_stops(&self.path, None),
            None => solver.track_through_stops(&self.path),
        };
        match tracked {
            Ok(_) => Ok(()),
            Err(Blocked {
                reason: Reason::Stop(limit),
                ..
            }) => {
                self.is_astray = true;
                Err(Error::Stop { limit, time })
            }
            Err(Blocked {
                reason: Reason::Spent(most),
                ..
            }) => {
                self.is_astray = true;
                Err(Error::spent(most, time))
            }
            Err(blocked) => {
                self.is_astray = true;
                let described =
                    blocked.describe(solver.mechanism(), solver.pose(), Some(time), |_| true);
                Err(Error::Blocked(described))
            }
        }
    }

    /// Moves the solver to a point of the motion, and evaluates the equations there.
    pub(super) fn evaluate(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &[f64],
    ) -> Result<(), Error> {
        self.set_drivers(solver, given, time, x);
        self.go(solver, time, None)?;
        self.solve(solver)
    }

    /// Returns L of J = L Lᵀ.
    pub(super) fn factor(&self) -> &DMatrix<f64> {
        &self.factor
    }

    /// Changes values or velocities of the freedoms so that held coordinates have those at which they are
    /// held.
    pub(super) fn correct(&mut self, order: Order, x: &mut [f64]) {
        let Self {
            passive,
            point,
            factor,
            accelerations: changes,
            ..
        } = self;
        changes.fill(0.0);
        passive.correct(&point.passive, order, changes);
        ascend(factor, changes);
        for (x, change) in x.iter_mut().zip(changes) {
            *x += *change;
        }
    }

    /// Writes velocities and accelerations of the freedoms, and the power of all that acts on the
    /// bodies but gravity, at the solver's pose.
    pub(super) fn write(&mut self, solver: &mut Solver, dx: &mut [f64]) -> Result<(), Error> {
        self.solve(solver)?;
        let count = self.freedoms.len();
        for (k, freedom) in self.freedoms.iter().enumerate() {
            let driver = self.point.drivers[freedom.index()];
            dx[k] = driver.first();
            dx[count + k] = driver.second();
        }
        dx[2 * count] = self.power(solver);
        Ok(())
    }

    /// Solves the equations of motion at the solver's pose.
    fn solve(&mut self, solver: &mut Solver) -> Result<(), Error> {
        let Self {
            point,
            forces,
            motion,
            passive,
            ..
        } = self;
        let Point {
            drivers,
            loads,
            passive: at,
            energy,
            kinetic_energy,
            ..
        } = point;
        let inputs = loads.len() - passive.loads();
        loads[inputs..].fill(0.0);
        let velocity = |driver: DriverId| drivers[driver.index()].first();
        solver.write_equations(velocity, loads, forces, motion)?;
        (*energy, *kinetic_energy) = (motion.energy, motion.kinetic_energy);
        passive.begin(solver, motion, at);
        self.prepare(solver)?;
        if self.passive.rubbing.is_empty() {
            self.respond();
        } else {
            self.solve_friction(solver)?;
        }
        self.passive.exert(&self.point.passive, &mut self.motion);
        Ok(())
    }

    /// Solves friction, and with it accelerations and forces that hold.
    fn solve_friction(&mut self, solver: &mut Solver) -> Result<(), Error> {
        let mut friction = std::mem::take(&mut self.passive.friction);
        let is_in_joints = friction.joints().next().is_some();
        let solved = friction.solve(|sizes, reactions| {
            let at = &mut self.point.passive;
            self.passive.rub(sizes, at, &mut self.motion);
            self.respond();
            if !is_in_joints {
                return Ok(());
            }
            let Point { drivers, loads, .. } = &self.point;
            solver.solve_rates(|driver| drivers[driver.index()], &mut self.rates)?;
            let motion = KnownMotion {
                rates: &self.rates,
                driver_rates: drivers,
                inputs: loads,
            };
            solver.solve_forces(motion, REACTIONS, &mut self.forces)?;
            for (reaction, (_, joint)) in reactions.iter_mut().zip(&self.passive.rubbing) {
                if let Some(joint) = joint {
                    *reaction = self.forces.reaction(*joint);
                }
            }
            Ok(())
        });
        self.passive.friction = friction;
        self.passive.bound(&mut self.point.passive);
        solved
    }

    /// Solves the accelerations, with the forces that hold, and writes the loads.
    fn respond(&mut self) {
        self.solve_accelerations();
        let Self {
            passive,
            point,
            freedoms,
            factor,
            accelerations,
            ..
        } = self;
        let Point {
            drivers,
            loads,
            passive: at,
            ..
        } = point;
        if at.is_empty() {
            return;
        }
        passive.accelerate(at, drivers.iter().map(Jet::second));
        if passive.holds() {
            accelerations.fill(0.0);
            passive.correct(at, Order::Acceleration, accelerations);
            passive.write_holding(at);
            ascend(factor, accelerations);
            for (freedom, change) in freedoms.iter().zip(&*accelerations) {
                drivers[freedom.index()].derivatives[1] += change;
            }
            passive.accelerate_freedoms(at, freedoms, accelerations);
        }
        let inputs = loads.len() - passive.loads();
        for (load, at) in loads[inputs..].iter_mut().zip(&*at) {
            *load = at.force;
        }
    }

    /// Factorises J = L Lᵀ. Prepares the forces that hold.
    ///
    /// # Errors
    ///
    /// [`Error::NoInertia`] for freedoms that move no mass.
    fn prepare(&mut self, solver: &Solver) -> Result<(), Error> {
        let EquationsOfMotion {
            weighted,
            weighted_rest,
            ..
        } = &mut self.motion;
        let definitions = solver.mechanism().drivers.iter();
        for (column, (driver, rates)) in definitions.zip(&self.point.drivers).enumerate() {
            if !driver.is_free() {
                weighted_rest.axpy(rates.second(), &weighted.column(column), 1.0);
            }
        }
        self.factorise(solver)?;
        if self.passive.holds() {
            self.passive
                .prepare(&self.freedoms, &self.factor, &mut self.point.passive);
        }
        Ok(())
    }

    /// Solves J ü = −bias for the freedoms.
    fn solve_accelerations(&mut self) {
        for (acceleration, freedom) in self.accelerations.iter_mut().zip(&self.freedoms) {
            *acceleration = self.motion.applied[freedom.index()];
        }
        descend(&self.factor, &mut self.accelerations);
        for (place, acceleration) in self.accelerations.iter_mut().enumerate() {
            *acceleration = -self.along[place] - *acceleration;
        }
        ascend(&self.factor, &mut self.accelerations);
        for (freedom, acceleration) in self.freedoms.iter().zip(&self.accelerations) {
            self.point.drivers[freedom.index()].derivatives[1] = *acceleration;
        }
    }

    /// Factorises J by least squares: the modified method of Gram and Schmidt makes the columns √M ∂q/∂u
    /// of the freedoms orthogonal, and takes their parts out of the rest. Where J is badly conditioned, as
    /// with bodies of very different masses, this saves half of its digits.
    ///
    /// # Errors
    ///
    /// [`Error::NoInertia`] for freedoms that move no mass.
    fn factorise(&mut self, solver: &Solver) -> Result<(), Error> {
        let EquationsOfMotion {
            weighted,
            weighted_rest: rest,
            ..
        } = &mut self.motion;
        let Self {
            factor,
            along,
            freedoms,
            ..
        } = self;
        for (place, freedom) in freedoms.iter().enumerate() {
            let index = freedom.index();
            let (column, mut others) = weighted.columns_range_pair_mut(index, index + 1..);
            let square = column.norm_squared();
            // The parts of others that were taken out of the column.
            let taken: f64 = (0..place).map(|k| factor[(place, k)].powi(2)).sum();
            if square.is_nan() || square <= NO_INERTIA.powi(2) * (square + taken) {
                let name = &solver.mechanism().drivers[index].name;
                let freedoms = vec![format!("freedom `{name}`")];
                return Err(Error::NoInertia { freedoms });
            }
            let norm = square.sqrt();
            factor[(place, place)] = norm;
            along[place] = column.dot(rest) / norm;
            let later = &freedoms[place + 1..];
            if later.is_empty() {
                break;
            }
            for (k, other) in later.iter().enumerate() {
                let mut other = others.column_mut(other.index() - index - 1);
                let part = column.dot(&other) / square;
                factor[(place + 1 + k, place)] = part * norm;
                other.axpy(-part, &column, 1.0);
            }
            rest.axpy(-along[place] / norm, &column, 1.0);
        }
        Ok(())
    }

    /// Returns the power of the applied forces and of the drivers \[W\].
    fn power(&self, solver: &Solver) -> f64 {
        let definitions = solver.mechanism().drivers.iter().enumerate();
        let driven = definitions.filter(|(_, driver)| !driver.is_free());
        let powers = driven.map(|(row, _)| {
            let accelerations = self.point.drivers.iter().enumerate();
            let inertial = accelerations
                .map(|(column, other)| self.motion.inertia[(row, column)] * other.second());
            let effort = self.motion.bias[row] + inertial.sum::<f64>();
            effort * self.point.drivers[row].first()
        });
        self.motion.applied_power + powers.sum::<f64>()
    }
}
