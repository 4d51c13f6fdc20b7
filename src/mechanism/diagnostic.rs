//! Problems of a mechanism file, as data.

use super::{Source, Span};

/// Severity of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The mechanism can be used, but is probably not what its author meant.
    Warning,
    /// The file does not describe a mechanism.
    Error,
}

impl Severity {
    /// Returns `warning` or `error`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Problem of a mechanism file, with its places and its help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Severity: warning or error.
    pub severity: Severity,
    /// Kind of problem, in kebab case: `unknown-body`.
    pub code: &'static str,
    /// Description: lower case, no full stop, names in back quotes.
    pub message: String,
    /// Places of the problem, the primary one first.
    pub labels: Vec<Label>,
    /// Correction, if one is known.
    pub help: Option<String>,
}

/// Place in the file with its part in the problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Place.
    pub span: Span,
    /// Text at the place; may be empty.
    pub text: String,
}

impl Diagnostic {
    /// Makes an error without place and help.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// Makes a warning without place and help.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Adds a place; the first one is the primary one.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Returns the problem with a correction.
    #[must_use]
    pub fn help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }

    /// Adds a correction.
    pub(super) fn suggest(&mut self, help: impl Into<String>) {
        self.help = Some(help.into());
    }

    /// Returns the problem on one line, `file:line:column: error: message; help`, for a log.
    #[must_use]
    pub fn one_line(&self, source: &Source) -> String {
        let mut line = source.name().to_owned();
        if let Some(label) = self.labels.first() {
            let position = source.position(label.span.start);
            line += &format!(":{}:{}", position.line, position.column);
        }
        line += &format!(": {}: {}", self.severity.as_str(), self.message);
        if let Some(help) = &self.help {
            line += &format!("; {help}");
        }
        line
    }
}

/// Defines the codes and lists them, so that a test can demand an example of each.
macro_rules! codes {
    ($($name:ident = $code:literal,)*) => {
        /// Codes of the kinds of problems.
        pub(super) mod code {
            $(pub(in crate::mechanism) const $name: &str = $code;)*
        }

        impl Diagnostic {
            /// Every code that a diagnostic can carry.
            pub const CODES: &'static [&'static str] = &[$(code::$name,)*];
        }
    };
}

codes! {
    BAD_EXPRESSION = "bad-expression",
    BAD_PROFILE = "bad-profile",
    BAD_TABLE = "bad-table",
    DECIMAL_COMMA = "decimal-comma",
    DRIVER_SOURCE = "driver-source",
    DUPLICATE_KEY = "duplicate-key",
    DUPLICATE_NAME = "duplicate-name",
    DUPLICATE_OUTPUT = "duplicate-output",
    FLOATING_BODY = "floating-body",
    FORCE_SHAPE = "force-shape",
    FRICTION_COORDINATE = "friction-coordinate",
    FUNCTION_RING = "function-ring",
    ILLEGAL_NAME = "illegal-name",
    ILLEGAL_TEXT = "illegal-text",
    ILLEGAL_VALUE = "illegal-value",
    LARGE_ANGLE = "large-angle",
    LARGE_LENGTH = "large-length",
    MISSING_KEY = "missing-key",
    MISSING_MASS = "missing-mass",
    NO_BODIES = "no-bodies",
    NOT_FINITE = "not-finite",
    NOT_TUNABLE = "not-tunable",
    NOT_UTF_8 = "not-utf-8",
    OUT_OF_RANGE = "out-of-range",
    PARAMETER_CYCLE = "parameter-cycle",
    RESERVED_NAME = "reserved-name",
    SAME_BODY = "same-body",
    SHAPE = "shape",
    STOP_COORDINATE = "stop-coordinate",
    SYNTAX = "syntax",
    TABLE_FILE = "table-file",
    TOO_MANY_PROBLEMS = "too-many-problems",
    UNKNOWN_BODY = "unknown-body",
    UNKNOWN_COORDINATE = "unknown-coordinate",
    UNKNOWN_FORMAT = "unknown-format",
    UNKNOWN_JOINT_TYPE = "unknown-joint-type",
    UNKNOWN_KEY = "unknown-key",
    UNKNOWN_MARKER = "unknown-marker",
    UNKNOWN_REACTION = "unknown-reaction",
    UNKNOWN_UNIT = "unknown-unit",
    UNUSED_FUNCTION = "unused-function",
    UNUSED_INPUT = "unused-input",
    UNUSED_PARAMETER = "unused-parameter",
    UNUSUAL_VALUE = "unusual-value",
    WRONG_DIMENSION = "wrong-dimension",
    WRONG_DISPLAY_UNIT = "wrong-display-unit",
    WRONG_TYPE = "wrong-type",
    WHEEL_SIZES = "wheel-sizes",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_names_the_primary_place_and_the_help() {
        let source = Source::new("a.toml", "x = 1\ny = 2\n");
        let bare = Diagnostic::warning("code", "something is odd");
        assert_eq!(bare.one_line(&source), "a.toml: warning: something is odd");
        let full = Diagnostic::error("code", "no body `cranck`")
            .label(10..11, "here")
            .label(0..1, "there")
            .help("did you mean `crank`?".to_owned());
        assert_eq!(
            full.one_line(&source),
            "a.toml:2:5: error: no body `cranck`; did you mean `crank`?"
        );
    }
}
