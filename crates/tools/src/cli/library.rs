//! Commands as functions, for programs without a command line. Their errors are the texts that the
//! program shows.

use std::path::Path;
use std::sync::Arc;

use serde_json::Value;

use super::commands::check::json::report_on;
use super::commands::export::{pack, platform, version};
use super::commands::new::templates;
use super::commands::range;
use super::given::assigning;
use super::given::input::Input;
use super::given::settings::check_limits;
use super::pages::documentation::show;
use super::pages::page_solver;
use super::results::form::Form;
use super::runtime;
use crate::drawing::animation::moving_gif;
use biela::fmi::{Platform, RuntimeLibrary};
use biela::kinematics::End;
use biela::mechanism::{DriverId, Mechanism, ParameterId, Source};

/// Tables of a mechanism: the names of their files, and their contents.
type Tables = Vec<(String, String)>;

/// Returns the names of the mechanisms that come with biela.
pub fn shipped() -> impl Iterator<Item = &'static str> {
    templates().map(|(name, ..)| name)
}

/// Returns the text and the tables of a mechanism that comes with biela, each table with the name of its
/// file.
///
/// # Errors
///
/// There is no such mechanism.
pub fn shipped_text(name: &str) -> Result<(&'static str, Tables), String> {
    let found = templates().find(|(known, ..)| *known == name);
    let Some((_, text, tables)) = found else {
        let names: Vec<&str> = shipped().collect();
        return Err(unknown_name("shipped mechanism", name, &names));
    };
    let tables = tables.iter();
    let tables = tables.map(|(file, table)| ((*file).to_owned(), (*table).to_owned()));
    Ok((text, tables.collect()))
}

/// Returns the report of `biela check --format json` on a mechanism.
#[must_use]
pub fn check(source: &Source, modes: bool) -> Value {
    report_on(source, modes)
}

/// Returns the FMU that `biela export` writes for version `2` or `3` of FMI and these platforms, all
/// without any; `terminals` adds terminals to FMI 2.0. The libraries come from the folder `runtime`,
/// or are those of this program.
///
/// # Errors
///
/// The mechanism does not assemble, there is no such version, or no library for a platform.
pub fn archive(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    fmi: &str,
    terminals: bool,
    runtime: Option<&Path>,
    platforms: &[&str],
) -> Result<Vec<u8>, String> {
    let platforms: Vec<Platform> = (platforms.iter().copied())
        .map(platform)
        .collect::<Result<_, _>>()?;
    let form = Form::new(version(fmi)?, terminals);
    let find = || {
        let found = runtime::narrow(runtime::find(runtime)?, &platforms)?;
        let libraries: Vec<_> = found.into_iter().map(|found| found.library).collect();
        Ok((libraries, page_solver::find(page_solver::Solver::Page)?))
    };
    let (libraries, page) = find().map_err(|error: super::told::error::Error| error.to_string())?;
    archive_of(source, mechanism, form, &libraries, page.as_deref())
}

/// Returns the FMU that `biela export` writes for version `2` or `3` of FMI, with these libraries,
/// and with a page if the solver for pages is given.
///
/// # Errors
///
/// The mechanism does not assemble, or there is no such version.
pub fn archive_with(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    fmi: &str,
    libraries: &[RuntimeLibrary],
    page: Option<&[u8]>,
) -> Result<Vec<u8>, String> {
    let form = Form::new(version(fmi)?, false);
    archive_of(source, mechanism, form, libraries, page)
}

/// Returns a moving picture, a GIF, of the motion that the documentation of an FMU shows.
///
/// # Errors
///
/// The mechanism does not assemble.
pub fn gif(source: &Source, mechanism: &Arc<Mechanism>) -> Result<Vec<u8>, String> {
    let input = Input {
        source: source.clone(),
        mechanism: Arc::clone(mechanism),
    };
    let mut solver = input.assemble().map_err(|error| error.to_string())?;
    let shown = show(&mut solver).map_err(|error| error.to_string())?;
    Ok(moving_gif(&shown.animation))
}

fn archive_of(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    form: Form,
    libraries: &[RuntimeLibrary],
    page: Option<&[u8]>,
) -> Result<Vec<u8>, String> {
    let input = Input {
        source: source.clone(),
        mechanism: Arc::clone(mechanism),
    };
    let solver = input.assemble().map_err(|error| error.to_string())?;
    let packed = pack(&input, &solver, form, libraries, page);
    packed.map_err(|error| error.to_string())
}

/// Returns the end of a driver's range as `biela range` describes it.
#[must_use]
pub fn describe_end(end: &End, mechanism: &Mechanism, driver: DriverId) -> String {
    range::end_text(end, &mechanism.drivers[driver.index()], driver)
}

/// Returns the value of an expression for a parameter, such as `120*mm`, with the file's values of
/// the others.
///
/// # Errors
///
/// The expression is wrong, the value is beyond the parameter's limits, or the parameter is
/// derived.
pub fn parameter_value(
    mechanism: &Mechanism,
    parameter: ParameterId,
    text: &str,
) -> Result<f64, String> {
    let expression = mechanism.parse_expression(text, None);
    let expression = expression.map_err(|error| error.message)?;
    let value = expression.value(&mechanism.default_parameters());
    check_parameter(mechanism, parameter, value)?;
    Ok(value)
}

/// Checks a value for a parameter \[SI\].
///
/// # Errors
///
/// The value is beyond the parameter's limits, or the parameter is derived.
pub fn check_parameter(
    mechanism: &Mechanism,
    parameter: ParameterId,
    value: f64,
) -> Result<(), String> {
    let parameter = &mechanism.parameters[parameter.index()];
    parameter
        .check_settable()
        .map_err(|error| error.to_string())?;
    check_limits(parameter, value)
}

/// Says that a name is unknown, with the known name that may be meant.
#[must_use]
pub fn unknown_name(kind: &str, name: &str, names: &[&str]) -> String {
    assigning::unknown_name(kind, name, names)
}
