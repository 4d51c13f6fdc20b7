//! `biela run`: the table that it writes, and what stops it.

use crate::cli::program::{altered, biela, column, stderr, stdout};

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
    assert_eq!(time, [0.0, 0.3, 0.6, 0.9, 1.0]);
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

/// Between samples 0.1 s apart, the crank swings from 60° by up to 30° both ways.
#[test]
fn each_excursion_beyond_a_limit_is_warned_of_once() {
    let folder = tempfile::tempdir().unwrap();
    let limited = [(
        "start = \"60*deg\"",
        "start = \"60*deg\", min = \"45*deg\", max = \"80*deg\"",
    )];
    let file = altered(folder.path(), "four_bar", &limited);
    let drive = "crank_angle = 60*deg + 30*deg*sin(2*pi*t)";
    let run = biela(&[
        "run", &file, "--drive", drive, "--stop", "2", "--step", "0.1",
    ])
    .code(0);
    let told = stderr(&run);
    let told: Vec<&str> = told
        .lines()
        .filter(|line| line.contains("beyond its"))
        .collect();
    let expected = [
        ("0.2", "max"),
        ("0.6", "min"),
        ("1.2", "max"),
        ("1.6", "min"),
    ];
    assert_eq!(told.len(), expected.len(), "{told:?}");
    for (line, (time, key)) in told.iter().zip(expected) {
        assert!(line.starts_with(&format!("warning: t = {time}")), "{line}");
        assert!(line.contains(&format!("beyond its `{key}` = ")), "{line}");
    }
}

/// A force 1/(t − 3) N has no value at 3 s, and a motion sqrt(2 − t) none after 2 s.
#[test]
fn what_has_no_value_at_the_start_is_told_with_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pusher.toml");
    let slide = "[joints]\nway = { type = 'translational', markers = ['ground.O', 'slide.O'] }\n";
    let along = "coordinate = 'x', markers = ['ground.O', 'slide.O']";
    let pusher = |motion: &str, force: &str| {
        let text = format!(
            "format = 1\nname = 'pusher'\n[ground.markers]\nO = [0, 0]\n[bodies.slide]\n\
             markers = {{ O = [0, 0] }}\n{slide}[drivers]\nx = {{ {along}, motion = '{motion}' }}\n\
             [forces]\npush = {{ {along}, value = '{force}' }}\n"
        );
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap()
    };
    let refusal = |motion: &str, force: &str, start: &str| {
        let file = pusher(motion, force);
        let message = stderr(&biela(&["run", file, "--start", start, "--stop", "5"]).code(1));
        let message = message.strip_prefix(&format!("error: {file}: "));
        message.expect("nothing else is told").to_owned()
    };
    assert_eq!(
        refusal("t", "1/(t - 3)", "3"),
        "at t = 3 s: force `push` has no finite value here\n"
    );
    assert_eq!(
        refusal("sqrt(2 - t)", "1", "3"),
        "at t = 3 s: driver `x` has no finite value\n"
    );
    assert_eq!(
        refusal("sqrt(2 - t)", "1", "2"),
        "at t = 2 s: driver `x` has no finite velocity or acceleration\n"
    );
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

/// The rocker swings; one turn further the mechanism closes again, and no motion leads there.
#[test]
fn a_start_beyond_a_dead_point_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[(
            r#"markers = ["ground.O2", "crank.O"], start = "60*deg""#,
            r#"markers = ["ground.O4", "rocker.O"], start = "140*deg""#,
        )],
    );
    for command in ["run", "draw", "range"] {
        let refused = biela(&[command, &file, "--drive", "crank_angle = 500*deg"]);
        let message = stderr(&refused.code(1));
        for words in ["dead point", "stops with driver `crank_angle` at", "deg"] {
            assert!(message.contains(words), "{command}: {message}");
        }
    }
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
    assert!(
        message.starts_with("error: mechanisms/tlv.toml: dead point"),
        "{message}"
    );
    assert!(
        message.contains("with `side_length` at 0.650000000 m"),
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
        header(&[
            "--variables",
            "crank.phi, coupler.P ,transmission.velocity,"
        ]),
        "time,crank.phi,coupler.P.x,coupler.P.y,coupler.P.vx,coupler.P.vy,coupler.P.ax,coupler.P.ay,\
         transmission.velocity"
    );
    let all = header(&[]);
    assert!(all.starts_with(
        "time,crank_angle.position,crank_angle.velocity,crank_angle.acceleration,crank.x,"
    ));
    assert!(all.ends_with(",transmission.acceleration"));
    let refusal =
        |file: &str, names: &str| stderr(&biela(&["run", file, "--variables", names]).code(2));
    for (names, expected) in [
        (
            "cupler.P",
            "there is no `cupler.P`; did you mean `coupler.P`?",
        ),
        (
            "transmission.volocity",
            "there is no `transmission.volocity`; did you mean `transmission.velocity`?",
        ),
        (
            "foo",
            "there is no `foo`; expected `crank_angle`, `crank`, `coupler`, `rocker` or \
             `transmission`",
        ),
        (
            "crank.phi, rocker.B.x",
            "marker `rocker.B` is no output; list it in `markers` of `[outputs]`",
        ),
        ("", "no variable is named"),
        (" , ", "no variable is named"),
    ] {
        let message = refusal("mechanisms/four_bar.toml", names);
        assert_eq!(message, format!("error: --variables: {expected}\n"));
    }
    let folder = tempfile::tempdir().unwrap();
    let narrowed = [("[outputs]\n", "[outputs]\nbodies = [\"rocker\"]\n")];
    let file = altered(folder.path(), "four_bar", &narrowed);
    let message = refusal(&file, "crank.phi");
    assert!(
        message.contains("body `crank` is no output; list it in `bodies` of `[outputs]`"),
        "{message}"
    );
}

#[test]
fn run_tells_how_large_a_file_becomes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.csv");
    let file = file.to_str().unwrap();
    // A dead point is near, so that nothing large is written.
    let run = |stop: &str, output: &str| {
        let drive = "side_length = 0.649999 + t";
        let mut arguments = vec!["run", "mechanisms/tlv.toml", "--drive", drive];
        arguments.extend(["--variables", "arm.phi", "--step", "0.01"]);
        arguments.extend(["--stop", stop, "--output", output]);
        stderr(&biela(&arguments).code(1))
    };
    // 2 columns of 20 bytes.
    let message = run("1e6", file);
    let note = format!("note: `{file}` takes about 4.0 GB: 100000001 rows of 2 columns\n");
    assert!(message.starts_with(&note), "{message}");
    for message in [run("4e5", file), run("1e6", "-")] {
        assert!(!message.contains("note: "), "{message}");
        assert!(message.contains("error: "), "{message}");
    }
}

#[test]
fn plain_angles_of_more_than_a_turn_are_warned_of() {
    let run = |option: &str, value: &str| {
        let file = "mechanisms/four_bar.toml";
        let all = [
            "run",
            file,
            option,
            value,
            "--stop",
            "0",
            "--variables",
            "crank.phi",
        ];
        stderr(&biela(&all[..4]).success())
    };
    assert_eq!(
        run("--drive", "crank_angle = 60 + 10*t"),
        "warning: --drive: an angle of 60 rad is 3437.7 deg; degrees are written `60*deg`\n"
    );
    assert_eq!(
        run("--drive", "crank_angle = 1 + 360*t"),
        "warning: --drive: a velocity of 360 rad/s is 20626.5 deg/s; degrees are written \
         `360*deg`\n"
    );
    // The author of these has thought of the unit.
    for drive in [
        "crank_angle = 1 + 360*deg*t",
        "crank_angle = 1 + 300*t",
        "crank_angle = 600*deg + t",
        "crank_angle = 3*pi + t",
        "crank_angle = 6 + 10*t",
    ] {
        assert_eq!(run("--drive", drive), "", "{drive}");
    }
}

#[test]
fn a_length_of_millimetres_is_warned_of() {
    let set = |file: &str, value: &str| {
        let arguments = ["run", file, "--set", value, "--stop", "0"];
        stderr(&biela(&arguments))
    };
    let file = "mechanisms/four_bar.toml";
    let says = "warning: --set: a length of 60 m is 60000 mm; write `60*mm`\n";
    assert!(set(file, "crank_length = 60").starts_with(says));
    let folder = tempfile::tempdir().unwrap();
    let bare = altered(folder.path(), "four_bar", &[(", display = \"mm\"", "")]);
    let says = "warning: --set: a length of 60 m in place of 0.1 m; write `60*mm`\n";
    assert!(set(&bare, "crank_length = 60").starts_with(says));
    for value in ["crank_length = 60*mm", "crank_length = 0.06", "base = 0.41"] {
        assert!(!set(file, value).contains("warning"), "{value}");
    }
}

#[test]
fn the_motion_proposed_for_a_driver_with_limits_keeps_to_them() {
    for (name, proposal) in [
        ("bicycle_suspension", "travel = -0.04 + 0.06*t"),
        ("excavator_arm", "boom_cylinder = 2.3 - 0.3*t"),
        ("hatch", "opening = -40*deg + 32.5*deg*t"),
        ("four_bar", "crank_angle = 60*deg + 2*pi*t"),
    ] {
        let file = format!("mechanisms/{name}.toml");
        let still = stderr(&biela(&["run", &file, "-o", "-"]).success());
        assert!(still.contains(&format!("--drive '{proposal}'")), "{still}");
    }
}

/// Two links in line, each with its driver; without gravity all biases are zero at rest.
const ARM: &str = r#"
format = 1
name = "arm"
[ground.markers]
O = [0, 0]
[bodies.a]
markers = { O = [0, 0], T = [1, 0] }
mass = 1
[bodies.b]
markers = { O = [0, 0], T = [1, 0] }
estimate = [1, 0, 0]
mass = 1
inertia = 0.1
center = [0.5, 0]
[joints]
O = { type = "revolute", markers = ["ground.O", "a.O"] }
P = { type = "revolute", markers = ["a.T", "b.O"] }
[drivers]
q = { coordinate = "angle", markers = ["ground.O", "a.O"], start = 0 }
r = { coordinate = "angle", markers = ["a.O", "b.O"], start = 0 }
[simulation]
gravity = [0, 0]
stop = 1
step = 0.5
"#;

#[test]
fn inputs_keep_inertia_and_bias_however_they_are_moved() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let run = |arguments: &[&str]| stdout(&biela(&[&["run"], arguments].concat()).success());
    let same = |one: &str, other: &str| {
        assert_eq!(one.lines().next(), other.lines().next());
        for name in one.lines().next().unwrap().split(',') {
            for (a, b) in column(one, name).iter().zip(column(other, name)) {
                assert!((a - b).abs() < 1e-12, "{name}: {a}, {b}");
            }
        }
    };
    let values = "time,q,q.velocity,q.acceleration\n0,0,0,1\n0.5,0.125,0.5,1\n1,0.5,1,1\n";
    let values = file("q.csv", values);
    let arm = file("arm.toml", ARM);
    let driven = run(&[&arm, "--drive", "q = t^2/2"]);
    same(&driven, &run(&[&arm, "--input", &values]));
    // The point mass of `b` a length and a half from O, and its own inertia.
    assert!((column(&driven, "q.inertia")[0] - (1.5 * 1.5 + 0.1)).abs() < 1e-12);
    for name in ["q.bias", "r.bias"] {
        assert!(column(&driven, name)[0].abs() < 1e-12, "{name}");
    }
    // A prescribed motion keeps its acceleration, also where a file gives its values.
    let prescribed = ARM.replacen("start = 0", "motion = \"t^2/2\"", 1);
    let prescribed = file("prescribed.toml", &prescribed);
    let own = run(&[&prescribed]);
    same(&own, &run(&[&prescribed, "--input", &values]));
    // The demand of the mass of `b` about P: its inertia there and that of P's acceleration.
    assert!((column(&own, "r.bias")[0] - 0.85).abs() < 1e-12);
}

/// Ten steps of 0.1 s are written as a person writes them, and all other numbers with all digits.
#[test]
fn times_are_those_that_a_person_writes() {
    let drive = "crank_angle = 60*deg + t/3";
    let options = ["--drive", drive, "--stop", "1", "--step", "0.1"];
    let run = biela(&[&["run", "mechanisms/four_bar.toml"][..], &options].concat()).code(0);
    let table = stdout(&run);
    let times = table.lines().skip(1).map(|row| row.split(',').next());
    let expected = [
        "0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1.0",
    ];
    assert!(times.eq(expected.map(Some)), "{table}");
}

/// A limit that is exceeded by less than a nanometre looks different from the value.
#[test]
fn an_excursion_tells_the_value_from_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    let limited = ("start = \"45*deg\"", "start = 0.5, max = 0.6");
    let file = altered(folder.path(), "slider_crank", &[limited]);
    let drive = "crank_angle = 0.5 + (0.1 + 1e-12)*t";
    let arguments = ["run", &file, "--drive", drive, "--stop", "1", "--step", "1"];
    let told = stderr(&biela(&arguments).success());
    for words in [
        "is at 0.600000000001 rad (34.37746770",
        "its `max` = 0.600000000000 rad (34.37746770",
    ] {
        assert!(told.contains(words), "{told}");
    }
}

/// The last row of a garage door that closes is at a change point, where its arm hangs straight down:
/// the forces are the limits along the motion, as `tests/solver/forces` derives them.
#[test]
fn forces_at_a_change_point_are_limits() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("door.toml");
    let text = r#"
        format = 1
        name = "garage_door"
        ground.markers = { J = [0, 1.05], track = [0, 2.0] }
        bodies.door = { markers = { top = [0, 2.0], P = [0, 0.1] }, mass = 60, inertia = 20, center = [0, 1.0] }
        bodies.arm.markers = { J = [0, 1.05], P = [0, 0.1] }
        joints.J = { type = "revolute", markers = ["ground.J", "arm.J"] }
        joints.P = { type = "revolute", markers = ["arm.P", "door.P"] }
        joints.track = { type = "slot", markers = ["ground.track", "door.top"] }
        drivers.trolley = { coordinate = "x", markers = ["ground.track", "door.top"], start = 0.05, min = 0, max = 1.9 }
    "#;
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().expect("temporary folders have plain names");
    let drive = "trolley = 0.05 - 0.05*t";
    let options = ["--drive", drive, "--stop", "1", "--step", "0.1"];
    let run = |variables: &str| {
        let arguments = [&["run", file, "-v", variables][..], &options].concat();
        biela(&arguments)
    };
    let csv = stdout(&run("P.fy,track.fy").success());
    for (name, expected) in [("P.fy", 128.324_43), ("track.fy", 460.289_82)] {
        let last = *column(&csv, name).last().expect("there are rows");
        assert!((last - expected).abs() < 2e-5, "{name}: {last}");
    }
    // With its mass off the line of its joints the arm bears a force without bound.
    std::fs::write(
        file,
        text.replace("center = [0, 1.0]", "center = [0.1, 1.0]"),
    )
    .unwrap();
    let refused = stderr(&run("P.fy").code(1));
    assert!(
        refused.contains(
            "at t = 1 s: the reactions of joints have no limit at the change point with driver \
             `trolley` at 0.000000000 m"
        ),
        "{refused}"
    );
    run("trolley.effort").success();
}

/// Returns the text of the sheet in an Excel file.
fn sheet(file: &std::path::Path) -> String {
    use std::io::Read as _;
    let file = std::fs::File::open(file).expect("it is written");
    let mut archive = zip::ZipArchive::new(file).expect("it is an archive");
    let mut entry = archive
        .by_name("xl/worksheets/sheet1.xml")
        .expect("it has a sheet");
    let mut text = String::new();
    entry.read_to_string(&mut text).expect("it is text");
    text
}

#[test]
fn an_excel_file_has_the_numbers_of_the_csv() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("motion.xlsx");
    let run = |output: &str| {
        let drive = "crank_angle = 60*deg + 2*pi*t";
        let variables = "crank_angle.position,rocker.phi";
        let arguments = [
            "run",
            "mechanisms/four_bar.toml",
            "--drive",
            drive,
            "-v",
            variables,
        ];
        biela(&[&arguments[..], &["--stop", "0.5", "-o", output]].concat()).success()
    };
    let csv = stdout(&run("-"));
    run(file.to_str().unwrap());
    let sheet = sheet(&file);
    for (letter, name) in [
        ("A", "time"),
        ("B", "crank_angle.position"),
        ("C", "rocker.phi"),
    ] {
        let values = column(&csv, name);
        assert_eq!(values.len(), 51);
        // The first row has the names.
        for (row, value) in (2..).zip(values) {
            let cell = format!("<c r=\"{letter}{row}\"><v>");
            let (_, rest) = sheet.split_once(&cell).expect("it has the cell");
            let (text, _) = rest.split_once('<').expect("the cell ends");
            assert_eq!(text.parse(), Ok(value), "{name} {row}");
        }
    }
    assert!(!sheet.contains("r=\"A53\"") && !sheet.contains("r=\"D2\""));
    let before = std::fs::read(&file).unwrap();
    run(file.to_str().unwrap());
    assert!(
        before == std::fs::read(&file).unwrap(),
        "it has no time of its own"
    );
    let refused = stderr(
        &biela(&[
            "run",
            "mechanisms/four_bar.toml",
            "--step",
            "1e-6",
            "-o",
            file.to_str().unwrap(),
        ])
        .code(2),
    );
    assert!(refused.contains("2000001 rows of 40 columns"), "{refused}");
    assert!(before == std::fs::read(&file).unwrap());
}

/// A Geneva wheel rests where its pin is opposite of it, whole turns of the crank away too.
#[test]
fn a_geneva_wheel_rests_at_whole_turns() {
    for turns in ["180*deg", "5*pi", "-5*pi", "75*pi"] {
        let drive = format!("crank_angle = {turns}");
        let arguments = ["run", "mechanisms/geneva_drive.toml", "--drive", &drive];
        let told = stdout(&biela(&arguments).success());
        let crank = column(&told, "crank_angle.position")[0];
        // A quarter back with each turn, from -pi/4 after half a turn.
        let wheel = -std::f64::consts::FRAC_PI_4 * (crank / std::f64::consts::PI).round();
        let angles = column(&told, "wheel.phi");
        // Some roundings of the angle.
        assert!(
            angles
                .iter()
                .all(|phi| (phi - wheel).abs() < 1e-14 * wheel.abs().max(1.0))
        );
    }
}

/// Cam and roller move as a slider–crank, e = 5 mm and l = 28 mm: beyond 343 rad/s the spring of 82 N
/// does not hold the follower of 0.12 kg at the top. It is told whichever variables are asked for.
#[test]
fn a_contact_that_pulls_is_told_whatever_is_asked_for() {
    for variables in [&[][..], &["-v", "cam.phi"], &["-v", "contact"]] {
        for (speed, expected) in [(335, 0), (351, 2)] {
            let drive = format!("cam_angle = -0.8 + {speed}*t");
            // From before the top, over two of them.
            let stop = format!("{}", 1.5 * std::f64::consts::TAU / f64::from(speed));
            let step = "0.0002";
            let file = "mechanisms/valve_train.toml";
            let mut all = vec![
                "run", file, "--drive", &drive, "--stop", &stop, "--step", step, "-o", "-",
            ];
            all.extend(variables);
            let told = stderr(&biela(&all).success());
            let lifts = told.matches("joint `contact` would lift off").count();
            assert_eq!(lifts, expected, "{variables:?}: {told}");
        }
    }
}

/// A torque of 1e9 N m turns the crank, with less than 0.01 kg m², by some 1e5 turns within 0.1 s.
#[test]
fn a_row_that_takes_too_long_ends_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let torque = [("description = \"torque on the crank\"", "value = 1e9")];
    let file = altered(folder.path(), "four_bar_free", &torque);
    let run = biela(&["run", &file, "--stop", "1", "--step", "0.1", "-o", "-"]).code(1);
    assert_eq!(stdout(&run).lines().count(), 2, "the names, and the start");
    let told = stderr(&run);
    assert!(
        told.contains("the free motion takes more than 300000 sub-steps"),
        "{told}"
    );
    assert!(told.contains("take shorter steps"), "{told}");
}
