//! Errors of commands, and their exit status.

use std::io;
use std::path::{Path, PathBuf};

use super::message::Message;
use crate::cli::results::stdout::shown;
use crate::exchange;
use biela::kinematics;

/// A command that could not do its work.
#[derive(Debug, thiserror::Error)]
pub(in crate::cli) enum Error {
    /// The mechanism file has errors, which have been shown.
    #[error("the mechanism file has errors")]
    Diagnosed,
    /// The mechanism cannot be assembled or moved.
    #[error("{file}: {error}")]
    Mechanism {
        file: String,
        error: kinematics::Error,
    },
    /// A motion cannot go on, or cannot start.
    #[error("{file}: {why}")]
    Stopped { file: String, why: String },
    /// An argument of the command is wrong.
    #[error("{0}")]
    Usage(String),
    /// A file cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// A file, or stdout for `-`, cannot be written.
    #[error("cannot write {}: {source}", shown(path))]
    Write { path: PathBuf, source: io::Error },
    /// The server of `watch` cannot listen.
    #[error("cannot listen on port {port}: {source}; --port names another, 0 a free one")]
    Listen { port: u16, source: io::Error },
    /// A file of another program cannot be imported.
    #[error("{file}: {error}")]
    Import {
        file: String,
        error: exchange::Error,
    },
    /// An imported mechanism has errors as a mechanism file, which have been shown.
    #[error("the mechanism of {format} is no mechanism of biela yet: correct the file")]
    Imported { format: &'static str },
    /// The archive of an FMU cannot be written.
    #[error("cannot write the archive: {0}")]
    Archive(io::Error),
}

impl Error {
    /// Returns what makes the error of a file that cannot be read.
    pub(in crate::cli) fn read(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::Read {
            path: path.to_owned(),
            source,
        }
    }

    /// Returns what makes the error of a file that cannot be written.
    pub(in crate::cli) fn write(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::Write {
            path: path.to_owned(),
            source,
        }
    }

    /// Tells the error on stderr, unless it was told already or is a closed pipe.
    pub(in crate::cli) fn show(&self) {
        match self {
            Self::Diagnosed => {}
            Self::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe => {}
            _ => Message::Error(self.to_string()).show(),
        }
    }

    /// Returns 1 for an error in the mechanism, 2 for one in the command.
    pub(in crate::cli) fn exit_status(&self) -> u8 {
        match self {
            Self::Diagnosed
            | Self::Mechanism { .. }
            | Self::Stopped { .. }
            | Self::Import { .. }
            | Self::Imported { .. } => 1,
            // A reader that has read enough closes the pipe.
            Self::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe => 0,
            Self::Usage(_)
            | Self::Read { .. }
            | Self::Write { .. }
            | Self::Listen { .. }
            | Self::Archive(_) => 2,
        }
    }
}
