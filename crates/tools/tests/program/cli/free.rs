//! `biela balance` and `biela linearize`

use serde_json::Value;

use crate::cli::program::{biela, stderr, stdout};

/// A rod of 2 kg whose centre of mass is 0.5 m from its pivot, with an inertia of 0.5 kg.m2 about it.
const ROD: &str = r#"
format = 1
name = "rod"
ground.markers = { O = [0, 0] }
bodies.rod = { mass = 2, center = [0.5, 0], markers = { O = [0, 0] } }
joints.O = { type = "revolute", markers = ["ground.O", "rod.O"] }
freedoms.swing = { coordinate = "angle", markers = ["ground.O", "rod.O"], start = "START*deg" }
forces.motor = { coordinate = "angle", markers = ["ground.O", "rod.O"] }
"#;

/// Runs a command on the rod and returns its answer.
fn answer(start: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    std::fs::write(&file, ROD.replace("START", start)).expect("it can be written");
    let mut all = vec![arguments[0], file.to_str().expect("UTF-8")];
    all.extend(&arguments[1..]);
    stdout(&biela(&all).success())
}

/// Two equal wheels with a ratio of 1/2 and a backlash of 1 deg, which overlap by 49.5 deg at the start.
const WHEELS: &str = r#"
format = 1
name = "wheels"
ground.markers = { O = [0, 0] }
bodies.a = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
bodies.b = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
joints.O = { type = "revolute", markers = ["ground.O", "a.O"] }
joints.P = { type = "revolute", markers = ["ground.O", "b.O"] }
joints.mesh = { type = "gear", markers = ["a.O", "b.O"], teeth = [20, 40], backlash = "1*deg" }
freedoms.p = { coordinate = "angle", markers = ["ground.O", "a.O"], start = "100*deg" }
freedoms.q = { coordinate = "angle", markers = ["ground.O", "b.O"] }
"#;

/// Each command that begins the motion warns once, and shows what results: 100 − 19.8 deg and −39.6 deg.
#[test]
fn a_start_at_which_parts_overlap_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("wheels.toml");
    std::fs::write(&file, WHEELS).expect("it can be written");
    let file = file.to_str().expect("UTF-8");
    let warning = "t = 0 s: the parts of joint `mesh` overlap by 49.5 deg; moved apart: `p` from 100 deg to \
                   80.2 deg, `q` from 0 deg to -39.6 deg";
    let answer = |arguments: &[&str]| {
        let assert = biela(arguments).success();
        let told = stderr(&assert);
        assert_eq!(told.matches(warning).count(), 1, "{told}");
        assert!(told.starts_with(&format!("warning: {warning}\n")), "{told}");
        stdout(&assert)
    };
    let checked = answer(&["check", file]);
    let expected = "assembled at\n  p = 80.200000 deg\n  q = -39.600000 deg\n";
    assert!(checked.contains(expected), "{checked}");
    answer(&["run", file, "-v", "p"]);
    answer(&["balance", file]);
    let xml = answer(&["export", file, "--model-description", "-"]);
    for (name, degrees) in [("p", 80.2_f64), ("q", -39.6)] {
        let variable = &xml[xml
            .find(&format!("name=\"{name}.position\""))
            .expect("an output")..];
        assert!(variable[..200].contains("initial=\"exact\""), "{variable}");
        let start = variable.split("start=\"").nth(1).expect("it has a start");
        let start: f64 = start[..start.find('"').expect("an end")]
            .parse()
            .expect("a number");
        assert!((start.to_degrees() - degrees).abs() < 1e-12, "{start}");
    }
    let report = stdout(&biela(&["check", file, "--format", "json"]).success());
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(
        report["assembled"]["overlaps"],
        serde_json::json!([warning])
    );
    let angle = report["assembled"]["drivers"][0]["value"]
        .as_f64()
        .expect("a number");
    assert!((angle.to_degrees() - 80.2).abs() < 1e-12, "{angle}");
}

/// As if the file had these starts. A run tells how well it has kept the energy.
#[test]
fn a_run_sets_the_start_of_a_freedom() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let run = |text: &str, set: &[&str]| {
        std::fs::write(&file, text).expect("it can be written");
        let mut all = vec!["run", file.to_str().expect("UTF-8"), "-o", "-"];
        all.extend(set);
        biela(&all)
    };
    let text = ROD.replace("START", "20");
    let set = [
        "--set",
        "swing.position=30*deg",
        "--set",
        "swing.velocity = -4",
    ];
    let set = run(&text, &set).success();
    let edited = ROD.replace("\"START*deg\"", "\"30*deg\", velocity = -4");
    let edited = run(&edited, &[]).success();
    assert_eq!(stdout(&set), stdout(&edited));
    let told = String::from_utf8_lossy(&set.get_output().stderr).into_owned();
    assert!(told.contains("error of the energy"), "{told}");

    let unknown = run(&text, &["--set", "swing.velocty=1"]).failure();
    let told = String::from_utf8_lossy(&unknown.get_output().stderr).into_owned();
    assert!(told.contains("`swing.velocity`"), "{told}");
    let endless = run(&text, &["--set", "swing.velocity=1/0"]).failure();
    let told = String::from_utf8_lossy(&endless.get_output().stderr).into_owned();
    assert!(told.contains("not a finite number"), "{told}");
}

/// Also from the very top, where the rod is in balance but not stable.
#[test]
fn a_rod_comes_down_to_rest() {
    for start in ["90", "89", "-30", "-90"] {
        let told = answer(start, &["balance"]);
        let is_down = ["= -90.000000 deg", "= 270.000000 deg"].map(|text| told.contains(text));
        assert!(is_down.contains(&true), "{start}: {told}");
    }
    // m g a cos(swing) = 9.81 N.m * 0.5 holds the rod at -60 degrees.
    let told = answer(
        "-90",
        &["balance", "--drive", "motor.effort = 2*9.81*0.5*0.5"],
    );
    assert!(told.contains("= -60.000000 deg"), "{told}");
}

/// A spring that is free at the top holds the rod at 60 degrees to either side, with k = m g a sin(60°)
/// over 60°.
#[test]
fn both_sides_of_a_top_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let k = 2.0 * 9.81 * 0.5 * 60.0_f64.to_radians().sin() / 60.0_f64.to_radians();
    let spring = format!(
        "forces.spring = {{ coordinate = \"angle\", markers = [\"ground.O\", \"rod.O\"], \
         stiffness = {k}, free = \"90*deg\" }}\n"
    );
    let text = ROD.replace("START", "100") + &spring;
    std::fs::write(&file, text).expect("it can be written");
    let file = file.to_str().expect("UTF-8");
    let one = stdout(&biela(&["balance", file]).success());
    assert!(
        one.starts_with("balanced at\n  swing = 150.000000 deg"),
        "{one}"
    );
    let all = stdout(&biela(&["balance", file, "--all"]).success());
    assert!(
        all.contains("1 of 2: balanced at\n  swing = 150.000000 deg"),
        "{all}"
    );
    assert!(
        all.contains("2 of 2: balanced at\n  swing = 30.000000 deg"),
        "{all}"
    );
    assert!(!all.contains("3 of"), "{all}");
}

/// Hanging it swings with the square of its frequency m g a / J; a torque accelerates it by 1 / J.
#[test]
fn a_hanging_rod_is_linear() {
    let text = answer("80", &["linearize", "--balance", "--variables", "rod.phi"]);
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let square = 2.0 * 9.81 * 0.5 / 0.5;
    for (matrix, row, column, expected) in [
        ("A", 0, 1, 1.0),
        ("A", 1, 0, -square),
        ("A", 1, 1, 0.0),
        ("B", 1, 0, 2.0),
        ("C", 0, 0, 1.0),
        ("D", 0, 0, 0.0),
    ] {
        let value = found[matrix][row][column].as_f64().expect("a number");
        // Some roundings of numbers of up to 20.
        assert!((value - expected).abs() < 1e-13, "{matrix}: {value}");
    }
}

/// m g a cos(30°) = 9.81 N.m * cos(30°) on the stop. There the rod does not move.
#[test]
fn a_rod_rests_on_a_stop_and_is_held() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let text = ROD.replace("START", "20") + "stops.low = { of = \"swing\", min = \"-30*deg\" }\n";
    std::fs::write(&file, text).expect("it can be written");
    let file = file.to_str().expect("UTF-8");
    let told = stdout(&biela(&["balance", file]).success());
    assert!(
        told.starts_with("balanced at\n  swing = -30.000000 deg\n  on stop `low`, 8.49571 N.m\n"),
        "{told}"
    );
    let run = biela(&["linearize", file, "--balance", "--variables", "rod.phi"]).success();
    let note = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(
        note.contains("on stop `low`, 8.49571 N.m: what is held"),
        "{note}"
    );
    let found: Value = serde_json::from_str(&stdout(&run)).expect("JSON");
    let force = found["held"]["low"].as_f64().expect("a number");
    assert!(
        (force - 9.81 * 30.0_f64.to_radians().cos()).abs() < 1e-10,
        "{force}"
    );
    for row in 0..2 {
        for column in 0..2 {
            let entry = found["A"][row][column].as_f64().expect("a number");
            assert!(entry.abs() < 1e-12, "{entry}");
        }
    }
}

/// Friction that holds the start is told with its limit, what gives way is told to be left out.
#[test]
fn friction_holds_or_is_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    for (force, place, told) in [
        (
            12,
            "0.000000 deg",
            "friction `pin` sticks, 9.81 N.m of up to 12 N.m",
        ),
        (9, "-90.000000 deg", "friction `pin` is left out"),
    ] {
        let friction = format!("friction.pin = {{ of = \"swing\", force = {force} }}\n");
        std::fs::write(&file, ROD.replace("START", "0") + &friction).expect("it can be written");
        let found = stdout(&biela(&["balance", file.to_str().expect("UTF-8")]).success());
        let expected = format!("balanced at\n  swing = {place}\n  {told}\n");
        assert!(found.starts_with(&expected), "{found}");
    }
}

/// An effort that nobody drives is zero in a column behind all others; a file of an earlier run drives it.
#[test]
fn efforts_that_are_inputs_have_columns() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let load = "forces.load = { marker = \"rod.O\" }\n";
    std::fs::write(&file, ROD.replace("START", "0") + load).expect("it can be written");
    let signals = folder.path().join("signals.csv");
    std::fs::write(&signals, "time,motor.effort,load.fy\n0,1,4\n1,2,4\n")
        .expect("it can be written");
    let rows = |arguments: &[&str]| -> Vec<Vec<f64>> {
        let file = file.to_str().expect("UTF-8");
        let run = [
            "run",
            file,
            "--stop",
            "1",
            "--step",
            "0.5",
            "-v",
            "motor,load",
        ];
        let csv = stdout(&biela(&[&run[..], arguments].concat()).success());
        let mut lines = csv.lines();
        assert_eq!(
            lines.next(),
            Some("time,motor.effort,load.fx,load.fy,load.torque")
        );
        let numbers = |line: &str| {
            line.split(',')
                .map(|x| x.parse().expect("a number"))
                .collect()
        };
        lines.map(numbers).collect()
    };
    let driven = |sizes: [[f64; 2]; 3]| {
        let rows = [0.0, 0.5, 1.0].into_iter().zip(sizes);
        rows.map(|(t, [effort, fy])| vec![t, effort, 0.0, fy, 0.0])
            .collect::<Vec<_>>()
    };
    assert_eq!(rows(&[]), driven([[0.0; 2]; 3]));
    let by_file = rows(&["--input", signals.to_str().expect("UTF-8")]);
    assert_eq!(by_file, driven([[1.0, 4.0], [1.5, 4.0], [2.0, 4.0]]));
    let by_option = rows(&["--drive", "motor.effort=1+t", "--drive", "load.fy=4"]);
    assert_eq!(by_option, by_file);
    let all = stdout(&biela(&["run", file.to_str().expect("UTF-8"), "--stop", "0"]).success());
    let header = all.lines().next().unwrap_or_default();
    let last = "energy.potential,motor.effort,load.fx,load.fy,load.torque";
    assert!(header.ends_with(last), "{header}");
}
