//! `biela platforms`

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use crate::cli::results::output::print;
use crate::cli::runtime;
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
        let found = runtime::find(self.runtime.as_deref())?;
        let mut text = String::new();
        for platform in Platform::ALL {
            let found = found.iter().find(|f| f.library.platform == platform);
            let (library, needs) = match found {
                None => ("-".to_owned(), None),
                Some(found) => (
                    found.path.as_ref().map_or_else(
                        || "in this program".to_owned(),
                        |path| path.display().to_string(),
                    ),
                    found.glibc(),
                ),
            };
            let needs = needs.map_or_else(String::new, |version| format!(", glibc {version}"));
            let system = format!("{}{needs}", platform.system);
            let _ = writeln!(text, "{:<16}{system:<34}{library}", platform.name);
        }
        print(&text)
    }
}
