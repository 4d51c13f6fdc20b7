//! The Python module `biela._biela`: what the package `biela` computes in Rust.
//!
//! | file | subject |
//! |---|---|
//! | `error` | errors as exceptions of the package |
//! | `call` | the work of a call: without the interpreter's lock, until Ctrl-C; panics as errors |
//! | `scenario` | parameters, and motions of drivers as samples |
//! | `runner` | a mechanism that moves along samples |
//! | `events` | events of free motions as columns |
//! | `run`, `film` | one motion with its gradients; its animation |
//! | `sweep` | the same motion of many variants, on all cores |
//! | `timing`, `follower` | drivers whose values are free; a mechanism that follows targets |
//! | `fit`, `attempt` | targets: costs of many variants; unknowns that a fit improves |
//! | `mechanism`, `rows` | the class `Mechanism`; what it returns as tuples |
//!
//! Shapes, units and names of Python are the package's business; here arrays are flat.

mod attempt;
mod call;
mod error;
mod events;
mod film;
mod fit;
mod follower;
mod mechanism;
mod rows;
mod run;
mod runner;
mod scenario;
mod sweep;
mod timing;

use std::ffi::OsString;
use std::path::PathBuf;

use biela_tools::cli;
use pyo3::prelude::*;

use crate::call::apart;
use crate::error::Failure;

/// A platform: name, system, oldest glibc, place of the library.
type PlatformTuple = (&'static str, &'static str, Option<String>, Option<String>);

/// Runs the program with these arguments, the first being its own name; returns its exit status.
#[pyfunction]
fn program(py: Python<'_>, arguments: Vec<OsString>) -> Result<u8, Failure> {
    apart(py, || Ok(cli::status(arguments)))
}

/// Fails as a defect of biela would; for tests, not in wheels.
#[cfg(debug_assertions)]
#[pyfunction]
fn defect(py: Python<'_>) -> Result<(), Failure> {
    apart(py, || panic!("a test"))
}

/// Says that a name is unknown, with the known name that may be meant.
#[pyfunction]
fn unknown_name(kind: &str, name: &str, known: Vec<String>) -> String {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    cli::unknown_name(kind, name, &known)
}

/// Returns the names of the mechanisms that come with biela.
#[pyfunction]
fn shipped() -> Vec<&'static str> {
    cli::shipped().collect()
}

/// Returns the text of a mechanism that comes with biela.
#[pyfunction]
fn shipped_text(name: &str) -> Result<&'static str, Failure> {
    let found = cli::shipped_text(name).map_err(Failure::Usage);
    found.map(|(text, _)| text)
}

/// Writes a copy of a mechanism that comes with biela under another name; returns its path.
#[pyfunction]
fn new(name: &str, template: &str, folder: PathBuf) -> Result<PathBuf, Failure> {
    Ok(cli::new(name, template, &folder)?)
}

/// Reads a mechanism of another program; returns its name, the text of its file, and remarks.
#[pyfunction]
fn import_mechanism(
    py: Python<'_>,
    file: PathBuf,
    length: Option<&str>,
) -> Result<(String, String, Vec<String>), Failure> {
    apart(py, || Ok(cli::import(&file, length)?))
}

/// Returns the platforms of FMUs: name, system, oldest glibc, and the place of the library.
#[pyfunction]
fn platforms(runtime: Option<PathBuf>) -> Result<Vec<PlatformTuple>, Failure> {
    let rows = cli::platforms(runtime.as_deref())?.into_iter();
    Ok(rows
        .map(|row| (row.name, row.system, row.glibc, row.library))
        .collect())
}

/// Returns the JSON Schema of mechanism files.
#[pyfunction]
fn schema() -> String {
    format!("{:#}\n", biela::mechanism::Mechanism::schema())
}

#[pymodule]
fn _biela(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(program, module)?)?;
    module.add_function(wrap_pyfunction!(unknown_name, module)?)?;
    module.add_function(wrap_pyfunction!(shipped, module)?)?;
    module.add_function(wrap_pyfunction!(new, module)?)?;
    module.add_function(wrap_pyfunction!(import_mechanism, module)?)?;
    module.add_function(wrap_pyfunction!(platforms, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(shipped_text, module)?)?;
    #[cfg(debug_assertions)]
    module.add_function(wrap_pyfunction!(defect, module)?)?;
    module.add_class::<mechanism::Mechanism>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<sweep::Sweep>()?;
    module.add_class::<fit::Targets>()?;
    module.add_class::<attempt::Attempt>()
}
