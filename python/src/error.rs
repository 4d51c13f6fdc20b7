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

impl Failure {
    /// Returns the exception of the package.
    pub(crate) fn raise(self, py: Python<'_>) -> PyErr {
        let (class, message) = match self {
            Self::Usage(message) => ("UsageError", message),
            Self::Assembly(message) => ("AssemblyError", message),
            Self::File(message) => ("FileError", message),
        };
        exception(py, class, (message,))
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
