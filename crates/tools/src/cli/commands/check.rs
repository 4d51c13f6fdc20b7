//! `biela check`

pub(in crate::cli) mod forces;
pub(in crate::cli) mod json;
mod shapes;

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use forces::Forces;

use crate::cli::at_rest::AtRest;
use crate::cli::given::input::warn_of_misfits;
use crate::cli::given::settings::Settings;
use crate::cli::given::signals::Signals;
use crate::cli::given::times::Times;
use crate::cli::results::output::print;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::cli::told::suggested_estimates::as_estimates;
use biela::kinematics::{
    self, AssemblyMode, Modes, NeededPlay, Origin, Path, Rates, Solver, System, offer_start,
};
use biela::mechanism::{
    CoordinateKind, DerivedMeasure, DriverId, DriverSource, Jet, Mechanism, Order, Unit, fixed,
    rounded, shown,
};

/// Check a mechanism file: read it, count its constraints, assemble it.
///
/// Prints the bodies, joints and drivers with their equations, the degrees of freedom, the
/// assembled pose at the drivers' start values, how far each body is from its estimate, and the
/// reciprocal condition of the pose (1 is best, 0 a singular position). If it can close in other
/// ways too, and has at most 40 bodies, a line says so. It tells the areas of
/// bodies with shapes, the masses that follow, and the clearances of contacts. With masses or forces it prints masses, efforts and reactions of the mechanism at rest there, all inputs of forces zero. It
/// warns of prescribed motions that leave the limits of their drivers, and of joints whose markers
/// were drawn apart in a mechanism that is drawn in one pose. If the mechanism does not
/// close, it says whether that is proved, which joints stay open and by how much, and prints the
/// nearest pose; if joints contradict each other, it prints the play that the last of them needs
/// over the motion of the first driver.
#[derive(Args, Debug)]
pub(in crate::cli) struct Check {
    /// The mechanism file.
    file: PathBuf,
    /// Print the pose, or the nearest one, as estimates to paste into the file.
    #[arg(long)]
    estimates: bool,
    /// Look for the other ways in which the mechanism closes at the start values, and print each
    /// as estimates to paste.
    #[arg(long)]
    modes: bool,
    /// Print the least clearance of each pair of shapes on different bodies over the range of each
    /// driver, whether they have a contact or not.
    #[arg(long)]
    clearances: bool,
    /// The format of the report: text, or JSON in SI units with all errors of the file.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    Text,
    Json,
}

/// Reciprocal condition below which a pose is called nearly singular.
const NEARLY_SINGULAR: f64 = 1e-6;

/// Most bodies of a mechanism whose other ways to close are looked for unasked: that takes a tenth
/// of a second.
const MOST_BODIES_SEARCHED: usize = 40;
/// Most steps of a run whose rows are compared with limits: more would take longer than assembly.
const MOST_STEPS_WATCHED: u64 = 100_000;
/// Least angle by which another way to close brings a body nearer to its estimate, for a note that
/// this one may be meant \[rad\].
const FAR: f64 = FRAC_PI_2;

impl Check {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        match self.format {
            Format::Text => self.tell(),
            Format::Json => self.report(),
        }
    }

    fn report(self) -> Result<(), Error> {
        if self.estimates {
            return Err(Error::Usage(
                "--estimates is of --format text: the pose is in the JSON".to_owned(),
            ));
        }
        if self.clearances {
            return Err(Error::Usage("--clearances is of --format text".to_owned()));
        }
        let (report, outcome) = json::report(&self.file, &self.settings, self.modes);
        print(&format!("{report:#}\n"))?;
        outcome
    }

    fn tell(self) -> Result<(), Error> {
        let input = self.settings.read(&self.file)?;
        let mechanism = &input.mechanism;
        print(&describe_equations(mechanism))?;
        let refuse = |error: kinematics::Error| {
            print(&describe_play(mechanism, &error))?;
            Err(input.error(offer_start(error, mechanism)))
        };
        let mut solver = match Solver::new(Arc::clone(mechanism)) {
            Ok(solver) => solver,
            Err(error) => return refuse(error),
        };
        let assembled = solver.assemble(&Path::new(mechanism));
        if let Err(error) = assembled {
            if let kinematics::Error::NotAssembled { .. } = &error {
                print("\nnot assembled; the nearest pose\n")?;
                print(&describe_bodies(&solver))?;
                if self.estimates {
                    print(&estimates(solver.mechanism(), &solver.pose().q))?;
                }
            }
            return refuse(error);
        }
        warn_of_misfits(&solver);
        for joint in solver.drawn_apart() {
            Message::Warning(joint.to_string()).show();
        }
        for excursion in excursions(&solver) {
            Message::Warning(excursion).show();
        }
        for overlap in shapes::overlapping_contacts(mechanism, &mechanism.default_parameters()) {
            Message::Warning(overlap).show();
        }
        let free = mechanism
            .has_freedoms()
            .then(|| AtRest::start(input.source.name(), input.assemble()?, Signals::default()));
        if let Some(Ok(at)) = &free {
            // Parts that overlapped have been moved apart.
            solver.restore(at.motion.pose());
        }
        print(&describe_pose(&mut solver))?;
        let parameters = &solver.pose().parameters;
        print(&shapes::describe_areas(mechanism, parameters))?;
        print(&shapes::describe_contacts(&solver))?;
        input.check_rest(&mut solver)?;
        if let Some(at) = free {
            print(&describe_free_motion(&mut at?)?)?;
        }
        if mechanism.has_dynamics() {
            let forces = Forces::at_rest(&mut solver).map_err(|error| input.error(error))?;
            print(&forces.describe(mechanism))?;
        }
        if !self.modes && mechanism.bodies.len() <= MOST_BODIES_SEARCHED {
            let modes = solver.modes().map_err(|error| input.error(error))?;
            print(&mention_modes(&solver, &modes))?;
        }
        if self.clearances {
            print(&shapes::describe_clearances(&input)?)?;
        }
        if self.estimates {
            print(&estimates(solver.mechanism(), &solver.pose().q))?;
        }
        if self.modes {
            let modes = solver.modes().map_err(|error| input.error(error))?;
            print(&describe_modes(mechanism, &modes))?;
        }
        Ok(())
    }
}

fn describe_equations(mechanism: &Arc<Mechanism>) -> String {
    let mut title = mechanism.name.clone();
    if !mechanism.description.is_empty() {
        let _ = write!(title, ": {}", mechanism.description);
    }
    let mut out = format!("{title}\n\n");
    for (label, count, names) in equations(mechanism) {
        let _ = writeln!(out, "  {label:<20}{count:>4}    {names}");
    }
    out
}

/// Returns the numbers of bodies, unknowns, constraints, drivers and freedoms, each with its label and
/// its names.
pub(in crate::cli) fn equations(mechanism: &Arc<Mechanism>) -> Vec<(&'static str, usize, String)> {
    let system = System::new(Arc::clone(mechanism));
    let joints = equations_of_joints(&system);
    let mut rows = Vec::new();
    let mut row = |label: &'static str, count: usize, names: Vec<String>| {
        rows.push((label, count, names.join(", ")));
    };
    let bodies = mechanism.bodies.iter().map(|body| body.name.clone());
    row("bodies", bodies.len(), bodies.collect());
    let unknowns = format!("x, y, phi of each body{}", contacts_text(&system));
    row("unknowns", system.unknowns(), vec![unknowns]);
    let count = joints.iter().sum::<usize>() + mechanism.constraints.len();
    let joints = mechanism.joints.iter().zip(&joints);
    let joints = joints.map(|(joint, rows)| format!("{} ({rows})", joint.name));
    let constraints = mechanism.constraints.iter();
    let constraints = constraints.map(|constraint| format!("{} (1)", constraint.name));
    row("constraints", count, joints.chain(constraints).collect());
    let drivers = mechanism.drivers.iter().map(|driver| {
        let source = match driver.source {
            DriverSource::Input { .. } => "input",
            DriverSource::Motion(_) => "prescribed motion",
            DriverSource::Free { .. } => "free",
        };
        format!("{} ({source})", driver.name)
    });
    let drivers: Vec<_> = drivers.collect();
    let (free, driven): (Vec<_>, Vec<_>) = mechanism
        .drivers
        .iter()
        .zip(drivers)
        .partition(|(driver, _)| driver.is_free());
    let names = |list: Vec<(_, String)>| list.into_iter().map(|(_, text)| text).collect();
    row("drivers", driven.len(), names(driven));
    if !free.is_empty() {
        row("freedoms", free.len(), names(free));
    }
    rows
}

/// Tells inertia and acceleration of each freedom at the start, and how they swing if they are at rest
/// there.
fn describe_free_motion(at: &mut AtRest) -> Result<String, Error> {
    let mut out = "\nfree motion at the start\n".to_owned();
    for (name, kind, inertia, acceleration) in at.freedoms() {
        let [of_inertia, of_acceleration] = [kind.inertia_unit(), kind.units()[2]];
        let _ = writeln!(
            out,
            "  {name}: inertia {}{}, acceleration {}{}",
            shown(inertia),
            of_inertia.suffix(),
            shown(acceleration),
            of_acceleration.suffix()
        );
    }
    let states = if at.keeps_coordinates() {
        "the freedoms"
    } else {
        "coordinates that are exchanged near dead points"
    };
    let _ = writeln!(out, "  states in model exchange: {states}");
    if at.is_balanced() {
        out += &oscillations(at)?;
    }
    Ok(out)
}

/// Tells how the freedoms move near the equilibrium at which they are, a line for each root.
pub(super) fn oscillations(at: &mut AtRest) -> Result<String, Error> {
    let mut out = String::new();
    for root in at.linearize(&[])?.a.complex_eigenvalues().iter() {
        let size = root.re.hypot(root.im);
        if root.im > 0.0 {
            let (frequency, damping) = (size / TAU, -root.re / size);
            let (frequency, damping) = (shown(rounded(frequency, 6)), fixed(damping, 4));
            let _ = writeln!(out, "  swings at {frequency} Hz, damping ratio {damping}");
        } else if root.im == 0.0 && root.re > 0.0 {
            let _ = writeln!(
                out,
                "  falls away, e-fold in {} s",
                shown(rounded(1.0 / root.re, 6))
            );
        } else if root.im == 0.0 && root.re < 0.0 {
            let _ = writeln!(
                out,
                "  comes to rest, e-fold in {} s",
                shown(rounded(-1.0 / root.re, 6))
            );
        }
    }
    Ok(out)
}

/// Returns the number of equations of each joint.
fn equations_of_joints(system: &System) -> Vec<usize> {
    let mut joints = vec![0; system.mechanism().joints.len()];
    for equation in system.equations() {
        if let Origin::Joint(joint) = equation.origin {
            joints[joint] += 1;
        }
    }
    joints
}

/// Lists the unknowns that joints bring with them.
fn contacts_text(system: &System) -> String {
    let first = 3 * system.mechanism().bodies.len();
    let joints: Vec<_> = (first..system.unknowns())
        .map(|column| system.describe_unknown(column))
        .collect();
    match joints[..] {
        [] => String::new(),
        _ => format!(", the contact's place of {}", joints.join(", ")),
    }
}

fn describe_pose(solver: &mut Solver) -> String {
    let mechanism = Arc::clone(solver.mechanism());
    let rcond = solver.rcond();
    let mut out = String::new();
    let redundancies = solver.redundancies();
    if !redundancies.is_empty() {
        let count: usize = redundancies.iter().map(|r| r.redundant).sum();
        let names: Vec<_> = redundancies
            .iter()
            .map(|r| match r.equations {
                1 => r.origin.clone(),
                _ => format!("{} of the {} of {}", r.redundant, r.equations, r.origin),
            })
            .collect();
        let names = names.join(", ");
        let _ = writeln!(out, "  {:<20}{count:>4}    {names}", "redundant");
    }
    // The Jacobian with all drivers is regular: one driver per degree of freedom.
    let count = mechanism.drivers.len();
    let free = mechanism
        .drivers
        .iter()
        .filter(|driver| driver.is_free())
        .count();
    let how = match free {
        0 => "all driven".to_owned(),
        _ if free == count => "all free".to_owned(),
        _ => format!("{} driven, {free} free", count - free),
    };
    let _ = writeln!(out, "  {:<20}{count:>4}    {how}", "degrees of freedom");
    let _ = writeln!(out, "\nassembled at");
    for (driver, value) in mechanism.drivers.iter().zip(&solver.pose().drivers) {
        let value = with_unit(driver.coordinate.kind, *value);
        let _ = writeln!(out, "  {} = {value}", driver.name);
    }
    out += &describe_bodies(solver);
    let still = Rates::new(solver.pose().q.len());
    let at_rest = derived_at_rest(solver);
    if !mechanism.measures.is_empty() || !at_rest.is_empty() {
        out.push('\n');
    }
    for (index, measure) in mechanism.measures.iter().enumerate() {
        let value = solver.measure(index, &still).value;
        let value = with_unit(measure.coordinate.kind, value);
        let _ = writeln!(out, "  {} = {value}", measure.name);
    }
    for (measure, value) in at_rest {
        let unit = measure.unit.map_or_else(String::new, Unit::suffix);
        let _ = writeln!(out, "  {} = {}{unit}", measure.name, shown(value));
    }
    let _ = writeln!(
        out,
        "\n  residual {}, reciprocal condition {}",
        scientific(solver.residual(), 1),
        scientific(rcond, 2)
    );
    if rcond < NEARLY_SINGULAR {
        let _ = writeln!(
            out,
            "  this is nearly a singular position: small changes of a driver have large effects"
        );
    }
    out
}

/// Returns the measures that are computed from positions, with their values at the solver's pose.
fn derived_at_rest(solver: &Solver) -> Vec<(&DerivedMeasure, f64)> {
    let still = Rates::new(solver.pose().q.len());
    let drivers = vec![Jet::constant(0.0); solver.pose().drivers.len()];
    let derived = solver.mechanism().derived.iter().enumerate();
    let positions = derived.filter(|(_, measure)| measure.order() == Order::Position);
    positions
        .map(|(index, measure)| (measure, solver.derived(index, &still, &drivers, None)))
        .collect()
}

/// Tells where prescribed motions leave the limits of their drivers in a run of the file.
fn excursions(solver: &Solver) -> Vec<String> {
    let mechanism = solver.mechanism();
    let drivers = mechanism.drivers.iter().enumerate();
    let mut limited: Vec<_> = drivers
        .filter(|(_, driver)| driver.motion().is_some() && driver.min.or(driver.max).is_some())
        .map(|(index, driver)| (DriverId(index), driver, false))
        .collect();
    let mut told = Vec::new();
    if limited.is_empty() {
        return told;
    }
    let times = Times::of_file(mechanism, MOST_STEPS_WATCHED);
    for time in (0..=times.steps).map(|row| times.at(row)) {
        for (id, driver, beyond) in &mut limited {
            let value = solver.motion(*id, time).value;
            let excursion = driver.excursion(value, time, beyond);
            told.extend(excursion.map(|excursion| excursion.to_string()));
        }
    }
    told
}

/// Returns a table of the bodies in the solver's pose, with their distance from the estimates.
fn describe_bodies(solver: &Solver) -> String {
    let (mechanism, q) = (solver.mechanism(), &solver.pose().q);
    let names = mechanism.bodies.iter().map(|body| body.name.len());
    let width = names.chain(["body".len()]).max().unwrap_or(0);
    let mut out = format!(
        "\n  {:<width$}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}\n",
        "body", "x [m]", "y [m]", "phi [deg]", "moved [m]", "turned [deg]"
    );
    // An estimate without a value was refused before.
    let moves = solver.moves().unwrap_or_default();
    let bodies = mechanism.bodies.iter().zip(q.chunks_exact(3));
    for ((body, q), moved) in bodies.zip(moves) {
        let _ = writeln!(
            out,
            "  {:<width$}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}",
            body.name,
            fixed(q[0], 6),
            fixed(q[1], 6),
            fixed(q[2].to_degrees(), 6),
            fixed(moved.length, 6),
            fixed(moved.angle.to_degrees(), 6)
        );
    }
    out
}

/// Returns the play that a joint needs over a motion, if constraints contradict each other.
fn describe_play(mechanism: &Arc<Mechanism>, error: &kinematics::Error) -> String {
    let Some(play) = NeededPlay::find(mechanism, error) else {
        return String::new();
    };
    let driver = &mechanism.drivers[play.driver.index()];
    let [from, to] = play
        .range
        .map(|value| with_unit(driver.coordinate.kind, value));
    let NeededPlay { open, .. } = play;
    let (joint, play) = (&open.origin, open.measured());
    let name = &driver.name;
    format!(
        "\nnot assembled; with a play of about {play} in {joint}, and all others exact, {name} moves \
         from {from} to {to}\n"
    )
}

/// Returns the pose as estimates, with a heading.
pub(super) fn estimates(mechanism: &Mechanism, q: &[f64]) -> String {
    let lines = as_estimates(mechanism, q);
    format!("\nestimates of this pose, to paste into the tables of the bodies\n\n{lines}")
}

/// Says that there are other ways to close, and which bodies have turned far from their estimates.
fn mention_modes(solver: &Solver, modes: &Modes) -> String {
    if modes.others.is_empty() {
        return String::new();
    }
    let least = if modes.complete { "" } else { "at least " };
    let ways = other_ways(modes);
    let mut out = format!("\n{least}{ways} to close at these values: `--modes`\n");
    let parameters = &solver.pose().parameters;
    let bodies = solver.mechanism().bodies.iter();
    // An estimate without a value was refused before.
    for (index, (body, moved)) in bodies.zip(solver.moves().unwrap_or_default()).enumerate() {
        let part = |k: usize| body.estimate[k].value(parameters);
        let phi = part(2);
        // Zeros are what a body without an estimate has.
        let is_estimated = (0..3).any(|k| part(k) != 0.0);
        let is_nearer =
            |mode: &AssemblyMode| (mode.q[3 * index + 2] - phi).abs() + FAR < moved.angle;
        if is_estimated && modes.others.iter().any(is_nearer) {
            let angle = shown(moved.angle.to_degrees());
            let _ = writeln!(
                out,
                "`{}` has turned {angle} deg from its estimate: is this the way that is meant?",
                body.name
            );
        }
    }
    out
}

fn other_ways(modes: &Modes) -> String {
    match modes.others.len() {
        0 => "no other way".to_owned(),
        1 => "1 other way".to_owned(),
        count => format!("{count} other ways"),
    }
}

fn describe_modes(mechanism: &Mechanism, modes: &Modes) -> String {
    let count = other_ways(modes);
    let certainty = match (modes.complete, modes.starts) {
        (true, _) => "these are all".to_owned(),
        (false, 0) => "there are more".to_owned(),
        (false, starts) => format!("found from {starts} starts; there may be more"),
    };
    let mut out = format!("\n{count} to close at these values ({certainty})\n");
    for (index, mode) in modes.others.iter().enumerate() {
        let nearly = if mode.rcond < NEARLY_SINGULAR {
            ", nearly a singular position"
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "\n# {}: reciprocal condition {}{nearly}, largest move from the estimates {:.2}\n\n{}",
            index + 1,
            scientific(mode.rcond, 2),
            mode.distance,
            as_estimates(mechanism, &mode.q).trim_end()
        );
    }
    out
}

pub(super) fn with_unit(kind: CoordinateKind, value: f64) -> String {
    if kind.is_angle() {
        format!("{} deg", fixed(value.to_degrees(), 6))
    } else {
        format!("{} m", fixed(value, 6))
    }
}

/// Formats a number with a power of ten, which is left out if it is zero.
pub(in crate::cli) fn scientific(value: f64, decimals: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let text = format!("{value:.decimals$e}");
    text.strip_suffix("e0").map_or(text.clone(), str::to_owned)
}
