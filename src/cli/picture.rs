//! Pictures in the format that their file's extension says.

use std::path::Path;

use super::error::Error;
use super::output::write;
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
        if path.as_os_str() == "-" {
            return Ok(Self::Svg);
        }
        let extension = path
            .extension()
            .map(|extension| extension.to_ascii_lowercase());
        match extension
            .as_deref()
            .and_then(|extension| extension.to_str())
        {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
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
