//! Text of a mechanism file, with lines and columns.

use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::encoding::{NotUtf8, decode};
use super::names::is_device;

/// Range of the text, in bytes.
pub type Span = Range<usize>;

/// Place in the text: line and column, both from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// Size of the largest mechanism file \[bytes\]. It holds fifty thousand bodies with their joints,
/// which take some seconds and some hundred megabytes.
const LARGEST_MECHANISM: u64 = 16 << 20;
/// Size of the largest CSV file \[bytes\], beyond any that people make.
const LARGEST_TABLE: u64 = 64 << 20;

/// Text of a mechanism file with the name of the file.
#[derive(Clone, Debug)]
pub struct Source {
    name: String,
    text: String,
    /// Fault in the encoding of the file.
    fault: Option<NotUtf8>,
    /// Folder of the files that it names.
    folder: Option<PathBuf>,
    /// Names and contents of the files that it names, where there are no folders.
    files: Vec<(String, String)>,
    /// Byte offset at which each line starts.
    line_starts: Vec<usize>,
}

impl Source {
    /// Makes a source of `text`; `name` is its path as the user gave it, for messages.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0)
            .chain(breaks.map(|(offset, _)| offset + 1))
            .collect();
        Self {
            name: name.into(),
            text,
            fault: None,
            folder: None,
            files: Vec::new(),
            line_starts,
        }
    }

    /// Reads the file at `path`, called `name` in messages. Files that it names are in the same
    /// folder. [`Mechanism::parse`](super::Mechanism::parse) reports a file that is not UTF-8.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is larger than any mechanism.
    pub fn open(name: impl Into<String>, path: &Path) -> io::Result<Self> {
        let (text, fault) = decode(read_bounded(path, LARGEST_MECHANISM)?);
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_owned);
        Ok(Self {
            fault,
            folder: Some(folder),
            ..Self::new(name, text)
        })
    }

    /// Returns the source with the folder of the files that it names.
    #[must_use]
    pub fn in_folder(self, folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: Some(folder.into()),
            ..self
        }
    }

    /// Returns the source with another text, which may name the same files.
    #[must_use]
    pub fn with_text(self, text: impl Into<String>) -> Self {
        let Self {
            name,
            folder,
            files,
            ..
        } = self;
        Self {
            folder,
            files,
            ..Self::new(name, text)
        }
    }

    /// Returns the source with files that it may name, each with its content: what a program
    /// without folders has in place of [`in_folder`](Self::in_folder).
    #[must_use]
    pub fn with_files(self, files: Vec<(String, String)>) -> Self {
        Self { files, ..self }
    }

    /// Returns the content of a file in the same folder.
    ///
    /// # Errors
    ///
    /// It cannot be read, or `name` is not the plain name of a file.
    pub(super) fn read_beside(&self, name: &str) -> io::Result<String> {
        let refuse = |why| Err(io::Error::new(io::ErrorKind::InvalidInput, why));
        if !is_portable(name) {
            return refuse("expected the plain name of a file beside the mechanism file");
        }
        if let Some((_, content)) = self.files.iter().find(|(file, _)| file == name) {
            return Ok(content.clone());
        }
        let Some(folder) = &self.folder else {
            return refuse("the mechanism was not read from a file");
        };
        let path = folder.join(name);
        // Opening a pipe would wait for whoever writes to it.
        if std::fs::metadata(&path)?.is_file() {
            let (text, fault) = decode(read_bounded(&path, LARGEST_TABLE)?);
            fault.map_or(Ok(text), |fault| {
                let help = match fault {
                    NotUtf8::Zip => "save the sheet as CSV",
                    _ => fault.help(),
                };
                let why = format!("it {fault}; {help}");
                Err(io::Error::new(io::ErrorKind::InvalidData, why))
            })
        } else {
            refuse("it is not a file")
        }
    }

    /// Returns the name given to [`Source::new`].
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the whole text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the fault in the encoding of the file, if there is one.
    pub(super) fn fault(&self) -> Option<NotUtf8> {
        self.fault
    }

    /// Returns the line and column of a byte offset; one past the end counts as the end.
    #[must_use]
    pub fn position(&self, offset: usize) -> Position {
        let offset = self.text.floor_char_boundary(offset);
        // The first line starts at 0, so at least one starts at or before the offset.
        let line = self.line_starts.partition_point(|start| *start <= offset);
        let start = self.line_starts[line - 1];
        Position {
            line,
            column: self.text[start..offset].chars().count() + 1,
        }
    }

    /// Returns line `number`, from 1, without its line break; empty if there is none.
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

/// Returns whether every system and every zip tool accepts this as the name of a file.
fn is_portable(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let legal = |c: char| c.is_alphanumeric() || " ._-+()".contains(c);
    !is_device(stem)
        && name.chars().all(legal)
        && !stem.trim().is_empty()
        && !name.ends_with(['.', ' '])
        && !name.starts_with(' ')
}

fn read_bounded(path: &Path, largest: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = File::open(path)?
        .take(largest + 1)
        .read_to_end(&mut bytes)?;
    if read as u64 > largest {
        let why = format!("it has more than {largest} bytes");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, why));
    }
    Ok(bytes)
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
    fn names_that_some_system_refuses_are_not_portable() {
        for name in [
            "a.csv",
            "Ley de elevación (2).csv",
            "cam_points.csv",
            "console",
            "com10.csv",
        ] {
            assert!(is_portable(name), "{name}");
        }
        for name in [
            "", ".", "..", ".a", "a.", "a ", " a", "../a", "a/b", "a\\b", "C:a", "a*", "a\nb",
            "con.csv", "Aux", "COM1.csv",
        ] {
            assert!(!is_portable(name), "{name}");
        }
    }

    #[test]
    fn an_empty_text_has_one_line() {
        let source = Source::new("a.toml", "");
        assert_eq!(source.position(0), Position { line: 1, column: 1 });
        assert_eq!(source.line(1), "");
    }
}
