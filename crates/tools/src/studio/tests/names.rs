//! Things get other names, and are taken away.

use serde_json::{Value, json};

use super::super::drawn::Drawn;
use super::super::gesture::{self, Editing, Refusal};
use super::super::new_names::named;
use super::{Files, act, act_warned, read, refusal, shipped, shipped_studio, state, studio};
use crate::write::TomlText;
use biela::mechanism::{Mechanism, Severity, Source};

fn drawn(text: &str, files: &Files) -> Option<Drawn> {
    Drawn::read(&Source::new("a", text).with_files(files.clone())).0
}

/// Does a gesture on a text that is drawn.
fn done(text: &str, drawn: &Drawn, files: &Files, gesture: &Value) -> Result<String, Refusal> {
    let text = TomlText::new(text).expect("it is TOML");
    let mut editing = Editing::new(text, drawn, files, 4);
    gesture::act(&read(gesture), &mut editing)?;
    Ok(editing.text.as_str().to_owned())
}

/// Returns all names of a file, of markers their paths.
fn all_names(text: &str) -> Vec<String> {
    let text = TomlText::new(text).expect("it is TOML");
    let mut names: Vec<String> = named().flat_map(|section| text.keys(&[section])).collect();
    let ground = text.keys(&["ground", "markers"]);
    names.extend(ground.iter().map(|marker| format!("ground.{marker}")));
    for body in text.keys(&["bodies"]) {
        let markers = text.keys(&["bodies", &body, "markers"]);
        names.extend(markers.iter().map(|marker| format!("{body}.{marker}")));
    }
    names
}

#[test]
fn a_new_name_changes_no_mechanism_and_the_old_one_gives_the_first_bytes() {
    let (mechanisms, files) = shipped();
    let mut count = 0;
    for (file, text) in mechanisms {
        let first = drawn(&text, &files).expect("it is drawn");
        for old in all_names(&text) {
            let rename = |text: &str, old: &str, new: &str| {
                let gesture = json!({ "kind": "rename", "old": old, "new": new });
                done(text, &first, &files, &gesture)
            };
            let new = rename(&text, &old, "fresh_name");
            let new = new.unwrap_or_else(|refusal| panic!("{file}, {old}: {refusal:?}"));
            assert_ne!(new, text, "{file}, {old}");
            let again = drawn(&new, &files);
            let again = again.unwrap_or_else(|| panic!("{file}, {old}: an error in\n{new}"));
            let bits = |drawn: &Drawn| drawn.q.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&again), bits(&first), "{file}, {old}");
            let (path, back) = match old.split_once('.') {
                Some((body, marker)) => (format!("{body}.fresh_name"), marker),
                None => ("fresh_name".to_owned(), &*old),
            };
            assert_eq!(rename(&new, &path, back), Ok(text.clone()), "{file}, {old}");
            count += 1;
        }
    }
    assert!(count > 1_000);
}

#[test]
fn a_new_name_stands_in_headers_dotted_keys_braces_and_formulas() {
    let text = r#"# The crank of all cranks.
format = 1
name = "crank"
description = "a crank, with crank.A"

[parameters]
crank_length = 0.1

[ground.markers]
O = [0, 0]

["bodies".crank]  # crank
estimate = [0, 0, "30*deg"]
[bodies.'crank'.markers]
O = [0, 0]
A = ["2*crank_length - crank_length", 0]

[joints]
O.type = "revolute"
O.markers = ["ground.O", 'crank.O']

[drivers]
turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = "30*deg" }

[measures]
speed = { value = "crank.omega + crank.A.vx/crank_length", unit = "rad/s" }

[outputs]
bodies = ["crank"]
markers = ["crank.A"]
"#;
    let mut host = studio(text);
    act(
        &mut host,
        &json!({ "kind": "rename", "old": "crank", "new": "arm" }),
    );
    act(
        &mut host,
        &json!({ "kind": "rename", "old": "arm.A", "new": "tip" }),
    );
    act(
        &mut host,
        &json!({ "kind": "rename", "old": "O", "new": "hinge" }),
    );
    act(
        &mut host,
        &json!({ "kind": "rename", "old": "crank_length", "new": "A" }),
    );
    insta::assert_snapshot!(host.text());
}

#[test]
fn markers_and_parameters_may_have_the_names_of_keys() {
    let text = r#"format = 1
name = "mechanism"

[parameters]
reach = 0.2
side = "reach/2"

[ground.markers]
side = ["reach", 0]

[bodies.rod]
markers = { points = [0, "side"], file = ["reach", 0] }

[joints]
A = { type = "revolute", markers = ["ground.side", "rod.points"] }
"#;
    let mut host = studio(text);
    let gesture = json!({ "kind": "rename", "old": "reach", "new": "span" });
    act(&mut host, &gesture);
    assert_eq!(host.text(), text.replace("reach", "span"));
}

#[test]
fn illegal_taken_and_ambiguous_names_are_refused() {
    let mut host = shipped_studio("cam_knife.toml");
    let mut why = |old: &str, new: &str| {
        refusal(
            &mut host,
            &json!({ "kind": "rename", "old": old, "new": new }),
        )
    };
    let reasons = [
        why("cam", "follower"),
        why("cam", "1cam"),
        why("cam", "a b"),
        why("cam", "ground"),
        why("cam", "sin"),
        why("cam.axle", "omega"),
        why("follower.edge", "top"),
        why("base", "theta"),
        why("nothing", "something"),
        why("cam.nothing", "something"),
    ];
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn any_one_thing_can_be_deleted_and_the_file_has_no_error() {
    let (mechanisms, files) = shipped();
    for (file, text) in mechanisms {
        let first = drawn(&text, &files).expect("it is drawn");
        for name in all_names(&text) {
            let gesture = json!({ "kind": "delete", "names": [name] });
            let left = done(&text, &first, &files, &gesture);
            let left = left.unwrap_or_else(|refusal| panic!("{file}, {name}: {refusal:?}"));
            let source = Source::new("a", &*left).with_files(files.clone());
            let problems = Mechanism::parse(&source).err().unwrap_or_default();
            let mut errors = problems.iter().filter(|p| p.severity == Severity::Error);
            let is_sheet = errors.all(|error| error.code == "no-bodies");
            assert!(is_sheet, "{file}, {name}: {problems:?}\n{left}");
            assert!(!all_names(&left).contains(&name), "{file}, {name}");
            let comments = |text: &str| {
                let lines = text.lines().filter(|line| line.starts_with('#'));
                lines.map(str::to_owned).collect::<Vec<_>>()
            };
            assert_eq!(comments(&left), comments(&text), "{file}, {name}");
        }
    }
}

#[test]
fn a_deleted_body_takes_its_joints_and_their_points_of_ground_along() {
    let mut host = shipped_studio("four_bar.toml");
    let view = act_warned(&mut host, &json!({ "kind": "delete", "names": ["rocker"] }));
    // The length of the rocker is of no use any more, and says so.
    assert_eq!(view["problems"].as_array().map(Vec::len), Some(2));
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_deleted_parameter_leaves_its_value() {
    let mut host = shipped_studio("engine.toml");
    let names = ["crank_length", "exponent"];
    let view = act(&mut host, &json!({ "kind": "delete", "names": names }));
    assert_eq!(state(&view), "driven");
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_deleted_measure_takes_the_stop_on_it_along() {
    let mut host = shipped_studio("latch.toml");
    let delete = json!({ "kind": "delete", "names": ["throw", "handle.A"] });
    let view = act_warned(&mut host, &delete);
    assert_eq!(state(&view), "undriven");
    insta::assert_snapshot!(host.text());
}

#[test]
fn all_bodies_deleted_leave_an_empty_sheet() {
    let mut host = shipped_studio("wedge_press.toml");
    let view = act_warned(
        &mut host,
        &json!({ "kind": "delete", "names": ["wedge", "ram"] }),
    );
    assert_eq!(state(&view), "empty");
    insta::assert_snapshot!(host.text());
}

#[test]
fn what_is_not_there_cannot_be_deleted() {
    let mut host = shipped_studio("four_bar.toml");
    let gesture = json!({ "kind": "delete", "names": ["crank", "cranck"] });
    assert_eq!(
        refusal(&mut host, &gesture),
        "there is nothing called `cranck`"
    );
}
