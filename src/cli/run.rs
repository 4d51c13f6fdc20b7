//! `biela run`

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::error::Error;
use super::input::Input;
use crate::fmi::{Causality, Order, Quantity, Variables};
use crate::kinematics::{Curve, Path, Pose, Rates, Reason, Solver, Start};
use crate::mechanism::{
    DriverId, DriverSource, ExpressionError, Jet, Mechanism, Motion as Prescribed, ParameterId,
    Variable,
};

/// Run a mechanism and print its motion as CSV.
///
/// Each row has the time, then value, velocity and acceleration of every driver, then all
/// outputs of the FMU under their names there, in SI units. Drivers that are FMI inputs stay at
/// their start values unless --drive says how they move; velocities and accelerations are exact
/// derivatives of these motions.
///
/// The mechanism starts in the assembly mode of its file. At a dead point the run ends with an
/// error; the rows up to there are written.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: biela run four_bar.toml --drive 'crank_angle = 60*deg + 2*pi*t' --stop 1"
)]
pub(super) struct Run {
    /// The mechanism file.
    file: PathBuf,
    /// Move a driver by an expression in t and the parameters, such as
    /// 'crank_angle=60*deg + 10*t'; may be given for several drivers.
    #[arg(short, long, value_name = "DRIVER=MOTION")]
    drive: Vec<String>,
    /// Change a parameter for this run, such as 'crank_length=120*mm'; may be given for several.
    #[arg(short, long, value_name = "PARAMETER=VALUE")]
    set: Vec<String>,
    /// Start time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Time between rows in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS")]
    step: Option<f64>,
    /// The CSV file to write [default: stdout].
    #[arg(short, long, value_name = "CSV")]
    output: Option<PathBuf>,
}

/// More rows than this are a slip in --step.
const MOST_ROWS: f64 = 1e9;

impl Run {
    pub(super) fn run(self) -> Result<(), Error> {
        let input = Input::read(&self.file)?;
        let times = self.times(&input.mechanism)?;
        let parameters = self.parameters(&input.mechanism)?;
        let driven = self.driven(&input.mechanism)?;
        let (home_solver, _) = input.assemble()?;
        let mut table = Table::new(&driven, self.writer()?, self.output.clone());
        let mut motion = Motion::start(home_solver, driven, parameters, times.start)
            .map_err(|error| input.error(error))?;
        table.write_header()?;
        table.write_row(&mut motion)?;
        for row in 1..=times.steps {
            motion.advance(times.at(row))?;
            table.write_row(&mut motion)?;
        }
        table.finish()
    }

    fn times(&self, mechanism: &Mechanism) -> Result<Times, Error> {
        let simulation = &mechanism.simulation;
        let start = self.start.unwrap_or(simulation.start);
        let stop = self.stop.unwrap_or(simulation.stop);
        let step = self.step.unwrap_or(simulation.step);
        let refuse = |message: String| Err(Error::Usage(message));
        if !(start.is_finite() && stop.is_finite() && stop >= start) {
            return refuse(format!(
                "cannot run from {start} s to {stop} s: the stop time must not be before the start"
            ));
        }
        if !(step.is_finite() && step > 0.0) {
            return refuse(format!("--step is {step}; expected a positive time"));
        }
        // A last step shorter than this part of the others is rounding.
        let steps = ((stop - start) / step - 1e-9).ceil().max(0.0);
        if steps > MOST_ROWS {
            return refuse(format!(
                "a step of {step} s from {start} s to {stop} s makes {steps:.1e} rows"
            ));
        }
        Ok(Times {
            start,
            stop,
            step,
            steps: steps as u64,
        })
    }

    /// The parameters in force.
    fn parameters(&self, mechanism: &Mechanism) -> Result<Vec<f64>, Error> {
        let mut values = mechanism.default_parameters();
        for assignment in &self.set {
            let (name, text) = split(assignment, "--set", "crank_length=120*mm")?;
            let id = mechanism.parameter_id(name).ok_or_else(|| {
                let names = mechanism.parameters.iter().map(|p| p.name.as_str());
                unknown("parameter", name, names)
            })?;
            let parameter = &mechanism.parameters[id.index()];
            if parameter.derived {
                return Err(Error::Usage(format!(
                    "--set: `{name}` is derived from other parameters; set those"
                )));
            }
            let value = mechanism
                .parse_expression(text, None)
                .map_err(|error| in_argument("--set", text, &error))?
                .evaluate(&|p| mechanism.parameters[p.index()].default, 0.0);
            let too_low = parameter.min.is_some_and(|min| value < min);
            let too_high = parameter.max.is_some_and(|max| value > max);
            if !value.is_finite() || too_low || too_high {
                return Err(Error::Usage(format!(
                    "--set: {value} is not a permitted value of `{name}`"
                )));
            }
            values[id.index()] = value;
        }
        mechanism.derive_parameters(&mut values);
        Ok(values)
    }

    /// The mechanism with the motions of --drive prescribed.
    fn driven(&self, mechanism: &Mechanism) -> Result<Arc<Mechanism>, Error> {
        let mut driven = mechanism.clone();
        for assignment in &self.drive {
            let (name, text) = split(assignment, "--drive", "crank_angle=60*deg + 10*t")?;
            let id = mechanism.driver_id(name).ok_or_else(|| {
                let names = mechanism.drivers.iter().map(|d| d.name.as_str());
                unknown("driver", name, names)
            })?;
            let motion = mechanism
                .parse_expression(text, Some(Variable::Time))
                .map_err(|error| in_argument("--drive", text, &error))?;
            driven.drivers[id.index()].source =
                DriverSource::Motion(Prescribed::Expression(motion));
        }
        Ok(Arc::new(driven))
    }

    fn writer(&self) -> Result<Box<dyn Write>, Error> {
        let file = self.output.as_ref().filter(|path| path.as_os_str() != "-");
        Ok(match file {
            None => Box::new(std::io::stdout().lock()),
            Some(path) => {
                let file = std::fs::File::create(path).map_err(|source| Error::Write {
                    path: path.clone(),
                    source,
                })?;
                Box::new(file)
            }
        })
    }
}

/// When rows are written.
struct Times {
    start: f64,
    stop: f64,
    step: f64,
    steps: u64,
}

impl Times {
    fn at(&self, row: u64) -> f64 {
        if row == self.steps {
            self.stop
        } else {
            self.start + row as f64 * self.step
        }
    }
}

fn split<'a>(
    assignment: &'a str,
    option: &str,
    example: &str,
) -> Result<(&'a str, &'a str), Error> {
    assignment
        .split_once('=')
        .map(|(name, text)| (name.trim(), text.trim()))
        .ok_or_else(|| {
            Error::Usage(format!(
                "{option}: `{assignment}` has no `=`; expected for example '{example}'"
            ))
        })
}

fn unknown<'a>(what: &str, name: &str, names: impl Iterator<Item = &'a str>) -> Error {
    let names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    let help = match names[..] {
        [] => "the mechanism has none".to_owned(),
        _ => format!("expected {}", names.join(", ")),
    };
    Error::Usage(format!("no {what} `{name}`; {help}"))
}

fn in_argument(option: &str, text: &str, error: &ExpressionError) -> Error {
    let column = text[..error.span.start].chars().count();
    let help = error
        .help
        .as_ref()
        .map_or_else(String::new, |help| format!("; {help}"));
    Error::Usage(format!(
        "{option}: {}{help}\n  {text}\n  {:column$}^",
        error.message, ""
    ))
}

/// A mechanism on its way along the motions of its drivers.
struct Motion {
    solver: Solver,
    path: Path,
    rates: Rates,
    driver_rates: Vec<Jet>,
}

impl Motion {
    /// Moves from the file's pose to the values at the start, in the file's assembly mode.
    fn start(
        mut home_solver: Solver,
        driven: Arc<Mechanism>,
        parameters: Vec<f64>,
        time: f64,
    ) -> Result<Self, crate::kinematics::Error> {
        let home = home_solver.pose().clone();
        let mut path = Path::new(home_solver.mechanism());
        path.duration = time - home.time;
        path.to.clone_from(&parameters);
        for (index, (curve, driver)) in path.curves.iter_mut().zip(&driven.drivers).enumerate() {
            // What is an input in the file has got an expression.
            if let (Curve::Input { position, jump, .. }, Some(Prescribed::Expression(expression))) =
                (curve, driver.motion())
            {
                *position = expression.evaluate(&|p: ParameterId| parameters[p.index()], time);
                *jump = home.drivers[index] - *position;
            }
        }
        if let Start::Reassembled(_) = home_solver.start(&home, &path)? {
            eprintln!(
                "warning: no continuous motion leads from the file's own pose to the start of \
                 this run: assembled there from the estimates, possibly in another assembly mode"
            );
        }
        let start: Pose = home_solver.pose().clone();
        let mut solver = Solver::new(Arc::clone(&driven))?;
        solver.restore(&start);
        let mut path = Path::new(&driven);
        path.start = time;
        path.from.clone_from(&parameters);
        path.to = parameters;
        for (curve, value) in path.curves.iter_mut().zip(&start.drivers) {
            if let Curve::Input { position, .. } = curve {
                *position = *value;
            }
        }
        let mut motion = Self {
            rates: Rates::new(start.q.len()),
            driver_rates: vec![Jet::constant(0.0); driven.drivers.len()],
            solver,
            path,
        };
        motion.solve_rates()?;
        Ok(motion)
    }

    /// Goes on to `time`.
    fn advance(&mut self, time: f64) -> Result<(), Error> {
        self.path.start = self.solver.pose().time;
        self.path.duration = time - self.path.start;
        if let Err(blocked) = self.solver.follow(&self.path) {
            let why = match &blocked.reason {
                Reason::Value(error) => error.to_string(),
                Reason::TooLong => "the motion is too fast for the steps".to_owned(),
                _ => "dead point".to_owned(),
            };
            let pose = self.solver.pose();
            let mechanism = self.solver.mechanism();
            let drivers: Vec<_> = mechanism
                .drivers
                .iter()
                .zip(&pose.drivers)
                .filter(|(driver, _)| driver.motion().is_some())
                .map(|(driver, value)| format!("`{}` at {value:.9}", driver.name))
                .collect();
            return Err(Error::DeadPoint(format!(
                "{why} at t = {:.9} s: the mechanism cannot go on, with {}",
                pose.time,
                drivers.join(", ")
            )));
        }
        self.solve_rates()
            .map_err(|error| Error::DeadPoint(format!("at t = {time} s: {error}")))
    }

    fn solve_rates(&mut self) -> Result<(), crate::kinematics::Error> {
        let time = self.solver.pose().time;
        let drivers = self.solver.mechanism().drivers.iter().enumerate();
        for (rates, (index, driver)) in self.driver_rates.iter_mut().zip(drivers) {
            if driver.motion().is_some() {
                *rates = self.solver.motion(DriverId(index), time);
            }
        }
        let driver_rates = &self.driver_rates;
        self.solver
            .solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)
    }
}

/// The CSV: one column a quantity.
struct Table {
    out: BufWriter<Box<dyn Write>>,
    path: PathBuf,
    columns: Vec<(String, Quantity)>,
}

impl Table {
    fn new(mechanism: &Mechanism, out: Box<dyn Write>, path: Option<PathBuf>) -> Self {
        let drivers = mechanism
            .drivers
            .iter()
            .enumerate()
            .flat_map(|(index, driver)| {
                ["position", "velocity", "acceleration"]
                    .into_iter()
                    .zip(Order::ALL)
                    .map(move |(suffix, order)| {
                        let name = format!("{}.{suffix}", driver.name);
                        (name, Quantity::Motion(DriverId(index), order))
                    })
            });
        let variables = Variables::new(mechanism);
        let outputs = variables
            .list()
            .iter()
            .filter(|variable| {
                variable.causality == Causality::Output
                    && !matches!(variable.quantity, Quantity::Motion(..))
            })
            .map(|variable| (variable.name.clone(), variable.quantity));
        Self {
            out: BufWriter::new(out),
            path: path.unwrap_or_else(|| PathBuf::from("stdout")),
            columns: drivers.chain(outputs).collect(),
        }
    }

    fn write_header(&mut self) -> Result<(), Error> {
        let names = self.columns.iter().map(|(name, _)| name.as_str());
        let line: Vec<_> = std::iter::once("time").chain(names).collect();
        writeln!(self.out, "{}", line.join(",")).map_err(|source| self.error(source))
    }

    fn write_row(&mut self, motion: &mut Motion) -> Result<(), Error> {
        self.try_write_row(motion)
            .map_err(|source| self.error(source))
    }

    /// Numbers are written so that reading them gives the same bits.
    fn try_write_row(&mut self, motion: &Motion) -> std::io::Result<()> {
        write!(self.out, "{:?}", motion.solver.pose().time)?;
        for (_, quantity) in &self.columns {
            let value = quantity.read(&motion.solver, &motion.rates, &motion.driver_rates);
            write!(self.out, ",{value:?}")?;
        }
        writeln!(self.out)
    }

    fn finish(mut self) -> Result<(), Error> {
        self.out.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: std::io::Error) -> Error {
        Error::Write {
            path: self.path.clone(),
            source,
        }
    }
}

/// Prints to stdout, where the reader may have gone.
pub(super) fn print(text: &str) -> Result<(), Error> {
    std::io::stdout()
        .write_all(text.as_bytes())
        .map_err(|source| Error::Write {
            path: PathBuf::from("stdout"),
            source,
        })
}
