//! `biela run`

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::conditions::{self, Conditions};
use super::error::Error;
use super::input::Input;
use crate::fmi::{Causality, Order, Quantity, variables};
use crate::kinematics::{Curve, Path, Rates, Reason, Solver};
use crate::mechanism::{DriverId, Jet, Mechanism};

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
    #[command(flatten)]
    conditions: Conditions,
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
        let parameters = self.conditions.parameters(&input.mechanism)?;
        let driven = self.conditions.driven(&input.mechanism)?;
        let home_solver = input.assemble()?;
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

/// A mechanism on its way along the motions of its drivers.
struct Motion {
    solver: Solver,
    path: Path,
    rates: Rates,
    driver_rates: Vec<Jet>,
    /// Whether it was warned of the singular position that is near.
    near_singular: bool,
}

impl Motion {
    /// Moves from the file's pose to the values at the start, in the file's assembly mode.
    fn start(
        home_solver: Solver,
        driven: Arc<Mechanism>,
        parameters: Vec<f64>,
        time: f64,
    ) -> Result<Self, crate::kinematics::Error> {
        let solver = conditions::start(home_solver, &driven, &parameters, time)?;
        let start = solver.pose();
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
            near_singular: false,
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
                Reason::Contradiction(open) => format!("beyond, {open}, redundant up to here"),
                Reason::TooLong => "the motion is too fast for the steps".to_owned(),
                Reason::Singular(point) => point.to_string(),
                _ => "no continuous motion".to_owned(),
            };
            let pose = self.solver.pose();
            let limits = match &blocked.reason {
                Reason::Singular(point) => &point.drivers,
                _ => &pose.drivers,
            };
            let mechanism = self.solver.mechanism();
            let drivers: Vec<_> = mechanism
                .drivers
                .iter()
                .zip(limits)
                .filter(|(driver, _)| driver.motion().is_some())
                .map(|(driver, value)| format!("`{}` at {value:.9}", driver.name))
                .collect();
            return Err(Error::DeadPoint(format!(
                "{why} at t = {:.9} s: the mechanism cannot go on, with {}",
                pose.time,
                drivers.join(", ")
            )));
        }
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            anstream::eprintln!("warning: t = {time} s: {approach}");
        }
        for crossing in self.solver.crossed() {
            let passed = self.solver.describe_crossing(crossing);
            anstream::eprintln!("note: t = {time} s: {passed}");
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
        let variables = variables(mechanism);
        let outputs = variables
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
