//! `--set` of commands that read a file as if it had other values, `run --quiet` and `run --events`.

use serde_json::Value;

use crate::cli::program::{altered, biela, column, stderr, stdout};

/// A bead above a stop: it falls by 0.05 m onto it and bounces with a restitution of 1/2.
const BEAD: &str = r#"
format = 1
name = "bead"
[ground.markers]
O = [0, 0, "90*deg"]
[parameters]
weight = 1
[bodies.bead]
mass = "weight"
markers = { O = [0, 0, "90*deg"] }
[joints]
rail = { type = "translational", markers = ["ground.O", "bead.O"] }
[freedoms]
height = { coordinate = "x", markers = ["ground.O", "bead.O"], start = 0.05 }
[stops]
table = { of = "height", min = 0, restitution = 0.5 }
"#;

fn bead(folder: &tempfile::TempDir) -> String {
    let file = folder.path().join("bead.toml");
    std::fs::write(&file, BEAD).expect("the folder is ours");
    file.to_str().expect("UTF-8").to_owned()
}

#[test]
fn check_tells_the_mechanism_with_the_values_that_are_set() {
    let set = ["--set", "crank_length=120*mm"];
    let plain = biela(&["check", "mechanisms/four_bar.toml"]).success();
    let told = biela(&[&["check", "mechanisms/four_bar.toml"], &set[..]].concat()).success();
    // The coupler begins at the end of the crank: 0.1 m and 0.12 m at 60 deg.
    for (answer, [x, y]) in [
        (stdout(&plain), ["0.050000", "0.086603"]),
        (stdout(&told), ["0.060000", "0.103923"]),
    ] {
        let coupler = answer
            .lines()
            .find(|line| line.trim().starts_with("coupler"));
        let words: Vec<_> = coupler.expect("it is listed").split_whitespace().collect();
        assert_eq!(words[1..3], [x, y], "{answer}");
    }
    let json = &["check", "mechanisms/four_bar.toml", "--format", "json"];
    let json = stdout(&biela(&[json, &set[..]].concat()).success());
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    let x = json["assembled"]["bodies"][1]["x"].as_f64();
    let x = x.or(json["assembled"]["bodies"][1]["q"][0].as_f64());
    assert!((x.expect("it has a place") - 0.06).abs() < 1e-12, "{json}");
}

#[test]
fn an_exported_model_has_the_values_that_are_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = |path, set| {
        let file = "mechanisms/four_bar.toml";
        let mut arguments = vec!["export", file, "--model-description", path];
        arguments.extend(set);
        arguments
    };
    let set = ["--set", "crank_length=120*mm"];
    let description = stdout(&biela(&arguments("-", set.to_vec())).success());
    // As an FMU of a file that has the value.
    let changed = altered(
        folder.path(),
        "four_bar",
        &[("value = 0.10", "value = 0.12")],
    );
    let expected = biela(&["export", &changed, "--model-description", "-"]).success();
    assert_eq!(description, stdout(&expected));
    let plain = stdout(&biela(&arguments("-", vec![])).success());
    assert_ne!(description, plain);
}

#[test]
fn settings_that_are_none_are_refused_by_each_command() {
    for command in ["check", "export", "page"] {
        let refused = biela(&[
            command,
            "mechanisms/four_bar.toml",
            "--set",
            "crank_lenth=1",
        ]);
        let told = stderr(&refused.code(2));
        assert!(told.contains("--set: no parameter `crank_lenth`"), "{told}");
        assert!(told.contains("crank_length"), "{told}");
    }
}

/// It falls from h to the stop in sqrt(2 h/g), arrives with sqrt(2 g h), and is up for g t = v.
#[test]
fn events_are_a_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bead(&folder);
    let arguments = [
        "run", &file, "--stop", "0.24", "--step", "0.12", "--events", "-",
    ];
    let run = biela(&arguments).success();
    let table = stdout(&run);
    assert!(table.starts_with("time,kind,name,speed\n"), "{table}");
    let rows: Vec<Vec<&str>> = table.lines().map(|row| row.split(',').collect()).collect();
    assert!(rows.len() > 2 && rows[1..].iter().all(|row| row[1..3] == ["impact", "table"]));
    let (g, h): (f64, f64) = (9.81, 0.05);
    let fall = (2.0 * h / g).sqrt();
    let speed = (2.0 * g * h).sqrt();
    let expected = [[fall, speed], [fall + speed / g, 0.5 * speed]];
    let [times, speeds] = ["time", "speed"].map(|name| column(&table, name));
    for (k, [time, speed]) in expected.into_iter().enumerate() {
        // The tolerance of free motion is 1e-8 or less.
        assert!((times[k] - time).abs() < 1e-8, "{table}");
        assert!((speeds[k] - speed).abs() < 1e-7, "{table}");
    }
}

#[test]
fn a_quiet_run_tells_errors_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bead(&folder);
    let results = folder.path().join("bead.csv");
    let results = results.to_str().expect("UTF-8");
    let run = |more: &[&str]| {
        let arguments = ["run", &file, "--stop", "0.24", "-o", results];
        biela(&[&arguments[..], more].concat())
    };
    let told = stderr(&run(&[]).success());
    for part in ["impact", "wrote", "free motion"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert_eq!(stderr(&run(&["--quiet"]).success()), "");
    let told = stderr(&run(&["--quiet", "--set", "wight=2"]).code(2));
    assert!(told.contains("did you mean `weight`"), "{told}");
}
