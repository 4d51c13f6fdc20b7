//! The text of a mechanism file, changed as a person would: each change replaces, adds or removes a
//! few letters, and all others stay.

use std::cell::OnceCell;
use std::ops::Range;
use std::rc::Rc;

use toml_edit::{Document, Item, Table, TomlError};

use super::braces::Braces;
use super::places::Places;
use super::section::sections;

/// The text of a file that is TOML.
#[derive(Clone, Debug)]
pub struct TomlText {
    text: String,
    /// Whether all its lines end with a carriage return, as those that are added will.
    has_returns: bool,
    /// The parsed text, until it changes.
    document: OnceCell<Rc<Document<String>>>,
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
    pub fn new(text: impl Into<String>) -> Result<Self, TomlError> {
        let text = text.into();
        let document = Document::parse(text.clone())?;
        let lines = text.matches('\n').count();
        Ok(Self {
            has_returns: lines > 0 && text.matches("\r\n").count() == lines,
            text,
            document: Rc::new(document).into(),
        })
    }

    /// Returns the text.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Returns the text of a value.
    pub fn get(&self, path: &[&str]) -> Option<&str> {
        let place = self.find(path)?.value;
        self.text.get(place)
    }

    /// Writes an item on one line: a table in braces.
    pub fn value(&self, path: &[&str]) -> String {
        if let Some(value) = self.get(path) {
            return value.to_owned();
        }
        let entries = self.keys(path).into_iter().map(|key| {
            let value = self.value(&[path, &[&*key]].concat());
            format!("{key} = {value}")
        });
        format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
    }

    /// Returns the place of a value.
    pub fn place(&self, path: &[&str]) -> Option<Range<usize>> {
        Some(self.find(path)?.value)
    }

    /// Returns the place of an element of a list.
    pub fn element(&self, path: &[&str], index: usize) -> Option<Range<usize>> {
        let document = self.document();
        item_at(document.as_table(), path)?
            .as_array()?
            .get(index)?
            .span()
    }

    /// Returns the place of a value, or of an element of the list there.
    pub fn number(&self, path: &[&str], element: Option<usize>) -> Option<Range<usize>> {
        match element {
            Some(index) => self.element(path, index),
            None => self.place(path),
        }
    }

    /// Returns whether there is an item.
    pub fn has(&self, path: &[&str]) -> bool {
        let document = self.document();
        item_at(document.as_table(), path).is_some()
    }

    /// Returns whether the item at a path is a table, in braces or not.
    pub fn has_keys(&self, path: &[&str]) -> bool {
        let document = self.document();
        item_at(document.as_table(), path).is_some_and(Item::is_table_like)
    }

    /// Returns the keys of a table, in their order; none of what is no table.
    pub fn keys(&self, path: &[&str]) -> Vec<String> {
        let document = self.document();
        let table = match path {
            [] => Some(document.as_item()),
            _ => item_at(document.as_table(), path),
        };
        let table = table.and_then(Item::as_table_like);
        let keys = table.into_iter().flat_map(|table| table.iter());
        keys.map(|(key, _)| key.to_owned()).collect()
    }

    /// Returns all keys and texts with their places.
    pub fn places(&self) -> Places {
        Places::of(&self.text)
    }

    /// Replaces a part of the text.
    pub fn replace(&mut self, place: Range<usize>, with: &str) {
        if self.has_returns {
            let lines = with.replace("\r\n", "\n").replace('\n', "\r\n");
            self.text.replace_range(place, &lines);
        } else {
            self.text.replace_range(place, with);
        }
        self.document = OnceCell::new();
    }

    /// Replaces parts of the text, which are in order and apart.
    pub fn replace_all(&mut self, parts: &[(Range<usize>, String)]) {
        for (place, with) in parts.iter().rev() {
            self.replace(place.clone(), with);
        }
    }

    /// Gives an item a value, which is TOML: the present one is replaced, a new one is added behind
    /// the others of its table. A table that does not exist is made.
    pub fn set(&mut self, path: &[&str], value: &str) {
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
            // A number or a text has no entries.
            Some(Item::Value(_)) => {
                if let Some(braces) = Braces::around(document.as_table(), path) {
                    self.replace_all(&braces.add(&self.text, value));
                }
            }
            Some(Item::Table(table)) if !table.is_implicit() && !table.is_dotted() => {
                let line = self.line_after(table, owner.is_empty());
                self.add_line(line, name, value);
            }
            Some(Item::Table(table)) if table.is_dotted() => {
                if let Some((line, key)) = self.dotted(table, name) {
                    self.add_line(line, &key, value);
                }
            }
            // It is there by the headers of its parts alone.
            Some(Item::Table(_)) => self.add_section(owner, &format!("{name} = {value}")),
            _ if owner.len() == 1
                || matches!(owner, ["ground", "markers" | "shapes"])
                || self.are_shapes_of_section(owner) =>
            {
                self.add_section(owner, &format!("{name} = {value}"));
            }
            _ => {
                let braces = format!("{{ {name} = {value} }}");
                self.set(owner, &braces);
            }
        }
    }

    /// Returns the end of the last line of a table that keys with points make, and its key `name` as
    /// these lines write it.
    fn dotted(&self, table: &Table, name: &str) -> Option<(usize, String)> {
        let first = table
            .iter()
            .next()
            .and_then(|(first, _)| table.key(first))?;
        let key = first.span()?.start;
        let line = self.text[..key].rfind('\n').map_or(0, |at| at + 1);
        let end = self.line_end(own_end(table)?);
        Some((end, format!("{}{name}", &self.text[line..key])))
    }

    /// Returns whether the shapes at a path can have a section of their own: their body has a header.
    fn are_shapes_of_section(&self, path: &[&str]) -> bool {
        let ["bodies", body, "shapes"] = path else {
            return false;
        };
        let document = self.document();
        let body = item_at(document.as_table(), &["bodies", body]);
        matches!(body, Some(Item::Table(body)) if !body.is_implicit() && !body.is_dotted())
    }

    /// Adds a section with its lines: behind the table in which it is, if that has a header, or behind the
    /// other ones of its kind, otherwise where the order of sections puts it.
    pub fn add_section(&mut self, path: &[&str], lines: &str) {
        let kind = path.first().copied().unwrap_or_default();
        let sections = sections();
        let place = sections.iter().position(|section| *section == kind);
        let before = place.map_or(&sections[..], |place| &sections[..=place]);
        let document = self.document();
        let owner = match path {
            [owner @ .., _] if owner.len() > 1 => item_at(document.as_table(), owner),
            _ => None,
        };
        let mut others = before.iter().rev();
        let end = owner
            .and_then(|owner| self.end_of(owner))
            .or_else(|| others.find_map(|kind| self.end_of(document.as_table().get(kind)?)))
            .unwrap_or_else(|| self.line_after(document.as_table(), true));
        let header = path.join(".");
        let gap = if end == 0 { "" } else { "\n" };
        let block = format!("{gap}\n[{header}]\n{lines}");
        let block = if end == 0 { block.trim_start() } else { &block };
        self.replace(end..end, block);
        self.end_with_newline();
    }

    /// Removes an item; comments above it stay, and a table that is empty then goes, too.
    pub fn remove(&mut self, path: &[&str]) {
        let document = self.document();
        let Some(item) = item_at(document.as_table(), path) else {
            return;
        };
        let mut cuts = Vec::new();
        self.lines_of(item, &mut cuts);
        if let Some(found) = self.find(path) {
            if found.in_braces {
                let braces = Braces::around(document.as_table(), path);
                cuts.extend(braces.and_then(|braces| braces.without(&self.text, found.key.start)));
            } else if item.is_value() {
                cuts.push(self.whole_lines(found.key.start..found.value.end));
            }
        }
        cuts.sort_by_key(|cut| cut.start);
        for cut in cuts.into_iter().rev() {
            let at = cut.start;
            self.replace(cut, "");
            self.close_gap(at);
        }
        if let Some((_, owner)) = path.split_last()
            && !owner.is_empty()
            && self.has(owner)
            && self.keys(owner).is_empty()
        {
            self.remove(owner);
        }
    }

    /// Removes an element of a list.
    pub fn remove_element(&mut self, path: &[&str], index: usize) {
        let [before, own, after] = [index.checked_sub(1), Some(index), index.checked_add(1)]
            .map(|index| self.element(path, index?));
        let cut = match (before, own, after) {
            (_, Some(own), Some(after)) => own.start..after.start,
            (Some(before), Some(own), None) => before.end..own.end,
            (None, Some(own), None) => own,
            (_, None, _) => return,
        };
        self.replace(cut, "");
    }

    // -- places --------------------------------------------------------------------------------

    fn document(&self) -> Rc<Document<String>> {
        let document = self.document.get_or_init(|| {
            let document = Document::parse(self.text.clone());
            Rc::new(document.expect("it was TOML when it was taken, and changes keep it so"))
        });
        Rc::clone(document)
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

    // -- changes -------------------------------------------------------------------------------

    /// Adds an entry behind a line, aligned with the entries above if they are aligned.
    fn add_line(&mut self, end: usize, name: &str, value: &str) {
        let above = self.text[..end].rsplit('\n').take(2).map(column);
        let above: Vec<Option<(usize, bool)>> = above.collect();
        let aligned = match above[..] {
            [Some((column, _)), Some((next, _))] if column == next => column,
            [Some((column, true)), ..] => column,
            _ => 0,
        };
        let aligned = aligned.max(name.len());
        let break_before = if end == 0 { "" } else { "\n" };
        let line = format!("{break_before}{name:aligned$} = {value}");
        self.replace(end..end, &line);
        self.end_with_newline();
    }

    fn end_with_newline(&mut self) {
        if !self.text.ends_with('\n') {
            self.replace(self.text.len()..self.text.len(), "\n");
        }
    }

    /// Leaves no two empty lines one after the other where lines were taken away, and none at the end.
    fn close_gap(&mut self, at: usize) {
        let (before, after) = self.text.split_at(at);
        let is_open = before.is_empty() || before.ends_with("\n\n");
        let gap = after.len() - after.trim_start_matches('\n').len();
        if is_open && gap > 0 {
            self.replace(at..at + gap, "");
        }
        while self.text.ends_with("\n\n") {
            self.replace(self.text.len() - 1..self.text.len(), "");
        }
    }
}

/// Returns the place of the sign `=` in a line with an entry, without the blank before it, and whether
/// there are more blanks.
fn column(line: &str) -> Option<(usize, bool)> {
    let at = line.find(" =")?;
    let name = &line[..at];
    let is_entry = !line.starts_with('[') && !name.contains(['"', '#']);
    is_entry.then_some((at, name.ends_with(' ')))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(text: &str, path: &[&str]) -> String {
        let mut text = TomlText::new(text).expect("it is TOML");
        text.set(path, "1");
        TomlText::new(text.as_str()).expect("it still is TOML");
        assert_eq!(text.get(path), Some("1"));
        text.as_str().to_owned()
    }

    #[test]
    fn a_table_of_parts_alone_gets_a_header() {
        assert_eq!(
            changed(
                "[bodies.crank.markers]\nA = 0\n[joints]\n",
                &["bodies", "crank", "mass"]
            ),
            "[bodies.crank.markers]\nA = 0\n\n[bodies.crank]\nmass = 1\n[joints]\n"
        );
    }

    #[test]
    fn a_table_of_keys_with_points_gets_another_one() {
        let path = ["bodies", "crank", "mass"];
        assert_eq!(
            changed("bodies.crank.center = [0, 0]\nname = 0\n", &path),
            "bodies.crank.center = [0, 0]\nbodies.crank.mass = 1\nname = 0\n"
        );
        assert_eq!(
            changed("[bodies]\ncrank.markers.A = 0\n", &path),
            "[bodies]\ncrank.markers.A = 0\ncrank.mass = 1\n"
        );
    }

    #[test]
    fn lines_end_as_those_of_the_text_do() {
        assert_eq!(
            changed(
                "\u{feff}[bodies.crank]\r\nmarkers = 0\r\n",
                &["bodies", "crank", "mass"]
            ),
            "\u{feff}[bodies.crank]\r\nmarkers = 0\r\nmass = 1\r\n"
        );
    }
}
