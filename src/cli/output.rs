//! Where results go.

use std::io::Write;
use std::path::Path;

use super::error::Error;

/// The path that stands for stdout.
pub(super) const STDOUT: &str = "-";

pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == STDOUT
}

/// A place for results as messages name it.
pub(super) fn shown(path: &Path) -> String {
    if is_stdout(path) {
        "stdout".to_owned()
    } else {
        format!("`{}`", path.display())
    }
}

/// Writes a file, or to stdout for `-`.
pub(super) fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    let written = if is_stdout(path) {
        let mut stdout = std::io::stdout().lock();
        // What stdout holds back would be lost without a word.
        stdout.write_all(content).and_then(|()| stdout.flush())
    } else {
        std::fs::write(path, content)
    };
    written.map_err(|source| Error::Write {
        path: path.to_owned(),
        source,
    })
}

/// Prints to stdout, where the reader may have gone.
pub(super) fn print(text: &str) -> Result<(), Error> {
    write(Path::new(STDOUT), text.as_bytes())
}
