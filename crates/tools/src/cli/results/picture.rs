//! Pictures in the format of their file's extension.

use std::path::Path;

use super::output::{tell_written, write};
use super::stdout::is_stdout;
use crate::cli::told::error::Error;
use crate::drawing::{Sheet, png, svg};

/// The format of a picture.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) enum Format {
    Svg,
    Png,
}

/// Width of a chart in pixels.
const PLOT_WIDTH: u32 = 800;
/// Width of a PNG in pixels: sharp on most screens and on paper.
const PNG_WIDTH: u32 = 1600;

/// Checks that the file of a page is called like one.
pub(in crate::cli) fn check_page(path: &Path) -> Result<(), Error> {
    if is_stdout(path) || matches!(&*extension(path), "html" | "htm") {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "`{}` has neither the extension .html nor .htm",
        path.display()
    )))
}

impl Format {
    /// Returns the format of a file; `-` is SVG.
    pub(in crate::cli) fn of(path: &Path) -> Result<Self, Error> {
        if is_stdout(path) {
            return Ok(Self::Svg);
        }
        match &*extension(path) {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            extension => {
                let film = match extension {
                    "gif" => "; `biela run --animate` writes pictures that move",
                    _ => "",
                };
                Err(Error::Usage(format!(
                    "`{}` has neither the extension .svg nor .png{film}",
                    path.display()
                )))
            }
        }
    }

    /// Returns the usual width of a picture in pixels: a PNG's, or `of_svg`.
    pub(in crate::cli) fn width(self, of_svg: u32) -> u32 {
        match self {
            Self::Svg => of_svg,
            Self::Png => PNG_WIDTH,
        }
    }

    /// Writes a chart.
    pub(in crate::cli) fn write_chart(self, path: &Path, sheet: &Sheet) -> Result<(), Error> {
        self.write(path, sheet, self.width(PLOT_WIDTH), false)
    }

    /// Writes a picture `width` pixels wide, and tells so.
    pub(in crate::cli) fn write(
        self,
        path: &Path,
        sheet: &Sheet,
        width: u32,
        transparent: bool,
    ) -> Result<(), Error> {
        write(path, &self.picture(sheet, width, transparent)?)?;
        tell_written(path);
        Ok(())
    }

    /// Returns a picture `width` pixels wide.
    pub(in crate::cli) fn picture(
        self,
        sheet: &Sheet,
        width: u32,
        transparent: bool,
    ) -> Result<Vec<u8>, Error> {
        match self {
            Self::Svg => Ok(svg::write(sheet, width, transparent).into_bytes()),
            Self::Png => png::write(sheet, width, transparent)
                .ok_or_else(|| Error::Usage(format!("no PNG is {width} pixels wide"))),
        }
    }
}

/// Returns a file's extension in small letters; an empty text if it has none.
pub(in crate::cli) fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}
