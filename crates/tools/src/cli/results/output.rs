//! Writing results to files and to stdout.

use std::io::Write;
use std::path::Path;

use super::stdout::{STDOUT, is_stdout};
use crate::cli::told::error::Error;
use crate::cli::told::message::remark;

/// Writes a file, or to stdout for `-`.
pub(in crate::cli) fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    let written = if is_stdout(path) {
        let mut stdout = std::io::stdout().lock();
        // An error in the buffered rest would be lost when the program ends.
        stdout.write_all(content).and_then(|()| stdout.flush())
    } else {
        std::fs::write(path, content)
    };
    written.map_err(Error::write(path))
}

/// Prints to stdout.
pub(in crate::cli) fn print(text: &str) -> Result<(), Error> {
    write(Path::new(STDOUT), text.as_bytes())
}

/// Tells on stderr that a file was written; nothing for stdout, which shows it itself.
pub(in crate::cli) fn tell_written(path: &Path) {
    if !is_stdout(path) {
        remark(format_args!("wrote {}", path.display()));
    }
}
