//! The program: it is run, and what it writes is read.

use std::path::Path;

use assert_cmd::Command;
use assert_cmd::assert::Assert;

/// The program, in the project's folder.
pub(crate) fn program() -> Command {
    // Exporting packs it.
    let _ = set_up::runtime_library();
    let mut command = Command::new(env!("CARGO_BIN_EXE_biela"));
    command
        .current_dir(set_up::root())
        .env_remove("SOURCE_DATE_EPOCH");
    command
}

pub(crate) fn biela(arguments: &[&str]) -> Assert {
    program().args(arguments).assert()
}

pub(crate) fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).expect("output is text")
}

pub(crate) fn stderr(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).expect("output is text")
}

/// A mechanism file made from a shipped one.
pub(crate) fn altered(folder: &Path, name: &str, changes: &[(&str, &str)]) -> String {
    let mut text = crate::common::text(&format!("mechanisms/{name}.toml"));
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).expect("the folder is ours");
    path.to_str()
        .expect("temporary folders have plain names")
        .to_owned()
}

/// Column `name` of a CSV.
pub(crate) fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let header = lines.next().expect("there is a header");
    let index = header
        .split(',')
        .position(|column| column == name)
        .unwrap_or_else(|| panic!("no column {name} in {header}"));
    lines
        .map(|line| {
            line.split(',')
                .nth(index)
                .expect("rows are complete")
                .parse()
                .expect("columns are numbers")
        })
        .collect()
}
