//! Reading of a mechanism file, and its diagnostics.

use std::path::Path as FilePath;
use std::sync::Arc;

use crate::cli::render::render;
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, tell, tells_errors_only};
use biela::kinematics::{self, Path, Solver, offer_start};
use biela::mechanism::{Diagnostic, Mechanism, Severity, Source};

/// A mechanism file that was read without errors.
#[derive(Debug)]
pub(in crate::cli) struct Input {
    pub(in crate::cli) source: Source,
    pub(in crate::cli) mechanism: Arc<Mechanism>,
}

impl Input {
    /// Reads a file and shows its errors and warnings on stderr.
    pub(in crate::cli) fn read(path: &FilePath) -> Result<Self, Error> {
        Self::read_and(path, show_diagnostics)
    }

    /// Reads a file, and shows its errors or warnings by `show` if there are any.
    pub(in crate::cli) fn read_and(
        path: &FilePath,
        show: impl FnOnce(&Source, &[Diagnostic]),
    ) -> Result<Self, Error> {
        let source = Source::open(path.display().to_string(), path).map_err(|error| {
            let named = format!("{}.toml", path.display());
            if FilePath::new(&named).is_file() {
                Error::Usage(format!(
                    "cannot read `{}`: {error}; did you mean `{named}`?",
                    path.display()
                ))
            } else {
                Error::read(path)(error)
            }
        })?;
        Self::parse(source, show)
    }

    /// Reads a source, and shows its errors or warnings by `show` if there are any.
    pub(super) fn parse(
        source: Source,
        show: impl FnOnce(&Source, &[Diagnostic]),
    ) -> Result<Self, Error> {
        let (mechanism, diagnostics) = match Mechanism::parse(&source) {
            Ok((mechanism, warnings)) => (Ok(mechanism), warnings),
            Err(errors) => (Err(Error::Diagnosed), errors),
        };
        if !diagnostics.is_empty() {
            show(&source, &diagnostics);
        }
        let mechanism = Arc::new(mechanism?);
        Ok(Self { source, mechanism })
    }

    /// Checks that there are forces to show.
    pub(in crate::cli) fn check_dynamics(&self) -> Result<(), Error> {
        if self.mechanism.has_dynamics() {
            return Ok(());
        }
        Err(Error::Usage(
            "--forces: the mechanism has no forces; give bodies a `mass` or add `[forces]`"
                .to_owned(),
        ))
    }

    /// Checks that there are contacts to show.
    pub(in crate::cli) fn check_contacts(&self) -> Result<(), Error> {
        if self.mechanism.has_contacts() {
            return Ok(());
        }
        Err(Error::Usage(
            "--contacts: the mechanism has no contacts; add `[contacts]`".to_owned(),
        ))
    }

    /// Returns an error of the kinematics with the name of the file.
    pub(in crate::cli) fn error(&self, error: kinematics::Error) -> Error {
        Error::Mechanism {
            file: self.source.name().to_owned(),
            error,
        }
    }

    /// Returns an error of a run that starts at `time` \[s\], with the name of the file.
    pub(in crate::cli) fn error_at(&self, time: f64, error: &kinematics::Error) -> Error {
        Error::Stopped {
            file: self.source.name().to_owned(),
            why: error.at_start(time),
        }
    }

    /// Returns a solver at the file's own assembled pose.
    pub(in crate::cli) fn assemble(&self) -> Result<Solver, Error> {
        let path = Path::new(&self.mechanism);
        let solver = Solver::assembled(Arc::clone(&self.mechanism), &path);
        solver.map_err(|error| self.error(offer_start(error, &self.mechanism)))
    }

    /// Refuses a start at which the mechanism cannot even rest, such as one at a jump of an equation.
    pub(in crate::cli) fn check_rest(&self, solver: &mut Solver) -> Result<(), Error> {
        let file = || self.source.name().to_owned();
        cannot_rest(solver).map_or(Ok(()), |why| Err(Error::Stopped { file: file(), why }))
    }
}

/// Shows errors or warnings of a file on stderr.
pub(super) fn show_diagnostics(source: &Source, diagnostics: &[Diagnostic]) {
    if tells_errors_only() && !has_errors(diagnostics) {
        return;
    }
    tell(render(source, diagnostics, true) + "\n");
}

/// Returns whether errors are among the problems of a file.
pub(super) fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    let mut severities = diagnostics.iter().map(|found| found.severity);
    severities.any(|severity| severity == Severity::Error)
}

/// Says why the mechanism cannot rest where the solver has assembled it at the file's own values; an
/// FMU of it does not initialise. The pose stays.
pub(in crate::cli) fn cannot_rest(solver: &mut Solver) -> Option<String> {
    let mechanism = Arc::clone(solver.mechanism());
    let home = solver.pose().clone();
    let blocked = solver.track(&Path::new(&mechanism)).err();
    solver.restore(&home);
    let why = blocked?.describe(&mechanism, &home, Some(home.time), |_| true);
    Some(format!("an FMU does not initialise: {why}"))
}

/// Warns on stderr of joints whose geometry does not fit the solver's pose, and of redundant ones.
pub(in crate::cli) fn warn_of_misfits(solver: &Solver) {
    for warning in misfits(solver) {
        warning.show();
    }
}

/// Returns the warnings of [`warn_of_misfits`].
pub(in crate::cli) fn misfits(solver: &Solver) -> Vec<Message> {
    let redundancies = solver.redundancies().into_iter().map(|r| r.to_string());
    let misfits = solver
        .geometry_warnings()
        .into_iter()
        .map(|m| m.to_string());
    redundancies.chain(misfits).map(Message::Warning).collect()
}
