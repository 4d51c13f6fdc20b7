//! `biela tolerance`

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::check::scientific;
use crate::cli::given::conditions::Conditions;
use crate::cli::given::input::Input;
use crate::cli::given::times::Span;
use crate::cli::motion::SignalledMotion;
use crate::cli::results::column::{self, Output, Source};
use crate::cli::results::output::print;
use crate::cli::told::error::Error;
use biela::dynamics::Motion;
use biela::kinematics::Direction;
use biela::mechanism::{DisplayUnit, Mechanism, Order, ParameterId, Signal, Unit, UnitName};

/// Tell how tolerances of parameters change the motion.
///
/// The tolerances are those of the file, `tolerance = "0.05*mm"` on a parameter. biela moves the
/// mechanism as `run` does and differentiates each output exactly by each parameter. At each time
/// the worst case is the sum of |derivative| times tolerance over all parameters, and the
/// statistical deviation the root of the sum of squares: three standard deviations, if the
/// tolerances are three standard deviations. The table has the largest of each over the motion, its
/// time, and the parameter with the largest part in it.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: biela tolerance slider_crank.toml --drive 'crank_angle = 2*pi*t' --stop 1"
)]
pub(in crate::cli) struct Tolerance {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    #[command(flatten)]
    span: Span,
    /// Variables of the table, separated by commas: one such as crank.phi, or all variables of a
    /// body, marker, measure, driver or joint by its name [default: positions of points of interest and measures,
    /// or of bodies].
    #[arg(short, long, value_name = "NAMES", value_delimiter = ',')]
    variables: Vec<String>,
}

/// The largest deviations of one variable over a motion, from times at which it has a value \[SI\].
#[derive(Clone, Debug, Default)]
struct Deviation {
    worst: f64,
    /// Time of the worst case \[s\].
    time: f64,
    /// Part of each parameter in the worst case; none if the variable has no value at any time.
    parts: Vec<f64>,
    statistical: f64,
}

impl Tolerance {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let input = Input::read(&self.file)?;
        let times = self.span.times(&input.mechanism)?;
        let scenario = (self.conditions).scenario(&input.mechanism, times.start, None)?;
        let mechanism = scenario.mechanism.clone();
        let tolerances = tolerances(&mechanism)?;
        if let Some(freedom) = mechanism.drivers.iter().find(|driver| driver.is_free()) {
            return Err(Error::Usage(format!(
                "--drive has to say how `{}` moves: the tolerance of a free motion is not known",
                freedom.name
            )));
        }
        let columns = self.columns(&mechanism)?;
        let mut motion = SignalledMotion::start(input.assemble()?, scenario);
        if columns.iter().any(Output::uses_forces) {
            let reactions = columns.iter().any(Output::uses_reactions);
            motion = motion.and_then(|motion| motion.with_forces(reactions));
        }
        let mut motion = motion.map_err(|error| input.error_at(times.start, &error))?;
        let mut deviations = vec![Deviation::default(); columns.len()];
        for row in 0..=times.steps {
            let advanced = motion.advance(times.at(row));
            motion.notices.drain(..).for_each(|notice| notice.show());
            advanced.map_err(|why| Error::Stopped {
                file: input.source.name().to_owned(),
                why,
            })?;
            add(&mut deviations, &mut motion, &columns, &tolerances)
                .map_err(|error| input.error(error))?;
        }
        print(&table(&mechanism, &columns, &tolerances, &deviations))
    }

    /// Returns the columns of the table; drivers are given and do not deviate.
    fn columns(&self, mechanism: &Arc<Mechanism>) -> Result<Vec<Output>, Error> {
        let mut columns = Output::all(mechanism);
        columns.retain(|column| !matches!(column.source, Source::Signal(Signal::Motion(_), _)));
        if !self.variables.is_empty() {
            return column::named(&columns, &self.variables, mechanism);
        }
        let told = column::told(&columns);
        if told.is_empty() {
            columns.retain(|column| matches!(column.source, Source::Signal(_, Order::Position)));
            return Ok(columns);
        }
        Ok(told)
    }
}

/// Returns the parameters with tolerances \[SI\].
fn tolerances(mechanism: &Mechanism) -> Result<Vec<(ParameterId, f64)>, Error> {
    let parameters = (0..).map(ParameterId).zip(&mechanism.parameters);
    let tolerances: Vec<_> = parameters
        .filter_map(|(id, parameter)| Some((id, parameter.tolerance?)))
        .collect();
    if tolerances.is_empty() {
        return Err(Error::Usage(
            "no parameter has a tolerance; add for example `tolerance = \"0.05*mm\"` to one"
                .to_owned(),
        ));
    }
    Ok(tolerances)
}

/// Adds the deviations at the present time.
fn add(
    deviations: &mut [Deviation],
    motion: &mut SignalledMotion,
    columns: &[Output],
    tolerances: &[(ParameterId, f64)],
) -> Result<(), biela::kinematics::Error> {
    let Motion {
        solver, solution, ..
    } = &mut motion.motion;
    let time = solver.pose().time;
    let mut direction = Direction::zero(solver.mechanism());
    let mut parts = vec![Vec::with_capacity(tolerances.len()); columns.len()];
    for (parameter, tolerance) in tolerances {
        direction.parameters[parameter.index()] = *tolerance;
        let changes = solution.changes(solver, columns, &direction)?;
        for (parts, change) in parts.iter_mut().zip(changes) {
            parts.push(change.abs());
        }
        direction.parameters[parameter.index()] = 0.0;
    }
    for (deviation, parts) in deviations.iter_mut().zip(parts) {
        let squares: f64 = parts.iter().map(|part| part * part).sum();
        deviation.statistical = deviation.statistical.max(squares.sqrt());
        let worst: f64 = parts.iter().sum();
        if worst > deviation.worst || deviation.parts.is_empty() && worst.is_finite() {
            (deviation.worst, deviation.time, deviation.parts) = (worst, time, parts);
        }
    }
    Ok(())
}

fn table(
    mechanism: &Mechanism,
    columns: &[Output],
    tolerances: &[(ParameterId, f64)],
    deviations: &[Deviation],
) -> String {
    let names = columns.iter().map(|column| column.name.len());
    let width = names.chain(["variable".len()]).max().unwrap_or(0);
    let mut out = format!(
        "{:<width$}  {:>11}  {:>11}  {:<8}  {:>10}  largest part\n",
        "variable", "worst case", "statistical", "unit", "at t [s]"
    );
    for (column, deviation) in columns.iter().zip(deviations) {
        if deviation.parts.is_empty() {
            let _ = writeln!(out, "{:<width$}  no value at any time", column.name);
            continue;
        }
        let (factor, unit) = shown_in(column.unit);
        let [worst, statistical] =
            [deviation.worst, deviation.statistical].map(|value| scientific(value * factor, 3));
        let largest = deviation.parts.iter().enumerate();
        let largest = largest.max_by(|a, b| a.1.total_cmp(b.1));
        let largest = largest.filter(|(_, part)| **part > 0.0);
        let largest = largest.map_or_else(String::new, |(index, part)| {
            let name = &mechanism.parameters[tolerances[index].0.index()].name;
            format!("{name} {:.0} %", 100.0 * part / deviation.worst)
        });
        let time = format!("{:.6}", deviation.time);
        let time = time.trim_end_matches('0').trim_end_matches('.');
        let line = format!(
            "{:<width$}  {worst:>11}  {statistical:>11}  {unit:<8}  {time:>10}  {largest}",
            column.name
        );
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

/// Returns the factor and the name of the unit that deviations are shown in: millimetres for
/// lengths.
fn shown_in(unit: Unit) -> (f64, UnitName) {
    match unit.display {
        Some(display) => (display.factor, display.name),
        None if unit == Unit::METRE => (1e3, DisplayUnit::MILLIMETRE.name),
        None => (1.0, unit.name),
    }
}
