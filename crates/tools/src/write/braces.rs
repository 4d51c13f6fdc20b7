//! Entries of a table in braces: on one line or on several, with comments and commas behind them.

use std::ops::Range;

use toml_edit::{InlineTable, Item, Table, Value};

/// A table in braces, and the keys that lead from it to a table that its keys with points make.
pub(super) struct Braces<'a> {
    table: &'a InlineTable,
    /// The keys from the table inwards.
    pub(super) inner: &'a [&'a str],
}

/// A change of a text: a part of it, and what takes its place.
pub(super) type Change = (Range<usize>, String);

impl<'a> Braces<'a> {
    /// Returns the innermost braces that enclose the item at a path.
    pub(super) fn around(root: &'a Table, path: &'a [&'a str]) -> Option<Self> {
        let mut found = None;
        let mut item = root.get(path.first()?)?;
        for (depth, name) in path.iter().enumerate().skip(1) {
            if let Item::Value(Value::InlineTable(table)) = item
                && !table.is_dotted()
            {
                let inner = &path[depth..];
                found = Some(Self { table, inner });
            }
            item = match item.as_table_like().and_then(|table| table.get(name)) {
                Some(next) => next,
                None if depth + 1 == path.len() => break,
                None => return None,
            };
        }
        found
    }

    /// Returns the changes that add an entry behind the others.
    pub(super) fn add(&self, text: &str, value: &str) -> Vec<Change> {
        let entry = format!("{} = {value}", self.inner.join("."));
        let Some(place) = self.table.span() else {
            return Vec::new();
        };
        let Some(last) = self.entries(text).pop() else {
            let inside = place.start + 1..place.end - 1;
            return if text[inside.clone()].contains('#') {
                vec![(inside.end..inside.end, format!("{entry} "))]
            } else {
                vec![(inside, format!(" {entry} "))]
            };
        };
        let comma = comma_after(text, last.end);
        let line = text[..last.start].rfind('\n').map_or(0, |at| at + 1);
        let indent = &text[line..last.start];
        // An entry on a line of its own gets one after it, behind its comment.
        if line > place.start && indent.trim().is_empty() {
            let behind = comma.map_or(last.end, |comma| comma + 1);
            let end = text[behind..].find(['\n', '}']).map_or(text.len(), |at| {
                // A brace in a comment ends nothing.
                if text[behind..behind + at].contains('#') {
                    text[behind..]
                        .find('\n')
                        .map_or(text.len(), |at| behind + at)
                } else {
                    behind + at
                }
            });
            let end = text[..end].trim_end_matches(['\r', ' ']).len().max(behind);
            let added = (end..end, format!("\n{indent}{entry}"));
            return match comma {
                Some(_) => vec![(added.0, added.1 + ",")],
                None => vec![(last.end..last.end, ",".to_owned()), added],
            };
        }
        match comma {
            Some(comma) => vec![(comma + 1..comma + 1, format!(" {entry}"))],
            None => vec![(last.end..last.end, format!(", {entry}"))],
        }
    }

    /// Returns the part of the text to take away for the entry whose key or value is at a place.
    pub(super) fn without(&self, text: &str, at: usize) -> Option<Range<usize>> {
        let entries = self.entries(text);
        let own = entries.iter().position(|entry| entry.contains(&at))?;
        let entry = entries[own].clone();
        if let Some(next) = entries.get(own + 1) {
            return Some(entry.start..next.start);
        }
        // The comma goes, the own one or that of the entry before, and what stands before a brace.
        let end = comma_after(text, entry.end).map_or(entry.end, |comma| comma + 1);
        let Some(before) = own.checked_sub(1).map(|before| &entries[before]) else {
            let blanks = text[end..].len() - text[end..].trim_start_matches(' ').len();
            return Some(entry.start..end + blanks);
        };
        // A comment behind the entry before stays, and with it its comma.
        if text[before.end..entry.start].contains('#') {
            let start = text[..entry.start].trim_end_matches([' ', '\t']);
            let rest = text[end..].trim_start_matches([' ', '\t', '\r']);
            let line = start.strip_suffix('\n').filter(|_| rest.starts_with('\n'));
            Some(line.unwrap_or(start).len()..end)
        } else {
            Some(before.end..end)
        }
    }

    /// Returns the places of the entries with a value, each from its key to the end of its value.
    fn entries(&self, text: &str) -> Vec<Range<usize>> {
        let mut entries = Vec::new();
        collect(self.table, text, &mut entries);
        entries.sort_by_key(|entry| entry.start);
        entries
    }
}

fn collect(table: &InlineTable, text: &str, entries: &mut Vec<Range<usize>>) {
    for (name, value) in table.iter() {
        match value {
            Value::InlineTable(inner) if inner.is_dotted() => collect(inner, text, entries),
            value => {
                let key = table.key(name).and_then(toml_edit::Key::span);
                if let (Some(key), Some(value)) = (key, value.span()) {
                    entries.push(start_of_key(text, key.start)..value.end);
                }
            }
        }
    }
}

/// Returns the start of a key with points whose last part begins at `at`.
fn start_of_key(text: &str, at: usize) -> usize {
    let mut start = at;
    while let Some(before) = text[..start]
        .trim_end_matches([' ', '\t'])
        .strip_suffix('.')
    {
        let before = before.trim_end_matches([' ', '\t']);
        start = match before.chars().next_back() {
            Some(quote @ ('"' | '\'')) => before[..before.len() - 1].rfind(quote).unwrap_or(0),
            _ => before
                .trim_end_matches(|c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-')
                .len(),
        };
    }
    start
}

/// Returns the place of the comma behind a value, comments and breaks before it left out.
fn comma_after(text: &str, from: usize) -> Option<usize> {
    let mut at = from;
    loop {
        let rest = &text[at..];
        at += rest.len() - rest.trim_start().len();
        match text[at..].chars().next()? {
            ',' => return Some(at),
            '#' => at += text[at..].find('\n')?,
            _ => return None,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::write::TomlText;

    const OWNER: [&str; 3] = ["bodies", "bar", "markers"];

    /// Every way to write a table of markers in braces: entries, the gap before each, the comma and
    /// the comment behind each, and what stands before the brace at the end.
    fn texts() -> Vec<(usize, String)> {
        let gaps = [" ", "\n", "\n    ", "\n# a comma, a } and a { above\n"];
        let ends = ["", " ", " # pivot", " # a comma, a brace }", "\t# [0, 1"];
        let mut texts = Vec::new();
        for (entries, gap) in (0..4).flat_map(|entries| gaps.map(|gap| (entries, gap))) {
            for (end, has_last_comma) in ends.iter().flat_map(|end| [(end, false), (end, true)]) {
                let mut inside = String::new();
                for number in 0..entries {
                    let is_last = number + 1 == entries;
                    let comma = if is_last && !has_last_comma { "" } else { "," };
                    inside += &format!("{gap}M{number} = [0, {number}]{comma}{end}");
                    inside += if end.contains('#') { "\n" } else { "" };
                }
                for body in [
                    format!("[bodies]\nbar.markers = {{{inside} }}\nrest = 1\n"),
                    format!("[bodies.bar]\nmarkers = {{{inside} }}\n\n[joints]\n"),
                    format!("[bodies]\nbar = {{ mass = 1, markers = {{{inside} }} }}\n"),
                    format!(
                        "[bodies]\nbar = {{ mass = 1,{}, }}\n",
                        inside
                            .trim_end()
                            .trim_end_matches(',')
                            .replace(" M", " markers.M")
                            .replace("\nM", "\nmarkers.M")
                    ),
                ] {
                    if TomlText::new(body.as_str())
                        .is_ok_and(|text| text.keys(&OWNER).len() == entries)
                    {
                        texts.push((entries, body));
                    }
                }
            }
        }
        assert!(texts.len() > 200, "{}", texts.len());
        texts
    }

    fn comments(text: &str) -> usize {
        text.matches('#').count()
    }

    #[test]
    fn an_entry_is_added_to_every_table_in_braces() {
        for (entries, before) in texts() {
            let mut text = TomlText::new(before.as_str()).expect("it is TOML");
            for number in entries..entries + 2 {
                let name = format!("M{number}");
                let path = [&OWNER[..], &[&*name]].concat();
                text.set(&path, &format!("[0, {number}]"));
                let after = TomlText::new(text.as_str());
                let after = after.unwrap_or_else(|error| panic!("{before}\n{text:?}\n{error}"));
                assert_eq!(
                    after.keys(&OWNER).len(),
                    number + 1,
                    "{before}\n{}",
                    text.as_str()
                );
                assert_eq!(after.get(&path), Some(&*format!("[0, {number}]")));
            }
            assert_eq!(
                comments(text.as_str()),
                comments(&before),
                "{before}\n{}",
                text.as_str()
            );
        }
    }

    #[test]
    fn each_entry_is_removed_from_every_table_in_braces() {
        for (entries, before) in texts() {
            for number in 0..entries {
                let mut text = TomlText::new(before.as_str()).expect("it is TOML");
                text.remove(&[&OWNER[..], &[&*format!("M{number}")]].concat());
                let after = TomlText::new(text.as_str());
                let after = after.unwrap_or_else(|error| panic!("{before}\n{text:?}\n{error}"));
                assert_eq!(
                    after.keys(&OWNER).len(),
                    entries - 1,
                    "{before}\n{}",
                    text.as_str()
                );
                for other in (0..entries).filter(|other| *other != number) {
                    let name = format!("M{other}");
                    let path = [&OWNER[..], &[&*name]].concat();
                    assert_eq!(after.get(&path), Some(&*format!("[0, {other}]")));
                }
            }
        }
    }

    #[test]
    fn an_entry_on_its_own_line_gets_one_after_it() {
        let before =
            "[bodies.bar]\nmarkers = {\n    A = [0, 0], # pivot\n    B = [0.2, 0] # pin\n}\n";
        let mut text = TomlText::new(before).expect("it is TOML");
        text.set(&[&OWNER[..], &["C"]].concat(), "[1, 0]");
        assert_eq!(
            text.as_str(),
            "[bodies.bar]\nmarkers = {\n    A = [0, 0], # pivot\n    B = [0.2, 0], # pin\n    C = [1, 0]\n}\n"
        );
        text.remove(&[&OWNER[..], &["C"]].concat());
        text.remove(&[&OWNER[..], &["A"]].concat());
        assert_eq!(
            text.as_str(),
            "[bodies.bar]\nmarkers = {\n    B = [0.2, 0], # pin\n}\n"
        );
    }
}
