//! Mechanisms of other programs, read into one draft and written as mechanism files.
//!
//! | file | subject |
//! |---|---|
//! | `draft` | [`Draft`]: bodies, points, joints, motions and notes as a file of any format has them |
//! | `sketch` | a draft from named points, links through them and anchors |
//! | `asmt` | assemblies of FreeCAD and OndselSolver |
//! | `linkage2` | documents of Linkage |
//! | `pmks` | links of PMKS+ |
//! | `pylinkage` | JSON of pylinkage |
//! | `dxf` | drawings, by a convention on their layers, read and written |
//! | `names`, `text` | the mechanism file of a draft |
//! | `pins` | [`Pins`]: a mechanism as links through pins, for links of PMKS+, documents of Linkage and JSON of pylinkage |
//! | `ssp` | an FMU as a system of SSP |
//! | `freedom` | coordinates that nothing drives, for free motion |
//! | `others` | entries of a source that a reader does not take |
//! | `note` | [`Note`]: what did not come over, or came over changed |
//! | `error` | [`Error`]: why a file gives no mechanism |
//!
//! Readers look at nothing but the bytes that they are given, and bound their work by its length.

mod asmt;
mod draft;
mod dxf;
mod error;
mod freedom;
mod linkage2;
mod note;
mod others;
mod pins;
mod pmks;
mod pylinkage;
mod sketch;
mod source_names;
mod ssp;
mod text;

pub use asmt::AssemblyFile;
pub use draft::{Draft, LengthUnit};
pub use dxf::WorkshopDrawing;
pub use error::Error;
pub use linkage2::linkage_document;
pub use note::Note;
pub use pins::Pins;
pub use pmks::pmks_link;
pub use pylinkage::pylinkage_json;
pub use ssp::write_ssp;

/// Most bytes of a file that is read.
pub const MOST_BYTES: usize = 64 << 20;

/// Formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// An assembly of FreeCAD or OndselSolver.
    Asmt,
    /// A document of Linkage.
    Linkage,
    /// A link of PMKS+.
    Pmks,
    /// JSON of pylinkage.
    Pylinkage,
    /// A drawing in DXF.
    Dxf,
}

impl Format {
    /// Returns the format of a file by its extension, in small letters; otherwise by its content. A file
    /// with an extension of its own is one of these only if its content says so without doubt.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownFormat`] if neither tells it.
    pub fn of(extension: &str, content: &[u8]) -> Result<Self, Error> {
        match extension {
            "asmt" => return Ok(Self::Asmt),
            "linkage2" => return Ok(Self::Linkage),
            "json" => return Ok(Self::Pylinkage),
            "dxf" => return Ok(Self::Dxf),
            _ => {}
        }
        let is_text = matches!(extension, "" | "txt" | "url" | "pmks");
        let start = String::from_utf8_lossy(&content[..content.len().min(4096)]);
        let start = start.trim_start_matches('\u{feff}').trim_start();
        if start.starts_with("OndselSolver") || start.starts_with("freeCAD:") {
            Ok(Self::Asmt)
        } else if start.starts_with('<') && start.contains("<linkage2") {
            Ok(Self::Linkage)
        } else if start.starts_with("AutoCAD Binary DXF") || dxf::is_start(start) {
            Ok(Self::Dxf)
        } else if is_text && start.starts_with('{') {
            Ok(Self::Pylinkage)
        } else if is_text && pmks::is_start(start) {
            Ok(Self::Pmks)
        } else {
            Err(Error::UnknownFormat)
        }
    }

    /// Returns the name of the format.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Asmt => "OndselSolver",
            Self::Linkage => "Linkage",
            Self::Pmks => "PMKS+",
            Self::Pylinkage => "pylinkage",
            Self::Dxf => "DXF",
        }
    }

    /// Reads a file; `name` is the mechanism's if the file has none, `length` the unit of its lengths
    /// where it does not tell one.
    ///
    /// # Errors
    ///
    /// The reason why the bytes give no mechanism.
    pub fn read(
        self,
        content: &[u8],
        name: &str,
        length: Option<LengthUnit>,
    ) -> Result<Draft, Error> {
        if content.len() > MOST_BYTES {
            return Err(Error::TooLong);
        }
        let text = String::from_utf8_lossy(content);
        let text = text.trim_start_matches('\u{feff}');
        // Names of the source stand in messages and comments.
        let is_hidden = |c: char| c.is_control() && !"\n\r\t".contains(c);
        let text = &*text
            .replace(is_hidden, " ")
            .replace("\r\n", "\n")
            .replace('\r', " ");
        let mut draft = Draft::new(name, self.name());
        match self {
            Self::Asmt => asmt::read(text, length, &mut draft)?,
            Self::Linkage => linkage2::read(text, &mut draft)?,
            Self::Pmks => pmks::read(text, &mut draft)?,
            Self::Pylinkage => pylinkage::read(text, length, &mut draft)?,
            Self::Dxf => dxf::read(text, length, &mut draft)?,
        }
        draft.finish()?;
        freedom::choose_drivers(&mut draft);
        Ok(draft)
    }
}
