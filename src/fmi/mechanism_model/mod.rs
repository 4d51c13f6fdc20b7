//! A mechanism as the model of an FMU: the [`Model`] made of a [`Mechanism`] and its [`Solver`].
//!
//! | file | subject |
//! |---|---|
//! | `variables` | the table of variables |
//! | `decisions` | what an export decides by numbers |
//! | `dependencies` | the variables on which another one depends |
//! | `description`, `guid`, `resource` | the FMU's files |
//! | `rule` | the parameters `rates` and `extrapolation`, and the sources of rates |
//! | `history` | the last samples of one driver, and the rates estimated from them |
//! | `input` | one driver's inputs: their path during a step and their rates |
//! | `force_input` | one input of a force |
//! | `forces` | forces at the pose, and contacts that lift off |
//! | `free` | the motion of freedoms |
//! | `monitor` | one driver's observations: contradictions, falls, limits |
//! | `parts` | a step in parts, between which the host sets inputs |
//! | `pose` | initialization, steps, and the pose and rates of the values set |
//! | `messages` | messages about poses and steps |
//! | `outputs` | values by value reference |
//! | `derivatives` | directional derivatives |
//! | `state` | the saved state |

mod decisions;
mod dependencies;
mod derivatives;
mod description;
mod follower;
mod force_input;
mod forces;
mod freedoms;
mod guid;
mod history;
mod input;
mod mechanism_state;
mod messages;
mod monitor;
mod outputs;
mod parts;
mod pose;
mod resource;
mod rule;
mod variables;

use std::path::Path as FilePath;
use std::sync::Arc;

pub use decisions::RESOURCE;
pub use description::describe;
pub use guid::guid;
pub use mechanism_state::MechanismState;
pub use resource::write_fmu;
pub use variables::{Quantity, TABLE_VERSION, variables};

use super::codec::{Codec, Unreadable};
use super::error::Failure;
use super::log::Logger;
use super::model::{Groups, Model, StateChange};
use super::model_description::{Capabilities, DependencyKind};
use super::state::{Interface, Phase};
use super::variable::Variable;
use crate::dynamics::{Event, FreeState, KeptStart, Motion, Overlap};
use crate::kinematics::{
    self, Budget, OutputSource, Path, Pose, Progress, Solver, SolverChoices, offer_start,
};
use crate::mechanism::{
    Driver, DriverId, Extrapolation, Jet, Mechanism, Order, ParameterId, RateSource, Signal,
    rounded,
};
use decisions::Decisions;
use follower::with_followers;
use force_input::ForceInput;
use guid::guid_decided;
use input::DriverInput;
use monitor::Monitor;
use outputs::Reals;
use parts::Parts;
use rule::{Rule, Source};
use variables::variables_of;

/// A mechanism at the values that a host has set.
#[derive(Debug)]
pub struct MechanismModel {
    mechanism: Arc<Mechanism>,
    guid: String,
    interface: Interface,
    variables: Vec<Variable<Quantity>>,
    /// The mechanism in motion, with rates and forces at its pose; the values of the drivers' rates have no
    /// meaning.
    motion: Motion,
    /// Pose of the file's own values, where its motion [begins](KeptStart), and the solver's choices there.
    file_pose: Arc<Pose>,
    file_choices: SolverChoices,
    /// Overlaps and impacts at the start of the file.
    overlaps: Vec<Overlap>,
    impacts: Vec<Event>,
    course: Course,
    reals: Reals,
    path: Path,
    /// Whether the states are those of coordinates that are exchanged.
    has_local_states: bool,
    /// The step that is being taken in parts.
    parts: Option<Box<Parts>>,
    /// Time of the dead point in front of which the last step has stopped.
    dead_point: Option<f64>,
    /// Whether inputs or parameters have jumped at the last commit.
    has_jumped: bool,
}

/// Everything that decides how the model goes on, apart from the solver's pose and the rates of the
/// drivers there: a saved state has it, and a step that is given up returns to it.
#[derive(Clone, Debug, PartialEq)]
struct Course {
    time: f64,
    /// Pose from which initialization starts: that of the file's own values, or that of a restored
    /// state, which another machine may have computed with other rounding.
    start_pose: Arc<Pose>,
    /// Parameters as set by the host, and those derived from them.
    parameters: Vec<f64>,
    rule: Rule,
    /// Most sub-steps of a call, at least 1.
    budget: f64,
    /// Pose from which the mechanism goes on; in co-simulation that of the last communication
    /// point.
    committed: Pose,
    /// The solver's choices at the committed pose, while it is at another one.
    committed_choices: SolverChoices,
    /// Rates of all drivers at the committed pose.
    committed_rates: Vec<Jet>,
    /// Whether the solver is at the committed pose.
    at_committed: bool,
    freshness: Freshness,
    /// Sources of the rates per driver at the solver's pose.
    sources: Vec<[Source; 2]>,
    /// Inputs per driver; those of prescribed motions have no meaning.
    inputs: Vec<DriverInput>,
    /// Inputs of the file and of forces, in the order of the loads.
    force_inputs: Vec<ForceInput>,
    /// The motion of freedoms at the committed pose.
    free: Option<FreeState>,
    /// Observations per driver.
    monitors: Vec<Monitor>,
    /// Effort of the last path.
    path_progress: Progress,
    /// Effort of the last step or, in model exchange, up to the last event.
    progress: Progress,
}

impl Course {
    /// Returns the course of a mechanism that begins at a pose with the solver's choices there.
    fn new(
        mechanism: &Mechanism,
        start: &Arc<Pose>,
        choices: &SolverChoices,
        free: Option<FreeState>,
    ) -> Self {
        let drivers = mechanism.drivers.len();
        let inputs = mechanism.drivers.iter().map(start_input);
        Self {
            time: start.time,
            start_pose: Arc::clone(start),
            parameters: mechanism.default_parameters(),
            rule: Rule {
                rates: mechanism.simulation.rates,
                extrapolation: mechanism.simulation.extrapolation,
            },
            budget: Budget::usual(mechanism).most().into(),
            committed: Pose::clone(start),
            committed_choices: choices.clone(),
            committed_rates: vec![Jet::constant(0.0); drivers],
            at_committed: true,
            freshness: Freshness::Stale,
            sources: vec![[Source::default(); 2]; drivers],
            inputs: inputs.collect(),
            force_inputs: (mechanism.load_inputs().iter())
                .map(|input| ForceInput::new(input.start))
                .collect(),
            free,
            monitors: vec![Monitor::default(); drivers],
            path_progress: Progress::default(),
            progress: Progress::default(),
        }
    }
}

/// Returns the inputs of a driver at its start; a freedom's are its states.
fn start_input(driver: &Driver) -> DriverInput {
    let mut input = DriverInput::new(driver.start().unwrap_or(0.0));
    if driver.follows.is_some() {
        return input.without_rates();
    }
    if driver.is_free() {
        input.set(Order::Velocity, driver.start_velocity());
    }
    input
}

/// Validity of the solver's pose and rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Freshness {
    /// Neither belongs to the values set.
    Stale,
    /// The pose belongs to the values set.
    Pose,
    /// Pose and rates belong to the values set.
    Rates,
}

impl MechanismModel {
    /// Assembles a mechanism at its own estimates and values.
    ///
    /// # Errors
    ///
    /// The mechanism does not assemble.
    pub fn new(mechanism: Arc<Mechanism>, interface: Interface) -> Result<Self, kinematics::Error> {
        let decisions = Decisions::of(&mechanism);
        Self::decided(mechanism, interface, &decisions)
    }

    /// Assembles a mechanism whose FMU follows from the decisions of its export.
    fn decided(
        mechanism: Arc<Mechanism>,
        interface: Interface,
        decisions: &Decisions,
    ) -> Result<Self, kinematics::Error> {
        let (mechanism, overlaps, impacts) = match KeptStart::of(&mechanism) {
            Some(kept) => (kept.mechanism, kept.overlaps, kept.events),
            None => (mechanism, Vec::new(), Vec::new()),
        };
        let mechanism = with_followers(mechanism, interface)?;
        let path = Path::new(&mechanism);
        let solver = Solver::assembled(Arc::clone(&mechanism), &path);
        let solver = solver.map_err(|error| offer_start(error, &mechanism))?;
        let file_pose = Arc::new(solver.pose().clone());
        let mut file_choices = SolverChoices::default();
        solver.copy_choices(&mut file_choices);
        let mut motion = Motion::new(solver);
        motion.solution.driver_rates.fill(Jet::constant(0.0));
        if mechanism.has_dynamics() {
            motion.seek_forces();
        }
        let prepared = motion.prepare_freedoms(Vec::new());
        debug_assert!(
            prepared.is_ok(),
            "the reader admits no tolerance that the integrator refuses"
        );
        let variables = variables_of(&mechanism, decisions);
        let free = motion.fresh().cloned();
        Ok(Self {
            guid: guid_decided(&mechanism, decisions),
            interface,
            reals: Reals::new(&mechanism, &variables),
            variables,
            course: Course::new(&mechanism, &file_pose, &file_choices, free),
            motion,
            has_local_states: decisions.has_local_states,
            file_choices,
            path,
            parts: None,
            dead_point: None,
            has_jumped: false,
            file_pose,
            overlaps,
            impacts,
            mechanism,
        })
    }

    /// Returns the mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// Returns the rule in force. In model exchange the host integrates, and gives every input at
    /// each time.
    fn rule(&self) -> Rule {
        match self.interface {
            Interface::CoSimulation => self.course.rule,
            Interface::ModelExchange => Rule {
                rates: RateSource::Inputs,
                extrapolation: Extrapolation::Hold,
            },
        }
    }

    #[inline]
    fn set_input(&mut self, driver: DriverId, order: Order, value: f64) {
        let index = driver.index();
        let input = &mut self.course.inputs[index];
        if order == Order::Position && self.mechanism.drivers[index].wrapped {
            let sources = self.course.monitors[index].sources;
            input.set_wrapped(value, self.course.committed.drivers[index], sources);
        } else {
            input.set(order, value);
        }
        self.set_freshness(Freshness::Stale);
    }

    /// Sets an input of the file or of a force, on which no pose depends.
    fn set_force_input(&mut self, place: usize, value: f64) {
        self.course.force_inputs[place].set(value);
        if self.has_followers() {
            self.set_freshness(Freshness::Stale);
        }
        if self.motion.free().is_some() {
            self.set_freshness(self.course.freshness.min(Freshness::Pose));
        }
        self.reals.invalidate();
    }

    /// Sets a parameter; those derived from it do not follow yet.
    fn set_parameter(&mut self, parameter: ParameterId, value: f64) {
        self.course.parameters[parameter.index()] = value;
        self.set_freshness(Freshness::Stale);
    }

    /// Records the validity of the solver's pose after a change, which makes all output values out
    /// of date.
    #[inline]
    fn set_freshness(&mut self, freshness: Freshness) {
        self.course.freshness = freshness;
        self.reals.invalidate();
    }
}

impl Model for MechanismModel {
    type Quantity = Quantity;
    type State = MechanismState;

    const CAPABILITIES: Capabilities = Capabilities {
        interpolates_inputs: true,
        output_derivatives: 2,
        directional_derivatives: true,
        intermediate_update: true,
    };

    fn load(resources: &FilePath, interface: Interface) -> Result<Self, Failure> {
        let (mechanism, decisions) = resource::read(resources)?;
        Self::decided(mechanism, interface, &decisions).map_err(failed)
    }

    fn guid(&self) -> &str {
        &self.guid
    }

    fn interface(&self) -> Interface {
        self.interface
    }

    fn variables(&self) -> &[Variable<Quantity>] {
        &self.variables
    }

    fn time(&self) -> f64 {
        self.course.time
    }

    fn set_time(&mut self, time: f64) {
        self.course.time = time;
        self.set_freshness(Freshness::Stale);
    }

    fn set_tolerance(&mut self, tolerance: f64, log: &Logger) {
        let (Some((free, ..)), Some(state)) = (self.motion.parts(), &mut self.course.free) else {
            return;
        };
        match free.set_tolerance(tolerance) {
            Ok(()) => state.tolerance = tolerance,
            Err(error) => log.warn(&format!(
                "{error}: the free motion is integrated with {}",
                state.tolerance
            )),
        }
    }

    fn reset(&mut self) {
        let (start, choices) = (&self.file_pose, &self.file_choices);
        let free = self.motion.fresh().cloned();
        self.course = Course::new(&self.mechanism, start, choices, free);
        self.motion.begin(start, choices);
        self.motion.solution.driver_rates.fill(Jet::constant(0.0));
        self.reals.invalidate();
        self.parts = None;
    }

    #[inline(always)]
    fn set_reals(&mut self, values: impl Iterator<Item = (Quantity, f64)>) {
        let mut parameters_changed = false;
        for (quantity, value) in values {
            match quantity {
                Quantity::Input(driver, order) => self.set_input(driver, order, value),
                Quantity::ForceInput(place) => self.set_force_input(place, value),
                Quantity::Parameter(parameter) => {
                    self.set_parameter(parameter, value);
                    parameters_changed = true;
                }
                Quantity::Budget => {
                    self.course.budget = value;
                    self.reals.invalidate();
                }
                Quantity::Output(OutputSource::Signal(Signal::Motion(freedom), order))
                | Quantity::State(freedom, order) => self.set_input(freedom, order, value),
                _ => unreachable!("only inputs, states and parameters are settable"),
            }
        }
        if parameters_changed {
            self.mechanism
                .derive_parameters(&mut self.course.parameters);
        }
    }

    fn set_integers(&mut self, values: impl Iterator<Item = (Quantity, i32)>) {
        for (quantity, value) in values {
            let item = value as usize - 1;
            match quantity {
                Quantity::RateSource => self.course.rule.rates = RateSource::ALL[item],
                Quantity::Extrapolation => {
                    self.course.rule.extrapolation = Extrapolation::ALL[item];
                }
                _ => unreachable!("only the two Enumerations are settable"),
            }
            self.set_freshness(Freshness::Stale);
        }
    }

    fn set_input_derivatives(&mut self, derivatives: impl Iterator<Item = (Quantity, usize, f64)>) {
        for (quantity, order, value) in derivatives {
            match quantity {
                Quantity::Input(driver, input) => {
                    self.course.inputs[driver.index()].set_derivative(input, order, value);
                }
                Quantity::ForceInput(place) => {
                    self.course.force_inputs[place].set_derivative(order, value);
                    continue;
                }
                _ => {}
            }
            self.set_freshness(Freshness::Stale);
        }
    }

    fn groups(&self, quantity: Quantity) -> Groups {
        outputs::group(&self.mechanism, quantity)
    }

    #[inline(always)]
    fn refresh(&mut self, groups: Groups, phase: Phase, log: &Logger) -> Result<(), Failure> {
        self.refresh_groups(groups, phase, log)
    }

    #[inline]
    fn reals(&self) -> &[f64] {
        self.reals.values()
    }

    fn integer(&self, quantity: Quantity) -> i32 {
        let count = match quantity {
            Quantity::RateSource => return self.course.rule.rates as i32,
            Quantity::Extrapolation => return self.course.rule.extrapolation as i32,
            Quantity::Iterations => self.course.progress.iterations,
            Quantity::Substeps => self.course.progress.substeps,
            Quantity::Proved => u32::from(self.course.progress.checked == 0),
            Quantity::Touching(stop) => self.motion.touching(stop),
            _ => unreachable!("all other variables are Reals"),
        };
        i32::try_from(count).unwrap_or(i32::MAX)
    }

    fn nominal(&self, quantity: Quantity) -> f64 {
        let mechanism = match quantity {
            Quantity::Output(_) => &self.mechanism,
            _ => self.motion.solver.mechanism(),
        };
        let (Quantity::Output(OutputSource::Signal(Signal::Motion(driver), _))
        | Quantity::State(driver, _)) = quantity
        else {
            unreachable!("states are freedoms")
        };
        if mechanism.drivers[driver.index()].coordinate.kind.is_angle() {
            1.0
        } else {
            rounded(self.motion.solver.size(), 1)
        }
    }

    fn directional_derivatives(
        &mut self,
        unknowns: &[Quantity],
        knowns: &[(Quantity, f64)],
        phase: Phase,
        log: &Logger,
    ) -> Result<Vec<f64>, Failure> {
        self.derivatives_along(unknowns, knowns, phase, log)
    }

    fn dependencies(&self, value_reference: u32, initializing: bool) -> Vec<(u32, DependencyKind)> {
        self.dependencies_of(value_reference, initializing)
    }

    fn commit(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        self.commit_values(phase, log)
    }

    fn update_discrete(&mut self) {
        self.course.progress = self.course.path_progress;
    }

    fn wants_event(&mut self) -> bool {
        self.wants_exchange() || self.wants_projection()
    }

    fn change_states(&mut self, log: &Logger) -> Result<StateChange, Failure> {
        let settled = self.settle_events(log)?;
        let exchanged = self.exchange_states()?;
        Ok(match (exchanged, settled) {
            (true, _) => StateChange::Exchange,
            (false, true) => StateChange::Values,
            (false, false) => StateChange::None,
        })
    }

    #[inline(always)]
    fn step(&mut self, size: f64, end: f64, stays: bool, log: &Logger) -> Result<(), Failure> {
        self.take_step(size, end, stays, log)
    }

    fn end_steps_at_events(&mut self, end: bool) {
        self.motion.ends_at_events = end;
    }

    fn begin_step(&mut self, size: f64, end: f64, log: &Logger) {
        self.begin_parts(size, end, log);
    }

    fn advance(&mut self, time: f64, log: &Logger) -> Result<(), Failure> {
        self.take_part(time, log)
    }

    fn split_step(&mut self, log: &Logger) {
        self.split_parts(log);
    }

    fn end_step(&mut self, log: &Logger) -> Result<(), Failure> {
        self.end_parts(log)
    }

    fn abandon_step(&mut self) {
        self.abandon_parts();
    }

    fn meet_dead_point(&mut self) {
        if let Some(time) = self.dead_point.take() {
            self.course.time = time;
        }
    }

    fn save(&mut self) -> MechanismState {
        self.save_state()
    }

    fn restore(&mut self, state: &MechanismState) {
        self.restore_state(state);
    }

    fn visit(state: &mut MechanismState, codec: &mut impl Codec) -> Result<(), Unreadable> {
        state.visit(codec)
    }

    fn check(&mut self, state: &mut MechanismState) -> Result<(), String> {
        self.check_state(state)
    }
}

/// Converts an error of the kinematics.
fn failed(error: impl ToString) -> Failure {
    Failure::Failed(error.to_string())
}

/// Converts an error of the kinematics about values that do not exist at the present pose.
fn without_value(error: impl ToString) -> Failure {
    Failure::Discarded(error.to_string())
}
