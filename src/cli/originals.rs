//! The files that a command reads, over which it writes nothing.

use std::path::{Path, PathBuf};

use same_file::Handle;

use super::error::Error;
use super::output::{is_stdout, shown};
use crate::mechanism::Mechanism;

/// What a command reads.
pub(super) struct Originals {
    /// Each with what it is.
    files: Vec<(&'static str, PathBuf)>,
}

impl Originals {
    /// A mechanism file and the tables that it names.
    pub(super) fn new(file: &Path, mechanism: &Mechanism) -> Self {
        let tables = tables(file, mechanism).map(|path| ("a table of the mechanism", path));
        let files = std::iter::once(("the mechanism file", file.to_owned()));
        Self {
            files: files.chain(tables).collect(),
        }
    }

    /// One more file that is read.
    pub(super) fn with(mut self, what: &'static str, path: &Path) -> Self {
        self.files.push((what, path.to_owned()));
        self
    }

    /// Refuses outputs of which one would be written over another, or over what is read.
    pub(super) fn refuse_as(&self, outputs: &[Option<&Path>]) -> Result<(), Error> {
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
            if let Some((what, file)) =
                files.find(|(_, file)| !is_stdout(output) && same(output, file))
            {
                return Err(Error::Usage(format!(
                    "nothing is written to {}: it is {what}, `{}`",
                    shown(output),
                    file.display()
                )));
            }
        }
        Ok(())
    }
}

/// The tables that a mechanism file names.
pub(super) fn tables(file: &Path, mechanism: &Mechanism) -> impl Iterator<Item = PathBuf> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let tables = mechanism.table_files.iter();
    tables.map(move |table| folder.join(&table.name))
}

/// Whether two paths lead to one file, whether it is there or not. What is no file, such as a
/// terminal, is not written over.
fn same(a: &Path, b: &Path) -> bool {
    if is_stdout(a) || is_stdout(b) {
        return is_stdout(a) && is_stdout(b);
    }
    match (a.is_file(), b.is_file()) {
        (true, true) => {
            let links = (Handle::from_path(a).ok()).zip(Handle::from_path(b).ok());
            links.is_some_and(|(a, b)| a == b) || at_one_place(a, b)
        }
        (false, false) if !a.exists() && !b.exists() => at_one_place(a, b),
        _ => false,
    }
}

fn at_one_place(a: &Path, b: &Path) -> bool {
    place(a).is_some_and(|a| place(b).is_some_and(|b| a == b))
}

/// The one path of a file, or of one that would be in a folder that is there.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = match path.parent()? {
        folder if folder.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let new = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(new)
}
