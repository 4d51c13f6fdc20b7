//! `terminalsAndIcons.xml` (FMI 3.0, 2.4.9), which FMUs of FMI 2.0 may have as well.

use std::io;

use super::Document;
use super::xml::{Element, Xml, document, non_empty, number};

/// Path of the file in the archive.
pub(in crate::fmi) const PATH: &str = "terminalsAndIcons/terminalsAndIcons.xml";
/// Path of the icon in the archive.
const ICON: &str = "terminalsAndIcons/icon.png";

/// Half the extent of the standard's coordinate system.
const EXTENT: f64 = 100.0;

/// A group of variables that are connected together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Name, unique among the terminals.
    pub name: String,
    /// One line for people; may be empty.
    pub description: String,
    /// Variables of the terminal.
    pub members: Vec<Member>,
}

/// A variable of a terminal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name within the terminal, by which hosts match terminals.
    pub name: String,
    /// Name of the variable.
    pub variable: String,
    /// Whether the values at connected terminals add up to zero, as those of a force do.
    pub is_flow: bool,
}

/// Returns the file; `None` if there are neither terminals nor an icon among the documents.
pub(in crate::fmi) fn write(terminals: &[Terminal], documents: &[Document]) -> Option<Vec<u8>> {
    let icon = documents.iter().find(|document| document.path == ICON);
    if terminals.is_empty() && icon.is_none() {
        return None;
    }
    Some(document(|xml| {
        xml.create_element("fmiTerminalsAndIcons")
            .with_attribute(("fmiVersion", "3.0"))
            .with_content(|xml| {
                if let Some(icon) = icon {
                    write_icon(xml, &icon.content)?;
                }
                write_terminals(xml, terminals)
            })
    }))
}

/// Writes the place of the icon: as large as the coordinate system, with the picture's own ratio of
/// width and height.
fn write_icon(xml: &mut Xml, png: &[u8]) -> io::Result<()> {
    let [width, height] = png_size(png).unwrap_or([1.0; 2]);
    let scale = EXTENT / width.max(height);
    let [x, y] = [width, height].map(|length| (scale * length).round());
    xml.create_element("GraphicalRepresentation")
        .with_content(|xml| {
            xml.create_element("Icon")
                .with_attributes([
                    ("x1", number(-x).as_str()),
                    ("y1", &number(-y)),
                    ("x2", &number(x)),
                    ("y2", &number(y)),
                ])
                .empty()
        })
}

/// Returns width and height of a PNG, which its first chunk has.
fn png_size(png: &[u8]) -> Option<[f64; 2]> {
    let side = |at: usize| {
        let bytes = png.get(at..at + 4)?.try_into().ok()?;
        Some(f64::from(u32::from_be_bytes(bytes)))
    };
    let size = [side(16)?, side(20)?];
    size.iter().all(|side| *side > 0.0).then_some(size)
}

fn write_terminals(xml: &mut Xml, terminals: &[Terminal]) -> io::Result<()> {
    // The schema forbids an empty list.
    if terminals.is_empty() {
        return Ok(());
    }
    xml.create_element("Terminals").with_content(|xml| {
        for terminal in terminals {
            xml.create_element("Terminal")
                .with_attributes([("name", terminal.name.as_str()), ("matchingRule", "bus")])
                .with_optional(&[("description", non_empty(&terminal.description))])
                .with_content(|xml| {
                    for member in &terminal.members {
                        let kind = if member.is_flow { "inflow" } else { "signal" };
                        xml.create_element("TerminalMemberVariable")
                            .with_attributes([
                                ("variableName", member.variable.as_str()),
                                ("memberName", &member.name),
                                ("variableKind", kind),
                            ])
                            .empty()?;
                    }
                    Ok(())
                })?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_icon_keeps_its_ratio() {
        let mut content = vec![0; 24];
        content[16..20].copy_from_slice(&512_u32.to_be_bytes());
        content[20..24].copy_from_slice(&256_u32.to_be_bytes());
        let icon = Document {
            path: ICON.to_owned(),
            content,
        };
        let xml = write(&[], &[icon]).expect("there is an icon");
        let xml = String::from_utf8(xml).expect("XML is text");
        let expected = r#"<Icon x1="-100.0" y1="-50.0" x2="100.0" y2="50.0"/>"#;
        assert!(xml.contains(expected), "{xml}");
        assert_eq!(write(&[], &[]), None);
    }
}
