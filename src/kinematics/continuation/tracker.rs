//! The tracker: chooses the length of each sub-step and carries the mechanism along the path.

mod length;
mod pace;

use std::sync::Arc;

use length::HALF;
pub(in crate::kinematics) use pace::most_substeps;
use pace::{Pace, Verdict};

use super::budget::Budget;
use super::driver_bounds::bound_drivers;
use super::outcome::{Blocked, Progress, Reason};
use super::stops::StopWatch;
use super::sub_step::{PathWatch, SubStep};
use crate::kinematics::Error;
use crate::kinematics::certificate::StepBounds;
use crate::kinematics::error::OpenJoint;
use crate::kinematics::newton::{Correction, Rejected};
use crate::kinematics::path::{DriverPath, Path, PathDrivers};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockState, Crossing, Extrapolation};
use crate::kinematics::redundancy;
use crate::kinematics::singular::{
    self, DriverLimit, FruitlessSearches, NEAR, SingularKind, SingularPoint,
};
use crate::kinematics::state::{State, UNIT_RATE};
use crate::kinematics::tolerances::SAME_PLACE_ON_PATH;
use crate::mechanism::{DriverId, Jet};

/// A motion that stops while a driver still moves by more than this per sub-step \[m or rad\] asks
/// for too long a path.
const LARGEST_LAST_MOVE: f64 = 1e-6;

/// The storage for tracking paths.
#[derive(Debug)]
pub(in crate::kinematics) struct PathTracker {
    drivers: PathDrivers,
    pub(in crate::kinematics) bounds: StepBounds,
    /// The change points passed on the path tracked last.
    crossed: Vec<Arc<Crossing>>,
    fruitless: FruitlessSearches,
    stops: StopWatch,
    /// Whether paths lead through stops, as searches for a pose do.
    ignores_stops: bool,
    pub(in crate::kinematics) budget: Budget,
}

impl PathTracker {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(compiled: &CompiledMechanism) -> Self {
        let system = &compiled.system;
        Self {
            drivers: PathDrivers::new(system.mechanism()),
            bounds: StepBounds::new(system),
            crossed: Vec::new(),
            fruitless: FruitlessSearches::default(),
            stops: StopWatch::new(compiled.stops.len()),
            ignores_stops: false,
            budget: Budget::UNLIMITED,
        }
    }

    /// Does work on paths that lead through stops.
    pub(in crate::kinematics) fn through_stops<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let before = std::mem::replace(&mut self.ignores_stops, true);
        let done = work(self);
        self.ignores_stops = before;
        done
    }

    /// Does work on paths that lead through stops, but not beyond the ends of curves.
    pub(in crate::kinematics) fn past_stops<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.stops.only_curves, true);
        let done = work(self);
        self.stops.only_curves = before;
        done
    }

    /// Returns the change points that the last path passed, in order.
    pub(in crate::kinematics) fn crossed(&self) -> &[Arc<Crossing>] {
        &self.crossed
    }

    /// Sets the change points that the last path passed, for a path in several parts.
    pub(in crate::kinematics) fn set_crossed(&mut self, crossed: Vec<Arc<Crossing>>) {
        self.crossed = crossed;
    }

    /// Moves the mechanism along `path`, at whose start its pose is. Allocates nothing, unless a
    /// block comes near a singular position. With `gives_up` it stops in front of one without
    /// looking for it.
    ///
    /// # Errors
    ///
    /// [`Blocked`] if the end cannot be reached on the continuous motion; the pose is then the
    /// last one reached. With `gives_up` the reason is [`Reason::Lost`] or one that needs no search.
    pub(in crate::kinematics) fn track(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        path: &Path,
        gives_up: bool,
    ) -> Result<Progress, Blocked> {
        self.track_watched(compiled, state, path, gives_up, None)
    }

    /// Moves the mechanism as [`track`](Self::track) does, in sub-steps that a watch admits.
    ///
    /// # Errors
    ///
    /// As [`track`](Self::track).
    pub(in crate::kinematics) fn track_watched(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        path: &Path,
        gives_up: bool,
        watch: Option<&mut dyn PathWatch>,
    ) -> Result<Progress, Blocked> {
        let watches_stops = !self.stops.is_empty() && !self.ignores_stops;
        let mut run = Run {
            compiled,
            state,
            drivers: &mut self.drivers,
            bounds: &mut self.bounds,
            crossed: &mut self.crossed,
            fruitless: &mut self.fruitless,
            is_watched: watches_stops || watch.is_some(),
            watches_stops,
            stops: &mut self.stops,
            watch: watch.map(|watch| watch as _),
            path,
            s: 0.0,
            length: 1.0,
            limit: None,
            opened: None,
            is_halved: false,
            is_last_attempt: false,
            gives_up,
            budget: self.budget,
            pace: Pace::default(),
            expected: None,
            searched: 0.0,
            progress: Progress::default(),
        };
        let ended = run.run();
        let (s, progress) = (run.s, run.progress);
        self.budget.spend(progress.substeps);
        match ended {
            Ok(()) => Ok(progress),
            Err(reason) => Err(Blocked {
                s,
                reason,
                progress,
            }),
        }
    }
}

/// A mechanism on a path.
struct Run<'a> {
    compiled: &'a mut CompiledMechanism,
    state: &'a mut State,
    drivers: &'a mut PathDrivers,
    bounds: &'a mut StepBounds,
    crossed: &'a mut Vec<Arc<Crossing>>,
    fruitless: &'a mut FruitlessSearches,
    /// Whether stops or another watch decide about sub-steps.
    is_watched: bool,
    watches_stops: bool,
    stops: &'a mut StopWatch,
    watch: Option<&'a mut dyn PathWatch>,
    path: &'a Path,
    /// The place on the path where the mechanism is.
    s: f64,
    /// Length of the next sub-step.
    length: f64,
    /// Limit of the next sub-step in front of a position that cannot be passed.
    limit: Option<DriverLimit>,
    /// A redundant constraint that was found open, and the place on the path.
    opened: Option<(f64, OpenJoint)>,
    /// Whether a sub-step was rejected without a ratio since the last accepted one.
    is_halved: bool,
    /// Whether the last sub-step had the smallest length.
    is_last_attempt: bool,
    /// Whether it stops in front of singular positions without looking for them.
    gives_up: bool,
    /// The budget at the start of the path.
    budget: Budget,
    pace: Pace,
    /// The place on the path of the singular position that slowed the motion down when its pace was
    /// judged last.
    expected: Option<f64>,
    /// The regularity at which no fitter rows were found last; zero at first.
    searched: f64,
    progress: Progress,
}

/// The cause of a rejected sub-step.
enum Failure {
    /// Newton–Raphson did not converge, or the certificate failed.
    NotCertified,
    /// The motion of a driver jumps.
    Jump(DriverId),
    /// No mechanism exists for a value at the end.
    Value(Error),
    /// A redundant constraint is open at the end.
    Contradiction(OpenJoint),
}

impl Run<'_> {
    /// Goes to the end of the path.
    ///
    /// # Errors
    ///
    /// The cause of a stop at `s`.
    fn run(&mut self) -> Result<(), Reason> {
        if self.is_ordinary() && self.take_at_once() {
            return Ok(());
        }
        self.set_out()?;
        self.look_ahead()?;
        while self.s < 1.0 {
            let smallest = self.smallest();
            self.prepare(smallest)?;
            let start = self.s;
            let cut_short = self.step(smallest)?;
            self.opened.take_if(|(place, _)| *place <= self.s);
            self.look_ahead()?;
            if self.s < 1.0 {
                let suggested = self.lengthened(self.s - start);
                // A sub-step that was cut short would have been possible at its full length.
                let possible = if cut_short { self.length } else { 0.0 };
                self.length = suggested.max(possible);
            }
        }
        Ok(())
    }

    /// Returns whether only the blocks decide about a path: as long as one sub-step does, nothing else
    /// takes part.
    fn is_ordinary(&self) -> bool {
        self.state.regularity >= NEAR
            && !self.is_watched
            && self.state.pose.crossings.is_empty()
            && self.compiled.redundant.is_empty()
            && self.budget.left > 0
            && !self.path.moves_parameters()
    }

    /// Takes an ordinary path, on which all drivers are inputs, in one sub-step. Where it cannot, or comes
    /// near a singular position, it returns false, and the mechanism is at the start of the path.
    fn take_at_once(&mut self) -> bool {
        if self.state.refresh(self.compiled).is_err() {
            return false;
        }
        let Self { drivers, path, .. } = self;
        drivers.parameters_move = false;
        let h = path.duration;
        let places = drivers.here.iter_mut().zip(&mut drivers.values);
        for ((k, driver_path), (here, value)) in path.driver_paths.iter().enumerate().zip(places) {
            let DriverPath::Input {
                position,
                velocity,
                acceleration,
                jump,
            } = *driver_path
            else {
                return false;
            };
            let start = Jet::new(position, [velocity, acceleration]);
            let second = h * h * acceleration;
            *here = Jet::new(position + jump, [h * velocity - jump, second]);
            *value = start.after(h).value;
            self.bounds.drivers[k] =
                0.125 * second.abs() + f64::EPSILON * (here.value.abs() + value.abs());
        }
        if self
            .compiled
            .system
            .check_drivers(&self.drivers.values)
            .is_err()
        {
            return false;
        }
        self.solve_tangent();
        self.bounds.begin();
        self.bounds.parameters.moving = false;
        let stepped = self.step_blocks(1.0);
        let Some(correction) = stepped
            .ok()
            .filter(|correction| correction.regularity >= NEAR)
        else {
            self.return_to_pose();
            return false;
        };
        self.crossed.clear();
        self.progress.substeps = 1;
        self.accept(1.0, correction);
        true
    }

    /// Makes sure that the mechanism is at the start of the path.
    fn set_out(&mut self) -> Result<(), Reason> {
        self.crossed.clear();
        self.fruitless.clear();
        self.drivers.parameters_move = self.path.moves_parameters();
        if self.drivers.parameters_move && !self.state.pose.crossings.is_empty() {
            // A crossing holds for the parameters of the pose only.
            self.state.release_crossings(self.compiled);
            self.state.move_to_pose(&self.compiled.system);
        }
        self.state
            .refresh(self.compiled)
            .map_err(|_| Reason::Lost)?;
        self.state.pose.time = self.path.time(0.0);
        self.evaluate_drivers(0.0);
        self.drivers.arrive();
        if self.watches_stops {
            self.stops.begin(self.compiled, self.state);
        }
        Ok(())
    }

    /// Takes fitter rows near a singular position of those in use, or adds the crossings of change
    /// points near the pose.
    ///
    /// # Errors
    ///
    /// A position right ahead that cannot be passed.
    #[inline]
    fn look_ahead(&mut self) -> Result<(), Reason> {
        self.limit = None;
        if self.state.regularity < NEAR && !self.gives_up {
            if self.drivers.parameters_move {
                self.take_fitter_rows();
            } else {
                self.limit = self.limit_near()?;
            }
        }
        Ok(())
    }

    /// Takes fitter rows near a singular position of those in use, if there are any: sub-steps may
    /// shorten without a rejection. Searches again once the regularity has changed by a factor of
    /// two.
    #[cold]
    fn take_fitter_rows(&mut self) {
        let regularity = self.state.regularity;
        if regularity > 0.5 * self.searched && regularity < 2.0 * self.searched {
            return;
        }
        self.searched = regularity;
        if redundancy::change_rows(self.compiled, self.state) {
            self.searched = 0.0;
            self.return_to_pose();
        }
    }

    /// Returns the limit of the next sub-step near a singular position.
    #[cold]
    fn limit_near(&mut self) -> Result<Option<DriverLimit>, Reason> {
        let limit = singular::look_ahead(
            self.compiled,
            self.state,
            &self.drivers.here,
            (self.path, self.s),
            self.fruitless,
        );
        limit.map_err(Reason::Singular)
    }

    /// Prepares the next sub-step from the pose.
    ///
    /// # Errors
    ///
    /// The cause of a stop, if a sub-step of the length `smallest` was tried already.
    fn prepare(&mut self, smallest: f64) -> Result<(), Reason> {
        if !self.state.pose.crossings.is_empty() {
            singular::leave_crossings(self.compiled, self.state, &self.drivers.here);
        }
        self.solve_tangent();
        self.judge_pace()?;
        let too_small = self.length < smallest;
        if too_small {
            let reason = self.reason_to_stop();
            if self.is_last_attempt || matches!(reason, Reason::Singular(_)) {
                return Err(reason);
            }
            self.length = smallest;
        }
        self.is_last_attempt = too_small;
        Ok(())
    }

    /// Judges the number of sub-steps that the path takes.
    ///
    /// # Errors
    ///
    /// The cause of a stop if they are too many, or would be at the pace of the last ones.
    fn judge_pace(&mut self) -> Result<(), Reason> {
        if self.progress.substeps >= self.budget.left {
            return Err(Reason::Spent(self.budget.most()));
        }
        let most = || {
            let CompiledMechanism { system, plan, .. } = &*self.compiled;
            let moved = || [system.equations().len(), self.state.at.profiles().len()];
            most_substeps(plan.work(), self.drivers.parameters_move.then(moved))
        };
        match self.pace.judge(self.progress.substeps, self.s, most) {
            Verdict::Fair => Ok(()),
            verdict => self.slow_down(verdict),
        }
    }

    /// Decides whether the motion may go on at a slow pace. Next to a singular position the pace does
    /// not predict the pace beyond it; if the position lies on the path and the motion still runs
    /// into the same one when its pace is judged again, it ends there.
    ///
    /// # Errors
    ///
    /// The cause of a stop otherwise.
    #[cold]
    fn slow_down(&mut self, verdict: Verdict) -> Result<(), Reason> {
        if self.state.regularity >= NEAR {
            return Err(Reason::TooLong);
        }
        if self.gives_up || self.drivers.parameters_move {
            return Err(Reason::NearSingular);
        }
        let end = singular::find_end(self.compiled, self.state, self.path, self.s);
        let loses_ranks = |end: &SingularPoint| end.kind == SingularKind::HigherRank;
        if end.as_deref().is_some_and(loses_ranks) {
            // The motion is there already, and its end has no place of its own.
            return Err(Reason::NearSingular);
        }
        let end = end.filter(|end| self.s < end.s && end.s <= 1.0);
        let expected = std::mem::replace(&mut self.expected, end.as_ref().map(|end| end.s));
        let is_known = |end: &SingularPoint| {
            expected.is_some_and(|expected| (end.s - expected).abs() <= SAME_PLACE_ON_PATH)
        };
        match (verdict, end) {
            (Verdict::Exhausted, None) => Err(Reason::NearSingular),
            (Verdict::Exhausted, Some(end)) => Err(Reason::Singular(end)),
            (_, Some(end)) if is_known(&end) => Err(Reason::Singular(end)),
            _ => Ok(()),
        }
    }

    /// Takes one sub-step: predicts, corrects and certifies its end, then accepts it or tries a
    /// shorter one. Returns whether the path cut it short.
    ///
    /// # Errors
    ///
    /// The cause of a stop, if a sub-step of the length `smallest` is rejected.
    fn step(&mut self, smallest: f64) -> Result<bool, Reason> {
        // A motion given by a table is bounded between its points only.
        let point = self.path.next_point(self.s, &self.state.motions);
        loop {
            let most = if self.is_watched {
                point.min(self.most_watched())
            } else {
                point
            };
            let goal = self.goal(most);
            self.progress.substeps = self.progress.substeps.saturating_add(1);
            match self.try_step(goal.s) {
                Ok(_) if self.is_watched && !self.is_admitted(goal.s)? => {
                    self.return_to_pose();
                }
                Ok(correction) => {
                    self.accept(goal.s, correction);
                    return Ok(goal.cut_short);
                }
                Err(failure) => {
                    self.return_to_pose();
                    self.shorten(failure, goal.s, smallest)?;
                }
            }
        }
    }

    /// Predicts, corrects and certifies the end of a sub-step. The pose stays as it is; all that is
    /// derived from it goes to the end, or anywhere in case of a failure.
    fn try_step(&mut self, end: f64) -> Result<Correction, Failure> {
        self.set_values(end).map_err(Failure::Value)?;
        let part = [self.s, end];
        let (system, state) = (&self.compiled.system, &*self.state);
        self.bounds.begin();
        bound_drivers(system, state, self.drivers, self.path, part, self.bounds)
            .map_err(|jumping| jumping.map_or(Failure::NotCertified, Failure::Jump))?;
        let correction = self
            .step_blocks(end - self.s)
            .map_err(|Rejected| Failure::NotCertified)?;
        if !self.compiled.redundant.is_empty() {
            self.watch_rows()?;
        }
        Ok(correction)
    }

    /// Predicts, corrects and certifies the blocks over a part of the path of this length, at whose end
    /// the drivers have their values.
    ///
    /// # Errors
    ///
    /// [`Rejected`]; all that is derived from the pose is then anywhere.
    fn step_blocks(&mut self, length: f64) -> Result<Correction, Rejected> {
        let CompiledMechanism { system, plan, .. } = &mut *self.compiled;
        let state = &mut *self.state;
        let extrapolation = extrapolation(&self.drivers.here, length);
        let unit_rates = state.has_single_driver().then_some(&UNIT_RATE[..]);
        let mut block_state = BlockState {
            system,
            targets: &state.targets,
            drivers: &self.drivers.values,
            at: &mut state.at,
            tangent: &mut state.tangent,
        };
        plan.step(
            &mut block_state,
            extrapolation,
            &state.pose.q,
            self.bounds,
            unit_rates,
        )
    }

    /// Returns the place on the path beyond which the next sub-step must not end.
    // Inlined, it would be part of steps without stops.
    #[inline(never)]
    fn most_watched(&self) -> f64 {
        let most = self
            .watch
            .as_ref()
            .map_or(f64::INFINITY, |watch| watch.most());
        most.min(if self.watches_stops {
            self.stops.most
        } else {
            f64::INFINITY
        })
    }

    /// Returns whether a certified sub-step is clear of all stops, and admitted by the watch.
    ///
    /// # Errors
    ///
    /// The stop that the pose is at, if the motion leads out.
    // Inlined, it would be part of steps without stops.
    #[inline(never)]
    fn is_admitted(&mut self, end: f64) -> Result<bool, Reason> {
        let part = [self.s, end];
        if let Some(watch) = &mut self.watch {
            let mut sub_step = SubStep {
                compiled: self.compiled,
                state: self.state,
                bounds: self.bounds,
                part,
            };
            if !watch.admits(&mut sub_step) {
                return Ok(false);
            }
        }
        if !self.watches_stops {
            return Ok(true);
        }
        let parameters = if self.drivers.parameters_move {
            &self.drivers.parameters
        } else {
            &self.state.pose.parameters
        };
        let checked = self
            .stops
            .check(self.compiled, self.state, parameters, self.bounds, part);
        match checked {
            Ok(false) => Ok(false),
            Ok(true) => {
                self.stops.accept(self.compiled, self.state, part);
                Ok(true)
            }
            Err(limit) => {
                self.return_to_pose();
                Err(Reason::Stop(limit))
            }
        }
    }

    /// Watches the rows set aside at the end of a sub-step, and between its ends.
    // Inlined, its loop invariants would be computed in steps without such rows.
    #[inline(never)]
    fn watch_rows(&mut self) -> Result<(), Failure> {
        if let Some(joint) = redundancy::opened(self.compiled, self.state) {
            return Err(Failure::Contradiction(joint));
        }
        redundancy::watch_between(self.compiled, self.state, self.bounds)
            .map_err(|Rejected| Failure::NotCertified)
    }

    /// Makes the end of a sub-step the pose.
    fn accept(&mut self, end: f64, correction: Correction) {
        // Written first: the caller copies it as a whole, which waits for parts written just before.
        let progress = &mut self.progress;
        progress.iterations = progress.iterations.saturating_add(correction.iterations);
        progress.checked = progress.checked.saturating_add(self.bounds.checked.into());
        let pose = &mut self.state.pose;
        pose.time = self.path.time(end);
        std::mem::swap(&mut pose.drivers, &mut self.drivers.values);
        if self.drivers.parameters_move {
            self.state.accept_parameters(&self.drivers.parameters);
        }
        self.state.accept_bodies();
        self.state.regularity = correction.regularity;
        self.note_crossings();
        self.drivers.arrive();
        self.s = end;
    }

    /// Derives bodies, parameters and tangent from the pose again.
    fn return_to_pose(&mut self) {
        self.state.return_to_pose(self.compiled);
        self.state
            .refresh(self.compiled)
            .expect("the pose was regular when it was reached");
        self.solve_tangent();
    }

    /// Solves the tangent of the path at the pose; with a single driver it is known already.
    fn solve_tangent(&mut self) {
        if !self.state.has_single_driver() {
            let CompiledMechanism { system, plan, .. } = &mut *self.compiled;
            plan.solve_rates(&mut self.state.block_state(system), &self.drivers.here);
        }
    }

    /// Evaluates the drivers at s.
    fn evaluate_drivers(&mut self, s: f64) {
        let mechanism = self.compiled.system.mechanism();
        self.drivers
            .evaluate(mechanism, self.path, s, &self.state.motions);
    }

    /// Evaluates the drivers at s and puts the parameters at s in force.
    ///
    /// # Errors
    ///
    /// A value for which no mechanism exists.
    fn set_values(&mut self, s: f64) -> Result<(), Error> {
        self.evaluate_drivers(s);
        self.drivers.take_values();
        if self.drivers.parameters_move {
            self.state
                .try_parameters(self.compiled, &self.drivers.parameters)?;
        }
        self.compiled.system.check_drivers(&self.drivers.values)
    }

    /// Notes the change points between the start of the sub-step and the pose.
    fn note_crossings(&mut self) {
        for crossing in &self.state.pose.crossings {
            let driver = crossing.driver.index();
            let before = self.drivers.here[driver].value - crossing.center;
            let now = self.state.pose.drivers[driver] - crossing.center;
            // A change point counts when it is reached, not when the motion sets out from it.
            if before != 0.0 && before * now <= 0.0 {
                self.progress.crossings += 1;
                self.crossed.push(Arc::clone(crossing));
            }
        }
    }

    /// Chooses a shorter sub-step, or other rows, after one to `end` was rejected.
    ///
    /// # Errors
    ///
    /// The cause of a stop, if that would be shorter than `smallest`.
    fn shorten(&mut self, failure: Failure, end: f64, smallest: f64) -> Result<(), Reason> {
        if let Failure::Contradiction(joint) = &failure {
            self.opened.get_or_insert_with(|| (end, joint.clone()));
        }
        if redundancy::change_rows(self.compiled, self.state) {
            // Blocks are others now.
            self.fruitless.clear();
            self.return_to_pose();
            return Ok(());
        }
        let ratio = match failure {
            // The certificate concerns the rows that are solved, and was not asked about values
            // without a mechanism.
            Failure::Contradiction(_) | Failure::Jump(_) | Failure::Value(_) => None,
            Failure::NotCertified => self.ratio_to_rejected(),
        };
        self.is_halved |= ratio.is_none();
        let tried = end - self.s;
        self.length = tried * ratio.unwrap_or(HALF);
        if tried >= 2.0 * smallest {
            self.length = self.length.max(smallest);
        }
        if self.length >= smallest {
            return Ok(());
        }
        match (failure, self.opened.take()) {
            // Next to a singular position no row holds to rounding.
            (Failure::Contradiction(_), Some((_, joint)))
                if !redundancy::is_nearly_singular(self.compiled, self.state) =>
            {
                Err(Reason::Contradiction(joint))
            }
            (Failure::Value(error), _) => Err(Reason::Value(error)),
            (Failure::Jump(driver), _) => Err(match self.reason_to_stop() {
                Reason::Lost | Reason::TooLong => Reason::Jump(driver),
                reason => reason,
            }),
            _ => Err(self.reason_to_stop()),
        }
    }

    /// Returns the cause of a stop at the pose.
    fn reason_to_stop(&mut self) -> Reason {
        if self.gives_up {
            return Reason::Lost;
        }
        if !self.drivers.parameters_move
            && let Some(end) = singular::find_end(self.compiled, self.state, self.path, self.s)
        {
            return Reason::Singular(end);
        }
        // Sub-steps may become ever shorter in front of an invalid value.
        let ahead = self.set_values((self.s + SAME_PLACE_ON_PATH).min(1.0));
        self.return_to_pose();
        if let Err(error) = ahead.and_then(|()| self.check_ropes()) {
            return Reason::Value(error);
        }
        let moves = |driver: &Jet| (self.length * driver.first()).abs() > LARGEST_LAST_MOVE;
        if self.drivers.here.iter().any(moves) {
            Reason::TooLong
        } else {
            Reason::Lost
        }
    }

    /// Refuses a pose at which the count of an arc of a rope jumps.
    fn check_ropes(&self) -> Result<(), Error> {
        let system = &self.compiled.system;
        let mut ropes = system.ropes();
        let found = ropes.find_map(|(joint, rope)| Some((joint, rope.at_jump(&self.state.at)?)));
        found.map_or(Ok(()), |(joint, (pulley, angle))| {
            Err(Error::RopeArc {
                rope: system.mechanism().joints[joint].name.clone(),
                pulley: system.mechanism().marker_path(pulley),
                angle,
            })
        })
    }
}

/// Returns the step along the tangent for the part `h` of the path: q + h q′ + ½ h² q″, where with
/// a single driver q′ = q_u u′ and q″ = q_u u″ + q_uu u′².
fn extrapolation(drivers: &[Jet], h: f64) -> Extrapolation {
    match drivers {
        [u] => Extrapolation {
            first: h * (u.first() + 0.5 * h * u.second()),
            second: 0.5 * (h * u.first()).powi(2),
        },
        _ => Extrapolation {
            first: h,
            second: 0.5 * h * h,
        },
    }
}
