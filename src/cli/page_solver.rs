//! The solver for pages, compiled to WebAssembly.

use std::borrow::Cow;
use std::path::Path;

use super::error::Error;

include!(concat!(env!("OUT_DIR"), "/embedded_solver.rs"));

/// Returns the solver in `file` if one is given, otherwise the one installed with this program, if
/// there is one: `../lib/biela/page.wasm` beside it, the one that the program carries, or the one
/// that `make page` built together with a program in `target/release`.
pub(super) fn find(file: Option<&Path>) -> Result<Option<Cow<'static, [u8]>>, Error> {
    if let Some(file) = file {
        return read(file).map(Some);
    }
    let program = std::env::current_exe().unwrap_or_default();
    let programs = program.parent().unwrap_or(Path::new(""));
    let installed = programs.join("../lib/biela/page.wasm");
    if installed.is_file() {
        return read(&installed).map(Some);
    }
    if let Some(solver) = EMBEDDED_SOLVER {
        return Ok(Some(Cow::Borrowed(solver)));
    }
    let built = programs.join("../runtimes/page.wasm");
    // Tests of debug builds must not depend on what else was built.
    if !cfg!(debug_assertions) && built.is_file() {
        return read(&built).map(Some);
    }
    Ok(None)
}

/// Returns the solver of [`find`]; its absence is an error.
pub(super) fn demand(file: Option<&Path>) -> Result<Cow<'static, [u8]>, Error> {
    find(file)?.ok_or_else(|| {
        Error::Usage(
            "no solver for pages was found beside this program: run `make page` and `make \
             install`, or name it with --solver; `biela run --animate` writes a page that plays a \
             motion"
                .to_owned(),
        )
    })
}

fn read(path: &Path) -> Result<Cow<'static, [u8]>, Error> {
    let content = std::fs::read(path).map_err(Error::read(path))?;
    if !content.starts_with(b"\0asm") {
        return Err(Error::Usage(format!(
            "`{}` is no solver for pages: it does not begin as WebAssembly does",
            path.display()
        )));
    }
    Ok(Cow::Owned(content))
}
