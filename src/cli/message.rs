//! What a command says to people, apart from its results.

use std::fmt::{self, Display, Formatter};
use std::io::Write as _;

use annotate_snippets::renderer::{DEFAULT_ERROR_STYLE, DEFAULT_NOTE_STYLE, DEFAULT_WARNING_STYLE};

/// A message; as text it begins with its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Message {
    Error(String),
    Warning(String),
    Note(String),
}

impl Message {
    /// Tells it on stderr, its kind in the colour that the renderer of diagnostics has for it.
    pub(super) fn show(&self) {
        let (style, kind, text) = match self {
            Self::Error(text) => (DEFAULT_ERROR_STYLE, "error", text),
            Self::Warning(text) => (DEFAULT_WARNING_STYLE, "warning", text),
            Self::Note(text) => (DEFAULT_NOTE_STYLE, "note", text),
        };
        tell(format_args!("{style}{kind}{style:#}: {text}"));
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (kind, text) = match self {
            Self::Error(text) => ("error", text),
            Self::Warning(text) => ("warning", text),
            Self::Note(text) => ("note", text),
        };
        write!(f, "{kind}: {text}")
    }
}

/// Writes a line to stderr, without colours where it is no terminal. That nobody can read it
/// changes nothing of what a command does.
pub(super) fn tell(line: impl Display) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
