//! Choices among the columns of a run.

use crate::cli::given::assigning::unknown;
use crate::cli::told::error::Error;
use biela::kinematics::ForceQuantity;
pub(in crate::cli) use biela::kinematics::{Output, OutputSource as Source};
use biela::mechanism::{BodyId, MarkerId, Mechanism, Order, Signal, help, in_our_words};

/// Returns the columns of these names: of a variable, or of a body, marker, driver or measure
/// with all its variables.
pub(in crate::cli) fn named(
    columns: &[Output],
    names: &[String],
    mechanism: &Mechanism,
) -> Result<Vec<Output>, Error> {
    let names = names.iter().map(|name| name.trim());
    let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
    if names.is_empty() {
        return Err(Error::Usage("--variables: no variable is named".to_owned()));
    }
    let exists = |name| columns.iter().any(|column| belongs_to(&column.name, name));
    if let Some(name) = names.iter().find(|name| !exists(name)) {
        let why = why_no_output(name, mechanism)
            .unwrap_or_else(|| format!("there is no `{name}`{}", suggestion(name, columns)));
        return Err(Error::Usage(format!("--variables: {why}")));
    }
    let is_named = |c: &&Output| names.iter().any(|name| belongs_to(&c.name, name));
    Ok(columns.iter().filter(is_named).cloned().collect())
}

/// Returns the column for the x-axis of a plot: a variable, or the position of a driver or
/// measure of this name.
pub(in crate::cli) fn over(columns: &[Output], name: &str) -> Result<Output, Error> {
    let name = name.trim();
    let position = format!("{name}.{}", Order::Position.suffix());
    let mut columns_so_called = columns
        .iter()
        .filter(|c| c.name == name || c.name == position);
    columns_so_called.next().cloned().ok_or_else(|| {
        let names = columns
            .iter()
            .map(|column| column.name.trim_end_matches(".position"));
        unknown("--over", "variable", name, &names.collect::<Vec<_>>())
    })
}

/// Returns the columns that a plot shows by default: the drivers with their efforts, and of
/// measures, points of interest and bodies the first kind that the mechanism has.
pub(in crate::cli) fn plotted(columns: &[Output]) -> Vec<Output> {
    let select = |is_wanted: fn(&Source) -> bool| -> Vec<Output> {
        let wanted = columns.iter().filter(|column| is_wanted(&column.source));
        wanted.cloned().collect()
    };
    let kinds: [fn(&Source) -> bool; 3] = [
        |source| {
            let is_measure = matches!(source, Source::Signal(Signal::Measure(_), _));
            is_measure || matches!(source, Source::Derived(_))
        },
        |source| matches!(source, Source::Signal(Signal::Marker(..), _)),
        |source| matches!(source, Source::Signal(Signal::Body(..), _)),
    ];
    let mut plotted = select(|source| matches!(source, Source::Signal(Signal::Motion(_), _)));
    let further = kinds.into_iter().map(select).find(|kind| !kind.is_empty());
    plotted.extend(further.unwrap_or_default());
    let is_effort = |c: &&Output| matches!(c.source, Source::Force(ForceQuantity::Effort(_)));
    plotted.extend(columns.iter().filter(is_effort).cloned());
    plotted
}

/// Returns the columns that a film tells in numbers by default: positions of drivers, points
/// of interest and measures.
pub(in crate::cli) fn told(columns: &[Output]) -> Vec<Output> {
    let told = columns.iter().filter(|column| column.is_told());
    told.cloned().collect()
}

/// Returns whether a variable has a name, or belongs to what has it: `crank.phi` to `crank`.
fn belongs_to(variable: &str, name: &str) -> bool {
    let rest = variable.strip_prefix(name);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Says which body or marker of this name, or of which variable, is no output; nothing if there
/// is none.
fn why_no_output(name: &str, mechanism: &Mechanism) -> Option<String> {
    let outputs = &mechanism.outputs;
    let markers = (0..mechanism.markers.len()).map(MarkerId);
    let markers = markers
        .filter(|id| !outputs.markers.contains(id))
        .map(|id| ("marker", mechanism.marker_path(id), "markers"));
    let bodies = (0..mechanism.bodies.len()).map(BodyId);
    let bodies = bodies
        .filter(|id| !outputs.bodies.contains(id))
        .map(|id| ("body", mechanism.bodies[id.index()].name.clone(), "bodies"));
    let mut others = markers.chain(bodies);
    let (kind, owner, list) = others.find(|(_, owner, _)| belongs_to(name, owner))?;
    Some(format!(
        "{kind} `{owner}` is no output; list it in `{list}` of `[outputs]`"
    ))
}

/// Suggests a variable, or an owner of variables, for an unknown name.
fn suggestion(name: &str, columns: &[Output]) -> String {
    let names = || columns.iter().map(|column| column.name.as_str());
    let mut owners = Vec::new();
    for (owner, _) in names().filter_map(|name| name.split_once('.')) {
        if !owners.contains(&owner) {
            owners.push(owner);
        }
    }
    let markers = names().filter_map(|name| Some(name.rsplit_once('.')?.0));
    let mut further: Vec<&str> = markers.chain(names()).collect();
    further.dedup();
    let words = in_our_words(name, &names().collect::<Vec<_>>());
    let help = words.or_else(|| help(name, &owners, &further));
    help.map_or_else(String::new, |help| format!("; {help}"))
}
