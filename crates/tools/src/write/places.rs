//! The keys and texts of a TOML file at their places, each as often as it is written.

use std::ops::Range;

use toml_parser::Source;
use toml_parser::parser::{Event, EventKind, parse_document};

/// A key as it is written: in a header, in front of a value, or between points.
#[derive(Debug)]
pub struct WrittenKey {
    /// Path of what it names.
    pub path: Vec<String>,
    /// Its place, without quotes.
    pub place: Range<usize>,
}

/// A text among the values.
#[derive(Debug)]
pub struct WrittenText {
    /// Path of the value; of an entry of a list, that of the list.
    pub path: Vec<String>,
    /// Its place, with its quotes.
    pub place: Range<usize>,
    /// Its place, without quotes.
    pub inside: Range<usize>,
}

/// Keys and texts in the order of the file.
#[derive(Debug, Default)]
pub struct Places {
    pub keys: Vec<WrittenKey>,
    pub texts: Vec<WrittenText>,
}

impl Places {
    /// Finds the keys and texts of a file that is TOML.
    pub fn of(text: &str) -> Self {
        let tokens = Source::new(text).lex().into_vec();
        let mut events: Vec<Event> = Vec::new();
        parse_document(&tokens, &mut events, &mut ());
        let mut walk = Walk::default();
        for event in events {
            walk.take(text, &event);
        }
        walk.places
    }
}

#[derive(Default)]
struct Walk {
    places: Places,
    path: Vec<String>,
    /// Length of the path of the table whose header came last.
    table: usize,
    /// The lists and tables in braces around: whether it is a list, and the length of its path.
    around: Vec<(bool, usize)>,
    is_header: bool,
}

impl Walk {
    fn take(&mut self, text: &str, event: &Event) {
        let place = event.span().start()..event.span().end();
        match event.kind() {
            EventKind::StdTableOpen | EventKind::ArrayTableOpen => {
                self.path.clear();
                self.is_header = true;
            }
            EventKind::StdTableClose | EventKind::ArrayTableClose => {
                self.table = self.path.len();
                self.is_header = false;
            }
            EventKind::SimpleKey => {
                let place = match event.encoding() {
                    Some(_) => place.start + 1..place.end - 1,
                    None => place,
                };
                self.path.push(text[place.clone()].to_owned());
                let path = self.path.clone();
                self.places.keys.push(WrittenKey { path, place });
            }
            EventKind::InlineTableOpen => self.around.push((false, self.path.len())),
            EventKind::ArrayOpen => self.around.push((true, self.path.len())),
            EventKind::InlineTableClose | EventKind::ArrayClose => {
                self.around.pop();
                self.end_value();
            }
            EventKind::Scalar => {
                if event.encoding().is_some() {
                    let whole = &text[place.clone()];
                    let is_long = whole.starts_with("\"\"\"") || whole.starts_with("'''");
                    let quote = if is_long { 3 } else { 1 };
                    self.places.texts.push(WrittenText {
                        path: self.path.clone(),
                        inside: place.start + quote..place.end - quote,
                        place,
                    });
                }
                self.end_value();
            }
            _ => {}
        }
    }

    fn end_value(&mut self) {
        match self.around.last() {
            Some((true, _)) => {}
            Some((false, length)) => self.path.truncate(*length),
            None => self.path.truncate(self.table),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_wherever_they_are_written() {
        let text =
            "a.b = \"x\"\n[c.\"d\"]\ne = { f = ['y', { g = 1 }], h = \"\"\"z\"\"\" }\nk = 2\n";
        let places = Places::of(text);
        let keys: Vec<String> = places.keys.iter().map(|key| key.path.join("/")).collect();
        let expected = [
            "a",
            "a/b",
            "c",
            "c/d",
            "c/d/e",
            "c/d/e/f",
            "c/d/e/f/g",
            "c/d/e/h",
            "c/d/k",
        ];
        assert_eq!(keys, expected);
        let written = |key: &WrittenKey| text[key.place.clone()] == *key.path[key.path.len() - 1];
        assert!(places.keys.iter().all(written));
        let texts = places.texts.iter();
        let texts: Vec<(String, &str)> = texts
            .map(|found| (found.path.join("/"), &text[found.inside.clone()]))
            .collect();
        let expected = [("a/b", "x"), ("c/d/e/f", "y"), ("c/d/e/h", "z")];
        assert_eq!(texts, expected.map(|(path, text)| (path.to_owned(), text)));
    }
}
