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
        let (kind, style, text) = self.parts();
        tell(format_args!("{style}{kind}{style:#}: {text}"));
    }

    /// Its kind, how that looks, and what it says.
    fn parts(&self) -> (&'static str, impl Display, &str) {
        match self {
            Self::Error(text) => ("error", DEFAULT_ERROR_STYLE, text),
            Self::Warning(text) => ("warning", DEFAULT_WARNING_STYLE, text),
            Self::Note(text) => ("note", DEFAULT_NOTE_STYLE, text),
        }
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (kind, _, text) = self.parts();
        write!(f, "{kind}: {text}")
    }
}

/// Writes a line to stderr, without colours where it is no terminal. That nobody can read it
/// changes nothing of what a command does.
pub(super) fn tell(line: impl Display) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
