//! The text of a mechanism file, and where in it something is.

use std::ops::Range;

/// A stretch of the text, in bytes.
pub type Span = Range<usize>;

/// A place in the text as people count: lines and columns from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// The text of a mechanism file and the name under which people know it.
#[derive(Clone, Debug)]
pub struct Source {
    name: String,
    text: String,
    /// Byte offset at which each line starts.
    line_starts: Vec<usize>,
}

impl Source {
    /// Keeps `text`, named `name` in messages: its path as the user gave it.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0)
            .chain(breaks.map(|(offset, _)| offset + 1))
            .collect();
        Self {
            name: name.into(),
            text,
            line_starts,
        }
    }

    /// The name given to [`Source::new`].
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The place of a byte offset; one past the end of the text counts as its end.
    #[must_use]
    pub fn position(&self, offset: usize) -> Position {
        let offset = self.boundary(offset);
        // The first line starts at 0, so at least one starts at or before the offset.
        let line = self.line_starts.partition_point(|start| *start <= offset);
        let start = self.line_starts[line - 1];
        Position {
            line,
            column: self.text[start..offset].chars().count() + 1,
        }
    }

    /// The start of the character at `offset`, or the end of the text.
    pub(crate) fn boundary(&self, offset: usize) -> usize {
        (0..=offset.min(self.text.len()))
            .rev()
            .find(|offset| self.text.is_char_boundary(*offset))
            .unwrap_or(0)
    }

    /// Line `number`, from 1, without its line break; empty if the text has no such line.
    #[must_use]
    pub fn line(&self, number: usize) -> &str {
        let Some(&start) = number
            .checked_sub(1)
            .and_then(|index| self.line_starts.get(index))
        else {
            return "";
        };
        let end = self.line_starts.get(number).copied();
        let line = &self.text[start..end.unwrap_or(self.text.len())];
        line.trim_end_matches(['\r', '\n'])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let source = Source::new("a.toml", "á = 1\r\n\nbé");
        let at = |line, column| Position { line, column };
        assert_eq!(source.position(0), at(1, 1));
        assert_eq!(source.position(1), at(1, 1));
        assert_eq!(source.position(2), at(1, 2));
        assert_eq!(source.position(8), at(2, 1));
        assert_eq!(source.position(9), at(3, 1));
        assert_eq!(source.position(12), at(3, 3));
        assert_eq!(source.position(usize::MAX), at(3, 3));
    }

    #[test]
    fn lines_come_without_their_break() {
        let source = Source::new("a.toml", "one\r\ntwo\n");
        let lines: Vec<&str> = (0..5).map(|number| source.line(number)).collect();
        assert_eq!(lines, ["", "one", "two", "", ""]);
    }

    #[test]
    fn an_empty_text_has_one_line() {
        let source = Source::new("a.toml", "");
        assert_eq!(source.position(0), Position { line: 1, column: 1 });
        assert_eq!(source.line(1), "");
    }
}
