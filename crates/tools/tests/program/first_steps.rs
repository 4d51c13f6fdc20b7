//! A mechanism of one's own, from the first try to the pictures: what the program says on the way.

use std::process::{Command, Output};

/// A quick-return whose arm drives a ram by a pinion: lengths in millimetres, angles in degrees.
const SHAPER: &str = r#"
format = 1
name = "shaper"

[parameters]
radius = { value = "40*mm", unit = "m", display = "mm" }
pinion = { value = "30*mm", unit = "m", display = "mm" }

[ground.markers]
O = [0, 0]
C = [0, "100*mm"]
R = [0, "-pinion"]

[bodies.crank]
markers = { O = [0, 0], A = ["radius", 0] }
estimate = [0, "100*mm", "30*deg"]

[bodies.arm]
markers = { O = [0, 0] }
estimate = [0, 0, "80*deg"]

[bodies.ram]
markers = { T = [0, 0] }
estimate = [0, "-pinion", 0]

[joints]
C = { type = "revolute", markers = ["ground.C", "crank.O"] }
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
slot = { type = "slot", markers = ["arm.O", "crank.A"] }
rail = { type = "translational", markers = ["ground.R", "ram.T"] }
mesh = { type = "rack_and_pinion", markers = ["arm.O", "ram.T"], radius = "pinion" }

[drivers]
motor = { coordinate = "angle", markers = ["ground.C", "crank.O"], start = "30*deg" }
"#;

/// Runs the program beside a mechanism file; stdout, stderr and the folder.
fn biela(text: &str, arguments: &[&str]) -> (String, String, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("shaper.toml"), text).expect("it can be written");
    let Output { stdout, stderr, .. } = Command::new(env!("CARGO_BIN_EXE_biela"))
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .expect("the program runs");
    let [stdout, stderr] =
        [stdout, stderr].map(|text| String::from_utf8(text).expect("output is text"));
    (stdout, stderr, folder)
}

#[test]
fn millimetres_are_told_how_they_are_written() {
    let first_try = SHAPER.replace(r#""40*mm", unit = "m""#, r#"40, unit = "mm""#);
    let (_, message, _) = biela(&first_try, &["check", "shaper.toml"]);
    let help = r#"values are SI: `value = "40*mm", unit = "m", display = "mm"`"#;
    assert!(message.contains(help), "{message}");
    // An angle of time has a constant as well, a mass in grams has none.
    for (unit, help) in [
        (
            "deg/s",
            r#"`value = "40*deg", unit = "rad/s", display = "deg/s"`"#,
        ),
        ("g", r#"`unit = "kg", display = "g"`"#),
    ] {
        let text = first_try.replace(r#"unit = "mm""#, &format!("unit = \"{unit}\""));
        let (_, message, _) = biela(&text, &["check", "shaper.toml"]);
        assert!(
            message.contains(&format!("values are SI: {help}")),
            "{message}"
        );
    }
}

#[test]
fn who_forgets_to_move_it_is_told_how() {
    for still in [&[][..], &["--drive", "motor = 0.5"]] {
        let mut arguments = vec!["run", "shaper.toml", "--animate", "shaper.html"];
        arguments.extend(still);
        let (_, message, _) = biela(SHAPER, &arguments);
        let note = "note: nothing moves; --drive or --input say how drivers move, for example \
                    --drive 'motor = 30*deg + 2*pi*t'\nwrote shaper.html\n";
        assert_eq!(message, note);
    }
    let drive = ["--drive", "motor = 30*deg + 2*pi*t"];
    let moved = [
        "run",
        "shaper.toml",
        "--animate",
        "shaper.html",
        drive[0],
        drive[1],
    ];
    assert_eq!(biela(SHAPER, &moved).1, "wrote shaper.html\n");
}

#[test]
fn written_pictures_are_told_of() {
    let (_, message, folder) = biela(SHAPER, &["draw", "shaper.toml"]);
    assert_eq!(message, "wrote shaper.svg\n");
    assert!(folder.path().join("shaper.svg").is_file());
    let (_, message, _) = biela(SHAPER, &["draw", "shaper.toml", "-o", "a.svg"]);
    assert_eq!(message, "wrote a.svg\n");
}

#[test]
fn plots_show_what_moves() {
    let run = ["run", "shaper.toml", "-d", "motor = 2*pi*t", "-p", "a.svg"];
    let (_, message, folder) = biela(SHAPER, &run);
    assert_eq!(message, "wrote a.svg\n");
    let picture = std::fs::read_to_string(folder.path().join("a.svg")).expect("it is drawn");
    for (name, shown) in [
        ("crank.phi", true),
        ("arm.phi", true),
        ("ram.x", true),
        ("ram.ax", true),
        // Crank and arm turn in place, the ram goes straight.
        ("crank.x", false),
        ("arm.vy", false),
        ("ram.y", false),
        ("ram.phi", false),
    ] {
        assert_eq!(picture.contains(&format!(">{name}<")), shown, "{name}");
    }
    // Variables that are asked for are shown.
    let all = [&run[..], &["-v", "ram"]].concat();
    let (_, _, folder) = biela(SHAPER, &all);
    let picture = std::fs::read_to_string(folder.path().join("a.svg")).expect("it is drawn");
    assert!(picture.contains(">ram.y<") && picture.contains(">ram.alpha<"));
}

#[test]
fn what_is_the_same_everywhere_is_said_so() {
    // The arm pushes along its guide: the transmission angle is right, but for the last digit of
    // its sine, which is half of the digits of the angle.
    let (text, _, folder) = biela(SHAPER, &["range", "shaper.toml", "--csv", "range.csv"]);
    assert!(
        text.contains("  transmission angle 90.00 deg everywhere\n"),
        "{text}"
    );
    assert!(
        text.contains("  reciprocal condition 1.00 everywhere\n"),
        "{text}"
    );
    let table = std::fs::read_to_string(folder.path().join("range.csv")).expect("it is written");
    let angles = table
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1));
    let angles: Vec<f64> = angles
        .map(|angle| angle.parse().expect("a number"))
        .collect();
    assert_eq!(angles, vec![std::f64::consts::FRAC_PI_2; 361]);
}
