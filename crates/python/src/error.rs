//! Errors as exceptions of the package.

use biela::kinematics;
use biela_tools::cli::Failed;
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
    /// A defect of biela: what has panicked, and where.
    Defect(String),
    /// Python raises an exception: that of Ctrl-C.
    Raised(PyErr),
    /// The call has ended before this thread was done.
    Ended,
}

impl Failure {
    /// Returns the exception's class and message; the exception itself that Python raises.
    fn told(self) -> Result<(&'static str, String), PyErr> {
        match self {
            Self::Usage(message) => Ok(("UsageError", message)),
            Self::Assembly(message) => Ok(("AssemblyError", message)),
            Self::File(message) => Ok(("FileError", message)),
            Self::Defect(what) => Ok((
                "Error",
                format!("defect in biela: {what}; please report it with the mechanism file"),
            )),
            Self::Raised(exception) => Err(exception),
            Self::Ended => Ok(("Error", "the call was ended".to_owned())),
        }
    }

    /// Returns the reason why a variant has no values.
    ///
    /// # Errors
    ///
    /// The failure itself where it is not the variant's: it ends the call.
    pub(crate) fn reason(self) -> Result<String, Self> {
        match self {
            Self::Usage(message) | Self::Assembly(message) | Self::File(message) => Ok(message),
            other => Err(other),
        }
    }
}

impl From<Failed> for Failure {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Usage(message) => Self::Usage(message),
            Failed::Mechanism(message) => Self::Assembly(message),
            other => Self::File(other.to_string()),
        }
    }
}

impl From<kinematics::Error> for Failure {
    fn from(error: kinematics::Error) -> Self {
        Self::Assembly(error.to_string())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure.told() {
            Ok((class, message)) => Python::attach(|py| exception(py, class, (message,))),
            Err(raised) => raised,
        }
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
