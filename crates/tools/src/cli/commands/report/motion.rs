//! The motion in a report: a chart over time, the events, and what the freedoms do near their equilibrium.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::picture;
use crate::cli::at_rest::AtRest;
use crate::cli::commands::check::oscillations;
use crate::cli::given::conditions::Scenario;
use crate::cli::given::input::Input;
use crate::cli::given::signals::Signals;
use crate::cli::given::times::Times;
use crate::cli::motion::SignalledMotion;
use crate::cli::results::column::{self, Output};
use crate::cli::results::picture::Format;
use crate::cli::results::plot::Plot;
use crate::cli::results::recorder::Recorder as _;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::drawing::svg::escape;
use biela::kinematics::Solver;

/// Most rows of the chart: more than its width in pixels show nothing further.
const MOST_ROWS: u64 = 2_000;
/// Most events that are listed.
const MOST_EVENTS: usize = 40;

/// Returns the motion from start to stop, if something moves by itself: nothing for a mechanism whose
/// drivers are inputs. `told` takes what is worth knowing of it.
pub(super) fn motion(
    input: &Input,
    scenario: &Scenario,
    told: &mut Vec<Message>,
) -> Result<String, Error> {
    let mechanism = scenario.mechanism.clone();
    if !mechanism.has_freedoms() && !mechanism.uses_time() {
        return Ok(String::new());
    }
    let start = scenario.start;
    let columns = column::plotted(&Output::all(&mechanism));
    let needs = |is_needed: fn(&Output) -> bool| columns.iter().any(is_needed);
    let [forces, reactions] = [Output::uses_forces, Output::uses_reactions].map(needs);
    let refuse = |error| input.error_at(start, &error);
    let at_start = || scenario.solver(input.assemble()?).map_err(refuse);
    let moving = SignalledMotion::from(at_start()?, Signals::default(), start);
    let mut moving = moving.map_err(refuse)?;
    if forces {
        moving = moving.with_forces(reactions).map_err(refuse)?;
    }
    let mut moving = moving.with_freedoms().map_err(|why| Error::Stopped {
        file: input.source.name().to_owned(),
        why: why.to_string(),
    })?;
    let mut plot = Plot::new(PathBuf::new(), Format::Svg, columns, true, None);
    let times = Times::of_file(&mechanism, MOST_ROWS);
    let mut lines = Vec::new();
    for row in 0..=times.steps {
        if let Err(why) = moving.advance(times.at(row)) {
            lines.push(format!("The motion ends: {why}."));
            break;
        }
        plot.add(&moving.motion)?;
    }
    let events = moving.events.iter().take(MOST_EVENTS);
    lines.extend(events.map(|event| event.describe(&mechanism)));
    if let Some(more) = moving.events.len().checked_sub(MOST_EVENTS + 1) {
        lines.push(format!("{} more events", more + 1));
    }
    lines.extend(moving.describe_integration());
    let chart = picture(&plot.sheet(&mechanism, &moving.events));
    let mut html = format!("<h2>Motion</h2>\n<figure>\n{chart}\n</figure>\n");
    html += &list(&lines);
    let is_warning = |message: &Message| matches!(message, Message::Warning(_));
    told.extend(moving.notices.into_iter().filter(is_warning));
    if mechanism.has_freedoms() {
        html += &equilibrium(input, at_start()?)?;
    }
    Ok(html)
}

/// Returns the equilibrium to which the freedoms come down from the start, and how they move near it.
fn equilibrium(input: &Input, solver: Solver) -> Result<String, Error> {
    let mut at = AtRest::begin(input.source.name(), solver, Signals::default())?;
    let mut lines = Vec::new();
    match at.balance().and_then(|_| oscillations(&mut at)) {
        Ok(roots) => {
            let pose = at.motion.pose();
            let drivers = at.motion.mechanism().drivers.iter().zip(&pose.drivers);
            let free = drivers.filter(|(driver, _)| driver.is_free());
            lines.extend(free.map(|(driver, value)| {
                format!("{} = {}", driver.name, driver.coordinate.kind.show(*value))
            }));
            lines.extend(roots.lines().map(|line| line.trim().to_owned()));
        }
        Err(error) => lines.push(error.to_string()),
    }
    Ok(format!("<h3>Equilibrium</h3>\n{}", list(&lines)))
}

/// Returns lines as a list.
fn list(lines: &[String]) -> String {
    let mut html = "<ul>".to_owned();
    for line in lines {
        let _ = write!(html, "<li>{}</li>", escape(&line.replace('`', "")));
    }
    html + "</ul>\n"
}
