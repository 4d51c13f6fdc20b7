//! `biela export`

use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use clap::Args;

use crate::cli::given::input::{Input, warn_of_misfits};
use crate::cli::given::input_files::InputFiles;
use crate::cli::given::settings::Settings;
use crate::cli::pages::documentation;
use crate::cli::pages::page_solver;
use crate::cli::results::form::Form;
use crate::cli::results::output::write;
use crate::cli::results::stdout::is_stdout;
use crate::cli::runtime::{self, FoundLibrary};
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, tell};
use crate::exchange::write_ssp;
use biela::dynamics::KeptStart;
use biela::fmi::{Platform, RuntimeLibrary, Version, describe, variables, write_fmu};
use biela::kinematics::Solver;
use biela::mechanism::Mechanism;

/// Reason why there is no system with an FMU of FMI 3.0.
pub(in crate::cli) const NO_SYSTEM: &str = "a system of SSP 1.0 holds FMUs of FMI 2.0";

/// Export a mechanism as an FMU, for co-simulation and for model exchange.
///
/// The FMU's inputs are the drivers without a prescribed motion, its parameters those of the
/// file, its outputs position, velocity and acceleration of all bodies. The mechanism is
/// assembled first; one that does not close is not exported.
///
/// The FMU contains its picture (model.png; with --fmi 3 documentation/diagram.png) and its
/// documentation (documentation/index.html): the mechanism in motion, its variables and parameters,
/// the limits of its drivers. If the solver for
/// pages is installed, documentation/page.html is the page of `biela page`.
///
/// The FMU runs on the platforms that `biela platforms` lists with a library.
///
/// The same file and the same libraries give the same bytes. Only if the environment variable SOURCE_DATE_EPOCH gives
/// a time (seconds since 1970) does the model description say when it was generated.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
        biela export four_bar.toml -o four_bar.fmu\n  \
        biela export four_bar.toml --ssp")]
pub(in crate::cli) struct Export {
    /// The mechanism file.
    file: PathBuf,
    /// The FMU to write, `-` for stdout [default: the mechanism's name with .fmu, with --ssp .ssp, in
    /// the current folder].
    #[arg(short, long, value_name = "FMU")]
    output: Option<PathBuf>,
    /// Version of FMI: 2 for FMI 2.0, 3 for FMI 3.0. The library in the FMU is the same.
    #[arg(long, value_name = "VERSION", default_value = "2", value_parser = version)]
    fmi: Version,
    /// Write only the FMU's modelDescription.xml to this file, `-` for stdout.
    #[arg(long, value_name = "XML", conflicts_with = "output")]
    model_description: Option<PathBuf>,
    /// Folder of runtime libraries, one subfolder per platform: linux64/biela.so, win64/biela.dll
    /// [default: those installed with this program].
    #[arg(long, value_name = "FOLDER")]
    runtime: Option<PathBuf>,
    /// Platforms that the FMU shall run on, separated by commas [default: all of which there is a
    /// runtime library].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = platform,
        conflicts_with = "model_description")]
    platforms: Vec<Platform>,
    /// Add terminals and an icon to an FMU of FMI 2.0, for hosts that read them there; an FMU of
    /// FMI 3.0 always has them.
    #[arg(long, conflicts_with = "model_description")]
    terminals: bool,
    /// Write a system of SSP 1.0, a file .ssp, which holds the FMU and the values of its parameters
    /// with their units; for hosts that connect FMUs.
    #[arg(long, conflicts_with = "model_description")]
    ssp: bool,
    /// Leave out the page on which the mechanism is moved by hand.
    #[arg(long, conflicts_with = "model_description")]
    no_page: bool,
    #[command(flatten)]
    settings: Settings,
}

impl Export {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let input = self.settings.read(&self.file)?;
        let mechanism = &input.mechanism;
        let mut files = InputFiles::new(&self.file, mechanism);
        if let Some(path) = self.model_description {
            files.refuse_as_outputs(&[Some(&path)])?;
            let solver = assemble(&input)?;
            let description = model_description(mechanism, &solver, self.fmi)?;
            return write(&path, &description);
        }
        if self.ssp && self.fmi == Version::Fmi3 {
            return Err(Error::Usage(format!(
                "--ssp: {NO_SYSTEM}; leave out --fmi 3"
            )));
        }
        let extension = if self.ssp { "ssp" } else { "fmu" };
        let path = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{}.{extension}", mechanism.name)));
        let found = runtime::find(self.runtime.as_deref())?;
        let found = runtime::narrow(found, &self.platforms)?;
        for library in found.iter().filter_map(|found| found.path.as_deref()) {
            files.add("a runtime library", library);
        }
        let mut packed = packed(&found, self.fmi, !self.platforms.is_empty());
        let libraries: Vec<_> = found.into_iter().map(|found| found.library).collect();
        files.refuse_as_outputs(&[Some(&path)])?;
        let solver = assemble(&input)?;
        warn_of_old(&libraries);
        let page = if self.no_page {
            None
        } else {
            page_solver::find(page_solver::Solver::Page)?
        };
        if page.is_none() && !self.no_page {
            packed += "; no page to move by hand: no solver for pages is installed";
        }
        let form = Form::new(self.fmi, self.terminals);
        let mut content = pack(&input, &solver, form, &libraries, page.as_deref())?;
        if self.ssp {
            content = system(mechanism, &content)?;
        }
        write(&path, &content)?;
        let name = if is_stdout(&path) {
            "stdout".into()
        } else {
            path.to_string_lossy()
        };
        tell(format_args!("wrote {name} ({packed})"));
        Ok(())
    }
}

/// Says which platforms libraries are for, each with what it needs there; then, unless the platforms
/// were `chosen`, which ones are left out.
fn packed(libraries: &[FoundLibrary], version: Version, chosen: bool) -> String {
    let names = libraries.iter().map(|found| {
        let name = found.library.platform.folder(version);
        match found.glibc() {
            Some(glibc) => format!("{name}, glibc {glibc} or newer"),
            None => name.to_owned(),
        }
    });
    let mut parts: Vec<String> = names.collect();
    let is_packed = |platform: &Platform| libraries.iter().any(|f| f.library.platform == *platform);
    let missing = Platform::ALL
        .into_iter()
        .filter(|platform| !is_packed(platform));
    let missing: Vec<&str> = missing.map(|platform| platform.folder(version)).collect();
    if !chosen && !missing.is_empty() {
        parts.push(format!("not {}", missing.join(", ")));
    }
    parts.join("; ")
}

/// Warns of libraries of other versions of biela.
fn warn_of_old(libraries: &[RuntimeLibrary]) {
    for library in libraries.iter().filter(|library| !library.is_current()) {
        let name = library.platform.name;
        let version = env!("CARGO_PKG_VERSION");
        let warning = format!(
            "the library for {name} is of another version of biela than {version}: install that of \
             {version}, as docs/install.md says"
        );
        Message::Warning(warning).show();
    }
}

/// Returns the FMU of a mechanism, which `solver` has assembled; with a page if the solver for pages
/// is given.
pub(in crate::cli) fn pack(
    input: &Input,
    solver: &Solver,
    form: Form,
    libraries: &[RuntimeLibrary],
    page: Option<&[u8]>,
) -> Result<Vec<u8>, Error> {
    let documents = documentation::documents(input, solver, form, page)?;
    let mut description = describe(&input.mechanism, solver.structure(), form.version);
    if !form.terminals {
        description.terminals.clear();
    }
    let mut archive = Cursor::new(Vec::new());
    write_fmu(
        &mut archive,
        &input.source,
        &input.mechanism,
        &description,
        libraries,
        &documents,
        generation_time()?.as_deref(),
    )
    .map_err(Error::Archive)?;
    Ok(archive.into_inner())
}

/// Returns a system of SSP 1.0 with the FMU of a mechanism.
pub(in crate::cli) fn system(mechanism: &Arc<Mechanism>, fmu: &[u8]) -> Result<Vec<u8>, Error> {
    let mut archive = Cursor::new(Vec::new());
    write_ssp(&mut archive, mechanism, &variables(mechanism), fmu).map_err(Error::Archive)?;
    Ok(archive.into_inner())
}

/// Returns the modelDescription.xml of the FMU of a mechanism that `solver` has assembled.
pub(in crate::cli) fn model_description(
    mechanism: &Arc<Mechanism>,
    solver: &Solver,
    version: Version,
) -> Result<Vec<u8>, Error> {
    let description = describe(mechanism, solver.structure(), version);
    Ok(description.write(generation_time()?.as_deref()))
}

/// Reads the name of a platform.
pub(in crate::cli) fn platform(name: &str) -> Result<Platform, String> {
    Platform::named(name).ok_or_else(|| {
        let names = Platform::ALL.map(|platform| platform.name);
        format!("expected one of {}", names.join(", "))
    })
}

/// Reads a version of FMI.
pub(in crate::cli) fn version(text: &str) -> Result<Version, String> {
    match text {
        "2" | "2.0" => Ok(Version::Fmi2),
        "3" | "3.0" => Ok(Version::Fmi3),
        _ => Err("expected 2 or 3".to_owned()),
    }
}

/// Returns a solver at the file's own pose, where the mechanism can rest; warns of misfits and overlaps there.
fn assemble(input: &Input) -> Result<Solver, Error> {
    let mut solver = input.assemble()?;
    input.check_rest(&mut solver)?;
    warn_of_misfits(&solver);
    let kept = KeptStart::of(&input.mechanism);
    for overlap in kept.iter().flat_map(|kept| &kept.overlaps) {
        Message::Warning(overlap.describe(&input.mechanism)).show();
    }
    Ok(solver)
}

/// Returns the time in `SOURCE_DATE_EPOCH` as the schema's `dateTime`.
fn generation_time() -> Result<Option<String>, Error> {
    let value = std::env::var_os("SOURCE_DATE_EPOCH");
    let Some(value) = value.filter(|value| !value.is_empty()) else {
        return Ok(None);
    };
    value
        .to_str()
        .and_then(|text| text.parse::<u64>().ok())
        // The last second of the year 9999.
        .filter(|seconds| *seconds <= 253_402_300_799)
        .map(|seconds| Some(date_time(seconds)))
        .ok_or_else(|| {
            Error::Usage(format!(
                "SOURCE_DATE_EPOCH is `{}`; expected seconds since 1970",
                value.display()
            ))
        })
}

/// Returns seconds since 1970 as `2026-11-21T03:46:00Z`.
fn date_time(seconds: u64) -> String {
    let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
    humantime::format_rfc3339_seconds(time).to_string()
}

#[cfg(test)]
mod tests {
    use super::date_time;

    // The pairs come from `date -u -d @SECONDS`.
    #[test]
    fn dates() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_799, "2000-02-29T23:59:59Z"),
            (1_704_067_199, "2023-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
            (253_402_300_799, "9999-12-31T23:59:59Z"),
        ] {
            assert_eq!(date_time(seconds), expected);
        }
    }
}
