//! Points are joined, and lengths and numbers get names.

use serde_json::{Value, json};

use super::{EMPTY, act, act_warned, ask, refusal, shipped_studio, state, studio};

fn ground(x: f64, y: f64) -> Value {
    json!({ "at": [x, y], "ground": true })
}

/// Two bars on ground, apart.
fn two_bars() -> super::Host {
    let mut host = studio(EMPTY);
    for (x, end) in [(0.0, [0.05, 0.086_602_540_378_443_87]), (0.4, [0.3, 0.2])] {
        let points = json!([ground(x, 0.0), { "at": end }]);
        act(&mut host, &json!({ "kind": "link", "points": points }));
    }
    host
}

#[test]
fn a_joined_pin_moves_onto_the_other_one() {
    let mut host = two_bars();
    let view = act(
        &mut host,
        &json!({ "kind": "join", "marker": "link_2.D", "onto": "link.B" }),
    );
    assert_eq!(state(&view), "rigid");
    insta::assert_snapshot!(host.text());
}

#[test]
fn pins_that_meet_are_joined_where_they_are() {
    let mut host = studio(EMPTY);
    for points in [[[0.0, 0.0], [0.1, 0.1]], [[0.3, 0.0], [0.1, 0.1]]] {
        let points = points.map(|at| json!({ "at": at }));
        act_warned(&mut host, &json!({ "kind": "link", "points": points }));
    }
    let names = ["link.B", "link_2.D"];
    let form = ask(&mut host, &json!({ "do": "inspect", "names": names }));
    let actions = form["actions"].as_array().expect("a list");
    let pin = (actions.iter()).find(|action| action["label"] == "Pin to link_2.D");
    let before = host.text().to_owned();
    act_warned(&mut host, &pin.expect("it is offered")["gesture"]);
    let joint = "B = { type = \"revolute\", markers = [\"link_2.D\", \"link.B\"] }\n";
    assert_eq!(host.text(), format!("{before}\n[joints]\n{joint}"));
    let form = ask(&mut host, &json!({ "do": "inspect", "names": names }));
    let is_pin = |action: &Value| action["label"] == "Pin to link_2.D";
    assert!(
        !form["actions"]
            .as_array()
            .expect("a list")
            .iter()
            .any(is_pin)
    );
}

#[test]
fn pins_that_are_joined_or_on_one_body_are_refused() {
    let mut host = two_bars();
    let mut why = |marker: &str, onto: &str| {
        refusal(
            &mut host,
            &json!({ "kind": "join", "marker": marker, "onto": onto }),
        )
    };
    let reasons = [
        why("link.A", "ground.A"),
        why("link.A", "link.B"),
        why("link.A", "link_2.C"),
        why("link.A", "link_2.X"),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn a_length_is_set_and_gets_a_name() {
    let mut host = two_bars();
    let markers = ["link.A", "link.B"];
    act(
        &mut host,
        &json!({ "kind": "length", "markers": markers, "value": 0.2 }),
    );
    let named = json!({
        "kind": "length", "markers": ["link_2.D", "link_2.C"], "value": 0.25, "name": "rocker_length",
    });
    let view = act(&mut host, &named);
    assert_eq!(state(&view), "undriven");
    insta::assert_snapshot!(host.text());
    let again = json!({ "kind": "length", "markers": ["link_2.C", "link_2.D"], "value": 0.3 });
    let answer = ask(
        &mut host,
        &json!({ "do": "gesture", "keep": true, "gesture": again }),
    );
    assert_eq!(answer["refused"]["parameter"], "rocker_length");
    let through = json!({
        "kind": "length", "markers": ["link_2.C", "link_2.D"], "value": 0.3, "through": "parameter",
    });
    act(&mut host, &through);
    assert!(
        host.text()
            .contains("rocker_length = { value = 0.3, unit = \"m\"")
    );
}

#[test]
fn lengths_that_stand_in_no_number_are_refused() {
    let mut host = shipped_studio("excavator_arm.toml");
    let mut why = |markers: [&str; 2], value: Value, name: &str| {
        let gesture = json!({ "kind": "length", "markers": markers, "value": value, "name": name });
        refusal(&mut host, &gesture)
    };
    let reasons = [
        why(["boom.cylinder", "boom.tip"], Value::Null, "a"),
        why(["boom.foot", "boom.cylinder"], Value::Null, "a"),
        why(["boom.foot", "boom.tip"], Value::Null, "a"),
        why(["boom.foot", "boom.tip"], Value::Null, "stick"),
        why(["boom.foot", "stick.tip"], Value::Null, "a"),
        why(["boom.foot", "boom.tip"], json!(-1), "a"),
        why(["boom.foot", "boom.foot"], Value::Null, "a"),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn numbers_become_parameters_with_their_units() {
    let mut host = shipped_studio("excavator_arm.toml");
    let mut make = |path: Value, element: Option<usize>, name: &str| {
        let gesture =
            json!({ "kind": "parameter", "path": path, "element": element, "name": name });
        let view = act(&mut host, &gesture);
        assert_eq!(state(&view), "driven");
    };
    make(json!(["bodies", "boom", "mass"]), None, "boom_mass");
    make(json!(["bodies", "boom", "inertia"]), None, "boom_inertia");
    make(
        json!(["bodies", "bucket", "markers", "ear"]),
        Some(1),
        "ear_height",
    );
    make(json!(["bodies", "boom", "estimate"]), Some(2), "boom_angle");
    make(
        json!(["drivers", "boom_cylinder", "start"]),
        None,
        "boom_start",
    );
    insta::assert_snapshot!(host.text());
    let mut why = |path: Value, element: Option<usize>, name: &str| {
        let gesture =
            json!({ "kind": "parameter", "path": path, "element": element, "name": name });
        refusal(&mut host, &gesture)
    };
    let reasons = [
        why(json!(["bodies", "boom", "mass"]), None, "again"),
        why(json!(["bodies", "stick", "mass"]), None, "boom"),
        why(json!(["bodies", "stick", "mass"]), None, "sin"),
        why(json!(["bodies", "stick", "mass"]), None, "1a"),
        why(json!(["bodies", "stick", "mast"]), None, "a"),
        why(json!(["bodies", "stick", "markers", "pin"]), Some(2), "a"),
        why(json!(["joints", "rod", "type"]), None, "a"),
        why(json!(["parameters", "load_mass", "value"]), None, "a"),
    ];
    insta::assert_snapshot!("no_parameters", reasons.join("\n"));
}

#[test]
fn an_element_of_a_list_is_put() {
    let mut host = shipped_studio("excavator_arm.toml");
    let put = |path: Value, element: usize, value: &str| json!({ "kind": "put", "path": path, "element": element, "value": value });
    act(
        &mut host,
        &put(json!(["bodies", "boom", "center"]), 1, "0.5"),
    );
    assert!(host.text().contains("center = [2.75, 0.5]"));
    act(
        &mut host,
        &put(json!(["bodies", "stick", "markers", "rear"]), 2, "90*deg"),
    );
    assert!(host.text().contains("rear = [-0.75, 0.25, \"90*deg\"]"));
    let gone = put(json!(["bodies", "boom", "center"]), 1, "");
    let why = "a number of `bodies.boom.center` cannot be left out";
    assert_eq!(refusal(&mut host, &gone), why);
    let inside = json!({ "kind": "put", "path": ["bodies", "boom", "mass", "unit"], "value": "1" });
    let why = "`bodies.boom.mass` is a value, which has no keys";
    assert_eq!(refusal(&mut host, &inside), why);
    let commented = json!({ "kind": "put", "path": ["bodies", "boom", "mass"], "value": "1 # kg" });
    assert!(refusal(&mut host, &commented).contains("unexpected character `#`"));
    let far = put(json!(["bodies", "boom", "center"]), 4, "1");
    assert_eq!(
        refusal(&mut host, &far),
        "`bodies.boom.center` has no number 5"
    );
}

#[test]
fn a_mass_follows_its_bar_until_it_has_numbers_of_its_own() {
    let mut host = studio(EMPTY);
    let points = json!([{ "at": [0, 0] }, { "at": [0.2, 0] }]);
    act_warned(&mut host, &json!({ "kind": "link", "points": points }));
    act_warned(&mut host, &json!({ "kind": "mass", "body": "link" }));
    // m l² / 12 = 0.04 / 12.
    assert!(
        host.text().contains("inertia = 0.00333\n"),
        "{}",
        host.text()
    );
    assert!(host.text().contains("center = [0.1, 0]\n"));
    let put = |key: &str, value: &str| {
        let path = ["bodies", "link", key];
        json!({ "kind": "put", "path": path, "value": value })
    };
    act_warned(&mut host, &put("mass", "2"));
    assert!(host.text().contains("inertia = 0.00667\n"));
    act_warned(&mut host, &put("mass", "1"));
    let ends = ["link.A", "link.B"];
    let length = |value: f64| json!({ "kind": "length", "markers": ends, "value": value });
    act_warned(&mut host, &length(0.3));
    // 0.09 / 12.
    assert!(
        host.text().contains("inertia = 0.0075\n"),
        "{}",
        host.text()
    );
    assert!(host.text().contains("center = [0.15, 0]\n"));
    act_warned(&mut host, &put("inertia", "0.01"));
    act_warned(
        &mut host,
        &json!({ "kind": "shift", "markers": [ends[1]], "by": [0.1, 0.0] }),
    );
    assert!(host.text().contains("inertia = 0.01\n"), "{}", host.text());
    assert!(host.text().contains("center = [0.2, 0]\n"));
}
