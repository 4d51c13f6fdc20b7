//! Mechanisms that go out to other programs and come back.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::mechanism::Mechanism;
use biela_tools::exchange::{
    AssemblyFile, Format, Pins, linkage_document, pmks_link, pylinkage_json,
};

use crate::common::{assembled, parse, shipped, straight_to};

/// Returns a mechanism that went out and came back.
fn back(mechanism: &Arc<Mechanism>, format: Format) -> Arc<Mechanism> {
    let (solver, _) = assembled(mechanism);
    let pins = || Pins::new(&solver).expect("it is a linkage");
    let text = match format {
        Format::Pmks => pmks_link(&pins()),
        Format::Linkage => linkage_document(&pins()),
        Format::Asmt => {
            AssemblyFile::new(&solver)
                .expect("it has these joints")
                .text
        }
        _ => pylinkage_json(&pins()),
    };
    let draft = format.read(text.as_bytes(), &mechanism.name, None);
    let draft = draft.unwrap_or_else(|error| panic!("{}: {error}", mechanism.name));
    parse(&draft.write("it"))
}

/// Returns the pins' places at each of some angles of the crank, by their names.
fn motion(mechanism: &Arc<Mechanism>, names: &[&str]) -> Vec<Vec<[f64; 2]>> {
    let (mut solver, mut path) = assembled(mechanism);
    let start = solver.pose().drivers[0];
    let parameters = mechanism.default_parameters();
    let mut places = Vec::new();
    for step in 0..24 {
        straight_to(&solver, &mut path, start + f64::from(step) / 24.0 * TAU);
        solver.track(&path).expect("it turns");
        let places_now = names.iter().map(|name| {
            let is =
                |marker: &&biela::mechanism::Marker| marker.name == *name && marker.body.is_some();
            let marker = mechanism.markers.iter().find(is);
            let marker = marker.unwrap_or_else(|| panic!("no {name}"));
            let [x, y] = marker
                .position
                .each_ref()
                .map(|e| e.evaluate(&|p| parameters[p.index()], 0.0_f64));
            let q = &solver.pose().q[3 * marker.body.expect("it moves").index()..];
            let (sin, cos) = q[2].sin_cos();
            [q[0] + cos * x - sin * y, q[1] + sin * x + cos * y]
        });
        places.push(places_now.collect());
    }
    places
}

#[test]
fn linkages_move_alike_after_they_came_back() {
    // Names of points that have one name on all bodies there and back.
    for (name, points) in [
        ("four_bar", &["A", "B", "P"][..]),
        ("slider_crank", &["A", "B"]),
        ("drag_link", &["A", "B"]),
    ] {
        let mechanism = shipped(name);
        let original = motion(&mechanism, points);
        // An assembly keeps an input at its start, as the straight way that is asked for here does.
        for (format, resolution) in [
            (Format::Pmks, 5e-6),
            (Format::Pylinkage, 1e-12),
            (Format::Linkage, 1e-9),
        ] {
            let again = motion(&back(&mechanism, format), points);
            for (there, here) in original.iter().flatten().zip(again.iter().flatten()) {
                let off = (there[0] - here[0]).hypot(there[1] - here[1]);
                // Rounded places move others by at most the ratio of the arms, below 10.
                assert!(off < 20.0 * resolution, "{name}, {format:?}: {off} m");
            }
        }
    }
}

#[test]
fn other_joints_are_refused_by_their_names() {
    for (name, joint) in [
        ("cam_knife", "contact"),
        ("planetary_gear", "inner"),
        ("slotted_lever", "`A`"),
    ] {
        let (solver, _) = assembled(&shipped(name));
        let error = Pins::new(&solver)
            .expect_err("it is no linkage")
            .to_string();
        assert!(error.contains(joint), "{error}");
    }
}

#[test]
fn a_link_is_short_and_its_sense_that_of_the_motion() {
    let text = include_str!("../../../../mechanisms/four_bar.toml");
    let turned = text.replace("start = \"60*deg\"", "motion = \"60*deg - 30*rpm*t\"");
    let (solver, _) = assembled(&parse(&turned));
    let link = pmks_link(&Pins::new(&solver).expect("it is a linkage"));
    assert!(link.len() < 300, "{link}");
    let draft = Format::Pmks
        .read(link.as_bytes(), "it", None)
        .expect("it is a link");
    assert!(draft.write("it").contains("value = \"-30*rpm\""));
}

/// A body with one pin, and several drivers with speeds of their own, in each format that has these.
#[test]
fn levers_and_all_speeds_come_back() {
    let text = "format = 1\nname = \"two\"\n[ground.markers]\nO = [0, 0]\nQ = [0.3, 0]\n\
        [bodies.lever]\nmarkers = { O = [0, 0], tip = [0.1, 0] }\nestimate = [0, 0, 0.5]\n\
        [bodies.crank]\nmarkers = { Q = [0, 0], A = [0.05, 0] }\nestimate = [0.3, 0, 1]\n\
        [joints]\nO = { type = \"revolute\", markers = [\"ground.O\", \"lever.O\"] }\n\
        Q = { type = \"revolute\", markers = [\"ground.Q\", \"crank.Q\"] }\n[drivers]\n\
        first = { coordinate = \"angle\", markers = [\"ground.O\", \"lever.O\"], motion = \"0.5 - 12.5*rpm*t\" }\n\
        second = { coordinate = \"angle\", markers = [\"ground.Q\", \"crank.Q\"], motion = \"1 + 40*rpm*t\" }\n";
    for format in [Format::Pmks, Format::Linkage, Format::Asmt] {
        let again = back(&parse(text), format);
        assert_eq!(again.bodies.len(), 2, "{format:?}");
        let (solver, _) = assembled(&again);
        let speed = |name: &str| {
            let is = |driver: &biela::mechanism::Driver| {
                let body = again.markers[driver.coordinate.to.index()].body;
                body.is_some_and(|body| again.bodies[body.index()].name == name)
            };
            let driver = again.drivers.iter().position(is).expect("it is driven");
            solver
                .motion(biela::mechanism::DriverId(driver), 0.0)
                .first()
                * 30.0
                / std::f64::consts::PI
        };
        // Speeds are written to a thousandth of a turn per minute.
        assert!(
            (speed("lever") + 12.5).abs() < 1e-3,
            "{format:?}: {}",
            speed("lever")
        );
        assert!(
            (speed("crank") - 40.0).abs() < 1e-3,
            "{format:?}: {}",
            speed("crank")
        );
    }
}

/// Mechanisms with slots, slides, gears, belts and racks have their own motion after they came back
/// from an assembly.
#[test]
fn assemblies_keep_motions_over_time() {
    for (name, driver, rate) in [
        ("four_bar", "crank_angle", 1.0),
        ("slider_crank", "crank_angle", 1.0),
        ("slotted_lever", "crank_angle", 1.0),
        ("drag_link", "crank_angle", 1.0),
    ] {
        let path = crate::common::folder("mechanisms").join(format!("{name}.toml"));
        let text = std::fs::read_to_string(path).expect("it is shipped");
        let line = text
            .lines()
            .find(|line| line.trim_start().starts_with(driver));
        let line = line.unwrap_or_else(|| panic!("{name} has no {driver}"));
        let start = line.find("start = ").expect("it is an input") + 8;
        let end = start + line[start..].find([',', '}']).expect("it ends");
        let value = line[start..end].trim().trim_matches('"');
        let motion = format!("motion = \"{value} + {rate}*t\" ");
        let driven = line.replace(&line[start - 8..end], &motion);
        let mechanism = parse(&text.replace(line, &driven));
        let again = back(&mechanism, Format::Asmt);
        let [there, here] = [&mechanism, &again].map(|mechanism| {
            let (mut solver, mut path) = assembled(mechanism);
            let mut poses = Vec::new();
            for step in 1..=10 {
                path.start = solver.pose().time;
                path.duration = 0.1 * f64::from(step) - path.start;
                solver
                    .track(&path)
                    .unwrap_or_else(|error| panic!("{name}: {error:?}"));
                for body in &mechanism.bodies {
                    let index = mechanism
                        .bodies
                        .iter()
                        .position(|other| other.name == body.name);
                    let q = &solver.pose().q[3 * index.expect("it is one of them")..][..3];
                    poses.push((body.name.clone(), [q[0], q[1]]));
                }
            }
            poses
        });
        // Frames are written with twelve digits of the size, below 1 m.
        for ((body, a), (_, b)) in there.iter().zip(&here) {
            let off = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(off < 1e-10, "{name}, {body}: {off} m");
        }
    }
}

/// Pins take no freedom for an input, and tell of a motion that is not uniform.
#[test]
fn freedoms_and_uneven_motions_are_told() {
    let lever = |moved: &str| {
        parse(&format!(
            r#"
format = 1
name = "lever"
[ground.markers]
O = [0, 0]
[bodies.arm]
mass = 1
inertia = 0.1
markers = {{ O = [0, 0], P = [0.3, 0] }}
[joints]
O = {{ type = "revolute", markers = ["ground.O", "arm.O"] }}
{moved}
"#
        ))
    };
    let angle = r#"coordinate = "angle", markers = ["ground.O", "arm.O"]"#;
    for (moved, inputs, told) in [
        (
            format!("[freedoms]\nswing = {{ {angle}, start = 0.3 }}"),
            0,
            "freedom `swing`",
        ),
        (
            format!("[drivers]\nswing = {{ {angle}, motion = \"0.3*sin(t)\" }}"),
            1,
            "the course of driver `swing`",
        ),
        (
            format!("[drivers]\nswing = {{ {angle}, motion = \"3*t\" }}"),
            1,
            "",
        ),
    ] {
        let (solver, _) = assembled(&lever(&moved));
        let pins = Pins::new(&solver).expect("it is a linkage");
        let document = linkage_document(&pins);
        assert_eq!(
            document.matches("input=\"true\"").count(),
            inputs,
            "{document}"
        );
        let notes: Vec<String> = pins.notes.iter().map(ToString::to_string).collect();
        let has_told = notes.iter().any(|note| note.contains(told));
        assert!(has_told || told.is_empty(), "{notes:?}");
        let is_uneven = notes.iter().any(|note| note.contains("the course of"));
        assert_eq!(is_uneven, told.contains("course"), "{notes:?}");
    }
}
