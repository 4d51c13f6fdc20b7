//! The files that a command reads, which it must not overwrite.

use std::path::{Path, PathBuf};

use same_file::Handle;

use crate::cli::results::stdout::{is_stdout, shown};
use crate::cli::told::error::Error;
use biela::mechanism::Mechanism;

/// The files that a command reads.
pub(in crate::cli) struct InputFiles {
    /// Each with its kind, in words.
    files: Vec<(&'static str, PathBuf)>,
}

impl InputFiles {
    /// Returns a mechanism file and the tables that it names.
    pub(in crate::cli) fn new(file: &Path, mechanism: &Mechanism) -> Self {
        let tables = tables(file, mechanism).map(|path| ("a table of the mechanism", path));
        let files = std::iter::once(("the mechanism file", file.to_owned()));
        Self {
            files: files.chain(tables).collect(),
        }
    }

    /// Returns one file that is no mechanism file.
    pub(in crate::cli) fn only(kind: &'static str, file: &Path) -> Self {
        Self {
            files: vec![(kind, file.to_owned())],
        }
    }

    /// Adds one more file.
    pub(in crate::cli) fn add(&mut self, kind: &'static str, path: &Path) {
        self.files.push((kind, path.to_owned()));
    }

    /// Refuses outputs of which one would overwrite another one or an input file.
    pub(in crate::cli) fn refuse_as_outputs(&self, outputs: &[Option<&Path>]) -> Result<(), Error> {
        let outputs: Vec<&Path> = outputs.iter().copied().flatten().collect();
        for (index, output) in outputs.iter().enumerate() {
            if let Some(other) = outputs[..index].iter().find(|other| same(output, other)) {
                return Err(Error::Usage(if is_stdout(output) {
                    "only one result can be written to stdout".to_owned()
                } else {
                    format!(
                        "two results would be written to one file: {} and {}",
                        shown(other),
                        shown(output)
                    )
                }));
            }
            let mut files = self.files.iter();
            if let Some((kind, file)) =
                files.find(|(_, file)| !is_stdout(output) && same(output, file))
            {
                return Err(Error::Usage(format!(
                    "nothing is written to {}: it is {kind}, `{}`",
                    shown(output),
                    file.display()
                )));
            }
        }
        Ok(())
    }
}

/// Returns the tables that a mechanism file names.
pub(in crate::cli) fn tables(file: &Path, mechanism: &Mechanism) -> impl Iterator<Item = PathBuf> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let tables = mechanism.table_files.iter();
    tables.map(move |table| folder.join(&table.name))
}

/// Returns whether two paths lead to one file, which need not exist. A terminal or a device is no
/// file: writing there overwrites nothing.
fn same(a: &Path, b: &Path) -> bool {
    if is_stdout(a) || is_stdout(b) {
        return is_stdout(a) && is_stdout(b);
    }
    match (a.is_file(), b.is_file()) {
        (true, true) => {
            let links = (Handle::from_path(a).ok()).zip(Handle::from_path(b).ok());
            links.is_some_and(|(a, b)| a == b) || have_same_place(a, b)
        }
        (false, false) if !a.exists() && !b.exists() => have_same_place(a, b),
        _ => false,
    }
}

fn have_same_place(a: &Path, b: &Path) -> bool {
    place(a).is_some_and(|a| place(b).is_some_and(|b| a == b))
}

/// Returns the canonical path of a file, or of a new file in an existing folder.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = match path.parent()? {
        folder if folder.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let new = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(new)
}
