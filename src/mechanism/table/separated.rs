//! Columns of numbers as text, in the forms that spreadsheets and simulators write.

use std::borrow::Cow;

/// A text of columns separated by commas, semicolons, tabs or, where there are none of these, by
/// blanks. Lines that start with `#` are skipped, and so are empty ones and a byte order mark. A line
/// `sep=;` before all others names the separator.
#[derive(Debug)]
pub struct Separated<'a> {
    text: Cow<'a, str>,
    delimiter: u8,
    /// Whether blanks separate the columns; commas have taken their place.
    has_blanks: bool,
}

impl<'a> Separated<'a> {
    /// Makes a reader of the text. A line such as `sep=;`, or else the first line that is no comment,
    /// decides the separator.
    pub fn new(text: &'a str) -> Self {
        let text = text.trim_start_matches('\u{feff}');
        let separated = |text, delimiter| Self {
            text,
            delimiter,
            has_blanks: false,
        };
        let start = text.lines().next().unwrap_or_default();
        if let Some(delimiter) = named_separator(start) {
            // A comment in its place leaves the other lines where they are.
            return separated(format!("#{}", &text[start.len()..]).into(), delimiter);
        }
        let first = text
            .lines()
            .find(|line| !is_comment(line) && !line.trim().is_empty())
            .unwrap_or_default();
        let mut delimiters = [b'\t', b';', b','].into_iter();
        if let Some(delimiter) = delimiters.find(|delimiter| first.as_bytes().contains(delimiter)) {
            return separated(text.into(), delimiter);
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
            has_blanks: true,
            ..separated(lines.collect::<Vec<_>>().join("\n").into(), b',')
        }
    }

    /// Returns a finite number of a field. Its decimal mark is a point or, where no comma separates the
    /// columns, a comma.
    pub fn number(&self, field: &str) -> Option<f64> {
        let number = match self.delimiter {
            b',' => field.parse(),
            _ => field.replacen(',', ".", 1).parse(),
        };
        number.ok().filter(|number: &f64| number.is_finite())
    }

    /// Returns the rows, of any number of columns: the line, from 1, and the fields without the
    /// blanks around them.
    pub fn rows(&self) -> impl Iterator<Item = (u64, csv::StringRecord)> {
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
    pub fn names(&self, row: &csv::StringRecord) -> csv::StringRecord {
        let mut names: Vec<String> = Vec::new();
        for field in row {
            match names.last_mut() {
                Some(name) if self.has_blanks && is_bracketed(field) => {
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

/// Returns the separator that a line such as `sep=;` names, as Excel writes it.
fn named_separator(line: &str) -> Option<u8> {
    let line = line.trim_matches('"');
    match line.as_bytes() {
        [name @ .., separator @ (b'\t' | b';' | b',')] if name.eq_ignore_ascii_case(b"sep=") => {
            Some(*separator)
        }
        _ => None,
    }
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#')
}

fn is_bracketed(field: &str) -> bool {
    let mut pairs = [('[', ']'), ('(', ')')].into_iter();
    pairs.any(|(open, close)| field.starts_with(open) && field.ends_with(close))
}

/// Returns a hint for a field that is no number.
pub fn comma_hint(found: &str) -> &'static str {
    if found.contains(',') && found.contains('.') {
        "; digits are not grouped"
    } else if found.contains(',') {
        "; decimals stand after a point"
    } else {
        ""
    }
}
