//! `biela run --input`: drivers and inputs of forces that follow the values of a file.

use crate::cli::program::{altered, biela, column, stderr, stdout};

/// Runs a mechanism of triangles for four seconds, its driver along the rows of a file.
fn run(content: &str, more: &[&str]) -> assert_cmd::assert::Assert {
    let folder = tempfile::tempdir().expect("there is a folder");
    let path = folder.path().join("inputs.csv");
    std::fs::write(&path, content).expect("it can be written");
    let mut arguments = vec![
        "run",
        "mechanisms/tlv.toml",
        "--input",
        path.to_str().expect("it is text"),
    ];
    arguments.extend(["--stop", "4", "--step", "0.5"]);
    arguments.extend(more);
    biela(&arguments)
}

/// Returns whether all values agree to rounding.
fn near(found: &[f64], expected: &[f64]) -> bool {
    let pairs = found.iter().zip(expected);
    found.len() == expected.len() && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn run_follows_the_values_of_a_file() {
    // Straight lines, held before and after, with a jump at 2 s.
    let content = "time,side_length.position\n1,0.3\n2,0.4\n2.0,0.5\n3,0.45\n";
    let csv = stdout(&run(content, &[]).success());
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
    let parameters = crate::common::text("mechanisms/tlv.toml");
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
}

#[test]
fn columns_are_separated_and_lines_end_in_any_usual_way() {
    // Whatever separates the columns, and however lines begin and end.
    for content in [
        "time;side_length\n1;0.3\n3;0.5\n",
        "time\tside_length\n1\t0.3\n3\t0.5\n",
        "time;side_length\n1,0;0,3\n3;0,5\n",
        "sep=;\r\ntime;side_length\r\ns;m\r\n1;0,3\r\n3;0,5\r\n",
        "\u{feff}time  side_length\r\n 1 0.3\r\n3 0.5",
        "\u{feff}time,side_length\r\n1,0.3\r\n3,0.5\r\n",
        "time,side_length,\n1,0.3,\n   \n3,0.5,\n# end",
    ] {
        let csv = stdout(&run(content, &[]).success());
        let position = column(&csv, "side_length.position");
        let expected = [0.3, 0.3, 0.3, 0.35, 0.4, 0.45, 0.5, 0.5, 0.5];
        assert!(near(&position, &expected), "{content}: {position:?}");
    }
}

#[test]
fn faults_of_a_file_of_values_are_named_with_their_line() {
    for (content, more, expected) in [
        (
            "zeit,side_length\n0,0.3\n",
            &[][..],
            "it has no column `time`; the first is `zeit`",
        ),
        (
            "time,side\n0,0.3\n",
            &[],
            "column `side` is no variable of a driver; did you mean `side_length.position`?",
        ),
        (
            "time,foo\n0,0.3\n",
            &[],
            "column `foo` is no variable of a driver; expected `side_length.position`\n",
        ),
        (
            "",
            &[],
            "it is empty; expected a line of column names with `time`",
        ),
        ("# nothing", &[], "it is empty"),
        (
            "time,arm.phi\n0,0.3\n",
            &[],
            "column `arm.phi` is no variable of a driver; expected `side_length.position`\n",
        ),
        // A slip is an error beside an input that is right, too.
        (
            "time,side_length,side_length.velocty\n0,0.3,0\n",
            &[],
            "no variable of a driver; did you mean `side_length.velocity`?",
        ),
        (
            "t,side_length,Time\n0,0.3,0\n",
            &[],
            "two columns for `time`: column 1 and column 3",
        ),
        (
            "time [ms],side_length\n0,0.3\n",
            &[],
            "the times are in `ms`; expected `s`",
        ),
        (
            "time,side_length [parsec]\n0,0.3\n",
            &[],
            "column `side_length` is in `parsec`; expected `m` or `mm` or `cm`",
        ),
        (
            "time,side_length\ns,kg\n0,0.3\n",
            &[],
            "line 2: column `side_length` is in `kg`; expected `m` or `mm` or `cm`",
        ),
        ("time\n0\n", &[], "it has no column besides `time`"),
        (
            "time,side_length\n0,\"0,3\"\n",
            &[],
            "line 2: `0,3` is not a finite number; decimals stand after a point",
        ),
        (
            "# a comment\ntime,side_length\n0,0.3\n\n1\n",
            &[],
            "line 5 has 1 column; the first has names for 2",
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
        (
            "time,side_length\n1600000001,0.3\n1600000000.25,0.3\n",
            &[],
            "line 3: time goes back to 1600000000.25",
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
            "two columns for `side_length.position`: column 2 and column 3",
        ),
        (
            "time,side_length\n0,0.3,1\n",
            &[],
            "line 2 has 3 columns; the first has names for 2",
        ),
        (
            "time,side_length\n0,0.3\n",
            &["--drive", "side_length=1"],
            "both --drive and --input say how `side_length` moves; leave out the columns of \
             `side_length`",
        ),
    ] {
        let message = stderr(&run(content, more).code(2));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn values_of_a_file_replace_a_motion() {
    let folder = tempfile::tempdir().unwrap();
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

/// Runs the four-bar, whose only driver is an angle, along the rows of a file.
fn four_bar(folder: &std::path::Path, content: &str) -> assert_cmd::assert::Assert {
    let path = folder.join("crank.csv");
    std::fs::write(&path, content).expect("it can be written");
    let input = ["--input", path.to_str().expect("UTF-8")];
    let span = ["--stop", "1", "--step", "0.25"];
    biela(&[&["run", "mechanisms/four_bar.toml"][..], &input, &span].concat()).success()
}

#[test]
fn run_reads_its_own_output() {
    let folder = tempfile::tempdir().unwrap();
    let motion = ["--drive", "crank_angle = 60*deg + sin(2*t)"];
    let span = ["--stop", "1", "--step", "0.25"];
    let first = biela(&[&["run", "mechanisms/four_bar.toml"][..], &motion, &span].concat());
    let first = stdout(&first.success());
    let again = four_bar(folder.path(), &first);
    let told = stderr(&again);
    assert_eq!(told.lines().count(), 1, "{told}");
    let expected = "crank.csv`: columns that are no inputs are ignored: `crank.x`, `crank.y`, \
                    `crank.phi` and ";
    assert!(
        told.starts_with("note: --input: `") && told.contains(expected),
        "{told}"
    );
    let again = stdout(&again);
    let names = first.lines().next().unwrap().split(',');
    for name in names {
        let [first, again] = [&first, &again].map(|csv| column(csv, name));
        assert_eq!(first.len(), again.len(), "{name}");
        for (a, b) in first.into_iter().zip(again) {
            // The same inputs to the last bit, on another way from point to point: some roundings of
            // rates up to ten.
            assert!((a - b).abs() < 1e-12, "{name}: {a} {b}");
        }
    }
}

#[test]
fn run_reads_what_other_programs_write() {
    let folder = tempfile::tempdir().unwrap();
    let expected = [1.0, 1.25, 1.5, 1.75, 2.0];
    let degrees = [1.0_f64, 2.0].map(f64::to_degrees);
    let [from, to] = degrees;
    for content in [
        "Time,crank_angle\n0,1\n1,2\n".to_owned(),
        "t;crank_angle\n0;1\n1;2\n".to_owned(),
        "time [s],crank_angle.position [rad]\n0,1\n1,2\n".to_owned(),
        "TIME (s),crank_angle (rad)\n0,1\n1,2\n".to_owned(),
        // With blanks between the columns and before the units.
        "TIME (s) crank_angle (rad)\n0 1\n1 2\n".to_owned(),
        format!("time [s] crank_angle [deg]\n0 {from:?}\n1 {to:?}\n"),
        // With units below the names, or without where there is none.
        "time,crank_angle\ns,rad\n0,1\n1,2\n".to_owned(),
        "time,crank_angle\n[s],[-]\n0,1\n1,2\n".to_owned(),
        format!("time,crank_angle [deg]\n0,{from:?}\n1,{to:?}\n"),
        format!("time,crank_angle\ns,deg\n0,{from:?}\n1,{to:?}\n"),
        // An index, and a column of texts.
        ",time,crank_angle,remark\n0,0,1,start\n1,1,2,end\n".to_owned(),
        "index,time,remark,crank_angle\n0,0,start,1\n1,1,,2\n".to_owned(),
    ] {
        let run = four_bar(folder.path(), &content);
        let told = stderr(&run);
        let is_told = told.contains("are ignored: ");
        assert_eq!(is_told, content.contains("remark"), "{content}{told}");
        assert_eq!(
            told.lines().count(),
            usize::from(is_told),
            "{content}{told}"
        );
        let position = column(&stdout(&run), "crank_angle.position");
        assert_eq!(position.len(), expected.len(), "{content}");
        for (found, expected) in position.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-14,
                "{content}: {found} {expected}"
            );
        }
    }
    let run = four_bar(
        folder.path(),
        "time,crank_angle,remark\n0,1,start\n1,2,end\n",
    );
    let told = stderr(&run);
    assert!(
        told.ends_with("`remark` is no input and is ignored\n"),
        "{told}"
    );
}

#[test]
fn run_ignores_a_column_like_an_input_that_has_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "five_bar_robot",
        &[("right_angle = {", "x1 = {")],
    );
    let path = folder.path().join("angles.csv");
    let run = |content: &str| {
        std::fs::write(&path, content).unwrap();
        let input = ["--input", path.to_str().unwrap()];
        let span = ["--stop", "1", "--step", "0.5"];
        biela(&[&["run", &file][..], &input, &span].concat())
    };
    let told = run("time,left_angle,x1,right_angle\n0,2.3,0.8,0\n1,2.4,0.9,0\n").success();
    let told = stderr(&told);
    assert!(
        told.ends_with("`right_angle` is no input and is ignored\n"),
        "{told}"
    );
    let told = stderr(&run("time,x1,right_angle\n0,0.8,0\n").code(2));
    assert!(told.contains("did you mean `left_angle`?"), "{told}");
}

#[test]
fn run_warns_of_columns_that_look_like_degrees() {
    let folder = tempfile::tempdir().unwrap();
    for (content, angle) in [
        // Whole numbers, and more than a turn at the start, as in --drive.
        (
            "time,crank_angle\n0,0\n1,90\n",
            Some("90 rad is 5156.6 deg"),
        ),
        (
            "time,crank_angle\n0,7.5\n1,8.1\n",
            Some("7.5 rad is 429.7 deg"),
        ),
        ("time,crank_angle\n0,1.5\n1,90\n", None),
        ("time,crank_angle [rad]\n0,0\n1,90\n", None),
        ("time,crank_angle [deg]\n0,0\n1,90\n", None),
        (
            "time,crank_angle,crank_angle.velocity\n0,1.5,90\n1,2,90\n",
            None,
        ),
    ] {
        let told = stderr(&four_bar(folder.path(), content));
        let Some(angle) = angle else {
            assert_eq!(told, "", "{content}");
            continue;
        };
        let expected = format!(
            "column `crank_angle`: an angle of {angle}; a column of degrees is called \
             `crank_angle [deg]`\n"
        );
        assert!(
            told.starts_with("warning: --input: `") && told.ends_with(&expected),
            "{told}"
        );
    }
}

#[test]
fn run_sets_inputs_of_forces_by_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loads.csv");
    let run = |mechanism: &str, content: &str, more: &[&str]| {
        std::fs::write(&path, content).unwrap();
        let mut arguments = vec!["run", mechanism, "--input", path.to_str().unwrap()];
        arguments.extend(["--stop", "2", "--step", "0.5"]);
        arguments.extend(more);
        biela(&arguments)
    };
    let loader = "mechanisms/loader.toml";
    // The same loads by --drive: the effort of each cylinder is linear in the load.
    let drive = [
        "--drive",
        "load.fy = -1000*t",
        "--drive",
        "load.torque = 30",
    ];
    let arguments = ["run", loader, "--stop", "2", "--step", "0.5"];
    let driven = stdout(&biela(&[&arguments[..], &drive].concat()).success());
    let content = "time,load.fy,load.torque\n0,0,30\n2,-2000,30\n";
    let csv = stdout(&run(loader, content, &[]).success());
    for name in ["lift.effort", "tilt.effort", "bucket_pin.fx"] {
        for (found, expected) in column(&csv, name).iter().zip(column(&driven, name)) {
            // Rounding of the numbers that make up forces of the weights.
            assert!((found - expected).abs() < 1e-9 * expected.abs(), "{name}");
        }
    }
    // A load that is constant before the first time and jumps at 1 s.
    let content = "time,lift,load.fy\n0.5,1.2,0\n1,1.2,0\n1,1.2,-5000\n";
    let csv = stdout(&run(loader, content, &[]).success());
    let effort = column(&csv, "lift.effort");
    let same = |a: f64, b: f64| (a - b).abs() < 1e-9 * a.abs();
    assert!(
        same(effort[0], effort[1]) && same(effort[2], effort[4]),
        "{effort:?}"
    );
    // The load moves further than the cylinder, whose force changes by more.
    assert!(effort[2] - effort[1] > 5000.0, "{effort:?}");
    for (mechanism, content, more, expected) in [
        (
            loader,
            "time,load.fz\n0,1\n",
            &[][..],
            "column `load.fz` is no variable of a driver and no input of a force; \
             did you mean `load.fx`?",
        ),
        (
            loader,
            "time,load.fx,load.fy,load.fx\n0,1,1,1\n",
            &[],
            "two columns for `load.fx`: column 2 and column 4",
        ),
        (
            loader,
            "time,load.fx\n0,1\n",
            &["--drive", "load.fx=1"],
            "both --drive and --input give `load.fx`",
        ),
        (
            "mechanisms/hatch.toml",
            "time,gas_spring.effort\n0,1\n",
            &[],
            "column `gas_spring.effort` is no input: the file or --drive gives `gas_spring` its size",
        ),
    ] {
        let message = stderr(&run(mechanism, content, more).code(2));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_value_of_a_wrapped_angle_means_the_turn_nearest_the_last_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("turns.csv");
    let run = |extra: &str, content: &str| {
        std::fs::write(&path, content).unwrap();
        let start = format!("start = \"60*deg\"{extra}");
        let file = altered(folder.path(), "four_bar", &[("start = \"60*deg\"", &start)]);
        let input = ["--input", path.to_str().unwrap()];
        let span = ["--stop", "0.4", "--step", "0.1"];
        let arguments = [&["run", &file][..], &input, &span].concat();
        let csv = stdout(&biela(&arguments).success());
        ["position", "velocity"].map(|order| column(&csv, &format!("crank_angle.{order}")))
    };
    let turn = std::f64::consts::TAU;
    let expected = [0.7, 3.7, 6.2, 0.1 + turn, 1.0 + turn];
    let near = |found: &[f64], expected: &[f64]| {
        let mut pairs = found.iter().zip(expected);
        found.len() == expected.len() && pairs.all(|(a, b)| (a - b).abs() < 1e-12)
    };
    let rows = "0.1,3.7\n0.2,6.2\n0.3,0.1\n0.4,1.0\n";
    // The first value is nearest the file's start, whatever turn it is on.
    for first in [0.7, 0.7 + turn] {
        let content = format!("time,crank_angle.position\n0,{first}\n{rows}");
        let [position, velocity] = run(", wrapped = true", &content);
        assert!(near(&position, &expected), "{position:?}");
        assert!((velocity[2] - (0.1 + turn - 6.2) / 0.1).abs() < 1e-9);
    }
    // Also where the value jumps.
    let content = "time,crank_angle\n0,6.2\n0.2,6.2\n0.2,0.1\n0.4,0.1\n";
    let [position, _] = run(", wrapped = true", content);
    let at = [6.2 - turn, 6.2 - turn, 0.1, 0.1, 0.1];
    assert!(near(&position, &at), "{position:?}");
    // Other angles count turns.
    let [position, _] = run("", &format!("time,crank_angle\n0,0.7\n{rows}"));
    assert!(near(&position, &[0.7, 3.7, 6.2, 0.1, 1.0]), "{position:?}");
}

/// A slider that carries a pendulum, or a plain bob where nothing is free.
fn carrier(driver: &str, is_free: bool) -> String {
    let (section, swing) = if is_free {
        ("freedoms", "start = 0.3")
    } else {
        ("drivers", "motion = \"0.3 + t\"")
    };
    format!(
        r#"
format = 1
name = "carrier"
[parameters]
gain = 2
[inputs]
setpoint = {{ start = 0.1 }}
[ground.markers]
O = [0, 0]
[bodies.block]
markers = {{ B = [0, 0] }}
mass = 2
[bodies.rod]
markers = {{ B = [0, 0] }}
mass = 1
inertia = 0.1
center = [0, -0.5]
[joints]
guide = {{ type = "translational", markers = ["ground.O", "block.B"] }}
hinge = {{ type = "revolute", markers = ["block.B", "rod.B"] }}
[drivers]
x = {{ coordinate = "x", markers = ["ground.O", "block.B"], {driver} }}
[{section}.swing]
coordinate = "angle"
markers = ["block.B", "rod.B"]
{swing}
"#
    )
}

/// A driver that follows an input with a column moves as one whose own column has what it follows: with a
/// pendulum on it that is driven and one that is free, with a jump of the column.
#[test]
fn a_driver_that_follows_an_input_is_moved_by_its_column() {
    let folder = tempfile::tempdir().unwrap();
    let [file, table] = ["carrier.toml", "table.csv"].map(|name| folder.path().join(name));
    let run = |text: &str, content: &str, more: &[&str]| {
        std::fs::write(&file, text).unwrap();
        std::fs::write(&table, content).unwrap();
        let arguments = ["run", file.to_str().unwrap()];
        let more = [&["--stop", "2", "--step", "0.125"][..], more].concat();
        biela(&[&arguments[..], &more].concat())
    };
    let by_table = ["--input", table.to_str().unwrap()];
    let rows = [
        [0.0, 0.1],
        [0.5, 0.25],
        [0.8, -0.05],
        [1.3, -0.05],
        [1.3, 0.1],
    ];
    let rows = [&rows[..], &[[1.75, 0.4]]].concat();
    let content = |name: &str, factor: f64| {
        let lines = rows.iter().map(|[t, s]| format!("{t},{}\n", factor * s));
        format!("time,{name}\n{}", lines.collect::<String>())
    };
    let names = [
        "x.position",
        "x.velocity",
        "x.acceleration",
        "x.effort",
        "rod.phi",
        "rod.alpha",
    ];
    for is_free in [false, true] {
        // A column that jumps moves a freedom by an impact.
        let follower = carrier("motion = \"gain*setpoint\"", is_free);
        let found = stdout(&run(&follower, &content("setpoint", 1.0), &by_table).success());
        let driven = carrier("start = 0.2", is_free);
        let truth = stdout(&run(&driven, &content("x", 2.0), &by_table).success());
        for name in names {
            let pairs = column(&found, name).into_iter().zip(column(&truth, name));
            for (row, (found, truth)) in pairs.enumerate() {
                // Roundings; of a free motion, whose steps are the same, with growth.
                let tolerance = if is_free { 1e-10 } else { 1e-13 };
                let off = (found - truth).abs() / (1.0 + truth.abs());
                assert!(off < tolerance, "{is_free} {name} {row}: {found} {truth}");
            }
        }
        // The input has a column, behind all others: the later value where it jumps.
        let header = found.lines().next().expect("there is one");
        assert!(header.ends_with(",setpoint"), "{header}");
        let setpoint = column(&found, "setpoint");
        assert!(near(&setpoint[..3], &[0.1, 0.1375, 0.175]), "{setpoint:?}");
        let moved = column(&found, "x.velocity");
        assert!((moved[1] - 0.6).abs() < 1e-13, "{moved:?}");
    }
    // The square of an input beside time: by the chain rule, as the same motion in t alone has it.
    let follower = carrier("motion = \"gain*setpoint^2 + 0.1*t^2\"", false);
    let found = run(&follower, "time,setpoint\n0,0.1\n3,0.7\n", &by_table);
    let found = stdout(&found.success());
    let motion = ["--drive", "setpoint = 0.1 + 0.2*t"];
    let truth = stdout(&run(&follower, "", &motion).success());
    assert!(near(
        &column(&truth, "setpoint"),
        &column(&found, "setpoint")
    ));
    let alone = stdout(&run(&follower, "", &["-v", "setpoint"]).success());
    assert_eq!(alone.lines().next(), Some("time,setpoint"));
    assert!(
        column(&alone, "setpoint")
            .iter()
            .all(|value| near(&[*value], &[0.1]))
    );
    for name in names {
        let pairs = column(&found, name).into_iter().zip(column(&truth, name));
        for (found, truth) in pairs {
            assert!(
                (found - truth).abs() < 1e-12 * (1.0 + truth.abs()),
                "{name}: {found} {truth}"
            );
        }
    }
    let accelerations = column(&found, "x.acceleration");
    assert!(
        accelerations.iter().all(|a| (a - 0.36).abs() < 1e-13),
        "{accelerations:?}"
    );
}

/// A function by which a driver follows an input is told where its table leaves the points, once; not one
/// that says what holds there.
#[test]
fn a_function_of_what_follows_an_input_is_told_beyond_its_points() {
    let folder = tempfile::tempdir().unwrap();
    let [file, table] = ["carrier.toml", "table.csv"].map(|name| folder.path().join(name));
    std::fs::write(&table, "time,setpoint\n0,0.1\n2,0.5\n").unwrap();
    let told = |ends: &str| {
        let law = format!(
            "[functions]\ncurve = {{ table = [[0, 0], [0.3, 1]], law = \"linear\"{ends} }}\n"
        );
        let text = carrier("motion = \"curve(setpoint)\"", false).replace("gain = 2\n", "") + &law;
        std::fs::write(&file, text).unwrap();
        let arguments = [
            "run",
            file.to_str().unwrap(),
            "--input",
            table.to_str().unwrap(),
        ];
        let more = ["--stop", "2", "--step", "0.125"];
        stderr(&biela(&[&arguments[..], &more].concat()).success())
    };
    let beyond = "function `curve` is called at ";
    let found = told("");
    // 0.1 + 0.2 t passes 0.3 after 1 s.
    assert!(
        found.contains("t = 1.125 s: function `curve` is called at 0.325, beyond"),
        "{found}"
    );
    assert_eq!(found.matches(beyond).count(), 1, "{found}");
    assert!(!told(", ends = \"periodic\"").contains(beyond));
}
