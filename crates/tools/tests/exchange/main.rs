//! Mechanisms of other programs: read, written as mechanism files, and moved.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod answers;
mod back;
mod cases;
mod keys;
mod motion;

use std::path::PathBuf;

use biela_tools::exchange::{Draft, Error, Format};

/// The sample files of a format, in order.
fn samples(format: &str) -> Vec<PathBuf> {
    let folder = common::folder("crates/tools/tests/exchange/samples").join(format);
    let entries = std::fs::read_dir(folder).expect("it is part of the project");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("it can be read").path())
        .collect();
    paths.sort();
    paths
}

/// Reads a sample file as the program does.
fn import(path: &std::path::Path) -> Result<Draft, Error> {
    let content = std::fs::read(path).expect("it can be read");
    let extension = path.extension().expect("it has one").to_string_lossy();
    let format = Format::of(&extension, &content)?;
    let stem = path.file_stem().expect("it has a name").to_string_lossy();
    format.read(&content, stem.trim_end_matches(".pmks"), None)
}
