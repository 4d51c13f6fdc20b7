//! A motion of a case, from row to row.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

use biela::dynamics::{Error, FreeMotion, FreeState, Given};
use biela::kinematics::{Output, Path, Pose, Solution, Solver, SolverChoices};
use biela::mechanism::{DriverId, Jet, Mechanism, Source};

use super::align::Happening;
use super::case::{Case, Check};

/// Evaluations of a motion beyond which it counts as hanging: some hundred times those of most.
pub const MOST_EVALUATIONS: u32 = 1_000_000;
/// Largest distance beyond a stop or into a contact \[m or rad\]: far more than rounding, far less
/// than a motion goes in a step.
const BEYOND: f64 = 1e-9;
/// Largest residual of the joints, in the mechanism's size.
const OPEN: f64 = 1e-10;
/// Speed up to which friction may stick \[m/s or rad/s\].
pub const AT_REST: f64 = 1e-7;
/// Largest error of the force of friction, as part of its size and more.
const FORCE: f64 = 1e-6;

/// Manner in which a motion is followed.
#[derive(Clone, Copy, Debug)]
pub struct Manner {
    /// Relative tolerance of the integration.
    pub tolerance: f64,
    /// Number of communication steps.
    pub steps: u32,
}

/// The motion at a time.
#[derive(Clone, Debug)]
pub struct Row {
    pub time: f64,
    /// x, y and phi of all bodies, and their rates.
    pub places: Vec<f64>,
    pub rates: Vec<f64>,
    /// The variables of the case's truth.
    pub variables: Vec<f64>,
}

/// The reason for which a motion ends before its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Variant of the error.
    pub variant: String,
    /// Its message, with `#` in place of numbers.
    pub name: String,
    /// Time of the last pose \[s\].
    pub time: f64,
}

/// A motion as it was followed.
#[derive(Clone, Debug, Default)]
pub struct Record {
    pub rows: Vec<Row>,
    pub events: Vec<Happening>,
    /// Why it ends early.
    pub refusal: Option<Refusal>,
    /// Violated invariant, in words.
    pub violation: Option<String>,
    pub evaluations: u64,
}

impl Record {
    /// Tells the events and the end.
    pub fn told(&self) -> String {
        let mut lines: Vec<String> = self.events.iter().map(Happening::told).collect();
        lines.extend(self.violation.clone());
        lines.push(match &self.refusal {
            Some(refusal) => format!("{refusal:?}"),
            None => format!("{} evaluations", self.evaluations),
        });
        lines.join("\n")
    }
}

/// Panic of an evaluation that is one too many.
struct Exhausted;

/// Inputs that stay, and the number of evaluations that are left.
struct Held<'a> {
    start: &'a [f64],
    left: Cell<u32>,
    /// Time of the last evaluation \[s\].
    time: Cell<f64>,
}

impl Given for Held<'_> {
    fn driver(&self, driver: DriverId, _: f64) -> Jet {
        Jet::constant(self.start[driver.index()])
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        self.time.set(time);
        let left = self.left.get().checked_sub(1);
        self.left
            .set(left.unwrap_or_else(|| resume_unwind(Box::new(Exhausted))));
        for (index, load) in loads.iter_mut().enumerate() {
            *load = 1.0 + index as f64;
        }
    }
}

/// A mechanism that moves freely.
struct Motion<'a> {
    solver: Solver,
    solution: Solution,
    free: FreeMotion,
    held: &'a Held<'a>,
}

/// Snapshot from which a fresh motion goes on.
struct Saved {
    state: FreeState,
    pose: Pose,
    choices: SolverChoices,
}

impl<'a> Motion<'a> {
    fn new(solver: Solver, tolerance: f64, held: &'a Held<'a>) -> Result<Self, Error> {
        let free = FreeMotion::new(&solver, tolerance)?;
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        solution.leave_out_reactions();
        Ok(Self {
            solution,
            free: free.expect("the kinds have freedoms"),
            solver,
            held,
        })
    }

    fn begin(&mut self) -> Result<(), Error> {
        self.free.start(&mut self.solver, self.held)
    }

    fn advance(&mut self, time: f64) -> Result<(), Error> {
        let Self {
            solver,
            solution,
            free,
            held,
        } = self;
        let parameters = solver.pose().parameters.clone();
        free.jump(solver, *held, &parameters)?;
        free.advance(solver, solution, *held, time)
    }

    fn save(&self) -> Saved {
        let mut choices = SolverChoices::default();
        self.solver.copy_choices(&mut choices);
        Saved {
            state: self.free.state(),
            pose: self.solver.pose().clone(),
            choices,
        }
    }

    /// Goes on from what another motion has saved.
    fn resume(&mut self, saved: &Saved) -> Result<(), Error> {
        let Self {
            solver,
            solution,
            free,
            ..
        } = self;
        free.select(solver, solution, &saved.state)?;
        let resumed = solver.resume(&saved.pose, &saved.choices);
        assert!(resumed, "the choices are those of the same mechanism");
        free.resume(solver, &saved.state)
    }

    /// Solves rates and forces.
    fn solve(&mut self) -> Result<(), Error> {
        self.held.loads(0.0, &mut self.solution.loads);
        self.free.tell(&mut self.solution);
        Ok(self.solution.solve(&mut self.solver)?)
    }
}

/// A case that is read and assembled.
pub struct Ready {
    mechanism: Arc<Mechanism>,
    solver_path: Path,
    start: Vec<f64>,
    outputs: Vec<Output>,
}

impl Ready {
    /// Reads and assembles a case. `None` if it does not close.
    ///
    /// # Panics
    ///
    /// The file has errors.
    pub fn new(text: &str) -> Option<Self> {
        let source = Source::new("attack.toml", text);
        let mechanism = match Mechanism::parse(&source) {
            Ok((mechanism, _)) => Arc::new(mechanism),
            Err(problems) => panic!("{problems:#?}\n{text}"),
        };
        let solver_path = Path::new(&mechanism);
        let solver = Solver::assembled(Arc::clone(&mechanism), &solver_path).ok()?;
        Some(Self {
            start: solver.pose().drivers.clone(),
            outputs: Output::all(&mechanism),
            solver_path,
            mechanism,
        })
    }

    fn solver(&self) -> Solver {
        let solver = Solver::assembled(Arc::clone(&self.mechanism), &self.solver_path);
        solver.expect("it was assembled before")
    }

    /// Follows the motion of a case.
    ///
    /// # Errors
    ///
    /// The motion hangs, or panics, in words.
    pub fn follow(&self, case: &Case, manner: Manner) -> Result<Record, String> {
        let mut record = Record::default();
        self.guarded(|held| self.follow_on(case, manner, held, &mut record))?;
        Ok(record)
    }

    /// Calls what evaluates a motion.
    fn guarded(&self, call: impl FnOnce(&Held<'_>)) -> Result<(), String> {
        let held = Held {
            start: &self.start,
            left: Cell::new(MOST_EVALUATIONS),
            time: Cell::new(0.0),
        };
        catch_unwind(AssertUnwindSafe(|| call(&held))).map_err(|panic| {
            if panic.is::<Exhausted>() {
                let time = held.time.get();
                return format!("hangs at {time} s: more than {MOST_EVALUATIONS} evaluations");
            }
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
            format!("panics: {}", words.unwrap_or("without words"))
        })
    }

    fn follow_on(&self, case: &Case, manner: Manner, held: &Held<'_>, record: &mut Record) {
        let started = Motion::new(self.solver(), manner.tolerance, held);
        let started = started.and_then(|mut motion| {
            motion.begin()?;
            motion.solve()?;
            Ok(motion)
        });
        let mut motion = match started {
            Ok(motion) => motion,
            Err(error) => {
                record.refusal = Some(refusal(&error, 0.0));
                return;
            }
        };
        let checks = Checks::new(&self.outputs, case);
        let mut energy = f64::INFINITY;
        for row in 0..=manner.steps {
            let time = case.duration * f64::from(row) / f64::from(manner.steps);
            let moved = match row {
                0 => Ok(()),
                _ => motion.advance(time).and_then(|()| motion.solve()),
            };
            let mechanism = &self.mechanism;
            let events = motion.free.events();
            record.events.extend(events.map(|event| Happening {
                time: event.time,
                name: mechanism.forces[event.force].name.clone(),
                kind: event.kind,
            }));
            record.evaluations = motion.free.statistics().evaluations;
            if let Err(error) = moved {
                record.refusal = Some(refusal(&error, motion.solver.pose().time));
                return;
            }
            let violation = checks.violation(&motion, &mut energy);
            if record.violation.is_none() {
                record.violation = violation.map(|words| format!("at {time} s: {words}"));
            }
            record
                .rows
                .push(checks.row(&motion, 3 * mechanism.bodies.len()));
        }
    }

    /// Follows a motion, and goes on with a fresh one from what is saved half-way.
    ///
    /// # Errors
    ///
    /// The two end at different numbers, in words.
    pub fn try_restored(&self, case: &Case, manner: Manner) -> Result<(), String> {
        let mut found = Ok(());
        self.guarded(|held| {
            found = self.compare_restored(case, manner, held);
        })?;
        found
    }

    fn compare_restored(&self, case: &Case, manner: Manner, held: &Held<'_>) -> Result<(), String> {
        let started = Motion::new(self.solver(), manner.tolerance, held);
        let started = started.and_then(|mut motion| motion.begin().map(|()| motion));
        let Ok(mut motion) = started else {
            return Ok(());
        };
        let time = |row: u32| case.duration * f64::from(row) / f64::from(manner.steps);
        let half = manner.steps / 2;
        for row in 1..=half {
            if motion.advance(time(row)).is_err() {
                return Ok(());
            }
        }
        motion.free.events().for_each(drop);
        let saved = motion.save();
        let fresh = Motion::new(self.solver(), manner.tolerance, held);
        let resumed = fresh.and_then(|mut fresh| fresh.resume(&saved).map(|()| fresh));
        let mut fresh = resumed.map_err(|error| format!("restored: {error}"))?;
        for row in half + 1..=manner.steps {
            let moved = [&mut motion, &mut fresh].map(|motion| motion.advance(time(row)));
            let events =
                [&mut motion, &mut fresh].map(|motion| motion.free.events().collect::<Vec<_>>());
            if moved[0] != moved[1] {
                return Err(format!("restored: at {} s {moved:?}", time(row)));
            }
            if events[0] != events[1] {
                return Err(format!(
                    "restored: other events before {} s: {events:?}",
                    time(row)
                ));
            }
            if motion.free.state() != fresh.free.state() {
                return Err(format!("restored: another state at {} s", time(row)));
            }
            if motion.solver.pose() != fresh.solver.pose() {
                return Err(format!("restored: another pose at {} s", time(row)));
            }
            if moved[0].is_err() {
                break;
            }
        }
        Ok(())
    }
}

/// Returns the refusal of an error.
fn refusal(error: &Error, time: f64) -> Refusal {
    let debug = format!("{error:?}");
    let variant = debug.split(|c: char| !c.is_alphanumeric()).next();
    let mut name = String::new();
    let mut in_number = false;
    for letter in error.to_string().chars() {
        let is_number = letter.is_ascii_digit()
            || in_number && matches!(letter, '.' | 'e' | '-' | '+')
            || matches!(letter, '-' | '−');
        if is_number && !in_number {
            name.push('#');
        } else if !is_number {
            name.push(letter);
        }
        in_number = is_number;
    }
    Refusal {
        variant: variant.unwrap_or_default().to_owned(),
        name,
        time,
    }
}

/// The checks of a case, with their variables found.
struct Checks<'a> {
    case: &'a Case,
    outputs: &'a [Output],
    truth: Vec<&'a Output>,
}

impl<'a> Checks<'a> {
    fn new(outputs: &'a [Output], case: &'a Case) -> Self {
        let mut checks = Self {
            case,
            outputs,
            truth: Vec::new(),
        };
        if let Some(truth) = &case.truth {
            let variables = truth.variables.iter();
            checks.truth = variables.map(|name| checks.output(name)).collect();
        }
        checks
    }

    fn output(&self, name: &str) -> &'a Output {
        let mut outputs = self.outputs.iter();
        let output = outputs.find(|output| output.name == name);
        output.unwrap_or_else(|| panic!("`{name}` is no variable of\n{}", self.case.text))
    }

    fn row(&self, motion: &Motion<'_>, bodies: usize) -> Row {
        let Motion {
            solver, solution, ..
        } = motion;
        let truth = self.truth.iter();
        Row {
            time: solver.pose().time,
            places: solver.pose().q[..bodies].to_vec(),
            rates: solution.rates.velocity()[..bodies].to_vec(),
            variables: truth.map(|output| solution.value(solver, output)).collect(),
        }
    }

    /// Returns what does not hold, in words.
    fn violation(&self, motion: &Motion<'_>, least_energy: &mut f64) -> Option<String> {
        let Motion {
            solver, solution, ..
        } = motion;
        let value = |name: &str| solution.value(solver, self.output(name));
        let residual = solver.residual();
        if residual.is_nan() || residual > OPEN {
            return Some(format!("joints are open by {residual:.1e}"));
        }
        for check in &self.case.checks {
            let violation = match check {
                Check::Within { variable, limits } => {
                    let here = value(variable);
                    let [least, most] = *limits;
                    let holds = (least - BEYOND..=most + BEYOND).contains(&here);
                    (!holds).then(|| format!("{variable} = {here} is not in {least} to {most}"))
                }
                Check::Friction { name, rate, law } => {
                    let force = value(&format!("{name}.effort"));
                    let speed = value(rate);
                    friction(force, speed, *law).map(|words| format!("friction {name}, {words}"))
                }
                Check::Gap { name, gap } => {
                    let gap = gap(&solver.pose().q);
                    let holds = gap >= -BEYOND;
                    (!holds).then(|| format!("the gap of {name} is {gap:.1e}"))
                }
                Check::Energy => {
                    let energy = value("energy.kinetic") + value("energy.potential");
                    let slack = 1e-6 * (1.0 + energy.abs());
                    let grows = energy - *least_energy;
                    *least_energy = least_energy.min(energy);
                    (grows > slack).then(|| format!("energy grows by {grows:.1e} J"))
                }
            };
            if violation.is_some() {
                return violation;
            }
        }
        None
    }
}

/// Returns what is wrong with a force of friction at a speed, in words.
fn friction(force: f64, speed: f64, [sliding, sticking, viscous]: [f64; 3]) -> Option<String> {
    let slack = FORCE * (1.0 + sticking);
    if speed.abs() <= AT_REST {
        let most = sticking + slack;
        return (force.is_nan() || force.abs() > most)
            .then(|| format!("at rest: {force} N is more than {sticking}"));
    }
    let expected = -speed.signum() * (sliding + viscous * speed.abs());
    let off = (force - expected).abs();
    (off.is_nan() || off > slack).then(|| format!("at {speed} m/s: {force} N, not {expected}"))
}
