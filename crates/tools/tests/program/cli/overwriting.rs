//! Results are not written over what is read, nor over one another.

use std::path::Path;

use crate::cli::program::{altered, program, stderr, stdout};

/// A command in a folder is refused, says so, and leaves all files as they are.
fn refused(folder: &Path, arguments: &[&str], expected: &str) {
    let files = || {
        let entries = std::fs::read_dir(folder).expect("it is there");
        let mut files: Vec<_> = entries
            .map(|entry| entry.expect("it can be read").path())
            .map(|path| (std::fs::read(&path).unwrap_or_default(), path))
            .collect();
        files.sort();
        files
    };
    let before = files();
    let assert = program()
        .current_dir(folder)
        .args(arguments)
        .assert()
        .code(2);
    assert_eq!(stdout(&assert), "", "{arguments:?}");
    assert_eq!(stderr(&assert), format!("error: {expected}\n"));
    assert!(files() == before, "{arguments:?}");
}

#[test]
fn the_mechanism_file_stays_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    altered(folder, "tlv", &[]);
    std::fs::create_dir(folder.join("sub")).unwrap();
    // Whatever the name, it may have the extension of a result.
    for name in ["tlv.svg", "tlv.html", "tlv.dxf"] {
        std::fs::hard_link(folder.join("tlv.toml"), folder.join(name)).unwrap();
    }
    for (arguments, output) in [
        (&["run", "tlv.toml", "-o"][..], "tlv.toml"),
        (&["run", "tlv.toml", "-o"], "sub/../tlv.toml"),
        (&["run", "tlv.toml", "--plot"], "tlv.svg"),
        (&["run", "tlv.toml", "--animate"], "tlv.html"),
        (&["range", "tlv.toml", "--csv"], "./tlv.toml"),
        (&["range", "tlv.toml", "--plot"], "tlv.svg"),
        (&["draw", "tlv.toml", "-o"], "tlv.svg"),
        (&["export", "tlv.toml", "-o"], "tlv.toml"),
        (&["report", "tlv.toml", "-o"], "tlv.html"),
        (&["draw", "tlv.toml", "-o"], "tlv.dxf"),
        (&["export", "tlv.toml", "--model-description"], "tlv.toml"),
    ] {
        let expected = format!("nothing is written to `{output}`: it is the mechanism file");
        let all: Vec<&str> = arguments.iter().copied().chain([output]).collect();
        refused(folder, &all, &format!("{expected}, `tlv.toml`"));
    }
    // Without a name, `draw` writes to the mechanism's with .svg.
    refused(
        folder,
        &["draw", "tlv.svg"],
        "nothing is written to `tlv.svg`: it is the mechanism file, `tlv.svg`",
    );
}

#[cfg(unix)]
#[test]
fn a_link_to_the_mechanism_file_is_that_file() {
    let folder = tempfile::tempdir().unwrap();
    altered(folder.path(), "tlv", &[]);
    std::os::unix::fs::symlink("tlv.toml", folder.path().join("link.csv")).unwrap();
    refused(
        folder.path(),
        &["run", "tlv.toml", "-o", "link.csv"],
        "nothing is written to `link.csv`: it is the mechanism file, `tlv.toml`",
    );
}

#[test]
fn tables_and_inputs_stay_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    altered(folder, "cam_points", &[]);
    std::fs::copy(
        crate::common::folder("mechanisms/cam_points.csv"),
        folder.join("cam_points.csv"),
    )
    .unwrap();
    for command in ["run", "export"] {
        refused(
            folder,
            &[command, "cam_points.toml", "-o", "cam_points.csv"],
            "nothing is written to `cam_points.csv`: it is a table of the mechanism, \
             `cam_points.csv`",
        );
    }
    altered(folder, "tlv", &[]);
    std::fs::write(folder.join("in.csv"), "time,side_length\n0,0.3\n1,0.4\n").unwrap();
    refused(
        folder,
        &["run", "tlv.toml", "--input", "in.csv", "-o", "./in.csv"],
        "nothing is written to `./in.csv`: it is the file of --input, `in.csv`",
    );
}

#[test]
fn two_results_have_two_places() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    altered(folder, "tlv", &[]);
    // The files are not there yet.
    refused(
        folder,
        &["run", "tlv.toml", "-o", "a.html", "--animate", "./a.html"],
        "two results would be written to one file: `a.html` and `./a.html`",
    );
    refused(
        folder,
        &["range", "tlv.toml", "--csv", "-", "--plot", "-"],
        "only one result can be written to stdout",
    );
    for arguments in [
        &["run", "tlv.toml", "-o", "a.csv", "--plot", "a.svg"][..],
        // Results of before may be written over.
        &["run", "tlv.toml", "-o", "a.csv", "--plot", "a.svg"],
        &["run", "tlv.toml", "--plot", "-"],
    ] {
        program()
            .current_dir(folder)
            .args(arguments)
            .assert()
            .success();
    }
}
