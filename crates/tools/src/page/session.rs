//! A mechanism at one pose, and its moves.

use std::sync::Arc;

use serde_json::Value;

use super::edit::{EditError, PosePart, edit, set_input_starts};
use super::held::assembled;
use super::outcome::{Obstacle, Outcome};
use super::ranges::{DriverRange, driver_ranges, start_rates};
use super::spring::Spring;
use super::undo::{Kept, UndoHistory};
use super::values::shown_in;
use crate::drawing::animation::MovingPicture;
use crate::drawing::{Scene, Sheet, svg};
use biela::dynamics::{Event, Motion, MotionState, Overlap};
use biela::kinematics::{
    DriverPath, ForceQuantity, Output, OutputSource, Path, Pose, Reason, Solver,
};
use biela::mechanism::{
    BodyId, DisplayUnit, DriverId, Jet, Mechanism, Order, Parameter, ParameterId, PrescribedMotion,
    Severity, Source, Unit,
};

/// Reciprocal condition below which a pose counts as a dead point, where rates grow without bound. A
/// dead point is located to 1e-9 of a path at worst, and its reciprocal condition is of the size of
/// the square root.
const AT_DEAD_POINT: f64 = 3e-5;

/// A mechanism that its reader moves by hand.
pub struct Session {
    source: Source,
    /// Warnings about the file, one line each.
    pub(super) warnings: Vec<String>,
    /// The mechanism that moves, with drivers behind those of the file where these are too few.
    pub(super) mechanism: Arc<Mechanism>,
    /// The mechanism of the file, which is drawn.
    pub(super) own: Arc<Mechanism>,
    /// The mechanism in motion, maybe with a spring. The rates of drivers that are inputs and the loads are
    /// the reader's.
    pub(super) motion: Motion,
    /// The events of the free motion, while a chart is computed.
    pub(super) events: Option<Vec<Event>>,
    /// Parts that overlapped, not told yet.
    pub(super) overlaps: Vec<Overlap>,
    /// The spring on which the reader holds a body.
    pub(super) spring: Option<Spring>,
    /// The point whose path is shown: of a body, in its frame \[m\].
    pub(super) traced: Option<(BodyId, [f64; 2])>,
    /// The start of the simulation, from which times are reached; for freedoms the moment at which
    /// they were let go.
    pub(super) start: MotionState,
    /// Whether rates and forces belong to the pose, where they exist.
    pub(super) has_rates: bool,
    pub(super) picture: MovingPicture,
    pub(super) outputs: Vec<Output>,
    /// Kinetic and potential energy among the outputs of a free motion; their sum is a variable.
    energies: Option<[usize; 2]>,
    pub(super) length: Option<DisplayUnit>,
    pub(super) ranges: Vec<Option<DriverRange>>,
    pub(super) path: Path,
    home: Kept,
    history: UndoHistory,
    /// The assembly modes listed last, with their bodies.
    pub(super) modes: Vec<Vec<f64>>,
}

impl Session {
    /// Reads a mechanism and assembles it.
    ///
    /// # Errors
    ///
    /// The problems of the file, one line each, or the reason why the mechanism does not assemble.
    pub fn open(source: Source) -> Result<Self, Vec<String>> {
        let (mechanism, diagnostics) = Mechanism::parse(&source).map_err(|diagnostics| {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            errors.map(|d| d.one_line(&source)).collect::<Vec<_>>()
        })?;
        let warnings = diagnostics.iter().map(|d| d.one_line(&source)).collect();
        let refuse = |error: biela::kinematics::Error| vec![error.to_string()];
        let own = Arc::new(mechanism);
        let mut solver = assembled(&own).map_err(refuse)?;
        let mechanism = Arc::clone(solver.mechanism());
        let (ranges, reached) = driver_ranges(&mut solver, own.drivers.len());
        let mut motion = Motion::new(solver);
        motion.solution.driver_rates = start_rates(&mechanism, &ranges);
        let prepared = motion.prepare_freedoms(Vec::new());
        prepared.map_err(|error| vec![error.to_string()])?;
        if mechanism.has_dynamics() {
            motion.seek_forces();
        }
        let start = motion.state();
        let home = Kept {
            mechanism: Arc::clone(&mechanism),
            start: start.clone(),
            now: start.clone(),
        };
        let outputs = Output::all(&own);
        let mut session = Self {
            warnings,
            start,
            energies: motion.free().and_then(|_| energies(&outputs)),
            events: None,
            overlaps: Vec::new(),
            spring: None,
            traced: None,
            has_rates: false,
            picture: MovingPicture::new(&mut motion.solver, &own, &reached, None),
            outputs,
            length: mechanism.length_display(),
            path: Path::new(&mechanism),
            mechanism,
            own,
            ranges,
            home,
            history: UndoHistory::default(),
            modes: Vec::new(),
            motion,
            source,
        };
        session.refresh();
        let overlaps = session.overlaps();
        session.warnings.extend(overlaps);
        session.home = session.now();
        Ok(session)
    }

    /// Returns the mechanism; its estimates may be those of another assembly mode than the file's.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// Returns the file as it was opened.
    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the pose; where the motion of freedoms goes on in other coordinates, with their
    /// values.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        self.motion.solver.pose()
    }

    // -- moves -------------------------------------------------------------------------------

    /// Moves a driver that is an input to a value \[m or rad\]. A freedom is let go from rest there.
    pub fn drive(&mut self, driver: DriverId, value: f64) -> Outcome {
        self.take();
        let path = self.path_here();
        let Some(DriverPath::Input { position, .. }) =
            path.driver_paths.get(driver.index()).copied()
        else {
            return Outcome::Refused(Obstacle::new("no driver that is an input"));
        };
        if !value.is_finite() {
            return Outcome::Refused(Obstacle::new("the value is no finite number"));
        }
        path.driver_paths[driver.index()] = DriverPath::held(value, position);
        let outcome = self.follow(|id| id == driver);
        self.release_moved(self.mechanism.drivers[driver.index()].is_free());
        self.tell_overlaps(outcome)
    }

    /// Moves to a time \[s\], with parameters and inputs as they are.
    pub fn go_to(&mut self, time: f64) -> Outcome {
        if !time.is_finite() {
            return Outcome::Refused(Obstacle::new("the time is no finite number"));
        }
        if self.motion.free().is_some() {
            return self.fly_to(time);
        }
        if time < self.pose().time
            && let Err(obstacle) = self.return_to_start()
        {
            return Outcome::Refused(obstacle);
        }
        let path = self.path_here();
        path.duration = time - path.start;
        let outcome = self.follow(|_| true);
        self.refresh();
        outcome
    }

    /// Changes a parameter to a value \[SI\]; the mechanism follows on its assembly mode. With
    /// `anew` it is assembled there if no continuous motion leads there.
    pub fn set(&mut self, parameter: ParameterId, value: f64, anew: bool) -> Outcome {
        let mechanism = Arc::clone(self.mechanism());
        let Some(own) = mechanism.parameters.get(parameter.index()) else {
            return Outcome::Refused(Obstacle::new("no such parameter"));
        };
        if let Some(message) = unfit(own, value) {
            return Outcome::Refused(Obstacle::new(message));
        }
        self.take();
        let before = self.pose().clone();
        let mut values = before.parameters.clone();
        values[parameter.index()] = value;
        mechanism.derive_parameters(&mut values);
        let path = self.path_here();
        path.to.clone_from(&values);
        let Err(blocked) = self.motion.solver.track(&self.path) else {
            self.release_moved(false);
            return self.tell_overlaps(Outcome::Reached);
        };
        let mut obstacle = Obstacle::of_stop(&blocked, &self.motion.solver, &self.path, |_| false);
        if let Reason::Stop(_) = blocked.reason {
            self.motion.solver.restore(&before);
            self.refresh();
            return Outcome::Refused(obstacle);
        }
        let way = before.parameters[parameter.index()];
        let limit = way + blocked.s * (value - way);
        self.motion.solver.restore(&before);
        let mut path = self.path_here().clone();
        path.from.clone_from(&values);
        path.to.clone_from(&values);
        match Solver::assembled(Arc::clone(&mechanism), &path) {
            Ok(solver) if anew => {
                self.motion.solver.restore(solver.pose());
                self.start = self.motion.state();
                self.release_moved(true);
                return self.tell_overlaps(Outcome::Reached);
            }
            Ok(_) => {
                let (unit, factor) = shown_in(own.unit.unwrap_or(Unit::ONE), None);
                let limit = biela::mechanism::shown(limit * factor);
                obstacle.message = format!(
                    "no continuous motion leads past `{}` = {limit} {unit}; the mechanism closes \
                     beyond in another position",
                    own.name
                );
                obstacle.assembles = true;
            }
            Err(error) => {
                obstacle = Obstacle::of_assembly(&error, &self.motion.solver);
            }
        }
        self.refresh();
        Outcome::Refused(obstacle)
    }

    /// Sets the rates of a driver that is an input \[m/s or rad/s, m/s² or rad/s²\], with which it
    /// moves along with freedoms, or the velocity of a freedom.
    pub fn set_speed(&mut self, driver: DriverId, velocity: f64, acceleration: f64) {
        self.take();
        let rates = [velocity, acceleration];
        if let Some(jet) = self.motion.solution.driver_rates.get_mut(driver.index())
            && rates.iter().all(|rate| rate.is_finite())
        {
            *jet = Jet::new(0.0, rates);
            self.release_moved(false);
        }
    }

    /// Sets the size of a force that is an input \[SI\], or an input: drivers that follow it move there.
    pub fn set_load(&mut self, input: usize, size: f64) -> Outcome {
        if !size.is_finite() {
            return Outcome::Refused(Obstacle::new("the value is no finite number"));
        }
        if self.mechanism.has_followers(input) {
            return self.lead_followers(input, size);
        }
        let Some(load) = self.motion.solution.loads.get_mut(input) else {
            return Outcome::Refused(Obstacle::new("no such input"));
        };
        *load = size;
        self.fly_on();
        self.refresh();
        Outcome::Reached
    }

    /// Returns the value of an input of those that [`set_load`](Self::set_load) sets \[SI\].
    #[must_use]
    pub fn load(&self, input: usize) -> Option<f64> {
        if self.mechanism.has_followers(input) {
            return Some(self.mechanism.inputs[input].start);
        }
        self.motion.solution.loads.get(input).copied()
    }

    /// Moves the drivers that follow an input to a value of it, as far as they can go: the mechanism becomes
    /// one whose input starts with the value reached.
    fn lead_followers(&mut self, input: usize, value: f64) -> Outcome {
        /// Part of the way by which a second try ends before the place where the first has stopped.
        const BEFORE: f64 = 1e-6;
        self.take();
        let here = self.pose().clone();
        let from = self.mechanism.inputs[input].start;
        let mut end = value;
        let mut stopped = None;
        for _ in 0..2 {
            let mut mechanism = Mechanism::clone(&self.mechanism);
            mechanism.set_input_start(input, end);
            self.path_to_followers(&mechanism, &here.parameters);
            let Err(blocked) = self.motion.solver.track(&self.path) else {
                return self.exchange_followers(mechanism, stopped);
            };
            let moves = |id: DriverId| self.mechanism.drivers[id.index()].follows.is_some();
            let obstacle = Obstacle::of_stop(&blocked, &self.motion.solver, &self.path, moves);
            stopped = stopped.or(Some(obstacle));
            self.motion.solver.restore(&here);
            end = from + (blocked.s - BEFORE).max(0.0) * (end - from);
        }
        self.refresh();
        Outcome::Refused(stopped.unwrap_or_default())
    }

    /// Goes on with a mechanism whose drivers that follow inputs are where the pose has them.
    fn exchange_followers(&mut self, mechanism: Mechanism, stopped: Option<Obstacle>) -> Outcome {
        let mut solver = match Solver::new(Arc::new(mechanism)) {
            Ok(solver) => solver,
            Err(error) => return Outcome::Refused(Obstacle::new(error.to_string())),
        };
        solver.restore(self.pose());
        self.exchange(solver);
        self.release_moved(false);
        self.tell_overlaps(stopped.map_or(Outcome::Reached, Outcome::Stopped))
    }

    /// Prepares the path to where the drivers that follow inputs are in a mechanism, at the present time and
    /// with these parameters.
    fn path_to_followers(&mut self, mechanism: &Mechanism, parameters: &[f64]) {
        let (time, now) = (self.pose().time, self.pose().drivers.clone());
        let path = self.path_here();
        let drivers = mechanism.drivers.iter().zip(now).enumerate();
        for (index, (driver, now)) in drivers {
            if let (Some(_), Some(PrescribedMotion::Expression(motion))) =
                (&driver.follows, driver.motion())
            {
                let value = motion.evaluate(&|p: ParameterId| parameters[p.index()], time);
                path.driver_paths[index] = DriverPath::held(value, now);
            }
        }
    }

    /// Returns descriptions of what has overlapped since the last call.
    fn overlaps(&mut self) -> Vec<String> {
        if let Some((free, ..)) = self.motion.parts() {
            self.overlaps.extend(free.overlaps());
        }
        let overlaps = self.overlaps.drain(..);
        overlaps
            .map(|overlap| overlap.describe(&self.own))
            .collect()
    }

    /// Returns the outcome of a move after which parts that overlapped were moved apart.
    pub(super) fn tell_overlaps(&mut self, outcome: Outcome) -> Outcome {
        match (outcome, self.overlaps().first()) {
            (Outcome::Reached, Some(overlap)) => Outcome::Stopped(Obstacle::new(overlap)),
            (outcome, _) => outcome,
        }
    }

    /// Prepares the path on which nothing moves, at the pose.
    pub(super) fn path_here(&mut self) -> &mut Path {
        self.motion.solver.pose().set_path(&mut self.path);
        let driver_paths = self.path.driver_paths.iter_mut();
        for (driver_path, driver) in driver_paths.zip(&self.mechanism.drivers) {
            if driver.motion().is_some() {
                *driver_path = DriverPath::Motion;
            }
        }
        &mut self.path
    }

    /// Follows the path that was prepared; `moves` tells which drivers move.
    pub(super) fn follow(&mut self, moves: impl Fn(DriverId) -> bool) -> Outcome {
        match self.motion.solver.track(&self.path) {
            Ok(_) => Outcome::Reached,
            Err(blocked) => Outcome::Stopped(Obstacle::of_stop(
                &blocked,
                &self.motion.solver,
                &self.path,
                moves,
            )),
        }
    }

    /// Goes to the start of the simulation, with parameters and inputs as they are. A failure
    /// leaves the pose.
    pub(super) fn return_to_start(&mut self) -> Result<(), Obstacle> {
        if self.motion.free().is_some() {
            let start = self.start.clone();
            self.motion.resume(&start);
            return Ok(());
        }
        let here = self.pose().clone();
        self.motion.solver.restore(&self.start.pose);
        let mechanism = Arc::clone(&self.mechanism);
        self.path_to_followers(&mechanism, &here.parameters);
        let path = &mut self.path;
        path.to.clone_from(&here.parameters);
        let inputs = path.driver_paths.iter_mut().zip(&here.drivers);
        for ((driver_path, value), driver) in inputs.zip(&mechanism.drivers) {
            if let (DriverPath::Input { position, .. }, None) = (*driver_path, driver.motion()) {
                *driver_path = DriverPath::held(*value, position);
            }
        }
        if let Outcome::Stopped(obstacle) = self.follow(|_| true) {
            self.motion.solver.restore(&here);
            return Err(obstacle);
        }
        self.start = self.motion.state();
        Ok(())
    }

    /// Solves rates and forces at the pose.
    pub(super) fn refresh(&mut self) {
        self.motion.solution.follow_motions(&self.motion.solver);
        let moves = self.release().is_ok();
        let is_solved = self.motion.solution.solve(&mut self.motion.solver).is_ok();
        self.has_rates = is_solved && moves && self.motion.solver.rcond() > AT_DEAD_POINT;
    }

    /// Returns the number of variables that are shown.
    pub(super) fn variables(&self) -> usize {
        self.outputs.len() + usize::from(self.energies.is_some())
    }

    /// Returns the places of kinetic and potential energy and of their sum among the variables of a
    /// free motion.
    pub(super) fn energies(&self) -> Option<[usize; 3]> {
        let [kinetic, potential] = self.energies?;
        Some([kinetic, potential, self.outputs.len()])
    }

    /// Returns the value of a variable by its place \[SI\], not a number where there is none.
    pub(super) fn variable(&self, index: usize) -> f64 {
        match (self.outputs.get(index), self.energies) {
            (Some(output), _) => self.value(output),
            (None, Some(parts)) if index == self.outputs.len() => parts
                .map(|part| self.value(&self.outputs[part]))
                .iter()
                .sum(),
            _ => f64::NAN,
        }
    }

    /// Returns the value of an output \[SI\], not a number where there is none.
    pub(super) fn value(&self, output: &Output) -> f64 {
        let needs_rates = match output.source {
            OutputSource::Signal(_, order) => order != Order::Position,
            OutputSource::Input(_) => false,
            OutputSource::Derived(index) => {
                self.mechanism().derived[index].order() != Order::Position
            }
            OutputSource::Force(_) => true,
        };
        if needs_rates && !self.has_rates {
            return f64::NAN;
        }
        self.motion.solution.value(&self.motion.solver, output)
    }

    // -- pictures and files ------------------------------------------------------------------

    /// Draws the moving picture anew, as changed parameters demand: with `keep` at the same scale,
    /// otherwise with the ranges of the drivers, which are found anew, and at the scale that fits.
    pub fn redraw(&mut self, keep: bool) {
        self.apart_by_hand(|session| session.draw_anew(keep));
    }

    fn draw_anew(&mut self, keep: bool) {
        self.picture = if keep {
            let scale = self.picture.scale();
            MovingPicture::new(&mut self.motion.solver, &self.own, &[], Some(scale))
        } else {
            let (ranges, reached) = driver_ranges(&mut self.motion.solver, self.own.drivers.len());
            self.ranges = ranges;
            MovingPicture::new(&mut self.motion.solver, &self.own, &reached, None)
        };
        self.refresh();
    }

    /// Returns the moving picture's parts.
    #[must_use]
    pub fn picture(&self) -> Value {
        self.picture.description()
    }

    /// Returns the diagram of the pose, as `biela draw` writes it.
    pub fn diagram(&mut self) -> String {
        self.apart_by_hand(|session| {
            let scene = Scene::new(&mut session.motion.solver, true);
            let sheet = Sheet::new(&scene, &session.motion.solver.pose().q);
            session.refresh();
            svg::write(&sheet, sheet.width(), false)
        })
    }

    /// Returns the mechanism's file with the parameters as they are, and with start values and
    /// estimates so that it assembles at the pose; freedoms go on with their velocities.
    ///
    /// # Errors
    ///
    /// Those of [`edit`], which a file that was read does not have.
    pub fn text(&self) -> Result<String, EditError> {
        let moved = self.pose() != &self.home.now.pose;
        let place = if moved {
            PosePart::Whole
        } else {
            PosePart::Keep
        };
        self.edited(place)
    }

    /// Returns the mechanism's file with the parameters as they are, and nothing else changed.
    ///
    /// # Errors
    ///
    /// Those of [`edit`], which a file that was read does not have.
    pub fn text_with_parameters(&self) -> Result<String, EditError> {
        self.edited(PosePart::Keep)
    }

    fn edited(&self, place: PosePart) -> Result<String, EditError> {
        let pose = self.own_pose();
        let parameters = self.mechanism().parameters.iter().zip(&pose.parameters);
        let changed =
            parameters.filter(|(p, value)| !p.derived && p.default.to_bits() != value.to_bits());
        let names: Vec<String> = changed.map(|(p, _)| p.name.clone()).collect();
        let velocity = |freedom| Some(self.driver(freedom).first());
        let text = self.source.text();
        let text = edit(text, &self.own, &names, (&pose, velocity), place)?;
        if place == PosePart::Keep {
            return Ok(text);
        }
        let inputs = self.own.inputs.iter().zip(&self.mechanism.inputs);
        let moved = inputs.filter(|(own, now)| own.start.to_bits() != now.start.to_bits());
        set_input_starts(text, moved.map(|(_, input)| (&*input.name, input.start)))
    }

    // -- undo --------------------------------------------------------------------------------

    /// Keeps the present state, to which [`undo`](Self::undo) returns.
    pub fn keep(&mut self) {
        self.let_go();
        self.history.keep(self.now());
    }

    /// Returns to the state kept last; false if there is none.
    pub fn undo(&mut self) -> bool {
        self.let_go();
        let back = self.history.undo(self.now());
        self.go_to_state(back)
    }

    /// Returns to the state that [`undo`](Self::undo) left; false if there is none.
    pub fn redo(&mut self) -> bool {
        self.let_go();
        let back = self.history.redo(self.now());
        self.go_to_state(back)
    }

    /// Returns to the file's own values and pose, to the speeds of the start and to no loads.
    pub fn reset(&mut self) {
        self.keep();
        self.go_to_state(Some(self.home.clone()));
        self.motion.solution.driver_rates = start_rates(&self.mechanism, &self.ranges);
        self.motion.solution.loads.fill(0.0);
        let mechanism = self.motion.solver.mechanism().clone();
        mechanism.write_load_starts(&mut self.motion.solution.loads);
        self.release_moved(false);
    }

    fn now(&self) -> Kept {
        Kept {
            mechanism: Arc::clone(self.mechanism()),
            now: self.motion.state(),
            start: self.start.clone(),
        }
    }

    /// Goes to a state, if there is one; returns whether there is.
    fn go_to_state(&mut self, state: Option<Kept>) -> bool {
        let Some(kept) = state else {
            return false;
        };
        if !Arc::ptr_eq(&kept.mechanism, self.mechanism())
            && let Ok(mut solver) = Solver::new(kept.mechanism)
        {
            // It has been assembled before, which chooses the rows that are solved.
            let _ = solver.assemble(&Path::new(solver.mechanism()));
            self.exchange(solver);
        }
        self.motion.resume(&kept.now);
        self.start = kept.start;
        self.refresh();
        true
    }

    /// Takes over a solver of the same mechanism with other estimates, at its pose.
    pub(super) fn adopt(&mut self, solver: Solver) {
        self.keep();
        self.exchange(solver);
        self.start = self.motion.state();
        self.release_moved(true);
    }

    /// Exchanges the solver for one of the same mechanism with other estimates.
    fn exchange(&mut self, solver: Solver) {
        self.take();
        self.mechanism = Arc::clone(solver.mechanism());
        self.motion.solver = solver;
        let prepared = self.motion.prepare_freedoms(Vec::new());
        debug_assert!(
            prepared.is_ok(),
            "those of the mechanism before were prepared"
        );
        let inputs = self.mechanism.inputs.iter().enumerate();
        for (index, input) in inputs.filter(|(index, _)| self.mechanism.has_followers(*index)) {
            if let Some(load) = self.motion.solution.loads.get_mut(index) {
                *load = input.start;
            }
        }
    }
}

/// Returns the places of kinetic and potential energy.
fn energies(outputs: &[Output]) -> Option<[usize; 2]> {
    let place = |quantity| {
        let source = OutputSource::Force(quantity);
        outputs.iter().position(|output| output.source == source)
    };
    Some([
        place(ForceQuantity::KineticEnergy)?,
        place(ForceQuantity::PotentialEnergy)?,
    ])
}

/// Returns the reason why a parameter cannot have a value.
fn unfit(parameter: &Parameter, value: f64) -> Option<String> {
    if let Err(error) = parameter.check_settable() {
        return Some(error.to_string());
    }
    let name = &parameter.name;
    if !value.is_finite() {
        return Some(format!("`{name}` must be a finite number"));
    }
    let (unit, factor) = shown_in(parameter.unit.unwrap_or(Unit::ONE), None);
    let limit = |limit: f64| biela::mechanism::shown(limit * factor);
    match (parameter.min, parameter.max) {
        (Some(min), _) if value < min => {
            Some(format!("`{name}` must be at least {} {unit}", limit(min)))
        }
        (_, Some(max)) if value > max => {
            Some(format!("`{name}` must be at most {} {unit}", limit(max)))
        }
        _ => None,
    }
}
