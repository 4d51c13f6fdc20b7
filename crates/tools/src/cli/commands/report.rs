//! `biela report`

mod motion;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::check::{equations, forces::Forces, scientific};
use super::range::{told, with_unit};
use crate::cli::given::conditions::{Conditions, Scenario};
use crate::cli::given::input::{Input, misfits};
use crate::cli::given::input_files::InputFiles;
use crate::cli::pages::documentation::{about, parameter, table};
use crate::cli::results::output::{tell_written, write};
use crate::cli::results::picture::check_page;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::drawing::animation::fill;
use crate::drawing::svg::{self, escape};
use crate::drawing::{Diagram, Sheet};
use biela::fmi::variables;
use biela::kinematics::{Rates, Solver};
use biela::mechanism::{DriverId, DriverSource, fixed, shown};

const PAGE: &str = include_str!("report.html");

/// Width of pictures and charts in pixels.
const WIDTH: u32 = 760;
/// Most drivers whose ranges are told: a page with more is none to read.
const MOST_DRIVERS: usize = 12;
/// Most bodies whose poses are listed.
const MOST_BODIES: usize = 60;

/// Write a report of a mechanism: one page that prints to PDF.
///
/// The page has the picture with dimensions, the degrees of freedom, the pose at the start, for each
/// driver its range with dead points, extremes of the measures, transmission angle and largest
/// forces, charts over the ranges, the forces at rest, the parameters, and the file itself. What moves
/// by itself is shown over time, with its events, its equilibrium and the frequencies there. It is one HTML file that needs no other and no network, and holds no script.
///
/// The same file gives the same bytes.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela report four_bar.toml -o four_bar.html")]
pub(in crate::cli) struct Report {
    /// The mechanism file.
    file: PathBuf,
    /// The page to write, `-` for stdout [default: the mechanism's name with _report.html in the
    /// current folder].
    #[arg(short, long, value_name = "HTML")]
    output: Option<PathBuf>,
    #[command(flatten)]
    conditions: Conditions,
}

impl Report {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        self.output.as_deref().map_or(Ok(()), check_page)?;
        let input = Input::read(&self.file)?;
        let name = &input.mechanism.name;
        let path = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{name}_report.html")));
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(&path)])?;
        let start = input.mechanism.simulation.start;
        let scenario = self.conditions.scenario(&input.mechanism, start, None)?;
        let (page, told) = page(&input, &scenario)?;
        told.iter().for_each(Message::show);
        write(&path, page.as_bytes())?;
        tell_written(&path);
        Ok(())
    }
}

/// Returns the report of a mechanism at the start of a scenario, and what is worth knowing of it.
pub(in crate::cli) fn page(
    input: &Input,
    scenario: &Scenario,
) -> Result<(String, Vec<Message>), Error> {
    let mut solver = scenario
        .solver(input.assemble()?)
        .map_err(|error| input.error(error))?;
    let mut told = misfits(&solver);
    let motion = motion::motion(input, scenario, &mut told)?;
    let solver = &mut solver;
    let mechanism = Arc::clone(solver.mechanism());
    let diagram = Diagram {
        dimensions: true,
        ..Diagram::default()
    };
    let sheet = diagram.sheet(solver).map_err(|error| input.error(error))?;
    let values = solver.pose().parameters.clone();
    let variables = variables(&mechanism);
    let rows = variables
        .iter()
        .filter_map(|variable| parameter(&mechanism, variable, &values));
    let parameters = table(&["Parameter", "Value", "Unit", "Limits", "Meaning"], rows);
    let page = fill(
        PAGE,
        &[
            ("title", &escape(&mechanism.name)),
            ("description", &escape(&mechanism.description)),
            ("about", &about(&mechanism)),
            ("picture", &picture(&sheet)),
            ("freedom", &freedom(solver)),
            ("pose", &pose(solver)),
            ("ranges", &ranges(solver)),
            ("motion", &motion),
            ("forces", &forces(input, solver)?),
            ("parameters", &parameters),
            ("file", &escape(input.source.text())),
            ("version", env!("CARGO_PKG_VERSION")),
        ],
    );
    Ok((page, told))
}

/// Returns a sheet as a part of a page.
fn picture(sheet: &Sheet) -> String {
    let picture = svg::write(sheet, WIDTH, true);
    match picture.find("<svg") {
        // The declaration of XML is none of HTML.
        Some(start) => picture[start..].to_owned(),
        None => picture,
    }
}

/// Returns the table of equations, with redundant ones and warnings.
fn freedom(solver: &mut Solver) -> String {
    let mechanism = solver.mechanism();
    let mut rows = equations(mechanism);
    let redundancies = solver.redundancies();
    if !redundancies.is_empty() {
        let count = redundancies.iter().map(|r| r.redundant).sum();
        let names: Vec<String> = redundancies.into_iter().map(|r| r.origin).collect();
        rows.push(("redundant", count, names.join(", ")));
    }
    rows.push(("degrees of freedom", mechanism.drivers.len(), String::new()));
    let rows = rows
        .into_iter()
        .map(|(label, count, names)| [label.to_owned(), count.to_string(), names]);
    let mut html = table(&["", "Number", "Names"], rows);
    let warnings = misfits(solver);
    if !warnings.is_empty() {
        let items = warnings
            .iter()
            .map(|warning| format!("<li>{}</li>", escape(&warning.to_string())));
        let _ = write!(html, "\n<ul>{}</ul>", items.collect::<String>());
    }
    html
}

/// Returns the tables of drivers, measures and bodies at the solver's pose.
fn pose(solver: &mut Solver) -> String {
    let rcond = scientific(solver.rcond(), 2);
    let (mechanism, pose) = (solver.mechanism(), solver.pose());
    let drivers = mechanism.drivers.iter().zip(&pose.drivers);
    let mut rows: Vec<[String; 3]> = drivers
        .map(|(driver, value)| {
            let source = match driver.source {
                DriverSource::Input { .. } => "input",
                DriverSource::Motion(_) => "prescribed motion",
                DriverSource::Free { .. } => "free",
            };
            let value = with_unit(driver.coordinate.kind, *value);
            [driver.name.clone(), value, source.to_owned()]
        })
        .collect();
    let still = Rates::new(pose.q.len());
    rows.extend(
        mechanism
            .measures
            .iter()
            .enumerate()
            .map(|(index, measure)| {
                let value = solver.measure(index, &still).value;
                let value = with_unit(measure.coordinate.kind, value);
                [measure.name.clone(), value, measure.description.clone()]
            }),
    );
    rows.push(["reciprocal condition".to_owned(), rcond, String::new()]);
    let mut html = table(&["Coordinate", "Value", ""], rows.into_iter());
    let bodies = mechanism.bodies.iter().zip(pose.q.chunks_exact(3));
    let bodies = bodies.take(MOST_BODIES).map(|(body, q)| {
        [
            body.name.clone(),
            fixed(q[0], 6),
            fixed(q[1], 6),
            fixed(q[2].to_degrees(), 6),
        ]
    });
    html += "\n";
    html += &table(&["Body", "x [m]", "y [m]", "phi [deg]"], bodies);
    html
}

/// Returns the lines and the chart of each driver.
fn ranges(solver: &mut Solver) -> String {
    let names: Vec<String> = solver
        .mechanism()
        .drivers
        .iter()
        .map(|driver| driver.name.clone())
        .collect();
    let mut html = String::new();
    for (index, name) in names.iter().enumerate().take(MOST_DRIVERS) {
        let (text, chart) = told(solver, DriverId(index));
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let first = lines.next().unwrap_or(name);
        let _ = write!(html, "<h3>{}</h3>\n<ul>", escape(first));
        for line in lines {
            let _ = write!(html, "<li>{}</li>", escape(&line.replace('`', "")));
        }
        html += "</ul>\n";
        if !chart.panels.is_empty() {
            let chart = picture(&Sheet::chart(&chart));
            let _ = writeln!(html, "<figure>\n{chart}\n</figure>");
        }
    }
    if html.is_empty() {
        html += "<p>None.</p>";
    }
    html
}

/// Returns masses, efforts and reactions at rest; nothing for a mechanism without dynamics.
fn forces(input: &Input, solver: &mut Solver) -> Result<String, Error> {
    if !solver.mechanism().has_dynamics() {
        return Ok(String::new());
    }
    let forces = Forces::at_rest(solver).map_err(|error| input.error(error))?;
    let masses = if forces.masses.is_empty() {
        String::new()
    } else {
        let rows = forces
            .masses
            .iter()
            .map(|(body, mass, inertia)| [body.clone(), shown(*mass), shown(*inertia)]);
        table(&["Body", "Mass [kg]", "Inertia [kg m²]"], rows)
    };
    let values = forces
        .values
        .iter()
        .map(|(name, value, unit)| [name.clone(), shown(*value), unit.to_string()]);
    Ok(format!(
        "<h2>Forces at rest</h2>\n{masses}\n{}",
        table(&["Force", "Value", "Unit"], values)
    ))
}
