//! The path `-`, which stands for stdout.

use std::path::Path;

/// The path that stands for stdout.
pub(in crate::cli) const STDOUT: &str = "-";

/// Returns whether a path stands for stdout.
pub(in crate::cli) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == STDOUT
}

/// Returns the name of an output for messages.
pub(in crate::cli) fn shown(path: &Path) -> String {
    if is_stdout(path) {
        "stdout".to_owned()
    } else {
        format!("`{}`", path.display())
    }
}
