//! Drawings that a rounded length would bend or lock, beside their closed forms: what fits together on the
//! sheet fits together in the file, to rounding.

use serde_json::{Value, json};

use super::{EMPTY, Host, act, ask, state, studio};
use crate::page::{Outcome, Session};
use biela::mechanism::{DriverId, Source};

/// Largest error of a point \[m\] on drawings of half a metre: some hundred roundings, times the condition
/// of three cranks near the line of their pivots.
const AT_ROUNDING: f64 = 1e-12;

fn marker(path: &str) -> Value {
    json!({ "at": [0, 0], "marker": path })
}

fn ground([x, y]: [f64; 2]) -> Value {
    json!({ "at": [x, y], "ground": true })
}

fn link(host: &mut Host, points: &[Value]) -> Value {
    act(host, &json!({ "kind": "link", "points": points }))
}

fn drive(host: &mut Host, joint: &str) {
    let view = act(host, &json!({ "kind": "driver", "joint": joint }));
    assert_eq!(
        state(&view),
        "driven",
        "{}\n{}",
        view["status"],
        host.text()
    );
}

/// Opens what is drawn as a mechanism that moves.
fn opened(host: &Host) -> Session {
    let source = Source::new("a.toml", host.text());
    Session::open(source).unwrap_or_else(|error| panic!("{error:?}\n{}", host.text()))
}

/// Returns where a marker is drawn \[m\].
fn drawn_at(view: &Value, marker: &str) -> [f64; 2] {
    let points = view["sketch"]["points"].as_array().expect("points");
    let has = |point: &&Value| {
        let markers = point["markers"].as_array();
        markers.is_some_and(|markers| markers.contains(&json!(marker)))
    };
    let point = points.iter().find(has).expect("it is drawn");
    [0, 1].map(|k| point["at"][k].as_f64().expect("a number"))
}

const PIVOTS: [[f64; 2]; 3] = [[0.0, 0.0], [0.2, 0.07], [0.45, -0.03]];

/// Draws three parallel cranks, each by the way `by` from its pivot, and the plate that they carry.
fn parallel_cranks(by: [f64; 2]) -> Host {
    let mut host = studio(EMPTY);
    for pivot in PIVOTS {
        let end = [pivot[0] + by[0], pivot[1] + by[1]];
        link(&mut host, &[ground(pivot), json!({ "at": end })]);
    }
    link(&mut host, &["link.B", "link_2.D", "link_3.F"].map(marker));
    drive(&mut host, "A");
    host
}

/// Turns parallel cranks whose way from their pivots is `by` at the start; the plate moves without
/// turning, on a circle.
fn turns_without_turning(host: &Host, by: [f64; 2]) {
    let mut session = opened(host);
    let radius = f64::hypot(by[0], by[1]);
    let start = f64::atan2(by[1], by[0]);
    let plate = 3 * session
        .mechanism()
        .body_id("plate")
        .expect("it is drawn")
        .index();
    let before = session.pose().q[plate..plate + 3].to_vec();
    for step in 1..=24 {
        let angle = start + f64::from(step) * 0.25;
        assert_eq!(
            session.drive(DriverId(0), angle),
            Outcome::Reached,
            "{}",
            host.text()
        );
        let q = &session.pose().q[plate..plate + 3];
        let meant = [
            before[0] - by[0] + radius * angle.cos(),
            before[1] - by[1] + radius * angle.sin(),
        ];
        let off = f64::hypot(q[0] - meant[0], q[1] - meant[1]);
        assert!(off < AT_ROUNDING, "{off} at {angle}");
        assert!((q[2] - before[2]).abs() < AT_ROUNDING);
    }
}

#[test]
fn three_parallel_cranks_on_points_of_the_grid_turn() {
    for by in [
        [0.1, 0.05],
        [0.03, 0.11],
        [-0.07, 0.02],
        [0.13, 0.13],
        [0.0, 0.1],
    ] {
        turns_without_turning(&parallel_cranks(by), by);
    }
}

#[test]
fn what_is_dragged_together_stays_equal() {
    let mut host = parallel_cranks([0.1, 0.05]);
    let markers = ["plate.B", "plate.D", "plate.F"];
    for by in [[-0.03, 0.02], [0.0123, -0.0045]] {
        act(
            &mut host,
            &json!({ "kind": "shift", "markers": markers, "by": by }),
        );
    }
    turns_without_turning(&host, [0.0823, 0.0655]);
    // A crank at 15° has no end on the grid.
    let angle = 15.0_f64.to_radians();
    let by = [0.1 * angle.cos(), 0.1 * angle.sin()];
    let mut host = parallel_cranks(by);
    act(
        &mut host,
        &json!({ "kind": "shift", "markers": markers, "by": [0.05, 0.01] }),
    );
    turns_without_turning(&host, [by[0] + 0.05, by[1] + 0.01]);
}

#[test]
fn copies_of_parallel_cranks_turn() {
    let by = [0.1, 0.05];
    let mut host = parallel_cranks(by);
    let bodies = ["link", "link_2", "link_3", "plate"];
    let angle = 30.0_f64.to_radians();
    let over = json!({ "kind": "mirror", "bodies": bodies, "at": [0.6, 0.013], "angle": angle });
    act(&mut host, &over);
    let joints: Vec<String> = (opened(&host).mechanism().joints.iter())
        .map(|joint| joint.name.clone())
        .collect();
    // The joint of the first mirrored crank with ground.
    drive(&mut host, &joints[6]);
    let mut session = opened(&host);
    let start = session.pose().drivers[1];
    for step in 1..=24 {
        let angle = start + f64::from(step) * 0.25;
        assert_eq!(
            session.drive(DriverId(1), angle),
            Outcome::Reached,
            "{}",
            host.text()
        );
    }
}

#[test]
fn a_rod_at_right_angles_to_its_guide_closes() {
    for end in [
        [0.04, 0.03],
        [0.1, 0.05],
        [-0.03, 0.07],
        [0.11, 0.13],
        [0.02, 0.09],
        [0.07, 0.03],
        [0.05, 0.12],
        [-0.1, 0.04],
        [0.01, 0.06],
        [0.03, 0.11],
    ] {
        // A guide as it lies on the sheet, and one that is askew by 1 in 2.
        for [foot, angle] in [
            [[end[0], -0.02], [0.0, 0.0]],
            [[end[0] - 0.05, end[1] + 0.1], [f64::atan2(1.0, 2.0), 0.0]],
        ] {
            let mut host = studio(EMPTY);
            link(&mut host, &[ground([0.0, 0.0]), json!({ "at": end })]);
            link(&mut host, &[marker("link.B"), json!({ "at": foot })]);
            let slider =
                json!({ "kind": "slider", "target": marker("link_2.C"), "angle": angle[0] });
            let view = act(&mut host, &slider);
            assert_eq!(state(&view), "undriven", "{}", host.text());
            // The crank is at its dead point; the slide moves it.
            drive(&mut host, "guide");
            let view = act(&mut host, &json!({ "kind": "trace", "marker": "link.B" }));
            let [x, y] = drawn_at(&view, "link_2.C");
            let off = f64::hypot(x - foot[0], y - foot[1]);
            assert!(off < 1e-16, "{off}\n{}", host.text());
        }
    }
}

#[test]
fn points_are_where_they_were_clicked() {
    let mut host = studio(EMPTY);
    let clicks = [
        [0.0, 0.0],
        [0.1, 0.05],
        [0.23, 0.17],
        [0.3, 0.02],
        [0.41, 0.13],
    ];
    let mut view = link(&mut host, &[ground(clicks[0]), json!({ "at": clicks[1] })]);
    let paths = ["link.B", "link_2.C", "link_3.D", "link_4.E"];
    for (path, click) in paths.iter().zip(&clicks[2..]) {
        view = link(&mut host, &[marker(path), json!({ "at": click })]);
    }
    for (path, click) in paths.iter().zip(&clicks[1..]) {
        assert_eq!(
            drawn_at(&view, path).map(f64::to_bits),
            click.map(f64::to_bits),
            "{}",
            host.text()
        );
    }
    // A point at the level of another one has its coordinate, not the noise of a pose.
    let level = drawn_at(&view, "link_2.C")[1];
    link(
        &mut host,
        &[ground([0.6, level]), json!({ "at": [0.7, level] })],
    );
    assert!(host.text().contains("= [0.6, 0.17]"), "{}", host.text());
}

#[test]
fn wheels_on_points_of_the_grid_mesh_to_rounding() {
    let mut host = studio(EMPTY);
    let [a, b] = [[0.0, 0.0], [0.1, 0.05]];
    let gear = json!({
        "kind": "wheels", "type": "gear", "points": [ground(a), ground(b)], "contact": [0.06, 0.03],
    });
    act(&mut host, &gear);
    let rack = json!({ "kind": "rack", "point": ground([0.3, 0.1]), "contact": [0.33, 0.04] });
    act(&mut host, &rack);
    opened(&host);
    let file: toml_edit::DocumentMut = host.text().parse().expect("it is TOML");
    let number = |item: &toml_edit::Item| item.as_float().expect("a number");
    let radii = &file["joints"]["gear"]["radii"];
    let sum = [0, 1].map(|k| radii[k].as_float().expect("a radius"));
    assert!(
        (sum[0] + sum[1] - f64::hypot(0.1, 0.05)).abs() < 1e-16,
        "{sum:?}"
    );
    let radius = number(&file["joints"]["mesh"]["radius"]);
    assert!((radius - f64::hypot(0.03, 0.06)).abs() < 1e-16, "{radius}");
}

#[test]
fn a_length_that_was_rounded_is_offered_as_it_fits() {
    let mut host = studio(EMPTY);
    for x in [0.0, 0.2, 0.4] {
        link(
            &mut host,
            &[ground([x, 0.0]), json!({ "at": [x + 0.08, 0.06] })],
        );
    }
    link(&mut host, &["link.B", "link_2.D", "link_3.F"].map(marker));
    drive(&mut host, "A");
    // The last digit of one of three equal cranks, as rounding leaves it.
    let worn = host.text().replace("F = [0.1, 0]", "F = [0.10001, 0]");
    let view = ask(&mut host, &json!({ "do": "type", "text": worn }));
    assert_eq!(state(&view), "open", "{}", view["status"]);
    let form = ask(&mut host, &json!({ "do": "inspect", "names": [] }));
    let action = &form["actions"][0];
    assert_eq!(action["label"], "Let it fit: link_3.E to link_3.F, 100 mm");
    let view = act(&mut host, &action["gesture"]);
    assert_eq!(state(&view), "driven", "{}", view["status"]);
    assert!(host.text().contains("F = [0.1, 0]"), "{}", host.text());
    let form = ask(&mut host, &json!({ "do": "inspect", "names": [] }));
    assert_eq!(form["actions"], json!([]));
}
