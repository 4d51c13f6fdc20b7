//! `biela range`

mod derived;
mod follower;
mod forces;
mod search;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use derived::{DerivedRange, uses_rates};
use follower::{at_speed, without_value};

pub(in crate::cli) use forces::LargestForces;

use super::check::scientific;

use crate::cli::given::bounds::{Bounds, driver_named, no_driver};
use crate::cli::given::conditions::Conditions;
use crate::cli::given::input::Input;
use crate::cli::given::input_files::InputFiles;
use crate::cli::results::output::{print, tell_written, write};
use crate::cli::results::picture::Format;
use crate::cli::results::plot::{MOST_BODIES, axis, panel, varies};
use crate::cli::results::stdout::is_stdout;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::drawing::{Axis, Line, LineChart, Panel, Sheet};
use biela::kinematics::{self, End, Extreme, RangeSettings, Reason, Sample, Solver};
use biela::mechanism::{CoordinateKind, Driver, DriverId, Mechanism, Unit, rounded, shown};

/// Find how far a driver can go.
///
/// biela follows the driver both ways from the start, and holds the others, until the mechanism
/// returns to its pose or meets a limit. A dead point is located to rounding, and named by
/// the links that line up there or the lines that meet. A driver's `min` and `max` are limits too,
/// unless --from and --to say otherwise. The least and the greatest value of each measure are told
/// with their places; one computed from velocities has those of a driver that moves at 1 m/s or
/// 1 rad/s, or at --speed. The transmission angle is that of the worst joint, from 0 deg at a dead
/// point to 90 deg at best; the reciprocal condition is that of `check`.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela range tlv.toml --driver side_length --plot range.svg")]
pub(in crate::cli) struct Range {
    /// The mechanism file.
    file: PathBuf,
    /// The driver to follow [default: each in turn].
    #[arg(long, value_name = "DRIVER")]
    driver: Option<String>,
    #[command(flatten)]
    bounds: Bounds,
    #[command(flatten)]
    conditions: Conditions,
    /// Speed of the driver in m/s or rad/s, for the largest effort and reaction of a mechanism with
    /// masses or forces [default: at rest], and for measures computed from velocities [default: 1].
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Write the poses of the motion: the driver's value, transmission angle, reciprocal condition,
    /// the measures, and the position of every body, in SI units; `-` for stdout.
    #[arg(long, value_name = "CSV")]
    csv: Option<PathBuf>,
    /// Plot the measures, or angles of bodies if there are none, and the transmission angle over
    /// the driver's value; the picture's extension, .svg or .png, decides, and `-` is SVG to
    /// stdout.
    #[arg(short, long, value_name = "PICTURE")]
    plot: Option<PathBuf>,
}

impl Range {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let format = self.plot.as_deref().map(Format::of).transpose()?;
        let input = Input::read(&self.file)?;
        InputFiles::new(&self.file, &input.mechanism)
            .refuse_as_outputs(&[self.csv.as_deref(), self.plot.as_deref()])?;
        let drivers = self.drivers(&input.mechanism)?;
        // --from and --to are given for a single driver only.
        let bounds = match drivers.first() {
            Some(driver) => self
                .bounds
                .of(&self.conditions, &input.mechanism, *driver)?,
            None => [None; 2],
        };
        check_speed(self.speed, &input.mechanism, "--speed")?;
        let mut solver = self.conditions.solver_at_start(&input)?;
        let driven = Arc::clone(solver.mechanism());
        let mut text = String::new();
        for &driver in &drivers {
            let start = solver.pose().drivers[driver.index()];
            let options = ["--from", "--to"];
            let found = FoundRange::new(&mut solver, driver, bounds, self.speed, options);
            let found = found.map_err(|why| {
                let file = input.source.name().to_owned();
                Error::Stopped { file, why }
            })?;
            found.describe(&mut text, &driven, driver, start);
            let FoundRange { range, derived, .. } = found;
            if let Some(path) = &self.csv {
                write(path, table(&driven, driver, &range, &derived).as_bytes())?;
                tell_written(path);
            }
            if let (Some(path), Some(format)) = (&self.plot, format) {
                let turning = turning(&driven, driver, &range).count();
                if !has_measures(&driven) && turning > MOST_BODIES {
                    let note = format!(
                        "the plot shows {MOST_BODIES} of {turning} bodies that turn; --csv has all"
                    );
                    Message::Note(note).show();
                }
                let sheet = Sheet::chart(&chart(&driven, driver, &range, &derived));
                format.write_chart(path, &sheet)?;
            }
        }
        // A table or a picture on stdout is not mixed with text.
        if ![self.csv, self.plot]
            .iter()
            .flatten()
            .any(|path| is_stdout(path))
        {
            print(&text)?;
        }
        Ok(())
    }

    fn drivers(&self, mechanism: &Mechanism) -> Result<Vec<DriverId>, Error> {
        if let Some(name) = &self.driver {
            return Ok(vec![driver_named(mechanism, name)?]);
        }
        let count = mechanism.drivers.len();
        if count == 0 {
            return Err(no_driver("range"));
        }
        if count > 1 && (self.csv.is_some() || self.plot.is_some()) {
            return Err(Error::Usage(
                "there are several drivers: --csv and --plot need one, named by --driver"
                    .to_owned(),
            ));
        }
        if count > 1 && (!self.bounds.is_empty()) {
            return Err(Error::Usage(
                "there are several drivers: --from and --to need one, named by --driver".to_owned(),
            ));
        }
        Ok((0..count).map(DriverId).collect())
    }
}

/// The range of a driver, with what is computed over it.
pub(in crate::cli) struct FoundRange {
    pub(in crate::cli) range: kinematics::Range,
    pub(in crate::cli) derived: Vec<DerivedRange>,
    /// `None` without masses and forces.
    pub(in crate::cli) forces: Option<LargestForces>,
}

impl FoundRange {
    /// Finds that of a driver from the solver's pose, with forces at a speed \[m/s or rad/s\], by default at
    /// rest. The pose is restored.
    ///
    /// # Errors
    ///
    /// The driver does not get to the bounds, which have these names: says why.
    pub(in crate::cli) fn new(
        solver: &mut Solver,
        driver: DriverId,
        bounds: [Option<f64>; 2],
        speed: Option<f64>,
        names: [&str; 2],
    ) -> Result<Self, String> {
        let mechanism = Arc::clone(solver.mechanism());
        let start = solver.pose().drivers[driver.index()];
        let settings = RangeSettings {
            bounds,
            ..RangeSettings::default()
        };
        let range = solver.range(driver, &settings);
        if let Some(why) = out_of_reach(&mechanism, driver, start, bounds, &range, names) {
            return Err(why);
        }
        let derived = DerivedRange::all(solver, driver, &range, speed);
        let speed = speed.unwrap_or(0.0);
        let has_forces = mechanism.has_dynamics();
        let forces = has_forces.then(|| LargestForces::new(solver, driver, &range, speed));
        Ok(Self {
            range,
            derived,
            forces,
        })
    }

    fn describe(&self, text: &mut String, mechanism: &Mechanism, driver: DriverId, start: f64) {
        describe(text, mechanism, driver, start, &self.range, &self.derived);
        if let Some(forces) = &self.forces {
            forces.describe(text, mechanism, driver);
        }
    }
}

/// Refuses a speed, an argument of this name, that is not finite or has no effect.
pub(in crate::cli) fn check_speed(
    speed: Option<f64>,
    mechanism: &Mechanism,
    name: &str,
) -> Result<(), Error> {
    match speed {
        Some(speed) if !speed.is_finite() => Err(Error::Usage(format!(
            "{name} is {speed}; expected a finite number"
        ))),
        Some(_) if !mechanism.has_dynamics() && !mechanism.derived.iter().any(uses_rates) => {
            Err(Error::Usage(format!(
                "{name} is of forces and of measures computed from velocities, but the mechanism has \
                 neither `mass` nor `[forces]` nor such a measure"
            )))
        }
        _ => Ok(()),
    }
}

/// Returns the lines that tell the range of a driver from the solver's pose, and its chart.
pub(in crate::cli) fn told(solver: &mut Solver, driver: DriverId) -> (String, LineChart) {
    let mechanism = Arc::clone(solver.mechanism());
    let start = solver.pose().drivers[driver.index()];
    let found = FoundRange::new(solver, driver, [None; 2], None, [""; 2]);
    let found = found.expect("there are no bounds to get to");
    let mut text = String::new();
    found.describe(&mut text, &mechanism, driver, start);
    let chart = chart(&mechanism, driver, &found.range, &found.derived);
    (text, chart)
}

/// Returns the reason why a range has no poses: from its start the driver does not get to the
/// bounds, which have these names.
fn out_of_reach(
    mechanism: &Mechanism,
    driver: DriverId,
    start: f64,
    bounds: [Option<f64>; 2],
    range: &kinematics::Range,
    [first, second]: [&str; 2],
) -> Option<String> {
    if !range.samples.is_empty() {
        return None;
    }
    let (option, value, end) = match bounds {
        [Some(from), _] if start < from => (first, from, &range.upper),
        [_, to] => (second, to?, &range.lower),
    };
    let of_driver = &mechanism.drivers[driver.index()];
    let value = with_unit(of_driver.coordinate.kind, value);
    let end = end_text(end, of_driver, driver);
    let name = &of_driver.name;
    Some(format!(
        "{name} does not get to {option}, {value}: it ends at {end}"
    ))
}

fn describe(
    text: &mut String,
    mechanism: &Mechanism,
    driver: DriverId,
    start: f64,
    range: &kinematics::Range,
    derived: &[DerivedRange],
) {
    let of_driver = &mechanism.drivers[driver.index()];
    let kind = of_driver.coordinate.kind;
    let value = |value: f64| with_unit(kind, value);
    let name = &of_driver.name;
    let gap = if text.is_empty() { "" } else { "\n" };
    let _ = writeln!(text, "{gap}{name}, from {}", value(start));
    if let [End::Turns(turns), End::Turns(_)] = [&range.upper, &range.lower] {
        let turns = match turns {
            1 => "a turn".to_owned(),
            turns => format!("{turns} turns"),
        };
        let _ = writeln!(
            text,
            "  turns fully: after {turns} the mechanism is where it was"
        );
    } else {
        for (way, end) in [("down to", &range.lower), ("up to", &range.upper)] {
            let _ = writeln!(text, "  {way:<8}{}", end_text(end, of_driver, driver));
        }
    }
    for point in &range.crossings {
        let _ = writeln!(
            text,
            "  passes a change point at {} where {}",
            value(point.value),
            point.geometry
        );
    }
    let mut tell_extremes = |name: &str, [low, high]: [String; 2], places: [f64; 2]| {
        let [at, high_at] = places.map(|at| about(kind, at));
        let _ = if low == high {
            writeln!(text, "  {name} {low} everywhere")
        } else {
            writeln!(
                text,
                "  {name} from {low}, at {at}, to {high}, at {high_at}"
            )
        };
    };
    for (measure, extremes) in mechanism.measures.iter().zip(&range.measures) {
        let value = |extreme: &Extreme| about(measure.coordinate.kind, extreme.value);
        let places = extremes.each_ref().map(|extreme| extreme.driver);
        tell_extremes(&measure.name, extremes.each_ref().map(value), places);
    }
    let mut missing = String::new();
    for (measure, found) in mechanism.derived.iter().zip(derived) {
        let moving = found.speed.map_or_else(String::new, |speed| {
            at_speed(mechanism, driver, speed) + ", "
        });
        let name = format!("{moving}{}", measure.name);
        if let (Some(shown), Some(extremes)) = (found.shown(measure), found.extremes) {
            tell_extremes(&name, shown, extremes.map(|extreme| extreme.driver));
        }
        let samples = range.samples.iter().zip(&found.values);
        let without = samples.filter(|(_, value)| value.is_nan());
        let without: Vec<f64> = without.map(|(sample, _)| sample.driver).collect();
        if !without.is_empty() {
            let place = without_value(&without, range.samples.len(), |at| about(kind, at));
            let _ = writeln!(missing, "  {name} has no value {place}");
        }
    }
    let extreme = |of: fn(&Sample) -> Option<f64>| {
        let known = range
            .samples
            .iter()
            .filter_map(|s| Some((of(s)?, s.driver)));
        let worst = known.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        worst.zip(known.max_by(|a, b| a.0.total_cmp(&b.0)))
    };
    if let Some(((worst, at), (best, best_at))) = extreme(|sample| sample.transmission) {
        let angles = [worst, best].map(|angle| format!("{:.2} deg", angle.to_degrees()));
        tell_extremes("transmission angle", angles, [at, best_at]);
    }
    if let Some(((worst, at), (best, _))) = extreme(|sample| Some(sample.rcond)) {
        // Less is the rounding of a singular pose.
        let [worst, best] = [worst, best].map(|rcond| {
            let rcond = if rcond < f64::EPSILON { 0.0 } else { rcond };
            scientific(rcond, 2)
        });
        let _ = if worst == best {
            writeln!(text, "  reciprocal condition {worst} everywhere")
        } else {
            let at = about(kind, at);
            writeln!(text, "  reciprocal condition {worst} at worst, at {at}")
        };
    }
    text.push_str(&missing);
}

pub(in crate::cli) fn end_text(end: &End, driver: &Driver, id: DriverId) -> String {
    let kind = driver.coordinate.kind;
    let value = |value: f64| with_unit(kind, value);
    match end {
        End::Turns(_) => "no limit".to_owned(),
        End::Singular(point) => format!("{}: {point}", value(point.drivers[id.index()])),
        End::Stop { value: at, limit } => format!("{}: {limit}", value(*at)),
        End::Blocked { value: at, reason } => {
            let reason = match reason {
                Reason::Value(error) => error.to_string(),
                Reason::Contradiction(open) => format!("beyond, {open}, redundant up to here"),
                Reason::TooLong => "it takes too many sub-steps".to_owned(),
                Reason::NearSingular => {
                    "it takes too many sub-steps next to a singular position".to_owned()
                }
                _ => "no continuous motion leads on".to_owned(),
            };
            format!("{}: {reason}", value(*at))
        }
        End::Bound { value: at } => {
            let bound = match Some(*at) {
                own if own == driver.min => "its `min`",
                own if own == driver.max => "its `max`",
                _ => "as far as asked",
            };
            format!("{}: {bound}", value(*at))
        }
        // The end of the search is no property of the mechanism: four digits are enough.
        End::NotFound { value: at } => {
            let (value, unit) = in_unit(kind, *at);
            let value = shown(rounded(value, 4));
            format!("{value} {unit} and farther: no limit was found")
        }
    }
}

/// Formats a value in deg or m with ten decimals: limits are located to rounding.
pub(in crate::cli) fn with_unit(kind: CoordinateKind, value: f64) -> String {
    let (value, unit) = in_unit(kind, value);
    let text = format!("{value:.10}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    // A smaller value is rounding.
    let text = if text == "-0" { "0" } else { text };
    format!("{text} {unit}")
}

/// Formats a value in deg or m with six digits.
fn about(kind: CoordinateKind, value: f64) -> String {
    let (value, unit) = in_unit(kind, value);
    // Smaller values are rounding beside those of any mechanism.
    let value = if value.abs() < 1e-12 { 0.0 } else { value };
    format!("{} {unit}", shown(value))
}

fn in_unit(kind: CoordinateKind, value: f64) -> (f64, &'static str) {
    if kind.is_angle() {
        (value.to_degrees(), "deg")
    } else {
        (value, "m")
    }
}

fn table(
    mechanism: &Mechanism,
    driver: DriverId,
    range: &kinematics::Range,
    derived: &[DerivedRange],
) -> String {
    let has_transmission = range.samples.iter().all(|s| s.transmission.is_some());
    let mut text = format!("{}.position", mechanism.drivers[driver.index()].name);
    if has_transmission {
        text.push_str(",transmission_angle");
    }
    text.push_str(",rcond");
    for measure in &mechanism.measures {
        let _ = write!(text, ",{}.position", measure.name);
    }
    for measure in &mechanism.derived {
        let _ = write!(text, ",{}", measure.name);
    }
    for body in &mechanism.bodies {
        let name = &body.name;
        let _ = write!(text, ",{name}.x,{name}.y,{name}.phi");
    }
    for (index, sample) in range.samples.iter().enumerate() {
        let _ = write!(text, "\n{:?}", sample.driver);
        if let Some(transmission) = sample.transmission.filter(|_| has_transmission) {
            let _ = write!(text, ",{transmission:?}");
        }
        let _ = write!(text, ",{:?}", sample.rcond);
        let derived = derived.iter().map(|measure| &measure.values[index]);
        for value in sample.measures.iter().chain(derived) {
            let _ = write!(text, ",{value:?}");
        }
        for value in &sample.pose.q[..3 * mechanism.bodies.len()] {
            let _ = write!(text, ",{value:?}");
        }
    }
    text.push('\n');
    text
}

/// Returns whether there are measures to plot.
fn has_measures(mechanism: &Mechanism) -> bool {
    !(mechanism.measures.is_empty() && mechanism.derived.is_empty())
}

/// Returns the bodies whose angles change, other than as the driver does.
fn turning(
    mechanism: &Mechanism,
    driver: DriverId,
    range: &kinematics::Range,
) -> impl Iterator<Item = usize> {
    let is_angle = mechanism.drivers[driver.index()].coordinate.kind.is_angle();
    (0..mechanism.bodies.len()).filter(move |body| {
        let angle = |s: &Sample| s.pose.q[3 * body + 2];
        let changes = |of: &dyn Fn(&Sample) -> f64| {
            let values: Vec<f64> = range.samples.iter().map(of).collect();
            varies(&values)
        };
        changes(&angle)
            && !(is_angle
                && (!changes(&|s| angle(s) - s.driver) || !changes(&|s| angle(s) + s.driver)))
    })
}

/// Returns the chart: the measures by unit or, without any, angles of bodies; and the transmission
/// angle.
fn chart(
    mechanism: &Mechanism,
    driver: DriverId,
    range: &kinematics::Range,
    derived: &[DerivedRange],
) -> LineChart {
    let of_driver = &mechanism.drivers[driver.index()];
    let [x_unit, angle] = [of_driver.coordinate.kind.unit(), Unit::RADIAN];
    let line = |name: &str, look: usize, unit: Unit, of: &dyn Fn(&Sample) -> f64| Line {
        name: name.to_owned(),
        look,
        values: (range.samples.iter())
            .map(|s| unit.display_factor() * of(s))
            .collect(),
        marks: Vec::new(),
    };
    let mark = |line: &mut Line, unit: Unit, extremes: &[Extreme; 2]| {
        if varies(&line.values) {
            let finite = extremes.iter().filter(|extreme| extreme.value.is_finite());
            line.marks.extend(finite.map(|extreme| {
                let at = x_unit.display_factor() * extreme.driver;
                let value = unit.display_factor() * extreme.value;
                (at, value, shown(value))
            }));
        }
    };
    let mut panels: Vec<(Unit, Panel)> = Vec::new();
    let mut add = |unit: Unit, line: Line| panel(&mut panels, unit, unit).lines.push(line);
    for (index, (measure, extremes)) in mechanism.measures.iter().zip(&range.measures).enumerate() {
        let kind = measure.coordinate.kind;
        let unit = kind.unit();
        let mut line = line(&measure.name, index, unit, &|s| s.measures[index]);
        mark(&mut line, unit, extremes);
        add(unit, line);
    }
    for (index, (measure, found)) in mechanism.derived.iter().zip(derived).enumerate() {
        let unit = measure.unit.unwrap_or(Unit::ONE);
        let factor = unit.display_factor();
        let mut line = Line {
            name: measure.name.clone(),
            look: mechanism.measures.len() + index,
            values: found.values.iter().map(|value| factor * value).collect(),
            marks: Vec::new(),
        };
        if let Some(extremes) = &found.extremes {
            mark(&mut line, unit, extremes);
        }
        add(unit, line);
    }
    if !has_measures(mechanism) {
        for body in turning(mechanism, driver, range).take(MOST_BODIES) {
            let name = format!("{}.phi", mechanism.bodies[body].name);
            add(angle, line(&name, body, angle, &|s| s.pose.q[3 * body + 2]));
        }
    }
    let mut panels: Vec<Panel> = panels.into_iter().map(|(_, panel)| panel).collect();
    if range.samples.iter().any(|s| s.transmission.is_some()) {
        panels.push(Panel {
            y: Axis {
                label: "transmission angle".to_owned(),
                unit: "deg".to_owned(),
            },
            lines: vec![line("worst joint", 0, angle, &|s| {
                s.transmission.unwrap_or(f64::NAN)
            })],
        });
    }
    LineChart {
        title: format!("{}: range of {}", mechanism.name, of_driver.name),
        description: mechanism.description.clone(),
        x: Axis {
            label: of_driver.name.clone(),
            unit: axis(x_unit).unit,
        },
        at: (range.samples.iter())
            .map(|sample| sample.driver * x_unit.display_factor())
            .collect(),
        instants: Vec::new(),
        panels,
    }
}
