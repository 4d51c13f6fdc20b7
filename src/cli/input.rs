//! Reading a mechanism file and showing what is wrong with it.

use std::io::IsTerminal;
use std::path::Path as FilePath;
use std::sync::Arc;

use super::error::Error;
use super::message::{Message, tell};
use super::render::render;
use crate::kinematics::{Path, Solver};
use crate::mechanism::{Diagnostic, Mechanism, Source};

/// A mechanism file that was read without errors.
#[derive(Debug)]
pub(super) struct Input {
    pub(super) source: Source,
    pub(super) mechanism: Arc<Mechanism>,
}

impl Input {
    /// Reads a file; errors and warnings are shown on stderr.
    pub(super) fn read(path: &FilePath) -> Result<Self, Error> {
        let source =
            Source::open(path.display().to_string(), path).map_err(|source| Error::Read {
                path: path.to_owned(),
                source,
            })?;
        match Mechanism::parse(&source) {
            Ok((mechanism, warnings)) => {
                show(&source, &warnings);
                Ok(Self {
                    source,
                    mechanism: Arc::new(mechanism),
                })
            }
            Err(diagnostics) => {
                show(&source, &diagnostics);
                Err(Error::Diagnosed)
            }
        }
    }

    /// An error of the kinematics about this file.
    pub(super) fn error(&self, error: crate::kinematics::Error) -> Error {
        Error::Mechanism {
            file: self.source.name().to_owned(),
            error,
        }
    }

    /// A solver that stands nowhere yet.
    pub(super) fn solver(&self) -> Result<Solver, Error> {
        Solver::new(Arc::clone(&self.mechanism)).map_err(|error| self.error(error))
    }

    /// A solver at the file's own assembled pose.
    pub(super) fn assemble(&self) -> Result<Solver, Error> {
        let mut solver = self.solver()?;
        solver
            .assemble(&Path::new(&self.mechanism))
            .map_err(|error| self.error(error))?;
        Ok(solver)
    }
}

/// Warns on stderr of joints that do not fit their own numbers where the solver stands, and of
/// redundant ones.
pub(super) fn warn_of_misfits(solver: &Solver) {
    for warning in misfits(solver) {
        warning.show();
    }
}

/// What [`warn_of_misfits`] warns of.
pub(super) fn misfits(solver: &Solver) -> Vec<Message> {
    let redundancies = solver.redundancies().into_iter().map(|r| r.to_string());
    let misfits = solver
        .geometry_warnings()
        .into_iter()
        .map(|m| m.to_string());
    redundancies.chain(misfits).map(Message::Warning).collect()
}

fn show(source: &Source, diagnostics: &[Diagnostic]) {
    if !diagnostics.is_empty() {
        let styled = std::io::stderr().is_terminal();
        tell(render(source, diagnostics, styled) + "\n");
    }
}
