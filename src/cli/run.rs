//! `biela run`

use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::columns::{Column, Record, Table};
use super::conditions::Conditions;
use super::error::Error;
use super::input::Input;
use super::message::Message;
use super::motion::Motion;
use super::originals::Originals;
use super::output::{STDOUT, is_stdout, write};
use super::picture::{Format, PLOT_WIDTH, extension};
use super::progress::Progress;
use super::recording::Recording;
use super::signals::Signals;
use crate::drawing::{Sheet, animation};
use crate::mechanism::{
    CoordinateKind, Driver, DriverSource, Mechanism, Motion as Prescribed, shown,
};

/// Run a mechanism: write its motion as CSV, plot it, animate it.
///
/// Each row has the time, then value, velocity and acceleration of every driver, then all
/// outputs of the FMU under their names there, in SI units. Drivers that are FMI inputs stay at
/// their start values unless --drive or --input says how they move; velocities and accelerations
/// are exact derivatives of these motions.
///
/// The mechanism starts in the assembly mode of its file. At a dead point the run ends with an
/// error; what there is up to there is written.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: biela run four_bar.toml --drive 'crank_angle = 60*deg + 2*pi*t' --stop 1"
)]
pub(super) struct Run {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    /// Move drivers by a CSV file: its first column is time, the others drivers' variables such
    /// as crank_angle.position.
    ///
    /// Between two rows values go straight, before the first and after the last they hold, and
    /// at a time that stands twice they jump: as FMPy does it. Velocities are those of the
    /// columns .velocity, or else the slopes; accelerations those of .acceleration, or else zero.
    /// Columns are separated by commas, semicolons, tabs or blanks.
    #[arg(short, long, value_name = "CSV")]
    input: Option<PathBuf>,
    /// Start time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Time between rows in seconds [default: the file's].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    step: Option<f64>,
    /// What to write and plot, separated by commas: variables such as crank.phi, or all of a
    /// body, marker, driver or measure by its name [default: in the CSV all; plotted drivers and
    /// measures, or points of interest, or bodies].
    #[arg(short, long, value_name = "NAMES", value_delimiter = ',')]
    variables: Vec<String>,
    /// The CSV file to write, `-` for stdout [default: stdout, if there is neither --plot nor
    /// --animate].
    #[arg(short, long, value_name = "CSV")]
    output: Option<PathBuf>,
    /// Plot positions, velocities and accelerations over time; the picture's extension, .svg or
    /// .png, decides, and `-` is SVG to stdout.
    #[arg(short, long, value_name = "PICTURE")]
    plot: Option<PathBuf>,
    /// Write a page, .html or .htm or `-` for stdout, on which the mechanism moves; it needs
    /// nothing from elsewhere. Of more than 10,000 rows it shows every second, third and so on.
    #[arg(short, long, value_name = "PAGE")]
    animate: Option<PathBuf>,
}

/// More rows than this are a slip in --step.
const MOST_ROWS: f64 = 1e9;
/// More rows than this are not held for a picture.
const MOST_PLOTTED: u64 = 1_000_000;
/// Of a CSV larger than this, in bytes, one is told before.
const LARGE: f64 = 2e9;
/// Seventeen digits, which tell any two numbers apart, with sign, point and comma.
const BYTES_PER_NUMBER: f64 = 20.0;

impl Run {
    pub(super) fn run(self) -> Result<(), Error> {
        let format = self.plot.as_deref().map(Format::of).transpose()?;
        self.check_page()?;
        let input = Input::read(&self.file)?;
        self.originals(&input.mechanism).refuse_as(&[
            self.csv().as_deref(),
            self.plot.as_deref(),
            self.animate.as_deref(),
        ])?;
        let times = self.times(&input.mechanism)?;
        let parameters = self.conditions.parameters(&input.mechanism)?;
        let mut driven = (self.conditions).driven(&input.mechanism, &parameters, times.start)?;
        let signals = match &self.input {
            Some(path) => Signals::read(path, &driven)?,
            None => Signals::default(),
        };
        self.conditions.refuse_twice(&signals, &driven)?;
        signals.take_over(&mut driven);
        let pictured = self.plot.is_some() || self.animate.is_some();
        let moves = |driver: &Driver| driver.motion().is_some_and(Prescribed::uses_time);
        if pictured && self.input.is_none() && !driven.drivers.iter().any(moves) {
            let example = input.mechanism.drivers.first().map(example);
            let example = example.unwrap_or_default();
            let note = format!("nothing moves; --drive or --input say how drivers move{example}");
            Message::Note(note).show();
        }
        let driven = Arc::new(driven);
        let all = Column::all(&driven);
        let (written, plotted, told) = if self.variables.is_empty() {
            let plotted = Column::of_interest(&all);
            let told = Recording::of_interest(&all);
            (all, plotted, told)
        } else {
            let chosen = Column::named(&all, &self.variables, &driven)?;
            (chosen.clone(), chosen.clone(), chosen)
        };
        let home_solver = input.assemble()?;
        if let Some(size) = self.size(&times, &written) {
            Message::Note(size).show();
        }
        let mut results = Results {
            table: self.table(&written)?,
            record: format.map(|_| Record::new(plotted)),
            recording: (self.animate.as_ref()).map(|_| Recording::new(told, times.steps)),
        };
        let motion = Motion::start(
            home_solver,
            Arc::clone(&driven),
            signals,
            parameters.clone(),
            times.start,
        )
        .map_err(|error| input.error(error))?;
        let file = input.source.name();
        let outcome = results.follow(motion, file, &times, self.fills_terminal());
        if let (Some(path), Some(format), Some(mut record)) = (&self.plot, format, results.record) {
            if self.variables.is_empty()
                && let Some([shown, moving]) = record.leave_out()
            {
                let note = format!(
                    "the plot shows {shown} of {moving} bodies that move; --variables names others"
                );
                Message::Note(note).show();
            }
            let sheet = Sheet::chart(&record.chart(&driven));
            format.write(path, &sheet, format.width(PLOT_WIDTH), false)?;
        }
        if let (Some(path), Some(recording)) = (&self.animate, results.recording) {
            let clock = [times.start, times.step];
            let animation = recording.animation(&driven, &parameters, clock);
            write(path, animation::page(&animation).as_bytes())?;
        }
        outcome
    }

    fn times(&self, mechanism: &Mechanism) -> Result<Times, Error> {
        let simulation = &mechanism.simulation;
        let start = self.start.unwrap_or(simulation.start);
        let stop = self.stop.unwrap_or(simulation.stop);
        let step = self.step.unwrap_or(simulation.step);
        let refuse = |message: String| Err(Error::Usage(message));
        for (option, value) in [("--start", start), ("--stop", stop), ("--step", step)] {
            if !value.is_finite() {
                return refuse(format!("{option} is {value}; expected a finite number"));
            }
        }
        let [from, to] = [start, stop].map(shown);
        if stop < start {
            return refuse(format!(
                "cannot run from {from} s to {to} s: the stop time must not be before the start"
            ));
        }
        if step <= 0.0 {
            let step = shown(step);
            return refuse(format!("--step is {step}; expected a positive time"));
        }
        // A last step shorter than this part of the others is rounding.
        let steps = ((stop - start) / step - 1e-9).ceil().max(0.0);
        if steps >= MOST_ROWS {
            let step = shown(step);
            return refuse(format!(
                "a step of {step} s from {from} s to {to} s makes more than {MOST_ROWS:e} rows"
            ));
        }
        let steps = steps as u64;
        let rows = steps + 1;
        if self.plot.is_some() && rows > MOST_PLOTTED {
            return refuse(format!(
                "--plot: {rows} rows are more than the {MOST_PLOTTED} of which a picture is made"
            ));
        }
        Ok(Times {
            start,
            stop,
            step,
            steps,
        })
    }

    /// The page is read by its extension.
    fn check_page(&self) -> Result<(), Error> {
        match &self.animate {
            Some(path) if !is_stdout(path) && !matches!(&*extension(path), "html" | "htm") => {
                Err(Error::Usage(format!(
                    "`{}` has neither the extension .html nor .htm",
                    path.display()
                )))
            }
            _ => Ok(()),
        }
    }

    /// What is read.
    fn originals(&self, mechanism: &Mechanism) -> Originals {
        let originals = Originals::new(&self.file, mechanism);
        match &self.input {
            Some(path) => originals.with("the file of --input", path),
            None => originals,
        }
    }

    /// Where the CSV goes, if there is one.
    fn csv(&self) -> Option<PathBuf> {
        let output = self.output.clone();
        let pictured = self.plot.is_some() || self.animate.is_some();
        output.or_else(|| (!pictured).then(|| PathBuf::from(STDOUT)))
    }

    /// How large a CSV file becomes, if that is much.
    fn size(&self, times: &Times, columns: &[Column]) -> Option<String> {
        let path = self.csv().filter(|path| !is_stdout(path))?;
        let (rows, columns) = (times.steps + 1, columns.len() + 1);
        let bytes = rows as f64 * columns as f64 * BYTES_PER_NUMBER;
        (bytes > LARGE).then(|| {
            format!(
                "`{}` takes about {:.1} GB: {rows} rows of {columns} columns",
                path.display(),
                bytes / 1e9
            )
        })
    }

    /// Whether the CSV scrolls over the terminal.
    fn fills_terminal(&self) -> bool {
        self.csv().is_some_and(|path| is_stdout(&path)) && std::io::stdout().is_terminal()
    }

    fn table<'a>(&self, columns: &'a [Column]) -> Result<Option<Table<'a>>, Error> {
        let Some(path) = self.csv() else {
            return Ok(None);
        };
        if is_stdout(&path) {
            let stdout = Box::new(std::io::stdout().lock());
            return Ok(Some(Table::new(columns, stdout, path)));
        }
        match std::fs::File::create(&path) {
            Ok(file) => Ok(Some(Table::new(columns, Box::new(file), path))),
            Err(source) => Err(Error::Write { path, source }),
        }
    }
}

/// How a driver may be moved, for who has not said so.
fn example(driver: &Driver) -> String {
    let DriverSource::Input { start } = driver.source else {
        return String::new();
    };
    let name = &driver.name;
    let motion = match driver.coordinate.kind {
        CoordinateKind::Angle => format!("{}*deg + 2*pi*t", round(start.to_degrees())),
        _ => format!(
            "{} + {}*t",
            round(start),
            round(0.1 * start.abs().max(0.01))
        ),
    };
    format!(", for example --drive '{name} = {motion}'")
}

/// Six digits of a number.
fn round(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// What becomes of a run.
struct Results<'a> {
    table: Option<Table<'a>>,
    record: Option<Record>,
    recording: Option<Recording>,
}

impl Results<'_> {
    /// Goes along with a motion of a file's mechanism; what is reached before an error is kept.
    fn follow(
        &mut self,
        mut motion: Motion,
        file: &str,
        times: &Times,
        quiet: bool,
    ) -> Result<(), Error> {
        let mut progress = Progress::new(times.steps, quiet);
        if let Some(table) = &mut self.table {
            table.write_header()?;
        }
        self.add(&motion)?;
        for row in 1..=times.steps {
            let advanced = motion.advance(times.at(row));
            for notice in motion.notices.drain(..) {
                progress.clear();
                notice.show();
            }
            advanced.map_err(|why| Error::DeadPoint {
                file: file.to_owned(),
                why,
            })?;
            self.add(&motion)?;
            progress.done(row);
        }
        match &mut self.table {
            Some(table) => table.finish(),
            None => Ok(()),
        }
    }

    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        if let Some(record) = &mut self.record {
            record.add(motion);
        }
        if let Some(recording) = &mut self.recording {
            recording.add(motion);
        }
        match &mut self.table {
            Some(table) => table.write_row(motion),
            None => Ok(()),
        }
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
