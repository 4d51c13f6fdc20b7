//! Errors as exceptions of the package.

use biela::kinematics;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// Cause of an exception.
#[derive(Debug)]
pub(crate) enum Failure {
    /// An argument of a call is wrong.
    Usage(String),
    /// The mechanism does not assemble, or its equations do not fit.
    Assembly(String),
    /// A file cannot be read or written, or an FMU cannot be made.
    File(String),
}

impl From<kinematics::Error> for Failure {
    fn from(error: kinematics::Error) -> Self {
        Self::Assembly(error.to_string())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        let (class, message) = match failure {
            Failure::Usage(message) => ("UsageError", message),
            Failure::Assembly(message) => ("AssemblyError", message),
            Failure::File(message) => ("FileError", message),
        };
        Python::attach(|py| exception(py, class, (message,)))
    }
}

/// Returns an exception of a class of the package.
pub(crate) fn exception<'py>(
    py: Python<'py>,
    class: &str,
    arguments: impl pyo3::call::PyCallArgs<'py>,
) -> PyErr {
    let raised = || -> PyResult<Bound<'py, PyAny>> {
        let class = py.import("biela.errors")?.getattr(class)?;
        class.cast_into::<PyType>()?.call1(arguments)
    };
    raised().map_or_else(|error| error, PyErr::from_value)
}
