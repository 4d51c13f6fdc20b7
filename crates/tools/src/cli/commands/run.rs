//! `biela run`

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::given::conditions::{Conditions, Scenario};
use crate::cli::given::input::Input;
use crate::cli::given::input_files::InputFiles;
use crate::cli::given::times::{Span, Times};
use crate::cli::motion::SignalledMotion;
use crate::cli::results::column::{self, Output};
use crate::cli::results::csv::Csv;
use crate::cli::results::events::Events;
use crate::cli::results::film::{Film, FilmFile};
use crate::cli::results::picture::{Format, extension};
use crate::cli::results::plot::Plot;
use crate::cli::results::recorder::Recorder;
use crate::cli::results::stdout::{STDOUT, is_stdout};
use crate::cli::results::xlsx::{MOST_COLUMNS, MOST_ROWS, Xlsx};
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, remark, tell_errors_only};
use crate::cli::told::progress::Progress;
use crate::drawing::ForcePlace;
use biela::mechanism::{Driver, DriverSource, Mechanism, rounded};

/// Run a mechanism: write its motion as CSV, plot it, animate it.
///
/// Each row has the time, then value, velocity and acceleration of every driver, then all
/// outputs of the FMU under their names there, in SI units. Drivers that are FMI inputs stay at
/// their start values unless --drive or --input says how they move; velocities and accelerations
/// are exact derivatives of these motions. Freedoms move by the forces from their starts on.
///
/// The mechanism starts in the assembly mode of its file. At a dead point the run ends with an
/// error; the results up to there are written.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: biela run four_bar.toml --drive 'crank_angle = 60*deg + 2*pi*t' --stop 1"
)]
pub(in crate::cli) struct Run {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    /// Move drivers and set inputs of forces by a CSV file: its first column is time, the others
    /// are variables of drivers such as crank_angle.position, and inputs such as cylinder.effort.
    ///
    /// Values are linear between two rows, constant before the first and after the last, and jump
    /// at a time that occurs twice, as in FMPy. A column .velocity gives the velocity of a driver,
    /// otherwise the slope does; a column .acceleration gives its acceleration, otherwise it is
    /// zero. A position of a wrapped angle means the turn nearest the last one. Columns are
    /// separated by commas, semicolons, tabs or blanks.
    #[arg(short, long, value_name = "CSV")]
    input: Option<PathBuf>,
    #[command(flatten)]
    span: Span,
    /// Variables to write and plot, separated by commas: one such as crank.phi, or all variables
    /// of a body, marker, driver, measure, joint or force by its name [default: in the CSV all; in
    /// plots drivers with their efforts and measures, or points of interest, or bodies].
    #[arg(short, long, value_name = "NAMES", value_delimiter = ',')]
    variables: Vec<String>,
    /// The file to write: CSV, or Excel if its extension is .xlsx; `-` is CSV to stdout [default:
    /// stdout, if no other result is asked for].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Plot positions, velocities and accelerations over time, drivers in panels of their own;
    /// the picture's extension, .svg or .png, decides, and `-` is SVG to stdout. Without
    /// --variables, what stays constant is left out.
    #[arg(short, long, value_name = "PICTURE")]
    plot: Option<PathBuf>,
    /// Plot over a variable such as a driver instead of time.
    #[arg(long, value_name = "NAME", requires = "plot")]
    over: Option<String>,
    /// Write a page on which the mechanism moves, .html or .htm or `-` for stdout, or a picture that
    /// moves by itself, .svg or .gif. All work offline. Of more than 10,000 rows the page shows every
    /// second, third and so on, of more than 240 the SVG, of more than 150 the GIF.
    #[arg(short, long, value_name = "PAGE")]
    animate: Option<PathBuf>,
    /// Let the page show forces as arrows where its reader asks for them: what joints and drivers
    /// exert, and springs, dampers and loads.
    #[arg(long, requires = "animate")]
    forces: bool,
    /// Write the events of free motion as CSV: time, kind, name of the stop, joint or friction, and at
    /// an impact the speed before; `-` is stdout.
    #[arg(long, value_name = "CSV")]
    events: Option<PathBuf>,
    /// Tell errors only: neither warnings and notes nor what was written.
    #[arg(short, long)]
    quiet: bool,
}

/// Largest number of rows that a picture holds.
const MOST_PLOTTED: u64 = 1_000_000;
/// Size of a CSV \[bytes\] above which a note tells it before.
const LARGE: f64 = 2e9;
/// Seventeen digits, which tell any two numbers apart, with sign, point and comma.
const BYTES_PER_NUMBER: f64 = 20.0;

impl Run {
    pub(in crate::cli) fn run(mut self) -> Result<(), Error> {
        if self.quiet {
            tell_errors_only();
        }
        let results = [&self.output, &self.plot, &self.animate, &self.events];
        if results.iter().all(|path| path.is_none()) {
            self.output = Some(PathBuf::from(STDOUT));
        }
        let format = self.plot.as_deref().map(Format::of).transpose()?;
        self.check_page()?;
        self.check_output()?;
        let input = Input::read(&self.file)?;
        if self.forces {
            input.check_dynamics()?;
        }
        self.refuse_overwriting(&input.mechanism)?;
        let times = self.span.times(&input.mechanism)?;
        let rows = times.steps + 1;
        if self.plot.is_some() && rows > MOST_PLOTTED {
            return Err(Error::Usage(format!(
                "--plot: {rows} rows are more than the {MOST_PLOTTED} of which a picture is made"
            )));
        }
        let scenario =
            (self.conditions).scenario(&input.mechanism, times.start, self.input.as_deref())?;
        let all = Output::all(&scenario.mechanism);
        let over = self.over.as_deref().map(|name| column::over(&all, name));
        let over = over.transpose()?;
        let is_choice = !self.variables.is_empty();
        let [written, plotted, told] = if is_choice {
            let named = column::named(&all, &self.variables, &scenario.mechanism)?;
            [named.clone(), named.clone(), named]
        } else {
            let [plotted, told] = [column::plotted(&all), column::told(&all)];
            [all, plotted, told]
        };
        let shown = [
            (&self.output, &written),
            (&self.plot, &plotted),
            (&self.animate, &told),
        ];
        let shown = shown.iter().filter(|(path, _)| path.is_some());
        let asks = |is_asked: fn(&Output) -> bool| {
            self.forces
                || shown
                    .clone()
                    .any(|(_, columns)| columns.iter().any(is_asked))
                || over.as_ref().is_some_and(is_asked)
        };
        let [asks_forces, asks_reactions] = [Output::uses_forces, Output::uses_reactions].map(asks);
        let home_solver = input.assemble()?;
        let notes = [
            note_of_rest(&input.mechanism, &scenario),
            self.note_of_size(&times, written.len() + 1),
        ];
        notes.iter().flatten().for_each(Message::show);
        let mut recorders: Vec<Box<dyn Recorder>> = Vec::new();
        if let Some(path) = &self.output {
            recorders.push(if extension(path) == "xlsx" {
                check_sheet(rows, written.len() + 1)?;
                Box::new(Xlsx::new(path.clone(), written))
            } else {
                Box::new(Csv::create(path.clone(), written)?)
            });
        }
        if let (Some(path), Some(format)) = (self.plot.clone(), format) {
            recorders.push(Box::new(Plot::new(path, format, plotted, !is_choice, over)));
        }
        if let Some(path) = self.events.clone() {
            recorders.push(Box::new(Events { path }));
        }
        let mut motion = SignalledMotion::start(home_solver, scenario);
        motion = motion.and_then(|motion| {
            if asks_forces {
                motion.with_forces(asks_reactions)
            } else {
                motion.with_contacts_watched()
            }
        });
        let motion = motion.map_err(|error| input.error_at(times.start, &error))?;
        let mut motion = motion.with_freedoms().map_err(|why| Error::Stopped {
            file: input.source.name().to_owned(),
            why: why.to_string(),
        })?;
        if let Some(path) = self.animate.clone() {
            let mut film = Film::new(told, times.steps, [times.start, times.step]);
            if self.forces {
                film.show_forces(ForcePlace::sought(
                    &mut motion.motion.solver,
                    &motion.motion.solution,
                ));
            }
            recorders.push(Box::new(FilmFile { film, path }));
        }
        let outcome = self.play(&mut motion, input.source.name(), &times, &mut recorders);
        // Also after a dead point: the results up to there are written.
        let finished = recorders
            .into_iter()
            .map(|r| r.finish(&motion.motion, &motion.events));
        let failed: Vec<Error> = finished.filter_map(Result::err).collect();
        if let Some(line) = motion.describe_integration() {
            remark(line);
        }
        let mut errors = outcome.err().into_iter().chain(failed);
        let Some(last) = errors.next_back() else {
            return Ok(());
        };
        errors.for_each(|error| error.show());
        Err(last)
    }

    /// Moves the mechanism through all times and gives each row to the recorders; drops one that
    /// fails.
    fn play(
        &self,
        motion: &mut SignalledMotion,
        file: &str,
        times: &Times,
        recorders: &mut Vec<Box<dyn Recorder>>,
    ) -> Result<(), Error> {
        // Rows on a terminal show the progress themselves.
        let fills_terminal =
            self.output.as_deref().is_some_and(is_stdout) && std::io::stdout().is_terminal();
        let mut progress = Progress::new(times.steps, self.quiet || fills_terminal);
        for row in 0..=times.steps {
            let advanced = motion.advance(times.at(row));
            for notice in motion.notices.drain(..) {
                progress.clear();
                notice.show();
            }
            advanced.map_err(|why| Error::Stopped {
                file: file.to_owned(),
                why,
            })?;
            for index in 0..recorders.len() {
                if let Err(error) = recorders[index].add(&motion.motion) {
                    recorders.remove(index);
                    return Err(error);
                }
            }
            progress.done(row);
        }
        Ok(())
    }

    /// Refuses a table for a spreadsheet in a format that is not written.
    fn check_output(&self) -> Result<(), Error> {
        match &self.output {
            Some(path) if matches!(&*extension(path), "xls" | "ods") => Err(Error::Usage(format!(
                "`{}` would be CSV: an Excel file has the extension .xlsx",
                path.display()
            ))),
            _ => Ok(()),
        }
    }

    /// Refuses a page whose name is neither that of a page nor that of a picture.
    fn check_page(&self) -> Result<(), Error> {
        match &self.animate {
            Some(path)
                if !is_stdout(path)
                    && !matches!(&*extension(path), "html" | "htm" | "svg" | "gif") =>
            {
                Err(Error::Usage(format!(
                    "`{}` has none of the extensions .html, .htm, .svg and .gif",
                    path.display()
                )))
            }
            Some(path) if self.forces && matches!(&*extension(path), "svg" | "gif") => {
                Err(Error::Usage(
                    "--forces: a moving picture has no arrows of forces; a page has them, .html"
                        .to_owned(),
                ))
            }
            _ => Ok(()),
        }
    }

    fn refuse_overwriting(&self, mechanism: &Mechanism) -> Result<(), Error> {
        let mut files = InputFiles::new(&self.file, mechanism);
        if let Some(path) = &self.input {
            files.add("the file of --input", path);
        }
        let outputs = [&self.output, &self.plot, &self.animate, &self.events];
        files.refuse_as_outputs(&outputs.map(Option::as_deref))
    }

    /// Returns a note of the size of the CSV file, if that is large.
    fn note_of_size(&self, times: &Times, columns: usize) -> Option<Message> {
        let is_csv = |path: &&Path| !is_stdout(path) && extension(path) != "xlsx";
        let path = self.output.as_deref().filter(is_csv)?;
        let rows = times.steps + 1;
        let bytes = rows as f64 * columns as f64 * BYTES_PER_NUMBER;
        (bytes > LARGE).then(|| {
            Message::Note(format!(
                "`{}` takes about {:.1} GB: {rows} rows of {columns} columns",
                path.display(),
                bytes / 1e9
            ))
        })
    }
}

/// Refuses what is larger than a sheet of an Excel file.
fn check_sheet(rows: u64, columns: usize) -> Result<(), Error> {
    if rows < MOST_ROWS && columns <= MOST_COLUMNS {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "--output: {rows} rows of {columns} columns are more than an Excel file has; write a CSV \
         file, or fewer with --step and --variables"
    )))
}

/// Returns a note if nothing moves, with an example of a motion.
fn note_of_rest(mechanism: &Mechanism, scenario: &Scenario) -> Option<Message> {
    let moves_freely = scenario.mechanism.has_freedoms();
    if moves_freely || scenario.signals.has_drivers() || scenario.mechanism.uses_time() {
        return None;
    }
    let duration = mechanism.simulation.stop - mechanism.simulation.start;
    let mut examples = mechanism
        .drivers
        .iter()
        .filter_map(|driver| example(driver, duration));
    let example = examples.next().unwrap_or_default();
    let note = format!("nothing moves; --drive or --input say how drivers move{example}");
    Some(Message::Note(note))
}

/// Returns an example of a motion of a driver that is an input: to its farther limit within a
/// duration \[s\], away from its only one, or a turn per second.
fn example(driver: &Driver, duration: f64) -> Option<String> {
    let DriverSource::Input { start } = driver.source else {
        return None;
    };
    let (value, usual): (fn(f64) -> String, _) = if driver.coordinate.kind.is_angle() {
        (
            |angle| format!("{}*deg", rounded(angle.to_degrees(), 6)),
            "2*pi".to_owned(),
        )
    } else {
        let velocity = rounded(0.1 * start.abs().max(0.01), 6);
        (
            |length| rounded(length, 6).to_string(),
            velocity.to_string(),
        )
    };
    let (sign, speed) = match (driver.min, driver.max) {
        (Some(min), Some(max)) if start - min > max - start => {
            ('-', value((start - min) / duration))
        }
        (Some(_), Some(max)) => ('+', value((max - start) / duration)),
        (None, Some(_)) => ('-', usual),
        (_, None) => ('+', usual),
    };
    let (name, start) = (&driver.name, value(start));
    Some(format!(
        ", for example --drive '{name} = {start} {sign} {speed}*t'"
    ))
}
