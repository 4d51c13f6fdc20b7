//! Pictures in the format that their file's extension says.

use std::path::Path;

use super::error::Error;
use super::output::{is_stdout, write};
use crate::drawing::{Sheet, png, svg};

/// What to write.
#[derive(Clone, Copy, Debug)]
pub(super) enum Format {
    Svg,
    Png,
}

/// Width of a chart in pixels.
pub(super) const PLOT_WIDTH: u32 = 800;

impl Format {
    /// The pixels for a picture of this width: a PNG has twice as many, so that it is sharp on
    /// most screens.
    pub(super) fn width(self, width: u32) -> u32 {
        match self {
            Self::Svg => width,
            Self::Png => 2 * width,
        }
    }

    /// The format of a file; `-` is SVG.
    pub(super) fn of(path: &Path) -> Result<Self, Error> {
        if is_stdout(path) {
            return Ok(Self::Svg);
        }
        match &*extension(path) {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            _ => Err(Error::Usage(format!(
                "`{}` has neither the extension .svg nor .png",
                path.display()
            ))),
        }
    }

    /// Writes a picture so many pixels wide.
    pub(super) fn write(
        self,
        path: &Path,
        sheet: &Sheet,
        width: u32,
        transparent: bool,
    ) -> Result<(), Error> {
        let picture = match self {
            Self::Svg => svg::write(sheet, width, transparent).into_bytes(),
            Self::Png => png::write(sheet, width, transparent)
                .ok_or_else(|| Error::Usage(format!("no PNG is {width} pixels wide")))?,
        };
        write(path, &picture)
    }
}

/// The extension of a file in small letters, empty if it has none.
pub(super) fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}
