//! Documents of Linkage (`.linkage2`): connectors, links through them, and ratios of gears.
//!
//! | file | subject |
//! |---|---|
//! | `xml` | the XML as a tree of elements |
//! | `keys` | elements and attributes that are taken, and those that only concern the picture |
//! | `document` | bodies and pins |
//! | `drive` | inputs and actuators |
//! | `way` | sliders, gears and chains |
//! | `write` | documents from links through pins |

mod document;
mod drive;
mod keys;
mod way;
mod write;
mod xml;

use super::draft::{Draft, LengthUnit};
use super::error::Error;
use document::Document;
pub use write::linkage_document;

/// Units of a document per inch, whatever unit it shows.
const PER_INCH: f64 = 96.0;

/// Reads a file.
pub(super) fn read(text: &str, draft: &mut Draft) -> Result<(), Error> {
    let root = xml::parse(text)?;
    if root.name != "linkage2" {
        let found = format!("<{}>", root.name);
        return Err(Error::unexpected(root.line, &found, "`<linkage2>`"));
    }
    let program = root.children.iter().find(|child| child.name == "program");
    let units = program.and_then(|program| program.text("units"));
    draft.unit = match units {
        Some("Inches") => LengthUnit::Inch,
        _ => LengthUnit::Millimetre,
    };
    // Six decimals of a 96th of an inch.
    draft.digits = 9;
    let per_unit = match draft.unit {
        LengthUnit::Inch => PER_INCH,
        _ => PER_INCH / 25.4,
    };
    Document::read(&root, per_unit)?.draft(draft)?;
    keys::note_others(&root, draft);
    Ok(())
}
