//! Helpers of the writers of XML.

use std::io;

use quick_xml::events::{BytesDecl, Event};
use quick_xml::writer::{ElementWriter, Writer};

/// A writer to memory.
pub(super) type Xml = Writer<Vec<u8>>;

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

/// Attributes that an element has only if they have a value.
pub(super) trait WithOptional {
    fn with_optional(self, attributes: &[(&str, Option<&str>)]) -> Self;
}

impl WithOptional for ElementWriter<'_, Vec<u8>> {
    fn with_optional(mut self, attributes: &[(&str, Option<&str>)]) -> Self {
        for &(name, value) in attributes {
            if let Some(value) = value {
                self = self.with_attribute((name, value));
            }
        }
        self
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
