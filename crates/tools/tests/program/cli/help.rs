//! Help texts, the schema of the file format, and completions for shells.

use crate::cli::program::{biela, stderr, stdout};

#[test]
fn help_goes_to_stdout() {
    for arguments in [
        &["-h"][..],
        &["--help"],
        &["check", "-h"],
        &["run", "--help"],
        &["draw", "--help"],
        &["export", "-h"],
        &["new", "-h"],
        &["import", "--help"],
        &["range", "--help"],
        &["tolerance", "--help"],
        &["watch", "--help"],
        &["page", "--help"],
        &["studio", "--help"],
        &["report", "-h"],
        &["convert", "-h"],
        &["schema", "--help"],
        &["completions", "-h"],
    ] {
        let assert = biela(arguments).success();
        assert!(stdout(&assert).contains("Usage: biela"), "{arguments:?}");
        assert_eq!(stderr(&assert), "");
    }
    let version = concat!("biela ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(stdout(&biela(&["--version"]).success()), version);
}

#[test]
fn schema_and_completions_are_printed() {
    let printed = stdout(&biela(&["schema"]).success());
    let schema: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(schema["properties"]["format"]["const"], 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("biela.schema.json");
    biela(&["schema", "-o", path.to_str().unwrap()]).success();
    assert_eq!(std::fs::read_to_string(path).unwrap(), printed);
    for (shell, wanted) in [
        ("bash", "complete -F"),
        ("zsh", "#compdef biela"),
        ("fish", "complete -c biela"),
    ] {
        let script = stdout(&biela(&["completions", shell]).success());
        assert!(
            script.contains(wanted) && script.contains("model-description"),
            "{shell}"
        );
    }
    biela(&["completions", "tcsh"]).code(2);
}
