//! The file's own keys: format, name and the FMI attributes.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::quoted;
use crate::mechanism::syntax::{self, Table};

use super::context::{Context, Fields};

/// The keys of the file itself.
pub(super) const KEYS: [&str; 16] = [
    "format",
    "name",
    "description",
    "author",
    "version",
    "license",
    "copyright",
    "parameters",
    "ground",
    "bodies",
    "joints",
    "constraints",
    "drivers",
    "measures",
    "outputs",
    "simulation",
];

/// The words of C11 that are no identifiers; `_Bool` and its like cannot be meant by accident.
pub(super) const C_KEYWORDS: [&str; 34] = [
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else",
    "enum", "extern", "float", "for", "goto", "if", "inline", "int", "long", "register",
    "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch", "typedef",
    "union", "unsigned", "void", "volatile", "while",
];

pub(super) struct Header {
    pub(super) name: Option<String>,
    pub(super) description: String,
    pub(super) author: Option<String>,
    pub(super) version: Option<String>,
    pub(super) license: Option<String>,
    pub(super) copyright: Option<String>,
}

/// Whether a mechanism may have this name: whether it is a C identifier.
#[must_use]
pub fn is_identifier(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && !C_KEYWORDS.contains(&name)
}

impl<'a> Context<'a> {
    /// The whole file as a table, its keys checked.
    pub(super) fn root(&mut self, document: &'a Table<'a>) -> Fields<'a> {
        let root = Fields {
            table: document,
            place: 0..0,
            subject: "the file".to_owned(),
        };
        self.check_keys(&root, &KEYS);
        root
    }

    pub(super) fn lower_header(&mut self, root: &Fields<'a>) -> Header {
        self.check_format(root);
        Header {
            name: self.lower_name(root),
            description: self.description(root),
            author: self.optional_text(root, "author"),
            version: self.optional_text(root, "version"),
            license: self.optional_text(root, "license"),
            copyright: self.optional_text(root, "copyright"),
        }
    }

    fn check_format(&mut self, root: &Fields<'a>) {
        let Some(value) = self.required(root, "format", "1") else {
            return;
        };
        if syntax::number(value.get_ref()) != Some(1.0) {
            self.error_with_help(
                code::UNKNOWN_FORMAT,
                value.span(),
                "this format of the file is not known",
                "expected `format = 1`".to_owned(),
            );
        }
    }

    fn lower_name(&mut self, root: &Fields<'a>) -> Option<String> {
        let value = self.required(root, "name", "\"my_mechanism\"")?;
        let name = self.text(value)?;
        if !is_identifier(name) {
            self.error_with_help(
                code::ILLEGAL_NAME,
                value.span(),
                format!(
                    "the mechanism's name {} is not a C identifier",
                    quoted(name)
                ),
                "letters, digits and `_`, not starting with a digit, and no word of the C language"
                    .to_owned(),
            );
            return None;
        }
        Some(name.to_owned())
    }
}
