//! Helpers of the writers of XML.

use std::io;

use quick_xml::events::{BytesDecl, Event};
use quick_xml::writer::Writer;

/// A writer to memory.
pub(super) type Xml = Writer<Vec<u8>>;

/// A writer of one element to memory.
pub(super) type ElementWriter<'a> = quick_xml::writer::ElementWriter<'a, Vec<u8>>;

/// Returns the bytes of a document whose root element `root` writes.
pub(super) fn document(root: impl FnOnce(&mut Xml) -> io::Result<()>) -> Vec<u8> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    let declaration = Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None));
    let written = xml.write_event(declaration).and_then(|()| root(&mut xml));
    written.expect("writing to memory does not fail");
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    bytes
}

/// Optional attributes of an element, and its content.
pub(super) trait Element: Sized {
    /// Adds the attributes that have a value.
    fn with_optional(self, attributes: &[(&str, Option<&str>)]) -> Self;

    /// Writes the element with what `content` writes.
    fn with_content(self, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()>;

    /// Writes the element without content.
    fn empty(self) -> io::Result<()>;
}

impl Element for ElementWriter<'_> {
    fn with_optional(mut self, attributes: &[(&str, Option<&str>)]) -> Self {
        for &(name, value) in attributes {
            if let Some(value) = value {
                self = self.with_attribute((name, value));
            }
        }
        self
    }

    fn with_content(self, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
        self.write_inner_content(content).map(drop)
    }

    fn empty(self) -> io::Result<()> {
        self.write_empty().map(drop)
    }
}

/// Returns a text that is not empty.
pub(super) fn non_empty(text: &str) -> Option<&str> {
    Some(text).filter(|text| !text.is_empty())
}

/// Formats a number so that reading it gives the same bits.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Formats a Boolean.
pub(super) fn boolean(value: bool) -> &'static str {
    if value { "true" } else { "false" }
}
