//! `biela page`

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::given::input::{Input, warn_of_misfits};
use crate::cli::given::input_files::InputFiles;
use crate::cli::given::settings::Settings;
use crate::cli::pages::live;
use crate::cli::pages::page_solver::{self, Solver};
use crate::cli::results::output::{tell_written, write};
use crate::cli::results::picture::check_page;
use crate::cli::results::stdout::is_stdout;
use crate::cli::told::error::Error;

/// Write a page on which a mechanism is moved by hand.
///
/// The page holds the solver itself and runs in any browser, without a network: one HTML file that
/// can be sent to anyone. Bodies are pulled with the mouse or a finger; drivers and parameters have
/// sliders and fields. A dead point stops the hand, a geometry that does not close names the open
/// joint. The page shows traces, velocities, accelerations, forces and charts, finds the other
/// positions in which the mechanism closes, and saves the changed file, pictures and values.
///
/// The same file gives the same page.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela page four_bar.toml -o four_bar.html")]
pub(in crate::cli) struct Page {
    /// The mechanism file.
    file: PathBuf,
    /// The page to write, `-` for stdout [default: the mechanism's name with .html in the current
    /// folder].
    #[arg(short, long, value_name = "PAGE")]
    output: Option<PathBuf>,
    /// The solver for pages, compiled to WebAssembly [default: the one installed with this
    /// program].
    #[arg(long, value_name = "WASM")]
    solver: Option<PathBuf>,
    /// Name of a script, beside the page, that takes the solver: several pages can share it.
    #[arg(long, value_name = "SCRIPT")]
    share: Option<String>,
    /// Address of a studio, such as the index.html that `biela studio --write` writes: *Edit in the
    /// studio* leads there.
    #[arg(long, value_name = "ADDRESS")]
    studio: Option<String>,
    #[command(flatten)]
    settings: Settings,
}

impl Page {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        self.output.as_deref().map_or(Ok(()), check_page)?;
        let input = self.settings.read(&self.file)?;
        let path = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{}.html", input.mechanism.name)));
        let script = self.share.as_deref().map(|script| beside(&path, script));
        let script = script.transpose()?;
        let files = InputFiles::new(&self.file, &input.mechanism);
        files.refuse_as_outputs(&[Some(&path), script.as_deref()])?;
        let wasm = match &self.solver {
            Some(file) => page_solver::read(file)?,
            None => page_solver::demand(Solver::Page)?,
        };
        warn_of_misfits(&input.assemble()?);
        let studio = self.studio.as_deref();
        let page = page(&input, &wasm, self.share.as_deref(), studio);
        write(&path, page.as_bytes())?;
        if let Some(script) = script {
            write(&script, live::shared_solver(&wasm).as_bytes())?;
        }
        tell_written(&path);
        Ok(())
    }
}

/// Returns the page of a mechanism with a solver, which stands in the script `share` beside it if there
/// is one; *Edit* leads to a `studio`.
pub(in crate::cli) fn page(
    input: &Input,
    wasm: &[u8],
    share: Option<&str>,
    studio: Option<&str>,
) -> String {
    let solver = share.map_or_else(|| live::solver(wasm), live::solver_in);
    live::page(&input.source, &input.mechanism, &solver, studio)
}

/// Returns the path of a file beside a page.
pub(in crate::cli) fn beside(page: &Path, name: &str) -> Result<PathBuf, Error> {
    let plain = Path::new(name).file_name().is_some_and(|file| file == name);
    if !plain || is_stdout(page) {
        return Err(Error::Usage(format!(
            "--share: `{name}` must be the plain name of a file, beside a page that is a file"
        )));
    }
    Ok(page.parent().unwrap_or(Path::new("")).join(name))
}
