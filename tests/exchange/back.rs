//! Mechanisms that go out as links of PMKS+ or JSON of pylinkage and come back.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::exchange::{Format, Pins, pmks_link, pylinkage_json};
use biela::mechanism::Mechanism;

use crate::common::{assembled, parse, shipped, straight_to};

/// Returns a mechanism that went out and came back.
fn back(mechanism: &Arc<Mechanism>, format: Format) -> Arc<Mechanism> {
    let (solver, _) = assembled(mechanism);
    let pins = Pins::new(&solver).expect("it is a linkage");
    let text = match format {
        Format::Pmks => pmks_link(&pins),
        _ => pylinkage_json(&pins),
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
        for (format, resolution) in [(Format::Pmks, 5e-6), (Format::Pylinkage, 1e-12)] {
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
    let text = include_str!("../../mechanisms/four_bar.toml");
    let turned = text.replace("start = \"60*deg\"", "motion = \"60*deg - 30*rpm*t\"");
    let (solver, _) = assembled(&parse(&turned));
    let link = pmks_link(&Pins::new(&solver).expect("it is a linkage"));
    assert!(link.len() < 300, "{link}");
    let draft = Format::Pmks
        .read(link.as_bytes(), "it", None)
        .expect("it is a link");
    assert!(draft.write("it").contains("value = \"-30*rpm\""));
}
