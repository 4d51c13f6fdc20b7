//! `biela check`

use assert_cmd::Command;

use crate::cli::program::{altered, biela, program, stderr, stdout};
use crate::common::mechanisms::crank;

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

/// Unasked, other ways to close are mentioned, with the bodies that another way would leave nearer
/// to their estimates.
#[test]
fn other_ways_to_close_are_mentioned() {
    let text = stdout(&biela(&["check", "mechanisms/four_bar.toml"]).success());
    assert_eq!(
        behind(&text, "  residual"),
        "\n1 other way to close at these values: `--modes`\n"
    );
    let folder = tempfile::tempdir().unwrap();
    // The rocker's estimate decides, the coupler's is right for the other way.
    let file = altered(
        folder.path(),
        "four_bar",
        &[
            ("\"20*deg\"]", "\"60*deg\"]"),
            ("[\"base\", 0, \"110*deg\"]", "[\"base\", 0, \"-80*deg\"]"),
        ],
    );
    let text = stdout(&biela(&["check", &file]).success());
    assert_eq!(
        behind(&text, "  residual"),
        "\n1 other way to close at these values: `--modes`\n`coupler` has turned 129.247 deg \
         from its estimate: is this the way that is meant?\n"
    );
    let text = stdout(&biela(&["check", "mechanisms/pendulum.toml"]).success());
    assert_eq!(behind(&text, "  residual"), "");
}

#[test]
fn efforts_have_six_digits() {
    let text = stdout(&biela(&["check", "mechanisms/loader.toml"]).success());
    assert!(text.contains("  lift.effort = 49026.7 N\n"), "{text}");
}

/// sin(2 pi t) exceeds 1/2 from 1/12 s on and −1/2 from 7/12 s on: in the next row, 0.1 s and 0.6 s.
#[test]
fn motions_beyond_limits_are_told_as_in_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.toml");
    let swing = |driver: &str, simulation: &str| {
        let text = crank(driver) + &format!("[simulation]\n{simulation}\n");
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap()
    };
    let limits = "min = -0.5, max = 0.5";
    let moving = format!("motion = 'sin(2*pi*t)', {limits}");
    let file = swing(&moving, "stop = 1\nstep = 0.1");
    let told = stderr(&biela(&["check", file]).success());
    let expected = [("0.1", "max"), ("0.6", "min")];
    assert_eq!(told.lines().count(), expected.len(), "{told}");
    for (line, (time, key)) in told.lines().zip(expected) {
        assert!(
            line.starts_with(&format!("warning: t = {time}"))
                && line.contains(" s: driver `turn` is"),
            "{line}"
        );
        assert!(line.contains(&format!("beyond its `{key}` = ")), "{line}");
    }
    assert_eq!(told, stderr(&biela(&["run", file, "-o", "-"]).success()));
    let report = stdout(&biela(&["check", "--format", "json", file]).success());
    let report: serde_json::Value = serde_json::from_str(&report).expect("it is JSON");
    let excursions = report["assembled"]["excursions"].as_array();
    let excursions = excursions.expect("a list").iter();
    let excursions = excursions.map(|text| format!("warning: {}\n", text.as_str().expect("text")));
    assert_eq!(told, excursions.collect::<String>());
    // Far more rows than are looked at, a span before, and a driver that does not move by itself.
    for (driver, simulation, count) in [
        (&*moving, "stop = 1\nstep = 1e-8", 2),
        (&moving, "stop = 0.08\nstep = 0.01", 0),
        (&moving, "start = 0.5\nstop = 1\nstep = 0.1", 1),
        (&format!("start = 0, {limits}"), "stop = 1", 0),
    ] {
        let told = stderr(&biela(&["check", swing(driver, simulation)]).success());
        assert_eq!(told.lines().count(), count, "{simulation}: {told}");
    }
}

/// Returns the text behind the line that starts with `heading`.
fn behind<'a>(text: &'a str, heading: &str) -> &'a str {
    let (_, behind) = text.split_once(heading).expect("it is there");
    behind.split_once('\n').expect("there is more").1
}

/// Pasted into the file, the estimates that `check` prints are the pose: to the digits printed.
#[test]
fn printed_estimates_can_be_pasted() {
    for name in crate::common::stems("mechanisms", "toml") {
        let file = format!("mechanisms/{name}.toml");
        let assert = biela(&["check", &file, "--estimates"]).success();
        let output = stdout(&assert);
        let text = std::fs::read_to_string(crate::common::folder(&file)).expect("it is shipped");
        let text = crate::common::pasted(&text, behind(&output, "estimates of this pose"));
        // A file with tables beside it can only be read from its folder.
        if text.contains(".csv") {
            continue;
        }
        let (solver, _) = crate::common::assembled(&crate::common::parse(&text));
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

/// A rod beside the coupler of a parallelogram that is a millimetre too long is so at every angle that
/// its own four-bar reaches: the pin is 0.101 m or more from the follower's pivot, the crank at
/// acos((0.1² + 0.2² − 0.101²) / (2·0.1·0.2)) = 5.75° or more, of which poses are 2° apart from 60°.
#[test]
fn the_play_that_a_contradiction_needs_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let rod =
        "[joints]\nrod = { type = 'link', markers = ['crank.A', 'follower.B'], length = 0.201 }";
    let file = altered(folder.path(), "parallelogram", &[("[joints]", rod)]);
    let assert = biela(&["check", &file]).code(1);
    insta::assert_snapshot!(
        behind(&stdout(&assert), "  drivers").trim(),
        @"not assembled; with a play of about 1.000 mm in joint `B`, and all others exact, crank_angle moves from 6.000000 deg to 354.000000 deg"
    );
    let report = stdout(&biela(&["check", "--format", "json", &file]).code(1));
    let report: serde_json::Value = serde_json::from_str(&report).expect("it is JSON");
    let play = &report["error"]["play"];
    assert_eq!(play["driver"], "crank_angle");
    assert_eq!(play["open"][0]["element"], "joint `B`");
    let gap = play["open"][0]["gap"].as_f64().expect("a number");
    assert!((gap - 1e-3).abs() < 1e-8, "{gap}");
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

    not assembled; the nearest pose

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
        "warning: constraint equations of joint `A_again` are redundant: all 2 follow from the \
         others; they are set aside and watched\n"
    );
    // On a terminal the kind has its colour, as that of what is wrong in the file.
    let colourful = Command::new(env!("CARGO_BIN_EXE_biela"))
        .env("CLICOLOR_FORCE", "1")
        .args(["check", &file])
        .assert();
    let message = stderr(&colourful.success());
    assert!(
        message.starts_with("\u{1b}[") && message.contains("mwarning\u{1b}[0m: constraint"),
        "{message:?}"
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
        // stderr names a file that cannot be read, as ever.
        assert_eq!(stderr(&assert).is_empty(), code != 2);
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

    let latin = check(&["crates/tools/tests/file/diagnostics/not-utf-8.toml"], 1);
    assert_eq!(latin["diagnostics"][0]["code"], "not-utf-8");
    let missing = check(&["no_such_file.toml"], 2);
    assert_eq!(missing["file"], "no_such_file.toml");
    assert_eq!(missing["ok"], false);
    let message = missing["error"]["message"].as_str().unwrap();
    assert!(message.starts_with("cannot read `no_such_file.toml`: "));

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
fn errors_have_colours_where_they_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("\"crank.A\"", "\"cranck.A\"")],
    );
    let errors = |variable: &str| {
        let mut program = program();
        program.args(["check", &file]).env(variable, "1");
        stderr(&program.assert().code(1))
    };
    assert!(errors("CLICOLOR_FORCE").contains("\u{1b}["));
    assert!(!errors("NO_COLOR").contains('\u{1b}'));
}

#[test]
fn a_joint_that_was_drawn_apart_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = |x: f64| {
        let path = folder.path().join("arm.toml");
        let text = format!(
            "format = 1\nname = \"arm\"\n[ground.markers]\nO = [0.1, 0]\nD = [0.5, 0]\n\
             [bodies]\ncrank = {{ markers = {{ O = [0.1, 0], A = [0.1, 0.2] }} }}\n\
             rod = {{ markers = {{ A = [0.1, 0.2], B = [{x}, 0.3] }} }}\n\
             rocker = {{ markers = {{ B = [0.5, 0.3], D = [0.5, 0] }} }}\n[joints]\n\
             O = {{ type = \"revolute\", markers = [\"ground.O\", \"crank.O\"] }}\n\
             A = {{ type = \"revolute\", markers = [\"crank.A\", \"rod.A\"] }}\n\
             B = {{ type = \"revolute\", markers = [\"rod.B\", \"rocker.B\"] }}\n\
             D = {{ type = \"revolute\", markers = [\"ground.D\", \"rocker.D\"] }}\n[drivers]\n\
             turn = {{ coordinate = \"angle\", markers = [\"ground.O\", \"crank.O\"], start = 0 }}\n"
        );
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    assert_eq!(stderr(&biela(&["check", &drawn(0.5)]).success()), "");
    let file = drawn(0.59);
    let says = "`rod.B` and `rocker.B` were drawn 90.00 mm apart: a slip in a coordinate?";
    assert_eq!(
        stderr(&biela(&["check", &file]).success()),
        format!("warning: {says}\n")
    );
    let report = stdout(&biela(&["check", &file, "--format", "json"]).success());
    assert!(report.contains(says), "{report}");
}

/// A block of 100 kg on a slope: friction of 0.2 holds it at 10°, not at 15°.
#[test]
fn self_locking_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let slow = |angle: f64| {
        let file = folder.path().join("slope.toml");
        let text = format!(
            r#"
format = 1
name = "slope"
[ground.markers]
O = [0, 0, "{angle}*deg"]
[bodies.block]
mass = 100
markers = {{ P = [0, 0, "{angle}*deg"] }}
[joints]
rail = {{ type = "translational", markers = ["ground.O", "block.P"] }}
[drivers]
way = {{ coordinate = "x", markers = ["ground.O", "block.P"], start = 0 }}
[friction]
shoe = {{ joint = "rail", coefficient = 0.2 }}
"#
        );
        std::fs::write(&file, text).unwrap();
        let file = file.to_str().unwrap();
        let json = stdout(&biela(&["check", file, "--format", "json"]).success());
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let (sine, cosine) = angle.to_radians().sin_cos();
        for (place, sign) in [(0, 1.0), (1, -1.0)] {
            let effort = &json["assembled"]["slow_motion"][0]["efforts"][place];
            let wanted = 981.0 * (sine + sign * 0.2 * cosine);
            assert!((effort.as_f64().unwrap() - wanted).abs() < 1e-9 * wanted.abs());
        }
        let text = stdout(&biela(&["check", file]).success());
        text.lines().last().unwrap().to_owned()
    };
    insta::assert_snapshot!(slow(10.0), @"  way.effort in slow motion: 363.568 N as it grows, -22.8704 N as it falls: self-locking");
    insta::assert_snapshot!(slow(15.0), @"  way.effort in slow motion: 443.416 N as it grows, 64.3868 N as it falls");
}

/// A start at a jump of an equation closes, and no motion leads there or away.
#[test]
fn a_start_without_a_motion_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let jump = [("law(mod(crank_angle + pi, 2*pi) - pi)", "law(0)")];
    let at = |start: &str| {
        let changes = [jump[0], ("start = \"-25*deg\"", start)];
        altered(folder.path(), "geneva_drive", &changes)
    };
    let file = at("start = \"180*deg\"");
    let fmu = folder.path().join("geneva.fmu");
    let fmu = fmu.to_str().unwrap();
    for arguments in [
        &["check", &file][..],
        &["export", "--no-page", "-o", fmu, &file],
    ] {
        let told = stderr(&biela(arguments).code(1));
        let wanted = "an FMU does not initialise: no continuous motion";
        assert!(told.contains(wanted), "{told}");
    }
    let report = stdout(&biela(&["check", "--format", "json", &file]).code(1));
    assert!(report.contains("an FMU does not initialise"), "{report}");
    biela(&["check", &at("start = \"170*deg\"")]).success();
}
