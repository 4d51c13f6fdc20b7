//! Bodies are duplicated and mirrored.

use serde_json::{Value, json};

use super::{act, refusal, shipped_studio, state};

/// Returns the frame of a body.
fn frame(view: &Value, body: &str) -> [f64; 3] {
    let bodies = view["sketch"]["bodies"]
        .as_array()
        .expect("there are bodies");
    let body = bodies
        .iter()
        .find(|found| found["name"] == body)
        .expect("it is drawn");
    [0, 1, 2].map(|k| body["frame"][k].as_f64().expect("a number"))
}

#[test]
fn a_duplicate_has_bodies_joints_and_points_of_its_own() {
    let mut host = shipped_studio("four_bar.toml");
    let bodies = ["crank", "coupler", "rocker"];
    let view = act(
        &mut host,
        &json!({ "kind": "duplicate", "bodies": bodies, "by": [0, 0.5] }),
    );
    insta::assert_snapshot!(host.text());
    // The copy is at its estimates, which are rounded, until something drives it.
    for body in bodies {
        let [x, y, phi] = frame(&view, body);
        let [u, v, psi] = frame(&view, &format!("{body}_2"));
        let off = [u - x, v - y - 0.5, psi - phi];
        assert!(off.iter().all(|part| part.abs() < 2e-3), "{body}: {off:?}");
    }
    assert_eq!(state(&view), "driven");
}

#[test]
fn a_duplicate_has_the_forces_on_its_bodies_and_on_no_other() {
    let text = r#"format = 1
name = "two_doors"

[parameters]
stiffness = 400

[ground.markers]
A = [0, 0]
S = [0.1, 0.1]

[bodies.door]
mass = 2
markers = { A = [0, 0], B = [0.3, 0] }

[bodies.flap]
markers = { B = [0, 0], C = [0.1, 0] }

[joints]
A = { type = "revolute", markers = ["ground.A", "door.A"] }
B = { type = "revolute", markers = ["door.B", "flap.B"] }

[forces]
closer = { coordinate = "distance", markers = ["ground.S", "door.B"], stiffness = "stiffness", free = 0.2 }
between = { coordinate = "distance", markers = ["door.A", "flap.C"], stiffness = 100, free = 0.3 }

[freedoms]
swing = { coordinate = "angle", markers = ["ground.A", "door.A"] }

[drivers]
tilt = { coordinate = "angle", markers = ["door.B", "flap.B"], start = 0.2 }
"#;
    let mut host = super::studio(text);
    let gesture = json!({ "kind": "duplicate", "bodies": ["door"], "by": [0, 0.5] });
    act(&mut host, &gesture);
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_duplicate_of_every_shipped_mechanism_stands_beside_it() {
    for (name, _) in super::shipped().0 {
        let mut host = shipped_studio(&name);
        let view = super::ask(&mut host, &json!({ "do": "view" }));
        let bodies = view["sketch"]["bodies"]
            .as_array()
            .expect("there are bodies")
            .clone();
        let names: Vec<&Value> = bodies.iter().map(|body| &body["name"]).collect();
        let gesture = json!({ "kind": "duplicate", "bodies": names, "by": [0.3, 1] });
        let view = super::act_finely(&mut host, &gesture, 9);
        let state = state(&view);
        let text = host.text();
        assert!(
            ["undriven", "driven", "free"].contains(&state),
            "{name}: {}\n{text}",
            view["status"]
        );
        // A point on a contour or a curve that nothing drives may go along until it closes.
        let source = biela::mechanism::Source::new("a", text).with_files(super::shipped().1);
        let (mechanism, _) = biela::mechanism::Mechanism::parse(&source).expect("it has no error");
        let parameters = mechanism.default_parameters();
        let is_on_curve = ["cam", "curve"].map(|kind| text.contains(&format!("type = \"{kind}\"")));
        let is_on_curve = is_on_curve.contains(&true);
        let copies = view["sketch"]["bodies"]
            .as_array()
            .expect("there are bodies");
        for (index, body) in bodies.iter().enumerate() {
            let number = |body: &Value, k: usize| body["frame"][k].as_f64().expect("a number");
            let copy = bodies.len() + index;
            for (k, by) in [0.3, 1.0, 0.0].into_iter().enumerate() {
                let meant = number(body, k) + by;
                let estimate = mechanism.bodies[copy].estimate[k].value(&parameters);
                assert!((estimate - meant).abs() < 1e-4, "{name}: {body}\n{text}");
                let drawn = number(&copies[copy], k);
                assert!(
                    is_on_curve || (drawn - meant).abs() < 2e-3,
                    "{name}: {body}\n{text}"
                );
            }
        }
    }
}

#[test]
fn a_mirrored_mechanism_is_the_picture_of_the_first() {
    let (names, _) = super::shipped();
    let mut count = 0;
    for (name, _) in names {
        let mut host = shipped_studio(&name);
        let view = super::ask(&mut host, &json!({ "do": "view" }));
        let bodies = view["sketch"]["bodies"]
            .as_array()
            .expect("there are bodies")
            .clone();
        let names: Vec<&Value> = bodies.iter().map(|body| &body["name"]).collect();
        let gesture = json!({ "kind": "mirror", "bodies": names, "at": [0.1, 0.2], "angle": 0.7 });
        let request = json!({ "do": "gesture", "keep": true, "decimals": 9, "gesture": gesture });
        let view = super::ask(&mut host, &request);
        if let Some(why) = view["refused"]["message"].as_str() {
            assert!(why.contains("cannot be mirrored"), "{name}: {why}");
            continue;
        }
        let state = state(&view);
        assert!(
            ["undriven", "driven"].contains(&state),
            "{name}: {}\n{}",
            view["status"],
            host.text()
        );
        let copies = view["sketch"]["bodies"]
            .as_array()
            .expect("there are bodies");
        assert_eq!(copies.len(), 2 * bodies.len(), "{name}");
        for (body, copy) in bodies.iter().zip(&copies[bodies.len()..]) {
            let [x, y, phi] = [0, 1, 2].map(|k| body["frame"][k].as_f64().expect("a number"));
            let [u, v, psi] = [0, 1, 2].map(|k| copy["frame"][k].as_f64().expect("a number"));
            let (sin, cos) = 1.4_f64.sin_cos();
            let [dx, dy] = [x - 0.1, y - 0.2];
            let place = [0.1 + cos * dx + sin * dy, 0.2 + sin * dx - cos * dy];
            let turn = (psi - 1.4 + phi).sin().abs();
            let off = f64::hypot(u - place[0], v - place[1]);
            assert!(
                off < 2e-3 && turn < 2e-3,
                "{name}: {body}, {copy}\n{}",
                host.text()
            );
        }
        count += 1;
    }
    assert!(count > 30, "{count}");
}

#[test]
fn a_mirrored_rack_and_a_bell_crank() {
    let mut host = shipped_studio("rack_drive.toml");
    let bodies = ["pinion", "rack", "carriage"];
    let gesture = json!({ "kind": "mirror", "bodies": bodies, "at": [0, 0.1], "angle": 0 });
    act(&mut host, &gesture);
    insta::assert_snapshot!(host.text());
}

#[test]
fn shapes_are_not_mirrored() {
    let mut host = shipped_studio("cam_knife.toml");
    let gesture =
        json!({ "kind": "mirror", "bodies": ["cam", "follower"], "at": [0, 0], "angle": 1.5 });
    let why = "joint `contact` cannot be mirrored, as the contour of its cam would have to be drawn \
               anew: duplicate the bodies, or choose others";
    assert_eq!(refusal(&mut host, &gesture), why);
    let gesture = json!({ "kind": "duplicate", "bodies": ["arm"], "by": [0, 0] });
    assert_eq!(refusal(&mut host, &gesture), "there is no body `arm`");
}
