//! The solver: a mechanism at one pose, and all that can be asked of it.

use std::sync::Arc;

use super::analysis::{
    self, Direction, DrawnApart, GeometryWarning, InstantCentre, Modes, OffPulley, Range,
    RangeSettings, Sensitivity,
};
use super::assembly::estimate::{Move, estimate, moves};
use super::constraint::{Clearance, Constraint};
use super::continuation::{Blocked, Budget, PathTracker, PathWatch, Progress, check_pose};
use super::error::Error;
use super::forces::{
    self, EquationsOfMotion, ForceParts, ForceSensitivity, Forces, Friction, KnownMotion, LiftOff,
};
use super::origin::Origin;
use super::path::{DriverPath, Path, Rates};
use super::plan::Crossing;
use super::plan::compiled_mechanism::CompiledMechanism;
use super::redundancy::{self, Redundancy};
use super::singular::{self, Approach};
use super::start;
use super::start::initial_pose::{self, Assembly};
use super::state::{Pose, SolverChoices, State};
use super::system::System;
use super::system::structure::Structure;
use crate::mechanism::{
    BodyId, Coordinate, DriverId, FeatureRun, Indeterminate, Jet, Load, MarkerId, Mechanism,
    Number, Order, ParameterId, PrescribedMotion, ShapeId,
};

/// Solves position, velocity and acceleration of one mechanism.
///
/// A solver is always at a pose. [`assemble`](Self::assemble) finds the first one,
/// [`track`](Self::track) moves it continuously, [`restore`](Self::restore) puts it back to a
/// saved one. All storage is made in [`new`](Self::new).
///
/// ```
/// use biela::kinematics::{Path, Solver};
/// use biela::mechanism::{Mechanism, Source};
///
/// let text = include_str!("../../mechanisms/four_bar.toml");
/// let (mechanism, _) = Mechanism::parse(&Source::new("four_bar.toml", text)).unwrap();
/// let mut solver = Solver::new(mechanism.into()).unwrap();
/// let path = Path::new(solver.mechanism());
/// solver.assemble(&path).unwrap();
/// let rocker = solver.mechanism().body_id("rocker").unwrap();
/// let phi = solver.pose().q[3 * rocker.index() + 2];
/// // By the law of cosines.
/// assert!((phi.to_degrees() - 122.824_780).abs() < 1e-6);
/// ```
#[derive(Debug)]
pub struct Solver {
    pub(super) compiled: CompiledMechanism,
    pub(super) state: State,
    pub(super) tracker: PathTracker,
}

impl Solver {
    /// Writes down the equations, analyses their structure and makes all storage.
    ///
    /// # Errors
    ///
    /// [`Error::Structure`] if the drivers do not match the degrees of freedom. Where equations and
    /// unknowns do not pair up, numbers decide, at the file's own values; then also those of
    /// [`assemble`](Self::assemble).
    pub fn new(mechanism: Arc<Mechanism>) -> Result<Self, Error> {
        let path = Path::new(&mechanism);
        let (mut compiled, pairs_up) = CompiledMechanism::new(mechanism);
        let mut state = State::new(&compiled.system);
        if !pairs_up {
            let chosen = redundancy::choose_rows(&mut compiled, &mut state, &path);
            chosen.map_err(|error| redundancy::explain_ratio(&compiled, &state, error))?;
        }
        Ok(Self {
            tracker: PathTracker::new(&compiled),
            compiled,
            state,
        })
    }

    /// Makes a solver that is assembled at the end of `path`.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new) and of [`assemble`](Self::assemble).
    pub fn assembled(mechanism: Arc<Mechanism>, path: &Path) -> Result<Self, Error> {
        let mut solver = Self::new(mechanism)?;
        solver.assemble(path)?;
        Ok(solver)
    }

    /// Returns the mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        self.compiled.system.mechanism()
    }

    /// Returns its equations.
    #[must_use]
    pub fn system(&self) -> &System {
        &self.compiled.system
    }

    /// Returns whether every body is placed by straight formulas, whatever the pose.
    #[must_use]
    pub fn is_explicit(&self) -> bool {
        self.compiled.plan.is_explicit()
    }

    /// Returns whether points move on open curves.
    #[must_use]
    pub fn has_ends_of_curves(&self) -> bool {
        self.compiled.has_ends_of_curves()
    }

    /// Returns the structure of the equations that are solved; those set aside take no part.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.compiled.structure
    }

    /// Returns the mechanism's characteristic length at the pose \[m\].
    #[must_use]
    pub fn size(&self) -> f64 {
        self.state.at.size()
    }

    /// Returns the pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.state.pose
    }

    /// Finds the pose at the end of `path` near the file's estimates: minimises
    /// (q − q⁰)ᵀ(q − q⁰) + r PhiᵀPhi for growing r (Eq. 3.6.9), then applies Newton–Raphson.
    ///
    /// Angles and lengths are scaled by the mechanism's size. An assembled angle is the
    /// representative nearest its estimate, unless an angle driver says which turn it is.
    ///
    /// # Errors
    ///
    /// [`Error::NotAssembled`] with the joints that stay open, and a proof that the mechanism
    /// cannot close, if there is one; [`Error::Singular`] if it closes in a singular position;
    /// [`Error::NotFinite`] and [`Error::NotPositive`] for values without a mechanism;
    /// [`Error::Ratio`] instead of these where coordinates move in too large a ratio;
    /// [`Error::BeyondStop`] for a pose beyond a stop. The solver is then without a valid pose until
    /// it is assembled or [restored](Self::restore); after the first of these its pose is the
    /// nearest one.
    pub fn assemble(&mut self, path: &Path) -> Result<Assembly, Error> {
        let Self {
            compiled, state, ..
        } = self;
        let assembly = initial_pose::assemble(compiled, state, path);
        let assembly =
            assembly.map_err(|error| redundancy::explain_ratio(compiled, state, error))?;
        check_pose(compiled, state)?;
        Ok(assembly)
    }

    /// Returns the path from the pose, which is that of the mechanism's own values, to the start of a
    /// motion at `time` \[s\]: to parameters \[SI\], and to the values of the drivers there.
    ///
    /// `driven` is the mechanism with that motion. `value` returns the values there of drivers that
    /// are its inputs; without one they stay as they are.
    #[must_use]
    pub fn path_to_start(
        &self,
        driven: &Mechanism,
        parameters: &[f64],
        time: f64,
        value: impl Fn(DriverId) -> Option<f64>,
    ) -> Path {
        let (own, home) = (self.mechanism(), self.pose());
        let mut path = Path::new(own);
        path.duration = time - home.time;
        path.to.copy_from_slice(parameters);
        for (index, driver_path) in path.driver_paths.iter_mut().enumerate() {
            let motions = [own, driven].map(|mechanism| mechanism.drivers[index].motion());
            let given = match motions {
                // A motion of the file is followed as such.
                [
                    Some(PrescribedMotion::Expression(own)),
                    Some(PrescribedMotion::Expression(same)),
                ] if own == same => None,
                [_, Some(PrescribedMotion::Expression(motion))] => {
                    Some(motion.evaluate(&|p: ParameterId| parameters[p.index()], time))
                }
                _ => value(DriverId(index)).or_else(|| {
                    let starts = [own, driven].map(|mechanism| mechanism.drivers[index].start());
                    starts[1].filter(|_| starts[0] != starts[1])
                }),
            };
            if let Some(position) = given {
                *driver_path = DriverPath::held(position, home.drivers[index]);
            }
        }
        path
    }

    /// Moves the mechanism from `home` to the values at the end of `path`, which starts there. Drivers
    /// and parameters go straight to these values, and whole turns of drivers last; where they
    /// bring the mechanism back to its pose they are counted, not followed. Where that way is
    /// blocked, `path` itself is followed.
    ///
    /// # Errors
    ///
    /// [`Error::NoWay`] if no continuous motion leads there, and those of
    /// [`assemble`](Self::assemble) if the mechanism does not close there or is beyond a stop. The
    /// solver is then without the pose asked for until it is [restored](Self::restore).
    pub fn start(&mut self, home: &Pose, path: &Path) -> Result<Progress, Error> {
        let Self {
            compiled,
            state,
            tracker,
        } = self;
        let started =
            tracker.through_stops(|tracker| start::start(compiled, state, tracker, home, path));
        let progress = started?;
        check_pose(compiled, state)?;
        Ok(progress)
    }

    /// Moves the mechanism along `path`, at whose start its pose must be. Change points on the way
    /// are crossed on the smooth continuation of the motion; at a stop the motion ends. Allocates
    /// nothing, unless a block comes near a singular position.
    ///
    /// # Errors
    ///
    /// [`Blocked`] if the end cannot be reached on the continuous motion. The pose is then the last
    /// one reached, which is a valid one.
    pub fn track(&mut self, path: &Path) -> Result<Progress, Blocked> {
        self.tracker
            .track(&mut self.compiled, &mut self.state, path, false)
    }

    /// Moves the mechanism along `path` as [`track`](Self::track) does, through stops: for trial
    /// poses that are no part of the motion.
    ///
    /// # Errors
    ///
    /// As [`track`](Self::track).
    pub fn track_through_stops(&mut self, path: &Path) -> Result<Progress, Blocked> {
        self.tracker.through_stops(|tracker| {
            tracker.track(&mut self.compiled, &mut self.state, path, false)
        })
    }

    /// Moves the mechanism along `path` as [`track`](Self::track) does, through stops, but not beyond the
    /// ends of curves, in sub-steps that a watch admits: for a motion that stops act on by their forces.
    ///
    /// # Errors
    ///
    /// As [`track`](Self::track).
    pub fn track_past_stops(
        &mut self,
        path: &Path,
        watch: Option<&mut dyn PathWatch>,
    ) -> Result<Progress, Blocked> {
        let Self {
            compiled,
            state,
            tracker,
        } = self;
        tracker.past_stops(|tracker| tracker.track_watched(compiled, state, path, false, watch))
    }

    /// Moves the mechanism along `path` as [`track`](Self::track) does, and gives up early where it
    /// cannot go on: singular positions are neither located nor crossed. For searches over many
    /// mechanisms, of which most stop somewhere.
    ///
    /// # Errors
    ///
    /// [`Blocked`] as for [`track`](Self::track); the reason is not looked for.
    pub fn track_or_give_up(&mut self, path: &Path) -> Result<Progress, Blocked> {
        self.tracker
            .track(&mut self.compiled, &mut self.state, path, true)
    }

    /// Limits the number of sub-steps that are taken from now on: paths that need more are
    /// [blocked](super::Reason::Spent).
    pub fn set_budget(&mut self, budget: Budget) {
        self.tracker.budget = budget;
    }

    /// Does work whose sub-steps count, and are not limited.
    pub fn overdraw<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let mut budget = self.budget();
        self.set_budget(Budget::UNLIMITED);
        let done = work(self);
        budget.spend(self.budget().spent());
        self.set_budget(budget);
        done
    }

    /// Returns the budget, with what is left of it.
    #[must_use]
    pub fn budget(&self) -> Budget {
        self.tracker.budget
    }

    /// Returns the change points that the last call of [`track`](Self::track) passed, in order.
    #[must_use]
    pub fn crossed(&self) -> &[Arc<Crossing>] {
        self.tracker.crossed()
    }

    /// Puts the mechanism back to a pose that this solver, or one of the same mechanism, was at.
    /// Allocates nothing, unless the choice among redundant rows has to change.
    ///
    /// # Panics
    ///
    /// If the pose belongs to another mechanism.
    pub fn restore(&mut self, pose: &Pose) {
        self.state.restore(&mut self.compiled, pose);
    }

    /// Copies the effects of earlier motion besides the pose into `choices`. Allocates the first
    /// time and when choices have changed.
    pub fn copy_choices(&self, choices: &mut SolverChoices) {
        let CompiledMechanism {
            redundant, plan, ..
        } = &self.compiled;
        choices.set_aside.clone_from(&redundant.now);
        plan.copy_choices(&mut choices.blocks);
    }

    /// Puts the mechanism back to a pose with the choices that were in use there: all further
    /// results have the same bits. Returns false if these choices are of another mechanism.
    /// Allocates nothing, unless the choices have changed.
    ///
    /// # Panics
    ///
    /// If the pose belongs to another mechanism.
    pub fn resume(&mut self, pose: &Pose, choices: &SolverChoices) -> bool {
        self.state.resume(&mut self.compiled, pose, choices)
    }

    /// Returns whether the bodies are where they are at another pose, apart from rounding.
    #[must_use]
    pub fn is_near(&self, pose: &Pose) -> bool {
        let mut turns = self.state.whole_turns_since(&self.compiled.system, pose);
        turns.all(|turns| turns == Some(0.0))
    }

    /// Copies the present pose into `pose`, which belongs to the same mechanism. Allocates
    /// nothing.
    pub fn save(&self, pose: &mut Pose) {
        pose.copy_from(&self.state.pose);
    }

    /// Returns the largest scaled residual of Phi at the present pose: metres over the mechanism's
    /// characteristic length, radians.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.state.residual(&self.compiled.system)
    }

    /// Returns the scaled reciprocal condition of the Jacobian at the present pose: 1 is best, 0
    /// singular. It is that of the block nearest to a singular position.
    pub fn rcond(&mut self) -> f64 {
        self.state.rcond(&mut self.compiled)
    }

    /// Solves the rates of q at the present pose for given rates of the drivers (`first` and
    /// `second` of each [`Jet`]; `value` is not read), by Eq. 3.6.10 and 3.6.11. Allocates nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular and no rates exist, [`Error::NoMotion`] for
    /// rates of a driver that are not finite, [`Error::TooFast`] where they make those of bodies
    /// overflow.
    pub fn solve_rates(
        &mut self,
        driver: impl Fn(DriverId) -> Jet,
        rates: &mut Rates,
    ) -> Result<(), Error> {
        self.state.solve_rates(&mut self.compiled, driver, rates)
    }

    /// Returns value, rate and acceleration of a measure at the present pose. Allocates nothing.
    #[must_use]
    pub fn measure(&self, index: usize, rates: &Rates) -> Jet {
        self.state.measure(&*self.compiled.measures[index], rates)
    }

    /// Returns the clearance of two shapes at the present pose and the nearest places of both outlines
    /// \[m\]; `None` for shapes that no measure and no contact names.
    #[must_use]
    pub fn clearance(&self, shapes: [ShapeId; 2]) -> Option<(f64, [[f64; 2]; 2])> {
        let runs = [FeatureRun::WHOLE; 2];
        let clearance = Clearance { shapes, runs };
        let places = clearance.places(&self.state.at)?;
        Some((clearance.value(&self.state.at), places.map(Into::into)))
    }

    /// Returns value, rate and acceleration of a relation, such as that of a
    /// [coordinate](super::constraint::of_coordinate), at the present pose. Allocates nothing.
    #[must_use]
    pub fn coordinate(&self, relation: &dyn Constraint, rates: &Rates) -> Jet {
        self.state.measure(relation, rates)
    }

    /// Returns the value of a relation at the present pose. Allocates nothing.
    #[must_use]
    pub fn place(&self, relation: &dyn Constraint) -> f64 {
        relation.value(&self.state.at)
    }

    /// Returns bounds of the rounding errors of [value, rate and acceleration](Self::coordinate) of a
    /// relation. Allocates nothing.
    #[must_use]
    pub fn coordinate_roundings(&self, relation: &dyn Constraint, rates: &Rates) -> [f64; 3] {
        self.state.measure_roundings(relation, rates)
    }

    /// Returns the relation along which a force acts that has this coordinate: of a joint with play its
    /// own.
    #[must_use]
    pub fn relation_of(&self, load: &Load, coordinate: &Coordinate) -> Arc<dyn Constraint> {
        self.compiled.system.relation_of(load, coordinate)
    }

    /// Returns least and largest value of the relation of a joint with play at the present pose \[m or
    /// rad\], for these parameters; infinite where its parts only push.
    #[must_use]
    pub fn limits_of_play<N: Number>(
        &self,
        joint: usize,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> [N; 2] {
        let open = self.compiled.system.open_relation(joint);
        let open = open.map(|open| open.limits(self.mechanism(), parameter, &self.state.at));
        open.unwrap_or([f64::NEG_INFINITY, f64::INFINITY].map(N::constant))
    }

    /// Returns point, velocity and acceleration of a marker: the x component, then the y component.
    #[must_use]
    pub fn marker(&self, marker: MarkerId, rates: &Rates) -> [Jet; 2] {
        self.state.marker(marker, rates)
    }

    /// Returns value, velocity and acceleration of a driver with a prescribed motion at a time, for
    /// the pose's parameters. Parameters contribute nothing to velocities, even while they change.
    /// Not a number for an input. Allocates nothing.
    #[must_use]
    pub fn motion(&self, driver: DriverId, time: f64) -> Jet {
        self.state.motions.evaluate(driver, Jet::variable(time))
    }

    /// Returns the first corner of a prescribed motion in a range of time, at which its velocity jumps: the
    /// last time before it and the first one after it \[s\]. Allocates nothing.
    #[must_use]
    pub fn next_corner(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        self.state.motions.corner(from, to)
    }

    /// Returns the distance of each body from its estimate at the present pose.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
    pub fn moves(&self) -> Result<Vec<Move>, Error> {
        let pose = self.pose();
        let estimate = estimate(&self.compiled.system, &pose.parameters)?;
        Ok(moves(&self.compiled.system, &pose.q, &estimate).collect())
    }

    /// Returns the joints and constraints with redundant equations, known once the solver is
    /// [assembled](Self::assemble). The mechanism moves without these equations; whether they hold
    /// is watched, and a step after which they do not is rejected.
    #[must_use]
    pub fn redundancies(&self) -> Vec<Redundancy> {
        redundancy::redundancies(&self.compiled)
    }

    /// Returns the joints that do not fit their own numbers at the present pose, in the order of
    /// declaration.
    #[must_use]
    pub fn geometry_warnings(&self) -> Vec<GeometryWarning> {
        analysis::geometry_warnings(&self.compiled, &self.state)
    }

    /// Returns the joints whose markers were drawn far apart, in the order of declaration: slips of
    /// coordinates in a mechanism that is drawn in one pose.
    #[must_use]
    pub fn drawn_apart(&self) -> Vec<DrawnApart> {
        analysis::drawn_apart(&self.compiled, &self.state)
    }

    /// Returns the approach to a singular position, if the mechanism, at the end of a path, has
    /// come near one since `near` was last false; `near` is true from then on until the mechanism
    /// is away again. Next to a change point that is crossed there is no warning. Away from
    /// singular positions it costs a comparison.
    pub fn approach(&mut self, near: &mut bool) -> Option<Approach> {
        singular::approach(&mut self.compiled, &mut self.state, near)
    }

    /// Returns the message for a change point that was passed.
    #[must_use]
    pub fn describe_crossing(&self, crossing: &Crossing) -> String {
        singular::describe_crossing(&self.compiled, crossing)
    }

    /// Returns whether the crossings of a pose that was read from outside are possible for this
    /// mechanism and contain q. The pose is then any until the next [`restore`](Self::restore).
    #[must_use]
    pub fn admits_crossings(&mut self, pose: &Pose) -> bool {
        singular::admits_crossings(&mut self.compiled, &mut self.state, pose)
    }

    /// Returns the derivative of the motion at the present pose along a direction, for these rates
    /// of q and of the drivers, which belong together by [`solve_rates`](Self::solve_rates). Exact
    /// to rounding; the work is proportional to the size of the mechanism.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular.
    pub fn sensitivity(
        &mut self,
        rates: &Rates,
        driver_rates: &[Jet],
        direction: &Direction,
    ) -> Result<Sensitivity<'_>, Error> {
        let mut found = None;
        let directions = std::slice::from_ref(direction);
        let sought = (directions, Order::Acceleration);
        let Self {
            compiled, state, ..
        } = self;
        state.sensitivities(compiled, rates, driver_rates, sought, |along| {
            found = Some(along);
            Ok(())
        })?;
        Ok(found.expect("there is one direction"))
    }

    /// Gives the derivatives of the motion at the present pose along each of some directions to
    /// `each`, in order: those of signals up to `order`, which saves the work on higher ones. The
    /// Jacobian is factorised once. See [`sensitivity`](Self::sensitivity).
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular, and those of `each`.
    pub fn sensitivities(
        &mut self,
        rates: &Rates,
        driver_rates: &[Jet],
        directions: &[Direction],
        order: Order,
        mut each: impl FnMut(&Sensitivity<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Self {
            compiled, state, ..
        } = self;
        state.sensitivities(
            compiled,
            rates,
            driver_rates,
            (directions, order),
            |along| each(&along),
        )
    }

    /// Makes the storage for forces of this mechanism.
    #[must_use]
    pub fn forces(&self) -> Forces {
        Forces::new(&self.compiled)
    }

    /// Makes the storage for friction.
    #[must_use]
    pub fn friction(&self) -> Friction {
        let mechanism = self.mechanism();
        let is_chosen = mechanism.outputs.indeterminate == Indeterminate::MinimumNorm;
        let open = !is_chosen && !self.compiled.redundant.now.is_empty();
        Friction::new(mechanism, open)
    }

    /// Solves the forces at the present pose for a motion that [`solve_rates`](Self::solve_rates)
    /// gave. Allocates nothing, unless other rows have become redundant or reactions are sought next
    /// to a change point.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::Mass`] for masses without a meaning, [`Error::NoForce`] for
    /// a force without direction or size, [`Error::Singular`] where the pose is singular,
    /// [`Error::ChangePoint`] where reactions have no limit at a change point.
    pub fn solve_forces(
        &mut self,
        motion: KnownMotion<'_>,
        parts: ForceParts,
        forces: &mut Forces,
    ) -> Result<(), Error> {
        forces.solve(&mut self.compiled, &mut self.state, motion, parts)
    }

    /// Makes the storage for the equations of motion.
    #[must_use]
    pub fn equations_of_motion(&self) -> EquationsOfMotion {
        EquationsOfMotion::new(self.state.pose.q.len(), self.state.pose.drivers.len())
    }

    /// Writes the equations of motion in the coordinates of the drivers at the present pose, for
    /// these velocities of theirs and these inputs of forces. Allocates nothing.
    ///
    /// # Errors
    ///
    /// Those of [`solve_rates`](Self::solve_rates) and [`solve_forces`](Self::solve_forces).
    pub fn write_equations(
        &mut self,
        velocity: impl Fn(DriverId) -> f64,
        inputs: &[f64],
        forces: &mut Forces,
        equations: &mut EquationsOfMotion,
    ) -> Result<(), Error> {
        let Self {
            compiled, state, ..
        } = self;
        forces.write_equations(compiled, state, velocity, inputs, equations)
    }

    /// Returns the rounding error of a driver's effort \[N or N m\]: a smaller effort cannot be told
    /// from zero. The efforts in `forces` must be up to date for these rates.
    #[must_use]
    pub fn effort_rounding(&self, rates: &Rates, driver: DriverId, forces: &Forces) -> f64 {
        forces.effort_rounding(&self.state, rates, driver)
    }

    /// Returns the pulleys that ropes begin to leave at the present pose, and sets in `off`, one entry
    /// per [pulley](Mechanism::pulleys), which ones they have left.
    pub fn off_pulleys<'a>(&'a self, off: &'a mut [bool]) -> impl Iterator<Item = OffPulley<'a>> {
        analysis::off_pulleys(&self.compiled.system, &self.state, off)
    }

    /// Returns the joints that can only push and begin to pull at the present pose, and sets in
    /// `lifted`, one entry per [contact](Forces::contacts), which of them pull. The reactions in
    /// `forces` must be up to date.
    pub fn lift_offs<'a>(
        &'a self,
        forces: &'a Forces,
        lifted: &'a mut [bool],
    ) -> impl Iterator<Item = LiftOff<'a>> {
        forces.lift_offs(&self.state, lifted)
    }

    /// Returns the derivatives of motion and forces at the present pose along a direction. Exact to
    /// rounding.
    ///
    /// # Errors
    ///
    /// Those of [`sensitivity`](Self::sensitivity) and [`solve_forces`](Self::solve_forces).
    pub fn force_sensitivity(
        &mut self,
        motion: KnownMotion<'_>,
        direction: &Direction,
        forces: &mut Forces,
    ) -> Result<ForceSensitivity, Error> {
        let Self {
            compiled, state, ..
        } = self;
        forces.sensitivity(compiled, state, motion, direction)
    }

    /// Gives the changes of the efforts of some drivers along each of some directions to `each`, with the
    /// number of the direction; `inputs` returns the changes of the inputs of forces along it. Far less
    /// work than the changes of [all forces](Self::force_sensitivity). Returns whether it has done so:
    /// next to a change point it does nothing.
    ///
    /// # Errors
    ///
    /// Those of [`force_sensitivity`](Self::force_sensitivity).
    pub fn effort_changes(
        &mut self,
        motion: KnownMotion<'_>,
        (drivers, directions): (&[DriverId], &[Direction]),
        forces: &mut Forces,
        inputs: impl FnMut(usize, &Sensitivity<'_>) -> Vec<f64>,
        each: impl FnMut(usize, &[f64]),
    ) -> Result<bool, Error> {
        let Self {
            compiled, state, ..
        } = self;
        forces.effort_changes((compiled, state), motion, drivers, directions, inputs, each)
    }

    /// Returns the joints and constraints whose reactions redundant constraints leave
    /// indeterminate, known once the solver is [assembled](Self::assemble). The pose is unchanged.
    pub fn indeterminate(&mut self) -> Vec<Origin> {
        let Self {
            compiled,
            state,
            tracker,
        } = self;
        tracker.through_stops(|tracker| forces::indeterminate(compiled, state, tracker))
    }

    /// Returns the instant centre of a body and ground, for rates of the present pose.
    ///
    /// # Panics
    ///
    /// If the body is none of the mechanism's.
    #[must_use]
    pub fn instant_centre(&self, body: BodyId, rates: &Rates) -> InstantCentre {
        let bodies = self.mechanism().bodies.len();
        analysis::instant_centre(&self.state, bodies, body, rates)
    }

    /// Finds the range of one driver up and down from the present pose, with the other drivers,
    /// time and parameters held: until it is blocked, has turned the mechanism to its start, or has
    /// gone far enough. A prescribed motion is taken for an input. The pose stays as it is.
    ///
    /// # Panics
    ///
    /// If the driver is none of the mechanism's.
    pub fn range(&mut self, driver: DriverId, settings: &RangeSettings) -> Range {
        let tracker = &mut self.tracker;
        analysis::range(
            &mut self.compiled,
            &mut self.state,
            tracker,
            driver,
            settings,
        )
    }

    /// Finds the other assembly modes for the parameters and driver values of the present pose. The
    /// search covers both branches of each dyad and, by bounds over intervals, all branches of
    /// other blocks with few angles. Of the remaining blocks it finds the branches that a
    /// minimisation from a fixed set of starts reaches. The pose is unchanged.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
    pub fn modes(&mut self) -> Result<Modes, Error> {
        analysis::modes(&mut self.compiled, &mut self.state)
    }
    /// Finds poses at the end of `path`, in any assembly mode, in the same order for the same
    /// branches: both branches of each dyad, of other blocks those found from starts near the
    /// estimates. There are none if the mechanism does not close; [`assemble`](Self::assemble) says
    /// why. The solver is then without a valid pose until it is [restored](Self::restore) to one of
    /// these.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`], [`Error::NotPositive`] and [`Error::NoMotion`] for values without a
    /// mechanism.
    pub fn poses(&mut self, path: &Path) -> Result<Vec<Pose>, Error> {
        analysis::poses(&mut self.compiled, &mut self.state, path)
    }
}
