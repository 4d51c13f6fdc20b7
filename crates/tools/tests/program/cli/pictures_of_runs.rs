//! `biela run --plot` and `--animate`

use crate::cli::program::{biela, stderr, stdout};

#[test]
fn run_plots_what_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let plot = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let mut arguments = vec!["run", "mechanisms/four_bar.toml", "--plot"];
        arguments.extend([
            path.to_str().unwrap(),
            "--drive",
            "crank_angle = 60*deg + 5*t + t^3",
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
    // Over a driver, which is then no line of its own.
    let (_, picture) = plot("e.svg", &["--over", "crank_angle"]);
    let picture = String::from_utf8(picture).unwrap();
    assert!(picture.contains(">crank_angle [deg]<"));
    assert!(!picture.contains(">crank_angle.position<") && !picture.contains(">time [s]<"));
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

/// The driver has a panel of its own, what is constant has none, and lines of a body have the
/// body's colour.
#[test]
fn plots_show_what_moves() {
    let folder = tempfile::tempdir().unwrap();
    let plot = |file: &str, drive: &str| {
        let path = folder.path().join("plot.svg");
        let path = path.to_str().unwrap();
        biela(&["run", file, "--drive", drive, "--plot", path]).success();
        std::fs::read_to_string(path).unwrap()
    };
    let picture = plot("mechanisms/four_bar.toml", "crank_angle = 60*deg + 5*t");
    assert_eq!(picture.matches(">angle [deg]<").count(), 2);
    assert!(picture.contains(">crank_angle.position<"));
    assert!(!picture.contains(">crank_angle.velocity<"));
    assert!(!picture.contains(">crank_angle.acceleration<"));
    let message = |over: &str| {
        let file = "mechanisms/four_bar.toml";
        let all = ["run", file, "--plot", "-", "--over", over];
        stderr(&biela(&all).code(2))
    };
    assert_eq!(
        message("crank_angel"),
        "error: --over: no variable `crank_angel`; did you mean `crank_angle`?\n"
    );
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
    assert_eq!(messages, format!("wrote {path}\n"));
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
fn run_writes_a_picture_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("four_bar.svg");
    let path = path.to_str().unwrap();
    let write = |drive: &str, stop: &str| {
        let four_bar = "mechanisms/four_bar.toml";
        let arguments = [
            "run", four_bar, "--drive", drive, "--stop", stop, "--step", "0.25",
        ];
        biela(&[&arguments[..], &["--animate", path]].concat()).success();
        std::fs::read_to_string(path).unwrap()
    };
    let svg = write("crank_angle = 60*deg + 2*pi*t", "1");
    let mut reader = quick_xml::Reader::from_str(&svg);
    while reader.read_event().unwrap() != quick_xml::events::Event::Eof {}
    // The crank turns by quarters about its pivot, the origin, and never back; clockwise is
    // positive on the sheet.
    let crank = "type=\"translate\" additive=\"replace\" values=\"0 0\" dur=\"2s\" \
                 repeatCount=\"indefinite\"/><animateTransform attributeName=\"transform\" \
                 type=\"rotate\" additive=\"sum\" values=\"-60;-150;-240;-330;-420\"";
    assert!(svg.contains(crank), "{svg}");
    for name in ["crank", "coupler", "rocker", "crank_angle", "P"] {
        assert!(svg.contains(&format!(">{name}<")), "{name}");
    }
    // Half a turn in three seconds is shown there and back, in six.
    let svg = write("crank_angle = 60*deg + pi/3*t", "3");
    assert!(svg.contains("dur=\"6s\""));
    let angles = svg
        .split("type=\"rotate\"")
        .find(|part| part.contains("values=\"-60;-75;-90;"));
    let angles = angles.expect("the crank turns").split('"').nth(3).unwrap();
    let angles: Vec<f64> = angles
        .split(';')
        .map(|angle| angle.parse().unwrap())
        .collect();
    assert_eq!((angles.len(), angles[12]), (25, -240.0));
    assert!(angles.iter().eq(angles.iter().rev()));
    // A page is still a page.
    biela(&[
        "run",
        "mechanisms/four_bar.toml",
        "--animate",
        "four_bar.mp4",
    ])
    .code(2);
}

#[test]
fn the_readme_shows_what_its_command_writes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("jansen_leg.svg");
    let drive = "crank_angle = -pi*t";
    let command = format!(
        "biela run mechanisms/jansen_leg.toml --drive '{drive}' --stop 2 --step 0.04 --animate "
    );
    for file in ["README.md", "Makefile"] {
        assert!(crate::common::text(file).contains(&command), "{file}");
    }
    let arguments = [
        "--drive",
        drive,
        "--stop",
        "2",
        "--step",
        "0.04",
        "--animate",
    ];
    let arguments = [&["run", "mechanisms/jansen_leg.toml"], &arguments[..]].concat();
    biela(&[&arguments[..], &[path.to_str().unwrap()]].concat()).success();
    let kept = crate::common::text("docs/jansen_leg.svg");
    assert!(
        std::fs::read_to_string(path).unwrap() == kept,
        "the picture of the readme has changed: run `make refresh` and look at docs/jansen_leg.svg"
    );
    assert!(kept.len() < 60_000, "{}", kept.len());
}

#[test]
fn plots_name_what_a_computed_measure_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("advantage.svg");
    let arguments = ["run", "mechanisms/toggle_press.toml", "--plot"];
    let more = ["--drive", "crank_angle = pi - t", "-v", "advantage"];
    biela(&[&arguments[..], &[path.to_str().unwrap()], &more].concat()).success();
    let svg = std::fs::read_to_string(path).unwrap();
    assert!(svg.contains(">value [1]<"));
}
