//! The solvers for browsers, compiled to WebAssembly.

use std::borrow::Cow;
use std::path::Path;

use crate::cli::told::error::Error;

include!(concat!(env!("OUT_DIR"), "/embedded_solvers.rs"));

/// The pages that have a solver.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) enum Solver {
    /// The page of a mechanism, also inside FMUs.
    Page,
    /// The studio, whose solver also writes FMUs.
    Studio,
}

impl Solver {
    /// Returns the name of its file.
    fn file(self) -> &'static str {
        match self {
            Self::Page => "page.wasm",
            Self::Studio => "studio.wasm",
        }
    }
}

/// Returns the solver installed with this program, if there is one: in `../lib/biela` beside it, the
/// one that the program carries, or the one that `make page` or `make studio` built together with a
/// program in `target/release`.
pub(in crate::cli) fn find(solver: Solver) -> Result<Option<Cow<'static, [u8]>>, Error> {
    let program = std::env::current_exe().unwrap_or_default();
    let programs = program.parent().unwrap_or(Path::new(""));
    let installed = programs.join("../lib/biela").join(solver.file());
    if installed.is_file() {
        return read(&installed).map(Some);
    }
    let mut embedded = EMBEDDED_SOLVERS.iter();
    if let Some((_, content)) = embedded.find(|(name, _)| *name == solver.file()) {
        return Ok(Some(Cow::Borrowed(content)));
    }
    let built = programs.join("../runtimes").join(solver.file());
    // Tests of debug builds must not depend on what else was built.
    if !cfg!(debug_assertions) && built.is_file() {
        return read(&built).map(Some);
    }
    Ok(None)
}

/// Returns the solver of [`find`]; its absence is an error.
pub(in crate::cli) fn demand(solver: Solver) -> Result<Cow<'static, [u8]>, Error> {
    find(solver)?.ok_or_else(|| {
        Error::Usage(match solver {
            Solver::Page => "no solver for pages was found beside this program: install it as \
                             docs/install.md says, or name it with --solver; `biela run --animate` \
                             writes a page that plays a motion"
                .to_owned(),
            Solver::Studio => "no solver for the studio was found beside this program: install it \
                               as docs/install.md says"
                .to_owned(),
        })
    })
}

/// Reads a solver.
pub(in crate::cli) fn read(path: &Path) -> Result<Cow<'static, [u8]>, Error> {
    let content = std::fs::read(path).map_err(Error::read(path))?;
    if !content.starts_with(b"\0asm") {
        return Err(Error::Usage(format!(
            "`{}` is no solver for pages: it does not begin as WebAssembly does",
            path.display()
        )));
    }
    Ok(Cow::Owned(content))
}
