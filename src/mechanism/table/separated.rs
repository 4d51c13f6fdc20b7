//! Columns of numbers as text, in the forms that spreadsheets and simulators write.

use std::borrow::Cow;

/// A text of columns separated by commas, semicolons, tabs or, where there are none of these, by
/// blanks. Lines that start with `#` are skipped, and so are empty ones and a byte order mark.
#[derive(Debug)]
pub(crate) struct Separated<'a> {
    text: Cow<'a, str>,
    delimiter: u8,
}

impl<'a> Separated<'a> {
    /// Makes a reader of the text. The first line that is no comment decides the separator.
    pub(crate) fn new(text: &'a str) -> Self {
        let text = text.trim_start_matches('\u{feff}');
        let first = text
            .lines()
            .find(|line| !is_comment(line) && !line.trim().is_empty())
            .unwrap_or_default();
        let mut delimiters = [b'\t', b';', b','].into_iter();
        if let Some(delimiter) = delimiters.find(|delimiter| first.as_bytes().contains(delimiter)) {
            return Self {
                text: text.into(),
                delimiter,
            };
        }
        // Commas for blanks leave the lines where they are.
        let lines = text.lines().map(|line| {
            if is_comment(line) {
                line.to_owned()
            } else {
                line.split_whitespace().collect::<Vec<_>>().join(",")
            }
        });
        Self {
            text: lines.collect::<Vec<_>>().join("\n").into(),
            delimiter: b',',
        }
    }

    /// Returns the rows, of any number of columns: the line, from 1, and the fields without the
    /// blanks around them.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (u64, csv::StringRecord)> {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .comment(Some(b'#'))
            .delimiter(self.delimiter)
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(self.text.as_bytes());
        // Reading from memory that holds valid UTF-8 does not fail.
        let records = reader.into_records().flatten();
        let has_fields = |record: &csv::StringRecord| record.len() > 1 || record.get(0) != Some("");
        records.filter(has_fields).map(|record| {
            let line = record.position().map_or(0, |place| self.line(place));
            (line, record)
        })
    }

    /// Returns a row of names. Where blanks separate the columns, a unit in brackets belongs to the
    /// name before it: `time [s]`.
    #[cfg(feature = "cli")]
    pub(crate) fn names(&self, row: &csv::StringRecord) -> csv::StringRecord {
        // Commas for blanks have made a text of its own.
        let has_blanks = matches!(self.text, Cow::Owned(_));
        let mut names: Vec<String> = Vec::new();
        for field in row {
            match names.last_mut() {
                Some(name) if has_blanks && is_bracketed(field) => {
                    name.push(' ');
                    name.push_str(field);
                }
                _ => names.push(field.to_owned()),
            }
        }
        names.into()
    }

    /// Returns the line of a record. The reader gives a place before the lines that it skipped.
    fn line(&self, place: &csv::Position) -> u64 {
        let rest =
            usize::try_from(place.byte()).map_or("", |byte| self.text.get(byte..).unwrap_or(""));
        let skipped = rest
            .lines()
            .take_while(|line| line.is_empty() || is_comment(line))
            .count();
        place.line() + skipped as u64
    }
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#')
}

#[cfg(feature = "cli")]
fn is_bracketed(field: &str) -> bool {
    let mut pairs = [('[', ']'), ('(', ')')].into_iter();
    pairs.any(|(open, close)| field.starts_with(open) && field.ends_with(close))
}

/// Returns a hint for a field that is no number.
pub(crate) fn comma_hint(found: &str) -> &'static str {
    if found.contains(',') {
        "; decimals stand after a point"
    } else {
        ""
    }
}
