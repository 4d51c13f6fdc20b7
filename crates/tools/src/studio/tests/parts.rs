//! Wheels, racks, cams, springs, loads, masses and stops.

use serde_json::{Value, json};

use super::super::host::Host;
use super::{EMPTY, act, refusal, shipped_studio, state, studio};

fn ground(x: f64, y: f64) -> Value {
    json!({ "at": [x, y], "ground": true })
}

fn marker(path: &str) -> Value {
    json!({ "at": [0, 0], "marker": path })
}

/// Returns the angle of a body \[rad\].
fn angle(view: &Value, body: &str) -> f64 {
    let bodies = view["sketch"]["bodies"]
        .as_array()
        .expect("there are bodies");
    let body = bodies
        .iter()
        .find(|found| found["name"] == body)
        .expect("it is drawn");
    body["frame"][2].as_f64().expect("an angle")
}

/// Drives a joint and turns it; returns the view.
fn turned(host: &mut Host, joint: &str, driver: &str, by: &str) -> Value {
    act(host, &json!({ "kind": "driver", "joint": joint }));
    let path = ["drivers", driver, "start"];
    act(host, &json!({ "kind": "put", "path": path, "value": by }))
}

#[test]
fn a_train_of_three_wheels_turns_by_its_radii() {
    let mut host = studio(EMPTY);
    let pair = json!({
        "kind": "wheels", "type": "gear",
        "points": [ground(0.0, 0.0), ground(0.3, 0.0)], "contact": [0.1, 0.02],
    });
    assert_eq!(state(&act(&mut host, &pair)), "undriven");
    let next = json!({
        "kind": "wheels", "type": "gear",
        "points": [marker("wheel_2.B"), ground(0.3, 0.5)], "contact": [0.31, 0.2],
    });
    act(&mut host, &next);
    let view = turned(&mut host, "A", "wheel_angle", "20*deg");
    assert_eq!(state(&view), "driven");
    insta::assert_snapshot!(host.text());
    assert!((angle(&view, "wheel_2").to_degrees() + 10.0).abs() < 1e-9);
    assert!((angle(&view, "wheel_3").to_degrees() - 20.0 / 3.0).abs() < 1e-9);
}

#[test]
fn wheels_on_one_bar_are_carried_by_it() {
    let mut host = studio(EMPTY);
    let link = json!({ "kind": "link", "points": [ground(0.0, 0.0), { "at": [0.24, 0.1] }] });
    act(&mut host, &link);
    let pair = json!({
        "kind": "wheels", "type": "internal",
        "points": [marker("link.A"), marker("link.B")], "contact": [0.36, 0.15],
    });
    let view = act(&mut host, &pair);
    assert_eq!(state(&view), "undriven");
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_belt_runs_over_wheels_with_radii() {
    let mut host = studio(EMPTY);
    let pair = json!({
        "kind": "wheels", "type": "crossed",
        "points": [ground(0.0, 0.0), ground(0.3, 0.1)], "radii": [0.05, 0.1],
    });
    act(&mut host, &pair);
    let view = turned(&mut host, "A", "wheel_angle", "20*deg");
    assert_eq!(state(&view), "driven");
    assert!((angle(&view, "wheel_2").to_degrees() + 10.0).abs() < 1e-9);
    insta::assert_snapshot!(host.text());
}

#[test]
fn wheels_that_cannot_mesh_are_refused() {
    let mut host = studio(EMPTY);
    let link = |x: f64| json!({ "kind": "link", "points": [ground(x, 0.0), { "at": [x, 0.2] }] });
    act(&mut host, &link(0.0));
    act(&mut host, &link(0.5));
    let mut why = |kind: &str, points: [Value; 2], contact: Value, radii: Value| {
        let gesture = json!({
            "kind": "wheels", "type": kind, "points": points, "contact": contact, "radii": radii,
        });
        refusal(&mut host, &gesture)
    };
    let apart = || [ground(0.0, 1.0), ground(0.4, 1.0)];
    let none = || Value::Null;
    let reasons = [
        why("gear", apart(), json!([0.5, 1.0]), none()),
        why("internal", apart(), json!([0.2, 1.0]), none()),
        why(
            "gear",
            [ground(0.0, 1.0), ground(0.0, 1.0)],
            json!([0, 1]),
            none(),
        ),
        why(
            "gear",
            [marker("link.B"), marker("link_2.D")],
            json!([0.2, 0.2]),
            none(),
        ),
        why(
            "gear",
            [marker("link.B"), ground(0.2, 0.2)],
            json!([0.1, 0.2]),
            none(),
        ),
        why("gear", apart(), none(), none()),
        why("belt", apart(), none(), json!([0.5, 0.05])),
        why("belt", apart(), none(), json!([0.0, 0.05])),
        why("crossed", apart(), none(), json!([0.3, 0.2])),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn a_rack_moves_as_its_pinion_rolls() {
    let contacts = [[0.1, -0.03], [0.1, 0.03], [0.13, 0.04]];
    for (index, contact) in contacts.into_iter().enumerate() {
        let mut host = studio(EMPTY);
        let rack = json!({ "kind": "rack", "point": ground(0.1, 0.0), "contact": contact });
        assert_eq!(state(&act(&mut host, &rack)), "undriven");
        if index == 0 {
            insta::assert_snapshot!(host.text());
        }
        let view = turned(&mut host, "A", "pinion_angle", "60*deg");
        assert_eq!(state(&view), "driven");
        // The pinion's rim moves the rack along.
        let bodies = view["sketch"]["bodies"]
            .as_array()
            .expect("there are bodies");
        let frame = &bodies[1]["frame"];
        let [x, y] = [0, 1].map(|k| frame[k].as_f64().expect("a number"));
        let [u, v] = [contact[0] - 0.1, contact[1]];
        let turn = 60.0_f64.to_radians();
        let moved = [contact[0] - v * turn, contact[1] + u * turn];
        assert!(
            f64::hypot(x - moved[0], y - moved[1]) < 2e-5,
            "{contact:?}: {x} {y}, {moved:?}"
        );
    }
}

#[test]
fn a_cam_lifts_its_follower_by_a_third() {
    for (kind, reach) in [("knife", 0.03), ("roller", 0.04), ("flat", 0.03)] {
        let mut host = studio(EMPTY);
        let cam = json!({
            "kind": "cam", "point": ground(0.05, 0.02), "contact": [0.05, 0.05], "follower": kind,
        });
        let view = act(&mut host, &cam);
        assert_eq!(state(&view), "undriven", "{}", view["status"]);
        insta::assert_snapshot!(format!("cam_{kind}"), host.text());
        let height = |view: &Value| {
            let bodies = view["sketch"]["bodies"]
                .as_array()
                .expect("there are bodies");
            bodies[1]["frame"][1].as_f64().expect("a number") - 0.02
        };
        assert!((height(&view) - reach).abs() < 1e-9, "{kind}");
        let view = turned(&mut host, "A", "cam_angle", "-90*deg");
        assert_eq!(state(&view), "driven");
        assert!(
            (height(&view) - reach - 0.01).abs() < 1e-6,
            "{kind} {}",
            height(&view)
        );
    }
}

#[test]
fn a_cam_needs_ground_and_a_radius() {
    let mut host = studio(EMPTY);
    let link = json!({ "kind": "link", "points": [ground(0.0, 0.0), { "at": [0.2, 0.0] }] });
    act(&mut host, &link);
    let mut why = |point: Value, contact: [f64; 2], follower: &str| {
        let gesture =
            json!({ "kind": "cam", "point": point, "contact": contact, "follower": follower });
        refusal(&mut host, &gesture)
    };
    let reasons = [
        why(marker("link.B"), [0.2, 0.1], "knife"),
        why(ground(0.5, 0.0), [0.5, 0.0], "knife"),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn a_free_bar_has_mass_spring_damper_load_and_stop() {
    let mut host = studio(EMPTY);
    let link = json!({ "kind": "link", "points": [ground(0.0, 0.0), { "at": [0.3, 0.0] }] });
    act(&mut host, &link);
    act(
        &mut host,
        &json!({ "kind": "mass", "body": "link", "mass": 2.5 }),
    );
    act(&mut host, &json!({ "kind": "freedom", "joint": "A" }));
    let ends = json!([{ "at": [0.2, 0.2], "ground": true }, { "at": [0.2, 0.0], "body": "link" }]);
    act(&mut host, &json!({ "kind": "spring", "points": ends }));
    let ends = json!([marker("ground.C"), marker("link.B")]);
    act(&mut host, &json!({ "kind": "damper", "points": ends }));
    act(&mut host, &json!({ "kind": "load", "marker": "link.B" }));
    let view = act(&mut host, &json!({ "kind": "stop", "joint": "A" }));
    assert_eq!(state(&view), "free");
    insta::assert_snapshot!(host.text());
}

#[test]
fn stops_are_around_the_value_of_today() {
    let mut host = shipped_studio("excavator_arm.toml");
    act(
        &mut host,
        &json!({ "kind": "stop", "driver": "boom_cylinder" }),
    );
    act(
        &mut host,
        &json!({ "kind": "stop", "driver": "stick_angle", "max": 0.0 }),
    );
    let view = act(&mut host, &json!({ "kind": "stop", "joint": "boom_foot" }));
    assert_eq!(state(&view), "driven");
    let lines = host.text().lines().filter(|line| line.contains("_stop "));
    insta::assert_snapshot!(lines.collect::<Vec<_>>().join("\n"));
    let beyond = json!({ "kind": "stop", "driver": "boom_cylinder", "min": 2.5 });
    let around = "it is at 2.3 m now: choose limits on both sides of that";
    assert_eq!(refusal(&mut host, &beyond), around);
    let rod = json!({ "kind": "stop", "joint": "rod" });
    let no_coordinate = "joint `rod` has no coordinate of its own to be limited: choose a pin or a \
                         slide";
    assert_eq!(refusal(&mut host, &rod), no_coordinate);
}

#[test]
fn forces_and_masses_that_make_no_sense_are_refused() {
    let mut host = shipped_studio("excavator_arm.toml");
    let mut why = |gesture: Value| refusal(&mut host, &gesture);
    let reasons = [
        why(json!({ "kind": "load", "marker": "ground.boom_foot" })),
        why(json!({ "kind": "mass", "body": "boom" })),
        why(json!({ "kind": "mass", "body": "boom", "mass": -1 })),
        why(json!({ "kind": "spring", "points": [marker("boom.foot"), marker("boom.tip")] })),
        why(json!({ "kind": "damper", "points": [marker("boom.tip"), marker("stick.pin")] })),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn a_geared_five_bar_is_drawn_with_wheels_fixed_to_its_cranks() {
    let mut host = studio(EMPTY);
    let link = |points: [Value; 2]| json!({ "kind": "link", "points": points });
    act(
        &mut host,
        &link([ground(0.0, 0.0), json!({ "at": [0.02, 0.06] })]),
    );
    act(
        &mut host,
        &link([ground(0.2, 0.0), json!({ "at": [0.17, 0.05] })]),
    );
    act(
        &mut host,
        &link([marker("link.B"), json!({ "at": [0.1, 0.2] })]),
    );
    act(&mut host, &link([marker("link_2.D"), marker("link_3.E")]));
    let gears = json!({
        "kind": "wheels", "type": "gear", "points": [marker("link.A"), marker("link_2.C")],
        "fixed": [true, true], "contact": [0.1, 0.0],
    });
    act(&mut host, &gears);
    let view = act(&mut host, &json!({ "kind": "driver", "joint": "A" }));
    assert_eq!(state(&view), "driven", "{}", host.text());
    assert!(
        host.text()
            .contains("markers = [\"link.A\", \"link_2.C\"], radii = [0.1, 0.1]"),
        "{}",
        host.text()
    );
    // A link from the face of a wheel is pinned there.
    let face = json!({ "at": [0.05, 0.0], "body": "link" });
    act(&mut host, &link([face, json!({ "at": [0.05, -0.1] })]));
    assert!(
        host.text().contains("B = [0.06324555320336758, 0], "),
        "{}",
        host.text()
    );
}

#[test]
fn a_roller_on_a_lever_follows_a_cam() {
    let mut host = studio(EMPTY);
    let points = json!([{ "at": [0.0, 0.1], "ground": true }, { "at": [0.1, 0.1] }]);
    act(&mut host, &json!({ "kind": "link", "points": points }));
    let cam = |of: &str| {
        json!({
            "kind": "cam", "point": { "at": [0.1, 0.02], "ground": true }, "contact": [0.1, 0.1], "of": of,
        })
    };
    let why =
        "`ground.A` is on ground, as the centre of the cam is: choose a point that moves past it";
    assert_eq!(refusal(&mut host, &cam("ground.A")), why);
    act(&mut host, &cam("link.B"));
    let view = act(&mut host, &json!({ "kind": "driver", "joint": "C" }));
    assert_eq!(state(&view), "driven", "{}", host.text());
    assert!(
        host.text()
            .contains("follower = \"roller\"\nradius = 0.02\nprofile = \"0.06 + 0.01*"),
        "{}",
        host.text()
    );
}

/// Draws two links in line, the first one on ground.
fn two_links() -> Host {
    let mut host = studio(EMPTY);
    let first = json!({ "kind": "link", "points": [ground(0.0, 0.0), { "at": [0.2, 0.0] }] });
    act(&mut host, &first);
    let second = json!({ "kind": "link", "points": [marker("link.B"), { "at": [0.25, 0.15] }] });
    act(&mut host, &second);
    host
}

#[test]
fn a_weld_keeps_the_angle_that_is_drawn() {
    let mut host = two_links();
    let view = act(&mut host, &json!({ "kind": "weld", "joint": "B" }));
    let drawn = f64::atan2(0.15, 0.05);
    assert!((angle(&view, "link_2") - drawn).abs() < 1e-12);
    let view = turned(&mut host, "A", "link_angle", "30*deg");
    assert!((angle(&view, "link_2") - drawn - 30.0_f64.to_radians()).abs() < 1e-12);
    let why = refusal(&mut host, &json!({ "kind": "weld", "joint": "A" }));
    assert!(
        why.contains("the driver `link_angle` moves this pin"),
        "{why}"
    );
    let to_ground = json!({ "kind": "weld_to_ground", "marker": "ground.A" });
    assert!(refusal(&mut host, &to_ground).contains("is a point of ground"));
    insta::assert_snapshot!(host.text());
}

#[test]
fn shapes_stand_behind_their_body_and_touch() {
    let mut host = two_links();
    let bar = json!({
        "kind": "shape", "shape": "bar", "points": [marker("link.A"), marker("link.B")],
        "rim": [0.1, 0.012],
    });
    act(&mut host, &bar);
    let disc = json!({
        "kind": "shape", "shape": "disc", "body": "ground", "points": [ground(0.0, 0.15)],
        "rim": [0.0, 0.17],
    });
    act(&mut host, &disc);
    let outline = json!({
        "kind": "shape", "shape": "outline", "body": "link_2",
        "points": [marker("link.B"), { "at": [0.3, 0.0] }, { "at": [0.25, 0.15] }],
    });
    act(&mut host, &outline);
    let points = json!([{ "at": [0.1, 0.01] }, { "at": [0.0, 0.16] }]);
    act(&mut host, &json!({ "kind": "contact", "points": points }));
    insta::assert_snapshot!(host.text());
    for (gesture, why) in [
        (
            json!({ "kind": "contact", "points": points }),
            "have a contact already",
        ),
        (
            json!({ "kind": "contact", "points": [{ "at": [0.1, 0.01] }, { "at": [0.5, 0.5] }] }),
            "there is no shape here",
        ),
        (
            json!({ "kind": "contact", "points": [{ "at": [0.1, 0.01] }, { "at": [0.1, 0.0] }] }),
            "two bodies",
        ),
        (
            json!({
                "kind": "shape", "shape": "bar", "points": [marker("link.A"), marker("link_2.C")],
                "rim": [0.1, 0.1],
            }),
            "on different ones",
        ),
        (
            json!({ "kind": "shape", "shape": "disc", "points": [marker("link.A")], "rim": [0, 0] }),
            "needs a radius",
        ),
        (
            json!({ "kind": "shape", "shape": "hole", "points": [{ "at": [0, 0] }], "rim": [1, 0] }),
            "part of a body",
        ),
    ] {
        let told = refusal(&mut host, &gesture);
        assert!(told.contains(why), "{told}");
    }
    // With its shape the contact goes.
    let view = act(
        &mut host,
        &json!({ "kind": "delete", "names": ["link.bar"] }),
    );
    assert!(
        !view["text"]
            .as_str()
            .is_some_and(|text| text.contains("contacts"))
    );
}

#[test]
fn ropes_tracks_couplings_and_friction_are_written_as_they_are_drawn() {
    let mut host = two_links();
    let curve =
        json!({ "kind": "curve", "marker": "link_2.C", "points": [[0.2, 0.2], [0.1, 0.2]] });
    act(&mut host, &curve);
    let third = json!({ "kind": "link", "points": [ground(0.5, 0.0), { "at": [0.5, 0.1] }] });
    act(&mut host, &third);
    let rope = json!({
        "kind": "rope", "points": [marker("link.B"), ground(0.3, 0.1), marker("link_3.E")],
    });
    act(&mut host, &rope);
    act(&mut host, &json!({ "kind": "friction", "joint": "A" }));
    let again = refusal(&mut host, &json!({ "kind": "friction", "joint": "A" }));
    assert!(again.contains("already"), "{again}");
    insta::assert_snapshot!(host.text());
    let mut host = two_links();
    act(
        &mut host,
        &json!({ "kind": "coupling", "joints": ["A", "B"] }),
    );
    insta::assert_snapshot!(host.text());
    let alone = refusal(
        &mut host,
        &json!({ "kind": "coupling", "joints": ["A", "A"] }),
    );
    assert!(alone.contains("two joints"), "{alone}");
}

#[test]
fn a_four_bar_is_of_the_type_that_grashof_says() {
    // Lengths of crank, coupler, rocker and base [m], with the type by the sums of two of them.
    for (lengths, kind) in [
        ([0.1, 0.25, 0.3, 0.4], "crank-rocker: `link` turns fully"),
        ([0.3, 0.25, 0.1, 0.4], "crank-rocker: `link_3` turns fully"),
        ([0.25, 0.3, 0.4, 0.1], "double-crank"),
        ([0.25, 0.1, 0.3, 0.4], "double-rocker: `link_2` turns fully"),
        ([0.2, 0.2, 0.2, 0.5], "triple-rocker"),
        ([0.1, 0.3, 0.2, 0.4], "change-point"),
    ] {
        let [crank, coupler, rocker, base] = lengths;
        // At this angle of the crank all of them close.
        let start = 0.5_f64;
        let at = [crank * start.cos(), crank * start.sin()];
        let [dx, dy] = [base - at[0], -at[1]];
        let far = f64::hypot(dx, dy);
        let along = (coupler * coupler - rocker * rocker + far * far) / (2.0 * far);
        let aside = (coupler * coupler - along * along).sqrt();
        let end = [
            at[0] + (along * dx - aside * dy) / far,
            at[1] + (along * dy + aside * dx) / far,
        ];
        assert!(aside.is_finite(), "{lengths:?} closes");
        let mut host = studio(EMPTY);
        let links = [
            json!([ground(0.0, 0.0), { "at": at }]),
            json!([marker("link.B"), { "at": end }]),
            json!([marker("link_2.C"), ground(base, 0.0)]),
        ];
        let views =
            links.map(|points| act(&mut host, &json!({ "kind": "link", "points": points })));
        assert!(views[1]["status"]["note"].is_null());
        let note = views[2]["status"]["note"].as_str().expect("a four-bar");
        assert!(note.starts_with(kind), "{lengths:?}: {note}");
        // The cosine law between coupler and rocker.
        let cos = (coupler * coupler + rocker * rocker - far * far) / (2.0 * coupler * rocker);
        let angle = cos.abs().acos().to_degrees();
        assert!(
            note.ends_with(&format!("transmission angle {angle:.0}° here")),
            "{angle}: {note}"
        );
    }
}
