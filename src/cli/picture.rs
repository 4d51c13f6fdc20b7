//! Pictures in the format of their file's extension.

use std::path::Path;

use super::error::Error;
use super::output::{tell_written, write};
use super::stdout::is_stdout;
use crate::drawing::{Sheet, png, svg};

/// The format of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) enum Format {
    Svg,
    Png,
}

/// Width of a chart in pixels.
const PLOT_WIDTH: u32 = 800;

impl Format {
    /// Returns the format of a file; `-` is SVG.
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

    /// Writes a chart; as a PNG with twice the pixels, so that it is sharp on most screens.
    pub(super) fn write_chart(self, path: &Path, sheet: &Sheet) -> Result<(), Error> {
        let width = match self {
            Self::Svg => PLOT_WIDTH,
            Self::Png => 2 * PLOT_WIDTH,
        };
        self.write(path, sheet, width, false)
    }

    /// Writes a picture `width` pixels wide, and tells so.
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
        write(path, &picture)?;
        tell_written(path);
        Ok(())
    }
}

/// Returns a file's extension in small letters; an empty text if it has none.
pub(super) fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}
