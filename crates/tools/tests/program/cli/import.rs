//! `biela import` and `biela convert`

use crate::cli::program::{biela, program, stderr, stdout};

/// Returns the path of a sample.
fn sample(name: &str) -> String {
    let folder = set_up::root().join("crates/tools/tests/exchange/samples");
    folder.join(name).to_string_lossy().into_owned()
}

#[test]
fn an_import_tells_its_notes_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let import = |arguments: &[&str]| {
        program()
            .current_dir(folder.path())
            .arg("import")
            .args(arguments)
            .assert()
    };
    let four_bar = sample("linkage2/four_bar.linkage2");
    let message = stderr(&import(&[&four_bar]).success());
    assert!(message.starts_with("note: left out, as they"), "{message}");
    assert!(
        message.ends_with("wrote four_bar.toml; now: biela check four_bar.toml\n"),
        "{message}"
    );
    let path = folder.path().join("four_bar.toml");
    let checked = stdout(&biela(&["check", path.to_str().unwrap()]).success());
    assert!(checked.contains("all driven"), "{checked}");
    // A file of the default name stays, one that is named is written anew.
    std::fs::write(&path, "mine").unwrap();
    let message = stderr(&import(&[&four_bar]).code(2));
    assert!(
        message.contains("`four_bar.toml` is there already"),
        "{message}"
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    import(&[&four_bar, "-o", "four_bar.toml"]).success();
    assert_ne!(std::fs::read_to_string(&path).unwrap(), "mine");
    let own = path.to_str().unwrap();
    let message = stderr(&import(&[own, "-o", own]).code(1));
    assert!(
        message.contains("no format that biela imports"),
        "{message}"
    );
}

#[test]
fn an_import_to_stdout_is_a_mechanism() {
    let text = stdout(&biela(&["import", &sample("dxf/four_bar.dxf"), "-o", "-"]).success());
    assert!(text.contains("\n[bodies.crank]\n"), "{text}");
    let link = std::fs::read_to_string(sample("pmks/four_bar.pmks.txt")).unwrap();
    let text = stdout(&biela(&["import", link.trim(), "-o", "-"]).success());
    assert!(text.contains("name = \"mechanism\""), "{text}");
}

#[test]
fn what_cannot_come_over_exits_with_1_and_a_missing_file_with_2() {
    for (name, expected) in [
        (
            "asmt/tilted.asmt",
            "joint `JD` (`RevoluteJoint`) is not in the plane",
        ),
        ("dxf/no_unit.dxf", "--length mm, cm, m or inch does"),
        ("pmks/changed.pmks.txt", "its check character"),
    ] {
        let file = sample(name);
        let message = stderr(&biela(&["import", &file, "-o", "-"]).code(1));
        assert!(message.contains(expected), "{message}");
        assert!(message.contains(name), "{message}");
    }
    let lengths = [
        "import",
        &sample("dxf/no_unit.dxf"),
        "--length",
        "mm",
        "-o",
        "-",
    ];
    assert!(stdout(&biela(&lengths).success()).contains("\"40*mm\""));
    biela(&["import", "no_such_file.asmt"]).code(2);
    biela(&["import", &sample("dxf/no_unit.dxf"), "--length", "foot"]).code(2);
}

#[test]
fn a_linkage_is_converted_and_another_mechanism_refused() {
    let link = stdout(&biela(&["convert", "mechanisms/four_bar.toml", "--to", "pmks"]).success());
    let back = stdout(&biela(&["import", link.trim(), "-o", "-"]).success());
    assert!(back.contains("[bodies.rocker]"), "{back}");
    let json =
        stdout(&biela(&["convert", "mechanisms/four_bar.toml", "--to", "pylinkage"]).success());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["links"].as_array().unwrap().len(), 4);
    let refused = biela(&["convert", "mechanisms/planetary_gear.toml", "--to", "pmks"]).code(1);
    assert!(stderr(&refused).contains("`inner` has no counterpart"));
    biela(&["convert", "mechanisms/four_bar.toml"]).code(2);
}

#[test]
fn a_drawing_for_the_workshop_has_no_options_of_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.dxf");
    let path = path.to_str().unwrap();
    let draw = |options: &[&str]| {
        let all = ["draw", "mechanisms/four_bar.toml", "-o", path];
        biela(&[&all, options].concat())
    };
    for option in [
        &["--poses", "3"][..],
        &["--dimensions"],
        &["--width", "100"],
    ] {
        let message = stderr(&draw(option).code(2));
        assert!(message.contains(option[0]), "{message}");
    }
    draw(&["--no-traces", "--drive", "crank_angle = 0"]).success();
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.ends_with("  0\nEOF\n") && !text.contains("\npath\n"));
}
