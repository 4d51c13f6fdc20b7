//! The XML of a document as a tree of elements.

use std::collections::HashMap;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::exchange::error::{self, Error};

/// Deepest element: a real document has four levels.
const DEEPEST: usize = 32;

/// An element with its attributes and those below it.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) attributes: HashMap<String, String>,
    pub(super) children: Vec<Element>,
    pub(super) line: usize,
}

impl Element {
    pub(super) fn text(&self, key: &str) -> Option<&str> {
        self.attributes.get(key).map(String::as_str)
    }

    pub(super) fn is(&self, key: &str) -> bool {
        self.text(key)
            .is_some_and(|value| value == "true" || value == "1")
    }

    /// Returns a number, 0 if it is missing.
    pub(super) fn number(&self, key: &str) -> Result<f64, Error> {
        self.text(key)
            .map_or(Ok(0.0), |text| error::number(text, self.line))
    }

    pub(super) fn id(&self) -> Result<&str, Error> {
        self.text("id").ok_or_else(|| Error::Missing {
            line: self.line,
            place: format!("`{}`", error::start_of(&self.name)),
            key: "id",
        })
    }

    /// Returns a name: its own, or its id after a word.
    pub(super) fn label(&self, word: &str) -> String {
        match self
            .text("name")
            .map(str::trim)
            .filter(|name| !name.is_empty())
        {
            Some(name) => error::start_of(name),
            None => error::start_of(&format!("{word}{}", self.text("id").unwrap_or_default())),
        }
    }

    /// Returns the ids of elements of this name below, or in an attribute of the name.
    pub(super) fn ids<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        let below = self.children.iter().filter(move |child| child.name == name);
        let below = below.filter_map(|child| child.text("id"));
        below.chain(self.text(name))
    }
}

/// Reads the elements of an XML text.
pub(super) fn parse(text: &str) -> Result<Element, Error> {
    let mut reader = Reader::from_str(text);
    let line_at = |position: u64| {
        let end = usize::try_from(position).unwrap_or(usize::MAX);
        let before = &text.as_bytes()[..end.min(text.len())];
        1 + before.iter().filter(|byte| **byte == b'\n').count()
    };
    let bad = |position: u64, reason: &dyn std::fmt::Display| Error::Xml {
        line: line_at(position),
        reason: error::start_of(&reason.to_string()),
    };
    // Lines are counted from the last element on.
    let (mut counted, mut line) = (0, 1);
    let mut open: Vec<Element> = Vec::new();
    loop {
        let event = reader
            .read_event()
            .map_err(|error| bad(reader.error_position(), &error))?;
        let position = usize::try_from(reader.buffer_position()).unwrap_or(text.len());
        let position = position.min(text.len());
        let passed = &text.as_bytes()[counted.min(position)..position];
        line += passed.iter().filter(|byte| **byte == b'\n').count();
        counted = position;
        let closed = match event {
            Event::Start(start) => {
                open.push(element(&start, line)?);
                if open.len() > DEEPEST {
                    return Err(Error::TooDeep { line });
                }
                None
            }
            Event::Empty(start) => Some(element(&start, line)?),
            Event::End(_) => open.pop(),
            Event::Eof => {
                return Err(bad(
                    reader.buffer_position(),
                    &"it ends before its first element does",
                ));
            }
            _ => None,
        };
        if let Some(closed) = closed {
            match open.last_mut() {
                Some(parent) => parent.children.push(closed),
                None => return Ok(closed),
            }
        }
    }
}

fn element(start: &BytesStart, line: usize) -> Result<Element, Error> {
    let mut attributes = HashMap::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|error| Error::Xml {
            line,
            reason: error::start_of(&error.to_string()),
        })?;
        let value = quick_xml::escape::unescape(&attribute.value).map_err(|error| Error::Xml {
            line,
            reason: error::start_of(&error.to_string()),
        })?;
        attributes.insert(attribute.key.as_ref().to_owned(), value.into_owned());
    }
    Ok(Element {
        name: start.name().as_ref().to_owned(),
        attributes,
        children: Vec::new(),
        line,
    })
}
