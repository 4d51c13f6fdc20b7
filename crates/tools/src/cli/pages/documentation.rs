//! The documentation inside an FMU: its picture, its page, and licences.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::sync::Arc;

use super::live;
use crate::cli::commands::range::{end_text, with_unit};
use crate::cli::given::input::Input;
use crate::cli::given::signals::Signals;
use crate::cli::motion::SignalledMotion;
use crate::cli::results::column::{self, Output};
use crate::cli::results::film::Film;
use crate::cli::results::form::Form;
use crate::cli::told::error::Error;
use crate::drawing::animation::{Animation, fill, page_with, player};
use crate::drawing::svg::escape;
use crate::drawing::{Scene, Sheet, png};
use biela::fmi::{Causality, Document, Kind, Quantity, Variability, Variable, Version, variables};
use biela::kinematics::{End, Range, RangeSettings, Solver};
use biela::mechanism::{
    Driver, DriverId, DriverSource, Mechanism, PrescribedMotion as Prescribed, Source, Unit,
    Variable as Of, rounded,
};

const MAIN: &str = include_str!("documentation.html");
/// Behaviour of drivers that are inputs, and of freedoms.
const DRIVEN: &str = include_str!("documentation_driven.html");
const FREE: &str = include_str!("documentation_free.html");
const STYLE: &str = include_str!("documentation.css");
/// The licences of what is inside the runtime library.
const LICENSES: &[u8] = include_bytes!("../../../../runtime/licenses.txt");

/// Width of the picture, which hosts show as an icon or beside the variables.
const ICON_WIDTH: u32 = 512;
/// Number of moments of the motion, and the largest number of bodies in all of them.
const MOMENTS: usize = 240;
const MOST_PLACED: usize = 24_000;
/// Most bodies of a mechanism whose picture has a motion of its own; the picture of a larger one
/// uses the poses of the film.
const MOST_SWEPT: usize = 1_000;
/// Most bodies of a mechanism that is moved: a larger one is shown at its start, without the ranges
/// of its drivers, so that an export takes seconds.
const MOST_MOVED: usize = 2_000;
/// Time that the film takes for a turn of the driver, or for its range there and back \[s\].
const PERIOD: f64 = 4.0;
/// Coarser settings than those of `biela range`: steps of three degrees, few turns, and lengths
/// up to three times the size of the mechanism.
const RANGE: RangeSettings = RangeSettings {
    samples: 120,
    turns: 8,
    lengths: 3.0,
    bounds: [None; 2],
    transmission: false,
};
/// Part of the range that a motion between two limits leaves out at each end: at a dead point
/// there is no velocity.
const INSIDE: f64 = 0.01;
/// Part of the searched range that is shown if no limit was found.
const SHOWN: f64 = 1.0 / 3.0;

/// A mechanism in motion.
pub(in crate::cli) struct Shown {
    pub(in crate::cli) animation: Animation,
    /// The motion, in words.
    pub(in crate::cli) moving: String,
    /// Ranges of the drivers that are inputs, from the mechanism's pose; none of a mechanism that is
    /// too large for a search.
    ranges: Vec<Option<Range>>,
}

/// Returns the picture and the page of a mechanism, and the licences, for an FMU of this form; `home`
/// has the mechanism's own pose. With the solver for pages there is a second page, on which the
/// mechanism is moved by hand.
pub(in crate::cli) fn documents(
    input: &Input,
    home: &Solver,
    form: Form,
    page_solver: Option<&[u8]>,
) -> Result<Vec<Document>, Error> {
    let refuse = |error| input.error(error);
    let mut solver = Solver::new(Arc::clone(&input.mechanism)).map_err(refuse)?;
    solver.restore(home.pose());
    let shown = show(&mut solver).map_err(refuse)?;
    let scene = if input.mechanism.bodies.len() <= MOST_SWEPT {
        Scene::new(&mut solver, true)
    } else {
        let poses = shown
            .animation
            .moments
            .iter()
            .map(|moment| moment.q.clone());
        let poses: Vec<_> = poses.collect();
        let home = home.pose();
        Scene::along(&input.mechanism, &home.parameters, &home.q, &poses, true)
    };
    let sheet = Sheet::small(&scene, &home.pose().q);
    let picture = png::write(&sheet, ICON_WIDTH, false)
        .ok_or_else(|| Error::Usage(format!("no PNG is {ICON_WIDTH} pixels wide")))?;
    let document = |path: &str, content: Vec<u8>| Document {
        path: path.to_owned(),
        content,
    };
    let diagram = match form.version {
        Version::Fmi2 => "model.png",
        Version::Fmi3 => "documentation/diagram.png",
    };
    let values = &home.pose().parameters;
    let has_live_page = page_solver.is_some();
    let page = page(
        &input.mechanism,
        values,
        &shown,
        form.version,
        has_live_page,
    );
    let mut documents = Vec::new();
    if form.terminals {
        documents.push(document("terminalsAndIcons/icon.png", picture.clone()));
    }
    documents.extend([
        document(diagram, picture),
        document("documentation/index.html", page.into_bytes()),
        document("documentation/licenses/license.txt", LICENSES.to_vec()),
    ]);
    if let Some(page_solver) = page_solver {
        let solver = live::solver(page_solver);
        // The FMU depends on what is in the file, not on the file's name.
        let name = format!("{}.toml", input.mechanism.name);
        let source = Source::new(name, input.source.text());
        let page = live::page(&source, &input.mechanism, &solver, None);
        documents.push(document("documentation/page.html", page.into_bytes()));
    }
    Ok(documents)
}

/// Moves a mechanism by its forces if it has freedoms, along its prescribed motions, or over the range
/// of its first driver that is an angle, or else of its first driver. One of more than [`MOST_MOVED`]
/// bodies stays at rest.
pub(in crate::cli) fn show(solver: &mut Solver) -> Result<Shown, biela::kinematics::Error> {
    let own = Arc::clone(solver.mechanism());
    // A large mechanism is moved less, so that its page takes seconds.
    let fewer = MOST_PLACED / own.bodies.len().max(1);
    let settings = RangeSettings {
        samples: RANGE.samples.min(10 * fewer as u32).max(RANGE.samples / 10),
        turns: RANGE.turns.min(fewer as u32).max(1),
        ..RANGE
    };
    let is_moved = own.bodies.len() <= MOST_MOVED;
    let ranges = own.drivers.iter().enumerate().map(|(index, driver)| {
        let is_searched = is_moved && driver.motion().is_none();
        is_searched.then(|| solver.range(DriverId(index), &settings))
    });
    let ranges: Vec<Option<Range>> = ranges.collect();
    let home = solver.pose().clone();
    let simulation = &own.simulation;
    let mut driven = Mechanism::clone(&own);
    let found = ranges.iter().enumerate();
    let found = found.filter_map(|(driver, range)| Some((driver, range.as_ref()?)));
    let is_angle = |(driver, _): &(usize, &Range)| own.drivers[*driver].coordinate.kind.is_angle();
    let first = found
        .clone()
        .find(is_angle)
        .or_else(|| found.clone().next());
    let is_free = own.has_freedoms();
    let (mut duration, mut moving) = match first {
        _ if !is_moved => (
            0.0,
            format!(
                "At its start: a mechanism of more than {MOST_MOVED} bodies is not moved here."
            ),
        ),
        _ if is_free => (
            simulation.stop - simulation.start,
            "Free motion from the start, until the stop time.".to_owned(),
        ),
        _ if own.uses_time() => (
            simulation.stop - simulation.start,
            "The prescribed motion, until the stop time.".to_owned(),
        ),
        Some((driver, range)) => {
            let (motion, duration) = motion_over(home.drivers[driver], range, simulation.start);
            // It parses: it is made of finite numbers.
            if let Ok(motion) = own.parse_expression(&motion, Some(Of::Time)) {
                let motion = Prescribed::Expression(motion);
                driven.drivers[driver].source = DriverSource::Motion(motion);
            }
            let name = &own.drivers[driver].name;
            let held = match own.drivers.len() {
                1 => "",
                _ => "; the other drivers are held at their start values",
            };
            (duration, format!("{name} over its range{held}."))
        }
        None => (0.0, "Nothing moves.".to_owned()),
    };
    let driven = Arc::new(driven);
    let mut solver = Solver::new(Arc::clone(&driven))?;
    solver.restore(&home);
    let start = simulation.start;
    let at_start = |solver| SignalledMotion::from(solver, Signals::default(), start);
    let mut motion = at_start(solver)?;
    if is_moved && is_free {
        motion = match motion.with_freedoms() {
            Ok(motion) => motion,
            Err(error) => {
                (duration, moving) = (0.0, format!("At its start: {error}."));
                let mut solver = Solver::new(Arc::clone(&driven))?;
                solver.restore(&home);
                at_start(solver)?
            }
        };
    }
    let told = column::told(&Output::all(&driven));
    let moments = (MOST_PLACED / own.bodies.len().max(1)).clamp(MOMENTS / 10, MOMENTS);
    let step = duration / moments as f64;
    let mut film = Film::new(told, moments as u64, [start, step]);
    film.add(&motion.motion);
    if duration > 0.0 {
        for moment in 1..=moments {
            // The film ends where the mechanism cannot go on.
            if motion.advance(start + moment as f64 * step).is_err() {
                break;
            }
            film.add(&motion.motion);
        }
    }
    Ok(Shown {
        animation: film.animation(&motion.motion),
        moving,
        ranges,
    })
}

/// Returns an expression in time that leads from `from` over a range, in full turns or there and
/// back, and its duration \[s\].
fn motion_over(from: f64, range: &Range, start: f64) -> (String, f64) {
    if let End::Turns(turns) = range.upper {
        let rate = TAU / PERIOD;
        let turns = f64::from(turns.max(1));
        return (
            format!("{from:?} + {rate:?}*(t - ({start:?}))"),
            turns * PERIOD,
        );
    }
    let ends = [
        (range.samples.first(), &range.lower),
        (range.samples.last(), &range.upper),
    ];
    let [low, high] = ends.map(|(sample, end)| {
        let limit = sample.map_or(from, |sample| sample.driver);
        match end {
            End::NotFound { .. } => from + SHOWN * (limit - from),
            _ => limit,
        }
    });
    let inside = INSIDE * (high - low);
    // The driver may start near a limit.
    let [low, high] = [(low + inside).min(from), (high - inside).max(from)];
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let phase = if half > 0.0 {
        ((middle - from) / half).clamp(-1.0, 1.0).acos()
    } else {
        0.5 * PI
    };
    let rate = TAU / PERIOD;
    let motion = format!("{middle:?} - {half:?}*cos({rate:?}*(t - ({start:?})) + {phase:?})");
    (motion, PERIOD)
}

/// Ends of the sentences about a step that asks for too much and about inputs, by version.
const FAILURE: [&str; 2] = [
    "is discarded: <code>fmi2DoStep</code> returns <code>fmi2Discard</code>, a warning names driver, \
     value and limit, and <code>fmi2LastSuccessfulTime</code> tells the last time whose values were \
     reached",
    "ends at the dead point if the host permits an early return, with a warning that names driver, \
     value and limit; otherwise <code>fmi3DoStep</code> returns <code>fmi3Discard</code>, and the \
     instance is as before",
];
const LAG: [&str; 2] = [
    "the host gives input derivatives (<code>fmi2SetRealInputDerivatives</code>, order 1 and 2)",
    "the host sets the inputs of t + h in intermediate update",
];

fn page(
    mechanism: &Arc<Mechanism>,
    values: &[f64],
    shown: &Shown,
    version: Version,
    has_live_page: bool,
) -> String {
    let variables = variables(mechanism);
    let live_page = if has_live_page {
        "<p><a href=\"page.html\">Move it by hand</a></p>"
    } else {
        ""
    };
    let has_inputs = mechanism.drivers.iter().any(Driver::is_given);
    let moved_by = match (has_inputs, mechanism.has_freedoms()) {
        (true, false) => "the drivers are its inputs",
        (true, true) => "the drivers are its inputs, and the forces move its freedoms",
        (false, true) => "the forces move it from the starts of its freedoms",
        (false, false) => "its drivers follow the motions of the file",
    };
    let interface = format!(
        ": {moved_by}; position, velocity and acceleration of the bodies are outputs, exact to {} at every \
         communication point.",
        if mechanism.has_freedoms() {
            "the tolerance"
        } else {
            "rounding"
        }
    );
    let driven = fill(
        DRIVEN,
        &[
            ("failure", FAILURE[version as usize]),
            ("lag", LAG[version as usize]),
        ],
    );
    let behaviour = [(has_inputs, &*driven), (mechanism.has_freedoms(), FREE)];
    let behaviour = behaviour.into_iter().filter(|(applies, _)| *applies);
    let behaviour: String = behaviour.map(|(_, text)| text).collect();
    let main = fill(
        MAIN,
        &[
            ("about", &about(mechanism)),
            ("moving", &escape(&shown.moving)),
            ("player", &(player(&shown.animation) + live_page)),
            ("drivers", &drivers(mechanism, &shown.ranges)),
            ("parameters", &parameters(mechanism, &variables, values)),
            ("outputs", &outputs(&variables)),
            ("version", env!("CARGO_PKG_VERSION")),
            ("standard", &version.to_string()),
            ("interface", &interface),
            ("behaviour", &behaviour),
        ],
    );
    page_with(&mechanism.name, &mechanism.description, &main, STYLE)
}

/// Returns author, version, licence and copyright, as far as the file has them.
pub(in crate::cli) fn about(mechanism: &Mechanism) -> String {
    let rows = [
        ("Author", &mechanism.author),
        ("Version", &mechanism.version),
        ("Licence", &mechanism.license),
        ("Copyright", &mechanism.copyright),
    ];
    let given = rows
        .into_iter()
        .filter_map(|(what, text)| Some((what, text.as_deref()?)));
    let mut html = String::new();
    for (what, text) in given {
        let _ = write!(html, "<dt>{what}</dt><dd>{}</dd>", escape(text));
    }
    if html.is_empty() {
        return html;
    }
    format!("<dl class=\"about\">{html}</dl>")
}

/// Returns the tables of drivers and of freedoms, each with its heading.
fn drivers(mechanism: &Mechanism, ranges: &[Option<Range>]) -> String {
    let mut rows = [Vec::new(), Vec::new()];
    for (index, (driver, range)) in mechanism.drivers.iter().zip(ranges).enumerate() {
        let kind = driver.coordinate.kind;
        let value = |value: f64| with_unit(kind, value);
        let start = match driver.source {
            DriverSource::Input { start } => value(start),
            DriverSource::Free {
                start, velocity, ..
            } if velocity != 0.0 => {
                let unit = kind.units()[1].suffix();
                format!("{}, {}{unit}", value(start), rounded(velocity, 12))
            }
            DriverSource::Free { start, .. } => value(start),
            DriverSource::Motion(_) => String::new(),
        };
        let limits = match range {
            None if driver.motion().is_some() => "prescribed by the file: no input".to_owned(),
            None => format!("biela range --driver {} finds them", driver.name),
            Some(Range { upper, lower, .. }) => match (lower, upper) {
                (End::Turns(_), End::Turns(1)) => "turns fully".to_owned(),
                (End::Turns(_), End::Turns(turns)) => {
                    format!("turns fully; the mechanism is back after {turns} turns")
                }
                _ => {
                    let end = |end| end_text(end, driver, DriverId(index));
                    format!("down to {}; up to {}", end(lower), end(upper))
                }
            },
        };
        rows[usize::from(driver.is_free())].push([
            driver.name.clone(),
            start,
            limits.replace('`', ""),
        ]);
    }
    let kinds = [
        ("Drivers", ["Driver", "Start", "Range, other drivers held"]),
        (
            "Freedoms",
            ["Freedom", "Start", "Range, all other coordinates held"],
        ),
    ];
    let shown = kinds.iter().zip(rows).filter(|(_, rows)| !rows.is_empty());
    let tables = shown.map(|((heading, header), rows)| {
        format!("<h2>{heading}</h2>\n{}\n", table(header, rows.into_iter()))
    });
    tables.collect()
}

/// Returns the table of parameters in SI units, then the folded table of settings.
fn parameters(mechanism: &Mechanism, variables: &[Variable<Quantity>], values: &[f64]) -> String {
    let header = ["Parameter", "Value", "Unit", "Limits", "Meaning"];
    let rows = variables
        .iter()
        .filter_map(|variable| parameter(mechanism, variable, values));
    let mut html = table(&header, rows);
    let settings = variables.iter().filter_map(setting);
    let settings: Vec<[String; 3]> = settings.collect();
    if !settings.is_empty() {
        let names: Vec<&str> = settings.iter().map(|row| row[0].as_str()).collect();
        let _ = write!(
            html,
            "<details><summary><b>settings</b> {}</summary>\n{}</details>\n",
            names.join(", "),
            table(&["Parameter", "Value", "Meaning"], settings.iter().cloned())
        );
    }
    html
}

/// Returns name, value and meaning of a variable that is a setting of the solver.
fn setting(variable: &Variable<Quantity>) -> Option<[String; 3]> {
    let (value, what) = match (&variable.kind, &variable.quantity) {
        (Kind::Enumeration { choices, start }, _) => {
            let items: Vec<String> = (1..)
                .zip(choices.items)
                .map(|(number, (name, what))| format!("{number} ({name}) {what}"))
                .collect();
            let what = format!("{}: {}", variable.description, items.join("; "));
            (start.to_string(), what)
        }
        (
            Kind::Real {
                start: Some(start), ..
            },
            Quantity::Budget,
        ) => (start.to_string(), meaning(variable)),
        _ => return None,
    };
    Some([variable.name.clone(), value, what])
}

/// Returns name, value, unit, limits and meaning of a variable that is a parameter.
pub(in crate::cli) fn parameter(
    mechanism: &Mechanism,
    variable: &Variable<Quantity>,
    values: &[f64],
) -> Option<[String; 5]> {
    let Kind::Real { unit, min, max, .. } = &variable.kind else {
        return None;
    };
    let value = match variable.quantity {
        Quantity::Parameter(parameter) => values[parameter.index()],
        Quantity::Weight(body, place) => mechanism.weight_at(body, values)?.numbers()[place],
        _ => return None,
    };
    let shown = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v}"));
    let limits = match (*min, *max) {
        (None, None) => String::new(),
        (min, None) => format!("≥ {}", shown(min)),
        (None, max) => format!("≤ {}", shown(max)),
        (min, max) => format!("{} to {}", shown(min), shown(max)),
    };
    Some([
        variable.name.clone(),
        // A derived value carries the rounding of its expression.
        shown(Some(rounded(value, 12))),
        name_of(*unit),
        limits,
        meaning(variable),
    ])
}

/// Returns the description of a parameter, and when it gets its value if that is not the start.
fn meaning(variable: &Variable<Quantity>) -> String {
    let mut what = variable.description.clone();
    if variable.causality == Causality::CalculatedParameter {
        what.push_str(" (derived from others)");
    } else if variable.variability == Variability::Tunable {
        what.push_str(" (may change between steps)");
    }
    what
}

/// Returns the tables of inputs and outputs, one for what each belongs to: a body, a driver, a
/// joint.
fn outputs(variables: &[Variable<Quantity>]) -> String {
    let told = variables.iter().filter(|variable| {
        matches!(
            variable.causality,
            Causality::Input
                | Causality::Output
                | Causality::StartedOutput
                | Causality::State
                | Causality::Local
        )
    });
    let mut owners: Vec<(&str, Vec<&Variable<Quantity>>)> = Vec::new();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for variable in told {
        let name = variable.name.as_str();
        let owner = name.split_once('.').map_or(name, |(owner, _)| owner);
        let place = *places.entry(owner).or_insert(owners.len());
        if place == owners.len() {
            owners.push((owner, Vec::new()));
        }
        owners[place].1.push(variable);
    }
    let mut html = String::new();
    for (owner, members) in owners {
        let parts = members.iter().map(|v| v.name.strip_prefix(owner));
        let parts: Vec<&str> = parts.filter_map(|part| part?.strip_prefix('.')).collect();
        let rows = members.iter().map(|variable| row(variable));
        let table = table(&["Variable", "Causality", "Unit", "Meaning"], rows);
        let _ = write!(
            html,
            "<details><summary><b>{}</b> {}</summary>\n{table}</details>\n",
            escape(owner),
            escape(&parts.join(", "))
        );
    }
    html
}

/// Returns name, causality, unit and meaning of a variable.
fn row(variable: &Variable<Quantity>) -> [String; 4] {
    let unit = match variable.kind {
        Kind::Real { unit, .. } => name_of(unit),
        _ => String::new(),
    };
    let causality = match variable.causality {
        Causality::Input => "input",
        Causality::Output | Causality::StartedOutput => "output",
        Causality::State => "state",
        _ => "local",
    };
    [
        variable.name.clone(),
        causality.to_owned(),
        unit,
        variable.description.replace('`', ""),
    ]
}

fn name_of(unit: Option<Unit>) -> String {
    unit.map_or_else(String::new, |unit| unit.name.to_string())
}

/// Returns a table; a word if it has no rows.
pub(in crate::cli) fn table<const N: usize>(
    header: &[&str; N],
    rows: impl Iterator<Item = [String; N]>,
) -> String {
    let mut html = String::from("<div class=\"table\"><table>\n<thead><tr>");
    for cell in header {
        let _ = write!(html, "<th scope=\"col\">{cell}</th>");
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    let mut empty = true;
    for row in rows {
        empty = false;
        html.push_str("<tr>");
        // On a telephone, without room for columns, each cell shows its header.
        for (what, cell) in header.iter().zip(row) {
            let _ = write!(html, "<td data-what=\"{what}\">{}</td>", escape(&cell));
        }
        html.push_str("</tr>\n");
    }
    if empty {
        return "<p>None.</p>".to_owned();
    }
    html.push_str("</tbody>\n</table></div>");
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documents_do_not_depend_on_the_name_of_the_file() {
        let text = include_str!("../../../../../mechanisms/pendulum.toml");
        let contents = |name: &str| -> Vec<_> {
            let source = Source::new(name, text);
            let (mechanism, _) = Mechanism::parse(&source).expect("it is the example");
            let mechanism = Arc::new(mechanism);
            let input = Input { source, mechanism };
            let home = input.assemble().expect("it closes");
            let form = Form::new(Version::Fmi2, false);
            let documents = documents(&input, &home, form, Some(b"\0asm"));
            let documents = documents.expect("it can be drawn").into_iter();
            documents
                .map(|document| (document.path, document.content))
                .collect()
        };
        let first = contents("pendulum.toml");
        assert!(
            first
                .iter()
                .any(|(path, _)| path == "documentation/page.html")
        );
        assert!(first == contents("a folder/copy of it.toml"));
    }
}
