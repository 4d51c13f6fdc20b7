//! Options that assign expressions to names.

use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use biela::mechanism::{ExpressionError, Jet, help, is_plain, large_angle, large_velocity, shown};

/// An option that assigns expressions to names.
pub(super) struct Assigning {
    pub(super) option: &'static str,
    pub(super) kind: &'static str,
    pub(super) example: &'static str,
    /// Kind of the names that another option assigns to, and that option.
    pub(super) other: [&'static str; 2],
}

impl Assigning {
    /// Splits each `NAME=EXPRESSION` into the name's index in `names` and the expression; another
    /// option assigns to the names `others`.
    pub(super) fn assignments<'a>(
        &self,
        given: &'a [String],
        names: &[&str],
        others: &[&str],
    ) -> Result<Vec<(usize, &'a str)>, Error> {
        let (option, example) = (self.option, self.example);
        let mut assignments: Vec<(usize, &str)> = Vec::new();
        for assignment in given {
            let Some((name, text)) = assignment.split_once('=') else {
                return Err(Error::Usage(format!(
                    "{option}: `{assignment}` has no `=`; expected for example '{example}'"
                )));
            };
            let name = name.trim();
            let index = names.iter().position(|known| *known == name);
            let index = index.ok_or_else(|| self.unknown(name, names, others))?;
            if assignments.iter().any(|(known, _)| *known == index) {
                return Err(Error::Usage(format!("{option}: `{name}` is given twice")));
            }
            assignments.push((index, text.trim()));
        }
        Ok(assignments)
    }

    /// Returns the error of an unknown name, which may belong to another option.
    fn unknown(&self, name: &str, names: &[&str], others: &[&str]) -> Error {
        let (option, kind, [other, right]) = (self.option, self.kind, self.other);
        let owner = name.split('.').next().unwrap_or(name);
        if others.contains(&owner) {
            let message =
                format!("{option}: no {kind} `{name}`; `{owner}` is a {other}: use {right}");
            return Error::Usage(message);
        }
        unknown(option, kind, name, names)
    }

    pub(super) fn refuse(&self, text: &str, error: &ExpressionError) -> Error {
        refuse(self.option, text, error)
    }
}

/// Returns the error of an expression, with a mark under its place.
pub(super) fn refuse(option: &str, text: &str, error: &ExpressionError) -> Error {
    let column = text[..error.span.start].chars().count();
    let help = (error.help.as_ref()).map_or_else(String::new, |help| format!("; {help}"));
    let mut message = format!("{option}: {}{help}", error.message);
    if !text.is_empty() {
        message += &format!("\n  {text}\n  {:column$}^", "");
    }
    Error::Usage(message)
}

/// Returns the error of an unknown name, with the known name that may be meant.
pub(in crate::cli) fn unknown(option: &str, kind: &str, name: &str, names: &[&str]) -> Error {
    Error::Usage(format!("{option}: {}", unknown_name(kind, name, names)))
}

/// Says that a name is unknown, with the known name that may be meant.
pub(in crate::cli) fn unknown_name(kind: &str, name: &str, names: &[&str]) -> String {
    let help = match names {
        [] => Some("the mechanism has none".to_owned()),
        _ => help(name, names, &[]),
    };
    let help = help.map_or_else(String::new, |help| format!("; {help}"));
    format!("no {kind} `{name}`{help}")
}

/// Warns of an angle of more than a turn, or of a velocity of whole right angles, that is made of
/// plain numbers: it looks like degrees.
pub(in crate::cli) fn warn_of_degrees(option: &str, text: &str, angle: Jet) {
    let of_angle = large_angle(angle.value).map(|message| (message, angle.value));
    let of_velocity = || Some((large_velocity(angle.first())?, angle.first()));
    let suspect = of_angle.or_else(of_velocity);
    if let Some((message, number)) = suspect.filter(|_| is_plain(text)) {
        let number = shown(number);
        let warning = format!("{option}: {message}; degrees are written `{number}*deg`");
        Message::Warning(warning).show();
    }
}
