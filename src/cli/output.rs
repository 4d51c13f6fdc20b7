//! Where results go.

use std::io::Write;
use std::path::Path;

use super::error::Error;

/// Writes a file, or to stdout for `-`.
pub(super) fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    let written = if path.as_os_str() == "-" {
        std::io::stdout().write_all(content)
    } else {
        std::fs::write(path, content)
    };
    written.map_err(|source| Error::Write {
        path: path.to_owned(),
        source,
    })
}
