//! Pairs of lines, a code and a value.

use crate::exchange::error::{self, Error};

/// A code with its value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<'a> {
    pub(super) code: i32,
    pub(super) value: &'a str,
    /// Line of the value, from 1.
    pub(super) line: usize,
}

impl Pair<'_> {
    pub(super) fn number(self) -> Result<f64, Error> {
        error::number(self.value, self.line)
    }
}

/// Returns the pairs of a file.
pub(super) fn pairs(text: &str) -> impl Iterator<Item = Result<Pair<'_>, Error>> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (line, code) = lines.next()?;
        let Some((next, value)) = lines.next() else {
            // An empty last line is no code.
            return (!code.trim().is_empty())
                .then(|| Err(Error::unexpected(line, code, "a code and its value")));
        };
        Some(match code.trim().parse() {
            Ok(code) => Ok(Pair {
                code,
                value: value.trim(),
                line: next,
            }),
            Err(_) => Err(Error::unexpected(line, code, "the number of a code")),
        })
    })
}
