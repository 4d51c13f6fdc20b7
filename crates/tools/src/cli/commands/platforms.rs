//! `biela platforms`

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::results::output::print;
use crate::cli::runtime::{self, FoundLibrary};
use crate::cli::told::error::Error;
use biela::fmi::Platform;

/// List the platforms that exported FMUs run on.
///
/// An FMU runs on the platforms whose runtime libraries are installed when it is exported: each
/// export packs them all. The list tells for each platform where its library is, and for Linux the
/// oldest C library (glibc) that it runs with.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela platforms")]
pub(in crate::cli) struct Platforms {
    /// Folder of runtime libraries, one subfolder per platform: linux64/biela.so, win64/biela.dll
    /// [default: those installed with this program].
    #[arg(long, value_name = "FOLDER")]
    runtime: Option<PathBuf>,
}

impl Platforms {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let mut text = String::new();
        for row in rows(self.runtime.as_deref())? {
            let needs = row
                .glibc
                .map_or_else(String::new, |version| format!(", glibc {version}"));
            let system = format!("{}{needs}", row.system);
            let library = row.library.as_deref().unwrap_or("-");
            let _ = writeln!(text, "{:<16}{system:<34}{library}", row.name);
        }
        print(&text)
    }
}

/// A platform, and what an FMU has for it.
#[derive(Clone, Debug)]
pub struct PlatformRow {
    /// Name of the platform.
    pub name: &'static str,
    /// Operating system and processor.
    pub system: &'static str,
    /// Oldest version of glibc with which the library runs, if it uses one.
    pub glibc: Option<String>,
    /// Place of the library, in words; `None` without one.
    pub library: Option<String>,
}

/// Returns all platforms, with the libraries in a folder, or those installed with this program.
pub(in crate::cli) fn rows(folder: Option<&Path>) -> Result<Vec<PlatformRow>, Error> {
    let found = runtime::find(folder)?;
    let rows = Platform::ALL.into_iter().map(|platform| {
        let found = found.iter().find(|f| f.library.platform == platform);
        PlatformRow {
            name: platform.name,
            system: platform.system,
            glibc: found.and_then(FoundLibrary::glibc),
            library: found.map(|found| {
                found.path.as_ref().map_or_else(
                    || "in this program".to_owned(),
                    |path| path.display().to_string(),
                )
            }),
        }
    });
    Ok(rows.collect())
}
