//! Messages to the user, on stderr.

use std::fmt::{self, Display, Formatter};
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};

use annotate_snippets::renderer::{DEFAULT_ERROR_STYLE, DEFAULT_NOTE_STYLE, DEFAULT_WARNING_STYLE};

use biela::dynamics::Notice;

/// A message; its text begins with its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Message {
    Error(String),
    Warning(String),
    Note(String),
}

impl Message {
    /// Writes the message to stderr, with its kind in the colour of diagnostics; nothing but errors where
    /// only these are told.
    pub(in crate::cli) fn show(&self) {
        if tells_errors_only() && !matches!(self, Self::Error(_)) {
            return;
        }
        let (kind, style, text) = self.parts();
        tell(format_args!("{style}{kind}{style:#}: {text}"));
    }

    /// Returns the message with its text changed.
    pub(in crate::cli) fn map_text(self, text: impl FnOnce(String) -> String) -> Self {
        match self {
            Self::Error(inner) => Self::Error(text(inner)),
            Self::Warning(inner) => Self::Warning(text(inner)),
            Self::Note(inner) => Self::Note(text(inner)),
        }
    }

    /// Returns the text without the kind.
    pub(in crate::cli) fn text(&self) -> &str {
        self.parts().2
    }

    /// Returns the kind, the style of the kind, and the text.
    fn parts(&self) -> (&'static str, impl Display, &str) {
        match self {
            Self::Error(text) => ("error", DEFAULT_ERROR_STYLE, text),
            Self::Warning(text) => ("warning", DEFAULT_WARNING_STYLE, text),
            Self::Note(text) => ("note", DEFAULT_NOTE_STYLE, text),
        }
    }
}

impl From<Notice<'_>> for Message {
    fn from(notice: Notice<'_>) -> Self {
        let text = notice.to_string();
        match notice {
            Notice::Event(..) | Notice::Crossing(..) => Self::Note(text),
            Notice::Overlap(..)
            | Notice::Approach(..)
            | Notice::Excursion(_)
            | Notice::OffPulley(_)
            | Notice::LiftOff(_)
            | Notice::Beyond(..) => Self::Warning(text),
        }
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (kind, _, text) = self.parts();
        write!(f, "{kind}: {text}")
    }
}

/// Whether only errors are told, by this run of the program.
static ERRORS_ONLY: AtomicBool = AtomicBool::new(false);

/// Tells errors only from now on.
pub(in crate::cli) fn tell_errors_only() {
    ERRORS_ONLY.store(true, Ordering::Relaxed);
}

/// Returns whether only errors are told.
pub(in crate::cli) fn tells_errors_only() -> bool {
    ERRORS_ONLY.load(Ordering::Relaxed)
}

/// Writes a line to stderr that says what was done, unless only errors are told.
pub(in crate::cli) fn remark(line: impl Display) {
    if !tells_errors_only() {
        tell(line);
    }
}

/// Writes a line to stderr, in its colours if that is a terminal or the environment asks for them
/// (`CLICOLOR_FORCE`, `NO_COLOR`). A closed stderr is no error.
pub(in crate::cli) fn tell(line: impl Display) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
