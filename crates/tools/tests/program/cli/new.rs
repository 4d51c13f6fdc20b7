//! `biela new`

use assert_cmd::Command;

use crate::cli::program::{biela, stderr, stdout};

#[test]
fn new_writes_a_mechanism_once() {
    let folder = tempfile::tempdir().unwrap();
    let new = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_biela"))
            .current_dir(folder.path())
            .arg("new")
            .args(arguments)
            .assert()
    };
    let message = stderr(&new(&["my_linkage"]).success());
    assert_eq!(
        message,
        "wrote my_linkage.toml; now: biela check my_linkage.toml\n"
    );
    // Commands can be pasted.
    std::fs::create_dir(folder.path().join("my own")).unwrap();
    let message = stderr(&new(&["a", "--folder", "my own"]).success());
    let path = std::path::Path::new("my own").join("a.toml");
    let path = path.display();
    let quote = if cfg!(windows) { '"' } else { '\'' };
    assert_eq!(
        message,
        format!("wrote {path}; now: biela check {quote}{path}{quote}\n")
    );
    std::fs::remove_dir_all(folder.path().join("my own")).unwrap();
    let text = std::fs::read_to_string(folder.path().join("my_linkage.toml")).unwrap();
    let shipped = crate::common::text("mechanisms/four_bar.toml");
    assert_eq!(
        text,
        shipped.replace("name = \"four_bar\"", "name = \"my_linkage\"")
    );
    let path = folder.path().join("my_linkage.toml");
    let checked = stdout(&biela(&["check", path.to_str().unwrap()]).success());
    assert!(checked.starts_with("my_linkage: "), "{checked}");
    // Nothing is overwritten, and tables come along.
    std::fs::write(&path, "mine").unwrap();
    let message = stderr(&new(&["my_linkage", "--from", "pendulum"]).code(2));
    assert!(
        message.contains("`my_linkage.toml` is there already"),
        "{message}"
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    new(&["cam", "--from", "cam_points"]).success();
    assert!(folder.path().join("cam_points.csv").is_file());
    let message = stderr(&new(&["cam_2", "--from", "cam_points"]).code(2));
    assert!(
        message.contains("`cam_points.csv` is there already"),
        "{message}"
    );
    assert!(!folder.path().join("cam_2.toml").exists());
    for name in ["2_bars", "four bar", "a/b", "int", "", "x.toml"] {
        let message = stderr(&new(&[name]).code(2));
        assert!(
            message.contains(&format!("`{name}` is no name")),
            "{message}"
        );
    }
    let message = stderr(&new(&["int"]).code(2));
    assert!(
        message.ends_with("; expected for example `int_1`\n"),
        "{message}"
    );
    let message = stderr(&new(&["x", "--from", "five_bar"]).code(2));
    assert!(message.contains("five_bar_robot"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}
