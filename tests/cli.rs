//! The commands as a user types them.

mod common;

use std::io::Read as _;
use std::path::Path;

use assert_cmd::Command;
use assert_cmd::assert::Assert;

fn biela(arguments: &[&str]) -> Assert {
    Command::new(env!("CARGO_BIN_EXE_biela"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env_remove("SOURCE_DATE_EPOCH")
        .args(arguments)
        .assert()
}

fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).expect("output is text")
}

fn stderr(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).expect("output is text")
}

/// A mechanism file made from a shipped one.
fn altered(folder: &Path, name: &str, changes: &[(&str, &str)]) -> String {
    let mut text =
        std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped");
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

#[test]
fn check_describes_a_mechanism() {
    let assert = biela(&["check", "mechanisms/four_bar.toml"]).success();
    assert_eq!(stderr(&assert), "");
    insta::assert_snapshot!(
        stdout(&assert).split("\n  residual").next().unwrap_or_default(),
        @r"
    four_bar: Crank–rocker four-bar linkage (cuadrilátero articulado)

      bodies                 3    crank, coupler, rocker
      unknowns               9    x, y, phi of each body
      constraints            8    O2 (2), A (2), B (2), O4 (2)
      drivers                1    crank_angle (input)
      degrees of freedom     1    all driven

    assembled at
      crank_angle = 60.000000 deg

      body            x [m]         y [m]     phi [deg]     moved [m]  turned [deg]
      crank        0.000000      0.000000     60.000000      0.000000      0.000000
      coupler      0.050000      0.086603     41.451706      0.003397     21.451706
      rocker       0.400000      0.000000    122.824780      0.000000     12.824780

      transmission = 81.373073 deg
    "
    );
}

/// What stands behind the line that starts with `heading`.
fn behind<'a>(text: &'a str, heading: &str) -> &'a str {
    let (_, behind) = text.split_once(heading).expect("it is there");
    behind.split_once('\n').expect("there is more").1
}

/// Pasted into the file, the estimates that `check` prints are the pose: to the digits printed.
#[test]
fn printed_estimates_can_be_pasted() {
    for name in common::stems("mechanisms", "toml") {
        let file = format!("mechanisms/{name}.toml");
        let assert = biela(&["check", &file, "--estimates"]).success();
        let output = stdout(&assert);
        let text = std::fs::read_to_string(common::folder(&file)).expect("it is shipped");
        let text = common::pasted(&text, behind(&output, "estimates of this pose"));
        // A file with tables beside it can only be read from its folder.
        if text.contains(".csv") {
            continue;
        }
        let (solver, _) = common::assembled(&common::parse(&text));
        let moves = solver.moves().expect("estimates are numbers");
        for moved in moves {
            // Twelve digits of a length below 1 m, or of 360 degrees.
            assert!(
                moved.length < 1e-11 && moved.angle < 1e-10,
                "{name}: {moved:?}"
            );
        }
    }
}

#[test]
fn modes_are_listed_with_their_estimates() {
    let assert = biela(&["check", "mechanisms/four_bar.toml", "--modes"]).success();
    insta::assert_snapshot!(behind(&stdout(&assert), "  residual"), @r#"

    1 other way to close at these values (these are all)

    # 1: reciprocal condition 5.09e-1, largest move from the estimates 1.73

    [bodies.crank]
    estimate = [0, 0, "60*deg"]
    [bodies.coupler]
    estimate = [0.05, 0.0866025403784, "-69.2474787749*deg"]
    [bodies.rocker]
    estimate = [0.4, 0, "209.379447784*deg"]
    "#);
}

#[test]
fn a_mechanism_that_does_not_close_is_shown_at_its_nearest() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("value = 0.10", "value = 0.80")],
    );
    let assert = biela(&["check", &file, "--estimates"]).code(1);
    insta::assert_snapshot!(behind(&stdout(&assert), "  drivers"), @r#"

    not assembled; the pose that comes nearest

      body            x [m]         y [m]     phi [deg]     moved [m]  turned [deg]
      crank        0.000000      0.000000     60.000000      0.000000      0.000000
      coupler      0.400000      0.692820    -90.000000      0.697060    110.000000
      rocker       0.400000      0.142820     90.000000      0.142820     20.000000

    estimates of this pose, to paste into the tables of the bodies

    [bodies.crank]
    estimate = [0, 0, "60*deg"]
    [bodies.coupler]
    estimate = [0.4, 0.692820323028, "-90*deg"]
    [bodies.rocker]
    estimate = [0.4, 0.142820323028, "90*deg"]
    "#);
    assert!(
        stderr(&assert).contains("the mechanism cannot close: joint `O4` stays open by 142.8 mm")
    );
}

#[test]
fn redundant_constraints_are_named_and_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let again = "A_again = { type = \"revolute\", markers = [\"crank.A\", \"coupler.A\"] }";
    let file = altered(
        folder.path(),
        "four_bar",
        &[("\n[drivers]", &format!("{again}\n\n[drivers]"))],
    );
    let assert = biela(&["check", &file]).success();
    assert_eq!(
        stderr(&assert),
        "warning: constraint equations of joint `A_again` are redundant: 2 of its 2 follow from \
         the others; they are set aside and watched\n"
    );
    let text = stdout(&assert);
    let line = "  redundant              2    2 of the 2 of joint `A_again`\n";
    assert!(text.contains(line), "{text}");
    assert!(
        text.contains("  degrees of freedom     1    all driven\n"),
        "{text}"
    );
}

#[test]
fn check_tells_scripts_what_it_finds() {
    let folder = tempfile::tempdir().unwrap();
    let check = |arguments: &[&str], code: i32| {
        let mut all = vec!["check", "--format", "json"];
        all.extend(arguments);
        let assert = biela(&all).code(code);
        assert_eq!(stderr(&assert), "");
        serde_json::from_str::<serde_json::Value>(&stdout(&assert)).unwrap()
    };
    let good = check(&["mechanisms/four_bar.toml", "--modes"], 0);
    assert_eq!(good["ok"], true);
    assert_eq!(good["diagnostics"].as_array().map(Vec::len), Some(0));
    assert_eq!(good["mechanism"]["name"], "four_bar");
    assert_eq!(good["mechanism"]["unknowns"], 9);
    let joint = serde_json::json!({ "name": "O2", "equations": 2 });
    assert_eq!(good["mechanism"]["joints"][0], joint);
    let crank = &good["assembled"]["bodies"][0];
    assert!((crank["phi"].as_f64().unwrap() - 60_f64.to_radians()).abs() < 1e-12);
    assert_eq!(good["assembled"]["measures"][0]["unit"], "rad");
    assert_eq!(
        good["assembled"]["modes"]["others"]
            .as_array()
            .map(Vec::len),
        Some(1)
    );

    // A file that is wrong, with the places.
    let file = altered(
        folder.path(),
        "four_bar",
        &[("\"crank.A\", ", "\"crank.AA\", ")],
    );
    let bad = check(&[&file], 1);
    assert_eq!(bad["ok"], false);
    let diagnostic = &bad["diagnostics"][0];
    assert_eq!(diagnostic["severity"], "error");
    assert_eq!(diagnostic["code"], "unknown-marker");
    let start = &diagnostic["labels"][0]["start"];
    let text = std::fs::read_to_string(&file).unwrap();
    let line = usize::try_from(start["line"].as_u64().unwrap()).unwrap();
    assert!(text.lines().nth(line - 1).unwrap().contains("crank.AA"));
    assert!(bad.get("mechanism").is_none() && bad.get("assembled").is_none());

    // One that does not close: the coupler is too short by 50 mm at 60 deg or more.
    let short = [("value = 0.25", "value = 0.01")];
    let open = check(&[&altered(folder.path(), "four_bar", &short)], 1);
    assert_eq!(open["ok"], false);
    assert!(
        open["error"]["message"].as_str().unwrap().contains("open"),
        "{open}"
    );
    assert!(open["error"]["open"][0]["gap"].as_f64().unwrap() > 0.0);
    assert_eq!(open["error"]["nearest"].as_array().map(Vec::len), Some(3));
}

#[test]
fn a_bad_file_exits_with_1_and_shows_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("\"crank.O\"]", "\"cranck.O\"]")],
    );
    for command in ["check", "run", "draw", "export"] {
        let assert = biela(&[command, &file]).code(1);
        assert_eq!(stdout(&assert), "");
        let message = stderr(&assert);
        assert!(message.contains("four_bar.toml:31:"), "{message}");
        assert!(message.contains("no body `cranck`"), "{message}");
        assert!(message.contains("did you mean `crank`?"), "{message}");
    }
}

#[test]
fn a_mechanism_that_does_not_close_exits_with_1_and_names_the_joint() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("value = 0.10", "value = 0.80")],
    );
    for command in ["check", "run", "draw", "export"] {
        let assert = biela(&[command, &file]).code(1);
        let message = stderr(&assert);
        assert!(
            message.contains("joint `O4` stays open by 142.8 mm"),
            "{message}"
        );
    }
}

#[test]
fn a_mechanism_without_driver_exits_with_1_and_says_what_is_loose() {
    let folder = tempfile::tempdir().unwrap();
    let driver = "crank_angle = { coordinate = \"angle\", markers = [\"ground.O2\", \"crank.O\"], start = \"60*deg\" }";
    let file = altered(folder.path(), "four_bar", &[(driver, "")]);
    let assert = biela(&["check", &file]).code(1);
    // What can be counted is shown all the same.
    assert!(stdout(&assert).contains("constraints            8"));
    assert!(stderr(&assert).contains("free to move: body `crank`"));
}

#[test]
fn a_motion_of_the_file_gives_way_to_one_of_the_command_line() {
    let run = biela(&[
        "run",
        "mechanisms/pick_and_place.toml",
        "--drive",
        "travel = 0.1 + t",
        "--stop",
        "0.1",
        "--step",
        "0.1",
    ])
    .code(0);
    let table = stdout(&run);
    let mut rows = table.lines().skip(1).map(|row| row.split(',').nth(1));
    assert_eq!(rows.next(), Some(Some("0.1")));
    assert_eq!(rows.next(), Some(Some("0.2")));
}

#[test]
fn bad_usage_exits_with_2() {
    for (arguments, expected) in [
        (&["check"][..], "required"),
        (
            &["check", "no_such_file.toml"],
            "cannot read `no_such_file.toml`",
        ),
        (&["fly"], "unrecognized subcommand"),
        (
            &["run", "mechanisms/tlv.toml", "--step", "0"],
            "expected a positive time",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--stop", "-1"],
            "must not be before the start",
        ),
        (&["run", "mechanisms/tlv.toml", "--step", "1e-300"], "rows"),
        (
            &["run", "mechanisms/tlv.toml", "--drive", "side_length"],
            "has no `=`",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--drive", "side=1"],
            "no driver `side`; expected `side_length`",
        ),
        (
            &[
                "run",
                "mechanisms/tlv.toml",
                "--drive",
                "side_length=0.3+*t",
            ],
            "^",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--set", "bas=1"],
            "no parameter `bas`",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--set", "base=0"],
            "not a permitted value",
        ),
        (&["run", "mechanisms/tlv.toml", "--set", "base=t"], "--set"),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "tlv.pdf"],
            "`tlv.pdf` has neither the extension .svg nor .png",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "svg"],
            "neither the extension",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "no_such_folder/x.svg"],
            "cannot write `no_such_folder/x.svg`",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "--width", "0"],
            "invalid value '0' for '--width <PIXELS>'",
        ),
        (
            &["export", "mechanisms/tlv.toml", "--runtime", "mechanisms"],
            "no runtime library",
        ),
        (
            &[
                "export",
                "mechanisms/tlv.toml",
                "-o",
                "no_such_folder/x.fmu",
            ],
            "cannot write",
        ),
    ] {
        let assert = biela(arguments).code(2);
        let message = stderr(&assert);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}

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
        &["range", "--help"],
        &["watch", "--help"],
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

/// Column `name` of a CSV.
fn column(csv: &str, name: &str) -> Vec<f64> {
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

#[test]
fn run_writes_exact_rates() {
    // u = 60° + 10 t + t²: u̇ = 10 + 2 t, ü = 2. The crank's phi is u itself.
    let drive = "crank_angle = 60*deg + 10*t + t^2";
    let arguments = [
        "run",
        "mechanisms/four_bar.toml",
        "--drive",
        drive,
        "--stop",
        "1",
        "--step",
        "0.3",
    ];
    let csv = stdout(&biela(&arguments).success());
    let time = column(&csv, "time");
    assert_eq!(time, [0.0, 0.3, 0.6, 0.899_999_999_999_999_9, 1.0]);
    for (row, t) in time.iter().enumerate() {
        let expected = [
            ("crank.phi", 60_f64.to_radians() + 10.0 * t + t * t),
            ("crank.omega", 10.0 + 2.0 * t),
            ("crank.alpha", 2.0),
            ("crank_angle.velocity", 10.0 + 2.0 * t),
        ];
        for (name, value) in expected {
            assert!(
                (column(&csv, name)[row] - value).abs() < 1e-13,
                "{name} at {t}"
            );
        }
    }
}

#[test]
fn run_keeps_the_assembly_mode_however_far_the_start_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.csv");
    let file = file.to_str().unwrap();
    let drive = "crank_angle = 500*deg + t";
    biela(&[
        "run",
        "mechanisms/four_bar.toml",
        "--drive",
        drive,
        "--set",
        "crank_length = 80*mm",
        "-o",
        file,
    ])
    .success();
    let csv = std::fs::read_to_string(file).unwrap();
    assert!((column(&csv, "crank.phi")[0] - 500_f64.to_radians()).abs() < 1e-12);
    // In the other mode the transmission angle is negative.
    assert!(
        column(&csv, "transmission.position")
            .iter()
            .all(|angle| *angle > 0.0)
    );
    assert_eq!(column(&csv, "time").len(), 201);
}

#[test]
fn run_stops_at_a_dead_point_and_keeps_the_rows_before() {
    let drive = "side_length = 0.35 + 0.1*t";
    let assert = biela(&[
        "run",
        "mechanisms/tlv.toml",
        "--drive",
        drive,
        "--stop",
        "5",
        "--step",
        "0.5",
    ])
    .code(1);
    // 0.65 m, where arm and base are in line, is reached at 3 s.
    let time = column(&stdout(&assert), "time");
    assert_eq!(time.last(), Some(&2.5));
    let message = stderr(&assert);
    assert!(message.contains("dead point"), "{message}");
    assert!(
        message.contains("`side_length` at 0.650000000"),
        "{message}"
    );
    assert!(
        message.contains("body `arm` and body `rod` line up"),
        "{message}"
    );
}

#[test]
fn run_tells_of_change_points_and_of_approaches() {
    let run = |file: &str, drive: &str| {
        stderr(
            &biela(&[
                "run", file, "--drive", drive, "--stop", "1", "--step", "0.01",
            ])
            .success(),
        )
    };
    let message = run("mechanisms/parallelogram.toml", "crank_angle = 1 + 6*t");
    let passed = "note: t = 0.36 s: change point passed on the smooth motion";
    assert!(message.contains(passed), "{message}");
    assert_eq!(message.lines().count(), 2, "{message}");
    let message = run("mechanisms/tlv.toml", "side_length = 0.35 + 0.29999999*t");
    assert!(
        message.contains("warning: t = 1 s: near a singular position"),
        "{message}"
    );
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
fn run_writes_the_variables_that_are_asked_for() {
    let header = |more: &[&str]| {
        let mut arguments = vec!["run", "mechanisms/four_bar.toml", "--stop", "0.1"];
        arguments.extend(more);
        let csv = stdout(&biela(&arguments).success());
        csv.lines().next().expect("there is a header").to_owned()
    };
    assert_eq!(
        header(&["--variables", "crank.phi,coupler.P,transmission.velocity"]),
        "time,crank.phi,coupler.P.x,coupler.P.y,coupler.P.vx,coupler.P.vy,coupler.P.ax,coupler.P.ay,\
         transmission.velocity"
    );
    let all = header(&[]);
    assert!(all.starts_with(
        "time,crank_angle.position,crank_angle.velocity,crank_angle.acceleration,crank.x,"
    ));
    assert!(all.ends_with(",transmission.acceleration"));
    let assert = biela(&["run", "mechanisms/four_bar.toml", "--variables", "cupler.P"]).code(2);
    let message = stderr(&assert);
    assert!(
        message.contains("no `cupler.P`; did you mean `coupler.P`?"),
        "{message}"
    );
}

#[test]
fn run_plots_what_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let plot = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let mut arguments = vec!["run", "mechanisms/four_bar.toml", "--plot"];
        arguments.extend([
            path.to_str().unwrap(),
            "--drive",
            "crank_angle = 60*deg + 5*t",
        ]);
        arguments.extend(more);
        let assert = biela(&arguments).success();
        (stdout(&assert), std::fs::read(path).unwrap())
    };
    // Without -o there is no CSV; with it there are both.
    let (csv, picture) = plot("a.svg", &[]);
    assert_eq!(csv, "");
    let picture = String::from_utf8(picture).unwrap();
    for wanted in [
        ">angle [deg]<",
        ">transmission.velocity<",
        ">crank_angle.acceleration<",
    ] {
        assert!(picture.contains(wanted), "{wanted}");
    }
    let (csv, picture) = plot("b.svg", &["-o", "-", "--variables", "coupler.P.x"]);
    assert!(csv.starts_with("time,coupler.P.x\n"));
    let picture = String::from_utf8(picture).unwrap();
    assert!(picture.contains(">coupler.P.x<") && !picture.contains("transmission"));
    assert!(plot("c.png", &[]).1.starts_with(b"\x89PNG"));
    // A run that is cut short is drawn up to there.
    let path = folder.path().join("d.svg");
    let path = path.to_str().unwrap();
    let drive = "side_length = 0.35 + 0.1*t";
    biela(&[
        "run",
        "mechanisms/tlv.toml",
        "--drive",
        drive,
        "--stop",
        "5",
        "--plot",
        path,
    ])
    .code(1);
    let picture = std::fs::read_to_string(path).unwrap();
    assert!(picture.contains(">side_length.position<"));
    assert!(picture.contains(">2.5<") && !picture.contains(">3.5<"));
}

#[test]
fn run_animates() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    let path = path.to_str().unwrap();
    let film = |arguments: &[&str], code: i32| {
        let mut all = vec!["run", "--animate", path];
        all.extend(arguments);
        let assert = biela(&all).code(code);
        assert_eq!(stdout(&assert), "");
        let page = std::fs::read_to_string(path).unwrap();
        let film = page.split("class=\"film\">").nth(1).unwrap();
        let film = &film[..film.find("</script>").unwrap()];
        let film: serde_json::Value = serde_json::from_str(film).unwrap();
        (film, stderr(&assert))
    };
    let four_bar = "mechanisms/four_bar.toml";
    let drive = "crank_angle = 60*deg + t";
    let (shown, messages) = film(
        &[
            four_bar, "--drive", drive, "--stop", "1.05", "--step", "0.1",
        ],
        0,
    );
    assert_eq!(messages, "");
    assert_eq!(shown["moments"], 12);
    assert_eq!(shown["stop"], 1.05);
    assert_eq!(shown["readings"][0]["name"], "crank_angle");
    let (shown, _) = film(
        &[four_bar, "--drive", drive, "--variables", "crank.omega"],
        0,
    );
    assert_eq!(shown["readings"].as_array().unwrap().len(), 1);
    assert_eq!(shown["readings"][0]["unit"], "deg/s");
    // Every second of 10,002 rows.
    let many = [
        four_bar, "--drive", drive, "--stop", "1.0001", "--step", "0.0001",
    ];
    let (shown, _) = film(&many, 0);
    assert_eq!(shown["moments"], 5001);
    assert!((shown["step"].as_f64().unwrap() - 2e-4).abs() < 1e-15);
    // A run that is cut short is shown up to there, and one that stands still is told of.
    let blocked = "side_length = 0.35 + 0.1*t";
    let tlv = [
        "mechanisms/tlv.toml",
        "--drive",
        blocked,
        "--stop",
        "5",
        "--step",
        "0.5",
    ];
    let (shown, messages) = film(&tlv, 1);
    assert_eq!(shown["moments"], 6);
    assert!(messages.contains("dead point"), "{messages}");
    let (_, messages) = film(&[four_bar], 0);
    assert!(messages.contains("note: nothing moves"), "{messages}");
}

#[test]
fn run_follows_the_values_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let run = |content: &str, more: &[&str]| {
        let path = folder.path().join("inputs.csv");
        std::fs::write(&path, content).unwrap();
        let mut arguments = vec![
            "run",
            "mechanisms/tlv.toml",
            "--input",
            path.to_str().unwrap(),
        ];
        arguments.extend(["--stop", "4", "--step", "0.5"]);
        arguments.extend(more);
        biela(&arguments)
    };
    // Straight lines, held before and after, with a jump at 2 s.
    let content = "time,side_length.position\n1,0.3\n2,0.4\n2.0,0.5\n3,0.45\n";
    let csv = stdout(&run(content, &[]).success());
    let near = |found: &[f64], expected: &[f64]| {
        let pairs = found.iter().zip(expected);
        found.len() == expected.len() && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12)
    };
    let position = column(&csv, "side_length.position");
    assert!(
        near(
            &position,
            &[0.3, 0.3, 0.3, 0.35, 0.5, 0.475, 0.45, 0.45, 0.45]
        ),
        "{position:?}"
    );
    let velocity = column(&csv, "side_length.velocity");
    assert!(
        near(
            &velocity,
            &[0.0, 0.0, 0.1, 0.1, -0.05, -0.05, 0.0, 0.0, 0.0]
        ),
        "{velocity:?}"
    );
    // The arm is where the law of cosines has it.
    let [base, arm] = [0.4, 0.25_f64];
    let parameters = std::fs::read_to_string("mechanisms/tlv.toml").unwrap();
    assert!(parameters.contains("value = 0.40") && parameters.contains("value = 0.25"));
    for (phi, u) in column(&csv, "arm.phi").iter().zip(&position) {
        let expected = ((base * base + arm * arm - u * u) / (2.0 * base * arm)).acos();
        assert!((phi - expected).abs() < 1e-12, "{phi} {expected}");
    }
    // Rates that the file gives count, and short names do.
    let content = "time, side_length, side_length.velocity, side_length.acceleration\n\
                   # a comment\n0,0.3,0.1,0.0\n4,0.5,0.2,1\n";
    let csv = stdout(&run(content, &[]).success());
    assert!((column(&csv, "side_length.velocity")[4] - 0.15).abs() < 1e-12);
    assert!((column(&csv, "side_length.acceleration")[4] - 0.5).abs() < 1e-12);
    for (content, more, expected) in [
        (
            "t,side_length\n0,0.3\n",
            &[][..],
            "the first column is `t`; expected `time`",
        ),
        (
            "time,side\n0,0.3\n",
            &[],
            "column `side` is no variable of a driver; expected `side_length.position`",
        ),
        (
            "time,side_length\n0,x\n",
            &[],
            "line 2: `x` is not a finite number",
        ),
        (
            "time,side_length\n1,0.3\n0,0.3\n",
            &[],
            "line 3: time goes back to 0",
        ),
        ("time,side_length\n", &[], "no rows"),
        (
            "time,side_length.velocity\n0,1\n",
            &[],
            "no column `side_length.position`",
        ),
        (
            "time,side_length,side_length.position\n0,1,1\n",
            &[],
            "two columns",
        ),
        (
            "time,side_length\n0,0.3,1\n",
            &[],
            "found record with 3 fields",
        ),
        (
            "time,side_length\n0,0.3\n",
            &["--drive", "side_length=1"],
            "both --drive and --input",
        ),
    ] {
        let message = stderr(&run(content, more).code(2));
        assert!(message.contains(expected), "{message}");
    }
    // A motion of the file gives way.
    let content = "time,crank_angle.position\n0,0\n1,1\n";
    let path = folder.path().join("crank.csv");
    std::fs::write(&path, content).unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("start = \"60*deg\"", "motion = \"60*deg + t\"")],
    );
    let csv = biela(&[
        "run",
        &file,
        "--input",
        path.to_str().unwrap(),
        "--stop",
        "1",
    ])
    .success();
    assert!(column(&stdout(&csv), "crank.phi")[0].abs() < 1e-12);
}

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
    let text = std::fs::read_to_string(folder.path().join("my_linkage.toml")).unwrap();
    let shipped = std::fs::read_to_string("mechanisms/four_bar.toml").unwrap();
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
    let message = stderr(&new(&["x", "--from", "five_bar"]).code(2));
    assert!(message.contains("five_bar_robot"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
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

#[test]
fn range_tells_the_limits() {
    let folder = tempfile::tempdir().unwrap();
    let [csv, plot] = ["range.csv", "range.svg"].map(|name| folder.path().join(name));
    let [csv, plot] = [&csv, &plot].map(|path| path.to_str().unwrap());
    let range = |arguments: &[&str]| {
        let mut all = vec!["range"];
        all.extend(arguments);
        biela(&all)
    };
    let tlv = range(&["mechanisms/tlv.toml", "--csv", csv, "--plot", plot]).success();
    // Base minus and plus arm: 0.4 m and 0.25 m.
    for wanted in [
        "side_length, from 0.35 m\n",
        "  down to 0.15 m: dead point, where body `arm` and body `rod` line up\n",
        "  up to   0.65 m: dead point, where body `arm` and body `rod` line up\n",
    ] {
        assert!(stdout(&tlv).contains(wanted), "{}", stdout(&tlv));
    }
    let table = std::fs::read_to_string(csv).unwrap();
    let lengths = column(&table, "side_length.position");
    assert!(lengths.is_sorted() && (lengths[0] - 0.15).abs() < 1e-12);
    for (length, phi) in lengths.iter().zip(column(&table, "arm.phi")) {
        let expected = (0.4_f64 * 0.4 + 0.25 * 0.25 - length * length) / (2.0 * 0.4 * 0.25);
        // At a limit the angle goes with the root of the distance from it.
        assert!(
            (phi.cos() - expected.clamp(-1.0, 1.0)).abs() < 1e-12,
            "{length}"
        );
    }
    assert!(
        column(&table, "rcond")
            .iter()
            .all(|rcond| (0.0..=1.0).contains(rcond))
    );
    let picture = std::fs::read_to_string(plot).unwrap();
    assert!(picture.contains(">side_length [m]<") && picture.contains(">arm.phi<"));

    // A table on stdout stands alone.
    let printed = stdout(&range(&["mechanisms/four_bar.toml", "--csv", "-"]).success());
    assert_eq!(column(&printed, "transmission_angle").len(), 361);
    let text = stdout(&range(&["mechanisms/four_bar.toml"]).success());
    assert!(
        text.contains("turns fully: after a turn the mechanism is where it was"),
        "{text}"
    );
    // 0.25 m and 0.30 m span 0.5 m there.
    assert!(
        text.contains("transmission angle from 49.46 deg, at 180 deg"),
        "{text}"
    );
    // With a base that is too long for the crank to turn.
    let text = stdout(&range(&["mechanisms/four_bar.toml", "--set", "base=0.48"]).success());
    let limit = ((0.1_f64 * 0.1 + 0.48 * 0.48 - 0.55 * 0.55) / (2.0 * 0.1 * 0.48)).acos();
    let found = text.split("up to   ").nth(1);
    let found = found.and_then(|rest| rest.split(' ').next());
    let found: f64 = found
        .expect("there is a limit")
        .parse()
        .expect("it is a number");
    // Ten decimals are shown.
    assert!((found - limit.to_degrees()).abs() < 1e-10, "{text}");
    assert!(text.contains("dead point"), "{text}");

    let both = stdout(&range(&["mechanisms/pantograph.toml"]).success());
    assert!(
        both.contains("tracer_x, from") && both.contains("\ntracer_y, from"),
        "{both}"
    );
    for (arguments, expected) in [
        (
            &["mechanisms/pantograph.toml", "--plot", plot][..],
            "--csv and --plot need one",
        ),
        (
            &["mechanisms/tlv.toml", "--driver", "side"],
            "no driver `side`; expected `side_length`",
        ),
        (
            &["mechanisms/tlv.toml", "--plot", "x.pdf"],
            "neither the extension",
        ),
    ] {
        let message = stderr(&range(arguments).code(2));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn draw_writes_what_the_extension_says() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let mut arguments = vec!["draw", "mechanisms/four_bar.toml", "-o"];
        arguments.push(path.to_str().unwrap());
        arguments.extend(more);
        let assert = biela(&arguments).success();
        assert_eq!(stdout(&assert) + &stderr(&assert), "");
        std::fs::read(path).unwrap()
    };
    let svg = draw("a.svg", &[]);
    let text = String::from_utf8(svg.clone()).unwrap();
    assert!(text.starts_with("<?xml") && text.contains("width=\"640\""));
    assert!(text.contains("class=\"traces\"") && text.contains("<rect"));
    assert!(svg == draw("b.SVG", &[]));
    let bare = draw("c.svg", &["--no-traces", "--transparent", "--width", "320"]);
    let bare = String::from_utf8(bare).unwrap();
    assert!(!bare.contains("class=\"traces\"") && !bare.contains("<rect"));
    assert!(bare.contains("width=\"320\"") && bare.contains("viewBox=\"0 0 640 "));
    assert!(draw("d.png", &[]).starts_with(b"\x89PNG"));
    let printed = biela(&["draw", "mechanisms/four_bar.toml", "-o", "-"]).success();
    assert_eq!(stdout(&printed), text);
    // Without -o, under the mechanism's own name where one is.
    Command::new(env!("CARGO_BIN_EXE_biela"))
        .current_dir(folder.path())
        .args([
            "draw",
            concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms/four_bar.toml"),
        ])
        .assert()
        .success();
    assert!(svg == std::fs::read(folder.path().join("four_bar.svg")).unwrap());
}

#[test]
fn draw_shows_the_pose_that_is_asked_for() {
    let draw = |more: &[&str]| {
        let mut arguments = vec!["draw", "mechanisms/four_bar.toml", "-o", "-"];
        arguments.extend(more);
        stdout(&biela(&arguments).success())
    };
    let home = draw(&[]);
    // The file's own values, as a motion that keeps still, change nothing.
    assert_eq!(home, draw(&["--drive", "crank_angle = 60*deg"]));
    assert_eq!(home, draw(&["--set", "crank_length = 100*mm"]));
    let turned = draw(&["--drive", "crank_angle = 120*deg"]);
    assert_ne!(home, turned);
    // The crank turns fully from there too.
    assert!(turned.contains("class=\"traces\""));
    assert_ne!(home, draw(&["--set", "crank_length = 80*mm"]));
    assert_ne!(home, draw(&["--drive", "crank_angle = 60*deg + t/10"]));
    biela(&[
        "draw",
        "mechanisms/four_bar.toml",
        "-o",
        "-",
        "--drive",
        "crank = 1",
    ])
    .code(2);
}

#[test]
fn an_fmu_carries_its_picture_and_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let hostile = "description = \"<script>alert('&')</script>";
    let file = altered(
        folder.path(),
        "tlv",
        &[("description = \"Variable", hostile)],
    );
    let path = folder.path().join("tlv.fmu");
    biela(&["export", &file, "-o", path.to_str().unwrap()]).success();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut content = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(name).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        bytes
    };
    assert!(content("model.png").starts_with(b"\x89PNG"));
    let page = String::from_utf8(content("documentation/index.html")).unwrap();
    assert!(page.contains("&lt;script&gt;alert(") && !page.contains("<script>alert"));
    for wanted in [
        "down to 0.15 m: dead point, where body arm and body rod line up",
        "up to 0.65 m: dead point",
        ">arm_length</td><td data-what=\"Value\">0.25</td><td data-what=\"Unit\">m</td>",
        "<td data-what=\"Limits\">≥ 0.001</td>",
        ">arm.omega</td><td data-what=\"Causality\">output</td><td data-what=\"Unit\">rad/s</td>",
        ">rates</td>",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn export_is_reproducible_and_dated_only_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let export = |name: &str, epoch: Option<&str>| {
        let path = folder.path().join(name);
        let mut command = Command::new(env!("CARGO_BIN_EXE_biela"));
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        command.env_remove("SOURCE_DATE_EPOCH");
        command.envs(epoch.map(|epoch| ("SOURCE_DATE_EPOCH", epoch)));
        command
            .args(["export", "mechanisms/tlv.toml", "-o"])
            .arg(&path);
        command.assert().success();
        std::fs::read(path).unwrap()
    };
    let first = export("a.fmu", None);
    assert!(first == export("b.fmu", None));
    assert!(first != export("c.fmu", Some("1700000000")));
    assert!(export("d.fmu", Some("1700000000")) == export("e.fmu", Some("1700000000")));
    Command::new(env!("CARGO_BIN_EXE_biela"))
        .env("SOURCE_DATE_EPOCH", "yesterday")
        .args(["export", "mechanisms/tlv.toml"])
        .assert()
        .code(2);
}
