//! Commands as functions, for programs without a command line. Their errors are the texts that the
//! program shows.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use super::commands::check::json::report_on;
use super::commands::convert::converted;
use super::commands::export::{NO_SYSTEM, model_description, pack, platform, system, version};
use super::commands::new::{templates, write_new};
pub use super::commands::platforms::PlatformRow;
use super::commands::platforms::rows;
use super::commands::range::{self, FoundRange, LargestForces, check_speed};
use super::commands::{import, page, report};
use super::given::conditions::Scenario;
use super::given::input::Input;
use super::given::settings::check_limits;
use super::given::signals::Signals;
use super::given::{assigning, bounds};
use super::pages::documentation::show;
use super::pages::{live, page_solver};
use super::results::form::Form;
use super::results::picture::Format;
use super::runtime;
use super::told::error::Error;
use crate::drawing::Sheet;
use crate::drawing::animation::moving_gif;
use biela::fmi::{Platform, RuntimeLibrary, Version};
use biela::kinematics::{End, Extreme, Range, Solver};
use biela::mechanism::{DriverId, Mechanism, ParameterId, Source};

/// A call that could not do its work, with the text that the program shows.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failed {
    /// An argument is wrong.
    #[error("{0}")]
    Usage(String),
    /// The mechanism does not assemble or move.
    #[error("{0}")]
    Mechanism(String),
    /// A file cannot be read or written.
    #[error("{0}")]
    File(String),
}

impl From<Error> for Failed {
    fn from(error: Error) -> Self {
        let text = error.to_string();
        match error {
            Error::Usage(_) => Self::Usage(text),
            Error::Diagnosed | Error::Mechanism { .. } | Error::Stopped { .. } => {
                Self::Mechanism(text)
            }
            _ => Self::File(text),
        }
    }
}

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

/// Writes a copy of the mechanism `from` that comes with biela under another name, as `biela new` does,
/// and returns its path.
///
/// # Errors
///
/// There is no such mechanism, the name is none, or a file is there already or cannot be written.
pub fn new(name: &str, from: &str, folder: &Path) -> Result<PathBuf, Failed> {
    Ok(write_new(name, from, folder)?)
}

/// Reads a mechanism of another program as `biela import` does: a file, or a link of PMKS+ itself,
/// whose lengths have the unit of this name where it does not tell it. Returns the mechanism's name,
/// the text of its file, and remarks.
///
/// # Errors
///
/// The file cannot be read, or is no mechanism.
pub fn import(file: &Path, length: Option<&str>) -> Result<(String, String, Vec<String>), Failed> {
    let (draft, text) = import::read(file, length)?;
    let notes = draft.notes.iter().map(ToString::to_string).collect();
    Ok((draft.mechanism_name(), text, notes))
}

/// Returns the file that `biela convert` writes for another program at a solver's pose, with remarks.
///
/// # Errors
///
/// There is no such program, or it cannot have the mechanism.
pub fn convert(to: &str, solver: &Solver) -> Result<(String, Vec<String>), Failed> {
    let (text, notes) = converted(to, solver).map_err(Failed::Usage)?;
    Ok((text, notes.iter().map(ToString::to_string).collect()))
}

/// Returns the page of `biela report` on a mechanism, `driven` by other motions and with these
/// parameters \[SI\], and warnings.
///
/// # Errors
///
/// The mechanism does not assemble at its start, or cannot rest there.
pub fn report(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    driven: &Arc<Mechanism>,
    parameters: &[f64],
) -> Result<(String, Vec<String>), Failed> {
    let scenario = Scenario {
        mechanism: Arc::clone(driven),
        parameters: parameters.to_vec(),
        signals: Signals::default(),
        start: mechanism.simulation.start,
    };
    let (page, told) = report::page(&input(source, mechanism), &scenario)?;
    let told = told.into_iter().map(|message| message.text().to_owned());
    Ok((page, told.collect()))
}

/// Returns the page of `biela page` with the solver of a file, or the one of this program; with `share`
/// the script of this name beside the page takes the solver, and is returned too. *Edit* leads to the
/// address `studio`.
///
/// # Errors
///
/// The mechanism does not assemble, or there is no solver.
pub fn page(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    (path, share): (&Path, Option<&str>),
    solver: Option<&Path>,
    studio: Option<&str>,
) -> Result<Vec<(PathBuf, String)>, Failed> {
    let input = input(source, mechanism);
    let script = share.map(|name| page::beside(path, name)).transpose()?;
    let wasm = match solver {
        Some(file) => page_solver::read(file)?,
        None => page_solver::demand(page_solver::Solver::Page)?,
    };
    input.assemble()?;
    let script = script.map(|script| (script, live::shared_solver(&wasm)));
    let page = (path.to_owned(), page::page(&input, &wasm, share, studio));
    Ok([page].into_iter().chain(script).collect())
}

/// Returns a picture in the format of the extension of `file`, SVG or PNG; `width` is in pixels, by
/// default the usual one.
///
/// # Errors
///
/// There is no such format, or no PNG of this width.
pub fn picture(
    file: &Path,
    sheet: &Sheet,
    width: Option<u32>,
    transparent: bool,
) -> Result<Vec<u8>, Failed> {
    let format = Format::of(file)?;
    let width = width.unwrap_or(format.width(sheet.width()));
    Ok(format.picture(sheet, width, transparent)?)
}

/// The range of a driver, and all that `biela range` tells of it.
#[derive(Clone, Debug)]
pub struct ToldRange {
    /// The range.
    pub range: Range,
    /// By computed measure its values at the samples, not numbers where it has none, and its least and
    /// greatest value, infinite where it grows without bound.
    pub derived: Vec<(Vec<f64>, Option<[Extreme; 2]>)>,
    /// Largest effort of the driver \[N or N m\], infinite where it grows without bound.
    pub effort: Option<Extreme>,
    /// Largest force in a joint \[N\], infinite where it grows without bound, and the joint.
    pub reaction: Option<(Extreme, Option<usize>)>,
    /// Places where there are no forces, and why, in words.
    pub without_forces: Option<String>,
}

/// Finds the range of a driver from a solver's pose, with its forces at a speed \[m/s or rad/s\], by
/// default at rest. The pose is restored. `names` are those of both bounds and of the speed, for errors.
///
/// # Errors
///
/// The bounds are not in order or out of reach, or the speed has no effect.
pub fn range(
    solver: &mut Solver,
    driver: DriverId,
    bounds: [Option<f64>; 2],
    speed: Option<f64>,
    [first, second, name]: [&str; 3],
) -> Result<ToldRange, Failed> {
    let mechanism = Arc::clone(solver.mechanism());
    check_order(bounds, [first, second])?;
    check_speed(speed, &mechanism, name)?;
    let found = FoundRange::new(solver, driver, bounds, speed, [first, second]);
    let found = found.map_err(Failed::Mechanism)?;
    let forces = found.forces.as_ref();
    Ok(ToldRange {
        derived: (found.derived.into_iter())
            .map(|measure| (measure.values, measure.extremes))
            .collect(),
        effort: forces.and_then(LargestForces::effort),
        reaction: forces.and_then(LargestForces::reaction),
        without_forces: forces.and_then(|forces| forces.without(&mechanism, driver)),
        range: found.range,
    })
}

/// Checks that the first of two bounds, which have these names, is less than the second.
///
/// # Errors
///
/// It is not.
pub fn check_order(bounds: [Option<f64>; 2], names: [&str; 2]) -> Result<(), Failed> {
    Ok(bounds::check_order(bounds, names)?)
}

/// Returns the platforms of `biela platforms`, with the libraries in a folder or those of this program.
///
/// # Errors
///
/// A library cannot be read, or there is none.
pub fn platforms(folder: Option<&Path>) -> Result<Vec<PlatformRow>, Failed> {
    Ok(rows(folder)?)
}

/// Returns the report of `biela check --format json` on a mechanism.
#[must_use]
pub fn check(source: &Source, modes: bool) -> Value {
    report_on(source, modes)
}

/// Options of `biela export`.
#[derive(Clone, Debug, Default)]
pub struct ArchiveOptions<'a> {
    /// Version of FMI: `2` or `3`.
    pub fmi: &'a str,
    /// Whether an FMU of FMI 2.0 has terminals; one of FMI 3.0 always has.
    pub terminals: bool,
    /// Folder of runtime libraries; those of this program without one.
    pub runtime: Option<&'a Path>,
    /// Names of platforms; all without any.
    pub platforms: Vec<&'a str>,
    /// Whether the page on which the mechanism is moved by hand stays away.
    pub no_page: bool,
    /// Whether a system of SSP 1.0 holds the FMU.
    pub ssp: bool,
}

/// Returns the FMU, or the system, that `biela export` writes.
///
/// # Errors
///
/// The mechanism does not assemble, there is no such version, or no library for a platform.
pub fn archive(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    options: &ArchiveOptions<'_>,
) -> Result<Vec<u8>, String> {
    let names = options.platforms.iter().copied();
    let platforms: Vec<Platform> = names.map(platform).collect::<Result<_, _>>()?;
    let form = Form::new(version(options.fmi)?, options.terminals);
    if options.ssp && form.version == Version::Fmi3 {
        return Err(format!("ssp: {NO_SYSTEM}"));
    }
    let find = || {
        let found = runtime::narrow(runtime::find(options.runtime)?, &platforms)?;
        let libraries: Vec<_> = found.into_iter().map(|found| found.library).collect();
        let page = if options.no_page {
            None
        } else {
            page_solver::find(page_solver::Solver::Page)?
        };
        Ok((libraries, page))
    };
    let (libraries, page) = find().map_err(|error: Error| error.to_string())?;
    let fmu = archive_of(source, mechanism, form, &libraries, page.as_deref())?;
    if !options.ssp {
        return Ok(fmu);
    }
    system(mechanism, &fmu).map_err(|error| error.to_string())
}

/// Returns the modelDescription.xml of the FMU for version `2` or `3` of FMI.
///
/// # Errors
///
/// The mechanism does not assemble, or there is no such version.
pub fn model_description_of(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    fmi: &str,
) -> Result<Vec<u8>, Failed> {
    let version = version(fmi).map_err(Failed::Usage)?;
    let solver = input(source, mechanism).assemble()?;
    Ok(model_description(mechanism, &solver, version)?)
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
    let mut solver = input(source, mechanism)
        .assemble()
        .map_err(|error| error.to_string())?;
    let shown = show(&mut solver).map_err(|error| error.to_string())?;
    Ok(moving_gif(&shown.animation))
}

fn input(source: &Source, mechanism: &Arc<Mechanism>) -> Input {
    Input {
        source: source.clone(),
        mechanism: Arc::clone(mechanism),
    }
}

fn archive_of(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    form: Form,
    libraries: &[RuntimeLibrary],
    page: Option<&[u8]>,
) -> Result<Vec<u8>, String> {
    let input = input(source, mechanism);
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
