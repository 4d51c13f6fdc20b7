//! Poses, dimensions, instant centres and contacts on demand.

use biela_tools::drawing::{Diagram, svg};

use crate::common::mechanisms::crank;
use crate::common::{assembled, parse, shipped, stems};
use crate::drawing::pictures::{Label, WIDTH, check_apart, check_picture};

fn draw(name: &str, diagram: &Diagram) -> String {
    let (mut solver, _) = assembled(&shipped(name));
    let home = solver.pose().clone();
    let sheet = diagram.sheet(&mut solver).expect("it can be drawn");
    assert_eq!(*solver.pose(), home, "the solver is back where it was");
    svg::write(&sheet, WIDTH, false)
}

/// Returns the number of paths in a group of a picture.
fn paths(picture: &str, class: &str) -> usize {
    let group = picture.split(&format!("<g class=\"{class}\"")).nth(1);
    let group = group.map(|rest| rest.split("</g>").next().expect("it is closed"));
    group.map_or(0, |group| group.matches("<path").count())
}

fn has(labels: &[Label], text: &str) -> bool {
    labels.iter().any(|label| label.text == text)
}

#[test]
fn a_picture_has_as_many_faint_poses_as_asked_for() {
    let with_poses = |poses| Diagram {
        poses,
        ..Diagram::default()
    };
    // Each of the three bars of a four-bar, at each pose.
    let picture = draw("four_bar", &with_poses(8));
    assert_eq!(paths(&picture, "poses"), 3 * 8);
    assert_eq!(paths(&picture, "traces"), 1);
    assert_eq!(
        paths(&picture, "ground"),
        paths(&draw("four_bar", &with_poses(0)), "ground")
    );
    check_apart("four_bar", &check_picture("four_bar", &picture));
    assert_eq!(
        draw("four_bar", &with_poses(0)),
        draw("four_bar", &Diagram::default())
    );
}

#[test]
fn each_mechanism_moves_in_its_picture() {
    let diagram = Diagram {
        traces: false,
        poses: 3,
        instant_centres: true,
        ..Diagram::default()
    };
    for name in stems("mechanisms", "toml") {
        let picture = draw(&name, &diagram);
        check_picture(&name, &picture);
        // One of the three may be the pose that is drawn.
        assert!(paths(&picture, "poses") >= 2, "{name}");
    }
}

#[test]
fn dimensions_tell_the_lengths_of_the_file_and_keep_apart() {
    let diagram = Diagram {
        traces: false,
        dimensions: true,
        ..Diagram::default()
    };
    let labels = check_picture("four_bar", &draw("four_bar", &diagram));
    // The parameters of the file; the coupler's point is at half its length, 50 mm aside.
    let aside = format!("{:.2}", 125.0_f64.hypot(50.0));
    for text in [
        "100",
        "250",
        "300",
        "400",
        &aside,
        "lengths in mm",
        "O2",
        "A",
        "B",
        "O4",
        "P",
    ] {
        assert!(has(&labels, text), "{text}");
    }
    for name in stems("mechanisms", "toml") {
        let labels = check_picture(&name, &draw(&name, &diagram));
        check_apart(&name, &labels);
    }
    // The offset of a guide from the crank's pivot; a guide through the pivot has none.
    for (name, text, is_told) in [
        ("slider_crank", "10", true),
        ("engine", "0", false),
        ("slotted_lever", "0", false),
    ] {
        let labels = check_picture(name, &draw(name, &diagram));
        assert_eq!(has(&labels, text), is_told, "{name}");
    }
    // Long names of joints give way to letters, with a key; P and Q are points of interest.
    let labels = check_picture("excavator_arm", &draw("excavator_arm", &diagram));
    for text in ["A", "B", "lengths in m"] {
        assert!(has(&labels, text), "{text}");
    }
    assert!(
        labels
            .iter()
            .any(|label| label.text.starts_with("A: boom_foot; B: stick_pin"))
    );
}

#[test]
fn instant_centres_far_away_are_told_in_words() {
    let diagram = Diagram {
        instant_centres: true,
        ..Diagram::default()
    };
    let labels = |name: &str| check_picture(name, &draw(name, &diagram));
    let slider_crank = labels("slider_crank");
    for text in [
        "I crank",
        "I connecting_rod",
        "instant centre at infinity (translation): slider",
    ] {
        assert!(has(&slider_crank, text), "{text}");
    }
    let robot = labels("five_bar_robot");
    for text in [
        "instant centres while left_angle moves alone",
        "at rest: right_arm",
    ] {
        assert!(has(&robot, text), "{text}");
    }
    // The bar of a parallelogram translates until its cranks differ a little: its centre is then
    // where the lines of the cranks meet, far outside the picture.
    let text = "format = 1\nname = 'nearly'\n[ground.markers]\nA = [0, 0]\nD = [0.2, 0]\n\
        [bodies.a]\nmarkers = { O = [0, 0], P = [0.1, 0] }\nestimate = [0, 0, 1]\n\
        [bodies.b]\nmarkers = { O = [0, 0], P = [0.1001, 0] }\nestimate = [0.2, 0, 1]\n\
        [bodies.bar]\nmarkers = { P = [0, 0], Q = [0.2, 0] }\nestimate = [0.05, 0.08, 0]\n\
        [joints]\nA = { type = 'revolute', markers = ['ground.A', 'a.O'] }\n\
        D = { type = 'revolute', markers = ['ground.D', 'b.O'] }\n\
        B = { type = 'revolute', markers = ['a.P', 'bar.P'] }\n\
        C = { type = 'revolute', markers = ['b.P', 'bar.Q'] }\n\
        [drivers]\nturn = { coordinate = 'angle', markers = ['ground.A', 'a.O'], start = 1 }\n";
    let (mut solver, _) = assembled(&parse(text));
    let sheet = diagram.sheet(&mut solver).expect("it moves");
    let labels = check_picture("nearly", &svg::write(&sheet, WIDTH, false));
    let told = |label: &Label| {
        label
            .text
            .starts_with("instant centre of bar outside the picture, at (")
    };
    assert!(labels.iter().any(told));
}

// The mechanism names no unit: lengths are in metres, and so is the scale, which is in millimetres
// without them.
#[test]
fn the_scale_has_the_unit_of_the_dimensions() {
    let text = crank("start = 0.3") + "outputs.markers = ['crank.A']\n";
    let texts = |dimensions: bool| {
        let diagram = Diagram {
            dimensions,
            ..Diagram::default()
        };
        let (mut solver, _) = assembled(&parse(&text));
        svg::write(
            &diagram.sheet(&mut solver).expect("it is drawn"),
            640,
            false,
        )
    };
    let with = texts(true);
    assert!(
        with.contains(">lengths in m<") && with.contains(">0.2 m<"),
        "{with}"
    );
    assert!(texts(false).contains(">200 mm<"));
}

/// A disc rests on a floor, a metre aside another one is 50 mm above it.
#[test]
fn contacts_are_dots_where_they_touch_and_lines_across_their_gaps() {
    let text = "format = 1\nname = 'discs'\n\
        [parameters]\ngap = { value = 0.05, unit = 'm', display = 'mm' }\n\
        [ground.markers]\nO = [0, 0, '90*deg']\nP = [1, 0, '90*deg']\nL = [-1, 0]\nR = [2, 0]\n\
        [ground.shapes]\nfloor = { wall = ['R', 'L'], depth = 0.1 }\n\
        [bodies.low]\nmarkers = { C = [0, 0] }\nshapes.rim = { disc = 'C', radius = 0.2 }\n\
        [bodies.high]\nmarkers = { C = [0, 0] }\nshapes.rim = { disc = 'C', radius = 0.2 }\n\
        [joints]\na = { type = 'translational', markers = ['ground.O', 'low.C'] }\n\
        b = { type = 'translational', markers = ['ground.P', 'high.C'] }\n\
        [drivers]\nc = { coordinate = 'x', markers = ['ground.O', 'low.C'], start = 0.2 }\n\
        d = { coordinate = 'x', markers = ['ground.P', 'high.C'], start = '0.2 + gap' }\n\
        [contacts]\nrests = { shapes = ['low.rim', 'ground.floor'] }\n\
        falls = { shapes = ['ground.floor', 'high.rim'] }\n";
    let draw = |contacts: bool| {
        let diagram = Diagram {
            contacts,
            ..Diagram::default()
        };
        let (mut solver, _) = assembled(&parse(text));
        let sheet = diagram.sheet(&mut solver).expect("it can be drawn");
        svg::write(&sheet, WIDTH, false)
    };
    let picture = draw(true);
    let labels = check_picture("discs", &picture);
    assert!(has(&labels, "rests 0 mm") && has(&labels, "falls 50 mm"));
    let group = picture.split("<g class=\"points\"").nth(1);
    let group = group.and_then(|rest| rest.split("</g>").next());
    let marks: Vec<Vec<f64>> = (group.expect("there are contacts").split(" d=\"").skip(1))
        .map(|mark| {
            let data = mark.split('"').next().expect("it is closed");
            let numbers = data.split(|c: char| c.is_ascii_alphabetic() || c == ' ');
            let numbers = numbers.filter(|number| !number.is_empty());
            numbers.map(|n| n.parse().expect("a number")).collect()
        })
        .collect();
    let [dot, line] = marks.as_slice() else {
        panic!("{picture}");
    };
    let [x, foot, other_x, top] = line[..] else {
        panic!("{line:?}");
    };
    // Places are written in hundredths of a pixel; the dot begins at its right, 3 pixels from its centre.
    let metre = x - (dot[0] - 3.0);
    assert!((foot - dot[1]).abs() < 0.02 && (other_x - x).abs() < 0.02);
    assert!((foot - top - 0.05 * metre).abs() < 0.02, "{dot:?} {line:?}");
    assert!(!draw(false).contains("class=\"points\""));
}
