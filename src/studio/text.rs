//! The text of a mechanism file, changed as a person would: each change replaces, adds or removes a
//! few letters, and all others stay.

use std::ops::Range;

use toml_edit::{Document, Item, Table, TomlError};

/// The sections of a mechanism file in the order in which new ones are put.
const SECTIONS: [&str; 13] = [
    "parameters",
    "ground",
    "bodies",
    "joints",
    "constraints",
    "drivers",
    "freedoms",
    "measures",
    "forces",
    "stops",
    "friction",
    "outputs",
    "simulation",
];
/// Longest line of a table with its entries.
const LINE: usize = 100;

/// The text of a file that is TOML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TomlText {
    text: String,
}

/// An item of the file: where its key and its value stand.
struct Found {
    key: Range<usize>,
    value: Range<usize>,
    /// The table in which it stands is written in braces.
    in_braces: bool,
}

impl TomlText {
    /// Takes a text.
    ///
    /// # Errors
    ///
    /// It is no TOML.
    pub(super) fn new(text: impl Into<String>) -> Result<Self, TomlError> {
        let text = text.into();
        Document::parse(&*text)?;
        Ok(Self { text })
    }

    /// Returns the text.
    pub(super) fn as_str(&self) -> &str {
        &self.text
    }

    /// Returns the text of a value.
    pub(super) fn get(&self, path: &[&str]) -> Option<&str> {
        let place = self.find(path)?.value;
        self.text.get(place)
    }

    /// Returns the place of a value.
    pub(super) fn place(&self, path: &[&str]) -> Option<Range<usize>> {
        Some(self.find(path)?.value)
    }

    /// Returns the place of an element of a list.
    pub(super) fn element(&self, path: &[&str], index: usize) -> Option<Range<usize>> {
        let document = self.document();
        item_at(document.as_table(), path)?
            .as_array()?
            .get(index)?
            .span()
    }

    /// Returns whether there is an item.
    pub(super) fn has(&self, path: &[&str]) -> bool {
        let document = self.document();
        item_at(document.as_table(), path).is_some()
    }

    /// Returns the keys of a table, in their order; none of what is no table.
    pub(super) fn keys(&self, path: &[&str]) -> Vec<String> {
        let document = self.document();
        let table = match path {
            [] => Some(document.as_item()),
            _ => item_at(document.as_table(), path),
        };
        let table = table.and_then(Item::as_table_like);
        let keys = table.into_iter().flat_map(|table| table.iter());
        keys.map(|(key, _)| key.to_owned()).collect()
    }

    /// Returns the texts of all strings in the file with their paths: of an entry of a list, that of
    /// the list.
    pub(super) fn strings(&self) -> Vec<(Vec<String>, Range<usize>)> {
        let document = self.document();
        let mut found = Vec::new();
        strings_in(document.as_item(), &mut Vec::new(), &mut found);
        found
    }

    /// Replaces a part of the text.
    pub(super) fn replace(&mut self, place: Range<usize>, with: &str) {
        self.text.replace_range(place, with);
    }

    /// Gives an item a value, which is TOML: the present one is replaced, a new one is added behind
    /// the others of its table. A table that does not exist is made.
    pub(super) fn set(&mut self, path: &[&str], value: &str) {
        if let Some(found) = self.find(path) {
            self.replace(found.value, value);
            return;
        }
        let Some((&name, owner)) = path.split_last() else {
            return;
        };
        let document = self.document();
        let owner_item = match owner {
            [] => Some(document.as_item()),
            _ => item_at(document.as_table(), owner),
        };
        match owner_item {
            Some(Item::Value(braces)) => {
                if let Some(place) = braces.span() {
                    let is_empty = braces.as_inline_table().is_none_or(|t| t.is_empty());
                    self.add_in_braces(place, name, value, is_empty);
                }
            }
            Some(Item::Table(table)) if !(table.is_implicit() && table.span().is_none()) => {
                let line = self.line_after(table, owner.is_empty());
                self.add_line(line, name, value);
            }
            _ if owner.len() == 1 || owner == ["ground", "markers"] => {
                self.add_section(owner, &format!("{name} = {value}"));
            }
            _ => {
                let braces = format!("{{ {name} = {value} }}");
                self.set(owner, &braces);
            }
        }
    }

    /// Adds a section with its lines: behind the other ones of its kind, otherwise where the order
    /// of sections puts it.
    pub(super) fn add_section(&mut self, path: &[&str], lines: &str) {
        let kind = path.first().copied().unwrap_or_default();
        let place = SECTIONS.iter().position(|section| *section == kind);
        let before = place.map_or(&SECTIONS[..], |place| &SECTIONS[..=place]);
        let document = self.document();
        let end = before
            .iter()
            .rev()
            .find_map(|section| self.end_of(document.as_table().get(section)?))
            .unwrap_or_else(|| self.line_after(document.as_table(), true));
        let header = path.join(".");
        let gap = if end == 0 { "" } else { "\n" };
        let block = format!("{gap}\n[{header}]\n{lines}");
        let block = if end == 0 { block.trim_start() } else { &block };
        self.text.insert_str(end, block);
        self.end_with_newline();
    }

    /// Removes an item; comments above it stay, and a table that is empty then goes, too.
    pub(super) fn remove(&mut self, path: &[&str]) {
        let document = self.document();
        let Some(item) = item_at(document.as_table(), path) else {
            return;
        };
        let mut cuts = Vec::new();
        self.lines_of(item, &mut cuts);
        if let Some(found) = self.find(path) {
            if found.in_braces {
                cuts = vec![self.entry_in_braces(&found)];
            } else if item.is_value() {
                cuts.push(self.whole_lines(found.key.start..found.value.end));
            }
        }
        cuts.sort_by_key(|cut| cut.start);
        for cut in cuts.into_iter().rev() {
            self.text.replace_range(cut, "");
        }
        if let Some((_, owner)) = path.split_last()
            && !owner.is_empty()
            && self.has(owner)
            && self.keys(owner).is_empty()
        {
            self.remove(owner);
        }
        self.close_gaps();
    }

    /// Gives an item another key; its place and all around it stay.
    pub(super) fn rename(&mut self, path: &[&str], name: &str) {
        let document = self.document();
        let mut keys = Vec::new();
        keys_named(document.as_table(), path, &mut keys);
        // A table may be spelled in several headers: `[bodies.arm]`, `[bodies.arm.markers]`.
        let mut places = keys;
        places.extend(self.header_keys(path));
        places.sort_by_key(|place: &Range<usize>| place.start);
        places.dedup();
        for place in places.into_iter().rev() {
            self.replace(place, name);
        }
    }

    // -- places --------------------------------------------------------------------------------

    fn document(&self) -> Document<String> {
        Document::parse(self.text.clone())
            .expect("it was TOML when it was taken, and changes keep it so")
    }

    fn find(&self, path: &[&str]) -> Option<Found> {
        let document = self.document();
        let (name, owner) = path.split_last()?;
        let owner = match owner {
            [] => document.as_item(),
            _ => item_at(document.as_table(), owner)?,
        };
        let table = owner.as_table_like()?;
        let (key, item) = table.get_key_value(name)?;
        Some(Found {
            key: key.span()?,
            value: item.as_value()?.span()?,
            in_braces: owner.is_value(),
        })
    }

    /// Returns the places of a name in the headers of tables that begin with a path.
    fn header_keys(&self, path: &[&str]) -> Vec<Range<usize>> {
        let mut found = Vec::new();
        let mut offset = 0;
        for line in self.text.split_inclusive('\n') {
            let trimmed = line.trim_start();
            if trimmed.starts_with('[') && !trimmed.starts_with("[[") {
                let start = offset + line.len() - trimmed.len() + 1;
                let end = trimmed.find(']').map_or(start, |end| start - 1 + end);
                let mut at = start;
                for (index, part) in self.text[start..end].split('.').enumerate() {
                    let name = part.trim();
                    let fits = path.get(index).is_some_and(|wanted| *wanted == name);
                    if !fits {
                        break;
                    }
                    if index + 1 == path.len() {
                        let from = at + part.len() - part.trim_start().len();
                        found.push(from..from + name.len());
                    }
                    at += part.len() + 1;
                }
            }
            offset += line.len();
        }
        found
    }

    /// Returns the end of the last line of a table's own entries.
    fn line_after(&self, table: &Table, is_root: bool) -> usize {
        let own = own_end(table).or_else(|| table.span().map(|header| header.end));
        match own {
            Some(end) => self.line_end(end),
            // A file that begins with a comment keeps it in front.
            None if is_root => self.head(),
            None => self.text.len(),
        }
    }

    /// Returns the end of the comments at the head of the file.
    fn head(&self) -> usize {
        let lines = self.text.split_inclusive('\n');
        let comments = lines.take_while(|line| line.starts_with('#'));
        comments.map(str::len).sum()
    }

    /// Returns the end of the last line of an item, with all tables in it.
    fn end_of(&self, item: &Item) -> Option<usize> {
        let last = last_place(item)?;
        Some(self.line_end(last))
    }

    fn line_end(&self, from: usize) -> usize {
        let rest = &self.text[from..];
        rest.find('\n').map_or(self.text.len(), |at| {
            let end = from + at;
            if self.text[..end].ends_with('\r') {
                end - 1
            } else {
                end
            }
        })
    }

    /// Returns the place of whole lines, with the break at their end.
    fn whole_lines(&self, place: Range<usize>) -> Range<usize> {
        let start = self.text[..place.start].rfind('\n').map_or(0, |at| at + 1);
        let end = self.text[place.end..].find('\n');
        start..end.map_or(self.text.len(), |at| place.end + at + 1)
    }

    /// Collects the lines of a table that has a header, and of all tables in it.
    fn lines_of(&self, item: &Item, cuts: &mut Vec<Range<usize>>) {
        let Some(table) = item.as_table() else {
            return;
        };
        if let Some(header) = table.span().filter(|_| !table.is_dotted()) {
            cuts.push(self.whole_lines(header));
        }
        for (name, inner) in table.iter() {
            if let (Some(key), Some(value)) = (
                table.key(name).and_then(toml_edit::Key::span),
                inner.as_value().and_then(toml_edit::Value::span),
            ) {
                cuts.push(self.whole_lines(key.start..value.end));
            }
            self.lines_of(inner, cuts);
        }
    }

    /// Returns the place of an entry in braces, with one of the commas beside it.
    fn entry_in_braces(&self, found: &Found) -> Range<usize> {
        let before = self.text[..found.key.start].trim_end();
        let after = &self.text[found.value.end..];
        let spaces = after.len() - after.trim_start().len();
        if before.ends_with(',') {
            before.len() - 1..found.value.end
        } else if after.trim_start().starts_with(',') {
            let end = found.value.end + spaces + 1;
            let blank = self.text[end..].len() - self.text[end..].trim_start().len();
            found.key.start..end + blank
        } else {
            found.key.start..found.value.end + spaces
        }
    }

    // -- changes -------------------------------------------------------------------------------

    fn add_in_braces(&mut self, braces: Range<usize>, name: &str, value: &str, is_empty: bool) {
        let inside = &self.text[braces.start + 1..braces.end - 1];
        let kept = inside.trim_end();
        let end = braces.start + 1 + kept.len();
        let comma = match (is_empty, kept.ends_with(',')) {
            (true, _) | (_, true) => " ",
            _ => ", ",
        };
        let entry = format!("{comma}{name} = {value} ");
        self.replace(end..braces.end - 1, &entry);
    }

    /// Adds an entry behind a line, aligned as that line is.
    fn add_line(&mut self, end: usize, name: &str, value: &str) {
        let start = self.text[..end].rfind('\n').map_or(0, |at| at + 1);
        let line = &self.text[start..end];
        let aligned = line
            .find(" =")
            .filter(|at| !line.starts_with('[') && !line[..*at].contains(['"', '#']))
            .map_or(name.len(), |at| at.max(name.len()));
        let break_before = if end == 0 { "" } else { "\n" };
        let line = format!("{break_before}{name:aligned$} = {value}");
        self.text.insert_str(end, &line);
        self.end_with_newline();
    }

    fn end_with_newline(&mut self) {
        if !self.text.ends_with('\n') {
            self.text.push('\n');
        }
    }

    /// Leaves no two empty lines one after the other, and none at the end.
    fn close_gaps(&mut self) {
        while let Some(at) = self.text.find("\n\n\n") {
            self.text.remove(at);
        }
        while self.text.ends_with("\n\n") {
            self.text.pop();
        }
    }
}

/// Writes entries in braces, or says that they are too long for one line with `name` in front.
pub(super) fn in_braces(name: &str, entries: &[(String, String)]) -> Option<String> {
    let entries: Vec<String> = (entries.iter())
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    let braces = format!("{{ {} }}", entries.join(", "));
    (name.len() + 3 + braces.len() <= LINE).then_some(braces)
}

/// Returns an item by its path.
fn item_at<'a>(table: &'a Table, path: &[&str]) -> Option<&'a Item> {
    let (first, rest) = path.split_first()?;
    let mut item = table.get(first)?;
    for name in rest {
        item = item.as_table_like()?.get(name)?;
    }
    Some(item)
}

/// Returns the end of the last own value of a table: of dotted keys, too.
fn own_end(table: &Table) -> Option<usize> {
    let ends = table.iter().filter_map(|(_, item)| match item {
        Item::Value(value) => Some(value.span()?.end),
        Item::Table(inner) if inner.is_dotted() => own_end(inner),
        _ => None,
    });
    ends.max()
}

fn last_place(item: &Item) -> Option<usize> {
    match item {
        Item::Value(value) => Some(value.span()?.end),
        Item::Table(table) => {
            let header = table.span().map(|span| span.end);
            let inner = table.iter().filter_map(|(_, item)| last_place(item));
            inner.chain(header).max()
        }
        _ => None,
    }
}

fn keys_named(table: &Table, path: &[&str], places: &mut Vec<Range<usize>>) {
    let Some((name, owner)) = path.split_last() else {
        return;
    };
    let owner = match owner {
        [] => Some(table as &dyn toml_edit::TableLike),
        _ => item_at(table, owner).and_then(Item::as_table_like),
    };
    if let Some((key, item)) = owner.and_then(|owner| owner.get_key_value(name))
        && item.is_value()
    {
        places.extend(key.span());
    }
}

fn strings_in(item: &Item, path: &mut Vec<String>, found: &mut Vec<(Vec<String>, Range<usize>)>) {
    if let Some(table) = item.as_table_like() {
        for (key, inner) in table.iter() {
            path.push(key.to_owned());
            strings_in(inner, path, found);
            path.pop();
        }
    } else if let Item::Value(value) = item {
        strings_of(value, path, found);
    }
}

fn strings_of(
    value: &toml_edit::Value,
    path: &[String],
    found: &mut Vec<(Vec<String>, Range<usize>)>,
) {
    match value {
        toml_edit::Value::String(_) => {
            found.extend(value.span().map(|place| (path.to_vec(), place)));
        }
        toml_edit::Value::Array(array) => {
            for inner in array {
                strings_of(inner, path, found);
            }
        }
        toml_edit::Value::InlineTable(table) => {
            // A table within a list.
            let mut path = path.to_vec();
            for (key, inner) in table.iter() {
                path.push(key.to_owned());
                strings_of(inner, &path, found);
                path.pop();
            }
        }
        _ => {}
    }
}
