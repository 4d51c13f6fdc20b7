//! `biela draw`

use assert_cmd::Command;

use crate::cli::program::{biela, stderr, stdout};

#[test]
fn draw_writes_what_the_extension_says() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let mut arguments = vec!["draw", "mechanisms/four_bar.toml", "-o"];
        arguments.push(path.to_str().unwrap());
        arguments.extend(more);
        let assert = biela(&arguments).success();
        assert_eq!(stdout(&assert), "");
        assert_eq!(stderr(&assert), format!("wrote {}\n", path.display()));
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
    // The width stands in the header, after signature, length and name of the chunk.
    for (name, more, width) in [
        ("d.png", &[][..], 1600_u32),
        ("e.png", &["--width", "96"], 96),
    ] {
        let png = draw(name, more);
        assert!(png.starts_with(b"\x89PNG") && png[16..20] == width.to_be_bytes());
    }
    let printed = biela(&["draw", "mechanisms/four_bar.toml", "-o", "-"]).success();
    assert_eq!(stdout(&printed), text);
    // Without -o, under the mechanism's own name where one is.
    Command::new(env!("CARGO_BIN_EXE_biela"))
        .current_dir(folder.path())
        .args([
            "draw",
            concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../mechanisms/four_bar.toml"
            ),
        ])
        .assert()
        .success();
    assert!(svg == std::fs::read(folder.path().join("four_bar.svg")).unwrap());
}

#[test]
fn draw_shows_forces_with_their_sizes() {
    let draw = |mechanism: &str, more: &[&str]| {
        let path = format!("mechanisms/{mechanism}.toml");
        biela(&[&["draw", &path, "-o", "-"], more].concat())
    };
    let without = stdout(&draw("hatch", &[]).success());
    assert!(!without.contains("class=\"forces\""));
    let at_rest = stdout(&draw("hatch", &["--forces"]).success());
    assert!(at_rest.contains("class=\"forces\""));
    // The hatch turns: its damper takes a part, and the inertia changes the effort.
    let moving = ["--forces", "--drive", "opening = -40*deg + 2*t"];
    assert_ne!(at_rest, stdout(&draw("hatch", &moving).success()));
    let message = stderr(&draw("four_bar", &["--forces"]).code(2));
    assert!(
        message.contains("--forces: the mechanism has no forces"),
        "{message}"
    );
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
fn draw_adds_what_is_asked_for() {
    let draw = |more: &[&str]| {
        let mut arguments = vec!["draw", "mechanisms/loader.toml", "-o", "-"];
        arguments.extend(more);
        biela(&arguments)
    };
    let plain = stdout(&draw(&[]).success());
    let poses = stdout(&draw(&["--poses", "4"]).success());
    assert!(poses.contains("class=\"poses\"") && !plain.contains("class=\"poses\""));
    // Without angles the first driver moves, here `lift`.
    assert_eq!(
        poses,
        stdout(&draw(&["--poses", "4", "--driver", "lift"]).success())
    );
    assert_ne!(
        poses,
        stdout(&draw(&["--poses", "4", "--driver", "tilt"]).success())
    );
    let bounded = stdout(&draw(&["--poses", "4", "--from", "1.1"]).success());
    assert_ne!(poses, bounded);
    let dimensions = stdout(&draw(&["--dimensions"]).success());
    assert!(dimensions.contains(">lengths in ") && dimensions.contains("class=\"dimensions\""));
    let centres = stdout(&draw(&["--instant-centres", "--driver", "tilt"]).success());
    assert!(centres.contains("instant centres while tilt moves alone"));
    let refused = stderr(&draw(&["--contacts"]).code(2));
    assert_eq!(
        refused,
        "error: --contacts: the mechanism has no contacts; add `[contacts]`\n"
    );
    let refused = stderr(&draw(&["--poses", "4", "--driver", "tild"]).code(2));
    assert_eq!(
        refused,
        "error: --driver: no driver `tild`; did you mean `tilt`?\n"
    );
    draw(&["--poses", "101"]).code(2);
    draw(&["--from", "2", "--to", "1"]).code(2);
}

#[test]
fn draw_without_a_driver_has_no_poses() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("truss.toml");
    let text = "format = 1\nname = 'truss'\n[ground.markers]\nO = [0, 0]\n\
        [bodies.bar]\nmarkers = { O = [0, 0] }\n\
        [joints]\nO = { type = 'weld', markers = ['ground.O', 'bar.O'] }\n";
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    for (option, named) in [("--poses=2", "--poses"), ("--from=1", "--from, --to")] {
        let refused = stderr(&biela(&["draw", path, "-o", "-", option]).code(2));
        assert_eq!(
            refused,
            format!("error: {named}: the mechanism has no driver\n")
        );
    }
    biela(&["draw", path, "-o", "-", "--instant-centres"]).success();
}
