//! Files that a command writes and does not overwrite.

use std::io::Write as _;
use std::path::Path;

use crate::cli::told::error::Error;
use crate::cli::told::message::tell;

/// Writes a new file.
pub(in crate::cli) fn create(path: &Path, text: &str) -> Result<(), Error> {
    let created = std::fs::File::create_new(path);
    let written = created.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|source| match source.kind() {
        std::io::ErrorKind::AlreadyExists => exists(path),
        _ => Error::write(path)(source),
    })
}

/// Quotes an argument for a shell, if that is necessary.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./:\\,+@%=".contains(c);
    let special = |c: char| !plain(c) || (c == '\\' && !cfg!(windows));
    if !argument.contains(special) {
        argument.to_owned()
    } else if cfg!(windows) {
        // No file name on Windows has a double quote.
        format!("\"{argument}\"")
    } else {
        format!("'{}'", argument.replace('\'', "'\\''"))
    }
}

/// Returns the error of a file that is there already.
pub(in crate::cli) fn exists(path: &Path) -> Error {
    Error::Usage(format!("`{}` is there already", path.display()))
}

/// Tells that a mechanism file was written, and the command that checks it.
pub(in crate::cli) fn tell_now_check(path: &Path) {
    let (shown, quoted) = (path.display(), quoted(&path.to_string_lossy()));
    tell(format_args!("wrote {shown}; now: biela check {quoted}"));
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[cfg(not(windows))]
    #[test]
    fn what_a_shell_would_take_apart_is_quoted() {
        for plain in ["a.toml", "./sub-1/a_b.toml", "../año/x.toml"] {
            assert_eq!(quoted(plain), plain);
        }
        for (special, expected) in [
            ("a b.toml", "'a b.toml'"),
            ("$HOME/a.toml", "'$HOME/a.toml'"),
            ("a\\b", "'a\\b'"),
            ("it's", "'it'\\''s'"),
            ("~/a", "'~/a'"),
        ] {
            assert_eq!(quoted(special), expected);
        }
    }
}
