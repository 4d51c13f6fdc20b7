//! Drawings by gestures, and the files that come out.

use serde::Deserialize as _;
use serde_json::{Value, json};

use super::host::Host;
use super::request::Gesture;

mod copies;
mod exact;
mod geometry;
mod inspect;
mod names;
mod parts;

pub(super) const EMPTY: &str = "format = 1\nname = \"mechanism\"\n";

/// A studio with an empty sheet.
pub(super) fn studio(text: &str) -> Host {
    let mut host = Host::default();
    let view = ask(
        &mut host,
        &json!({ "do": "begin", "name": "a.toml", "text": text }),
    );
    assert!(
        view["problems"].as_array().is_some_and(Vec::is_empty),
        "{view}"
    );
    host
}

pub(super) fn ask(host: &mut Host, request: &Value) -> Value {
    host.answer(&request.to_string())
}

/// Reads a gesture.
pub(super) fn read(gesture: &Value) -> Gesture {
    Gesture::deserialize(gesture).expect("it is a gesture")
}

/// Does a gesture that is to succeed and to leave no problem.
pub(super) fn act(host: &mut Host, gesture: &Value) -> Value {
    let answer = act_warned(host, gesture);
    let has_none = answer["problems"].as_array().is_some_and(Vec::is_empty);
    assert!(has_none, "{}\n{answer}", host.text());
    answer
}

/// Does a gesture that is to succeed; what it leaves may have warnings.
pub(super) fn act_warned(host: &mut Host, gesture: &Value) -> Value {
    act_finely(host, gesture, 4)
}

/// Does a gesture, as [`act_warned`] does, with lengths of these decimals.
pub(super) fn act_finely(host: &mut Host, gesture: &Value, decimals: usize) -> Value {
    let request =
        json!({ "do": "gesture", "keep": true, "decimals": decimals, "gesture": gesture });
    let answer = ask(host, &request);
    assert!(answer["refused"].is_null(), "{gesture}: {answer}");
    let problems = answer["problems"].as_array().expect("a list");
    let is_error = |problem: &&Value| problem["severity"] == "error";
    assert_eq!(problems.iter().find(is_error), None, "{}", host.text());
    answer
}

/// Returns why a gesture is refused, which changes nothing.
pub(super) fn refusal(host: &mut Host, gesture: &Value) -> String {
    let before = host.text().to_owned();
    let request = json!({ "do": "gesture", "keep": true, "gesture": gesture });
    let answer = ask(host, &request);
    assert_eq!(host.text(), before);
    let message = answer["refused"]["message"].as_str();
    message
        .unwrap_or_else(|| panic!("{gesture}: {answer}"))
        .to_owned()
}

/// The files beside a mechanism's, with their contents.
pub(super) type Files = Vec<(String, String)>;

/// Returns the name and text of each shipped mechanism, with the files that they name.
pub(super) fn shipped() -> (Vec<(String, String)>, Files) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mechanisms");
    let (mut mechanisms, mut files) = (Vec::new(), Vec::new());
    for file in std::fs::read_dir(folder).expect("the folder is there") {
        let path = file.expect("it can be read").path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let extension = path.extension().unwrap_or_default();
        if extension != "toml" && extension != "csv" {
            continue;
        }
        let text = std::fs::read_to_string(&path)
            .expect("it is text")
            .replace("\r\n", "\n");
        if extension == "toml" {
            mechanisms.push((name, text))
        } else {
            files.push((name, text))
        }
    }
    mechanisms.sort();
    assert!(mechanisms.len() > 50);
    (mechanisms, files)
}

/// A studio with a shipped mechanism, which may have warnings.
pub(super) fn shipped_studio(name: &str) -> Host {
    let (mechanisms, files) = shipped();
    let (_, text) = mechanisms
        .iter()
        .find(|(file, _)| file == name)
        .expect("it is shipped");
    let mut host = Host::default();
    let begin = json!({ "do": "begin", "name": name, "text": text, "files": files });
    ask(&mut host, &begin);
    host
}

pub(super) fn state(view: &Value) -> &str {
    view["status"]["state"].as_str().unwrap_or_default()
}

#[test]
fn a_four_bar_is_drawn_in_four_gestures() {
    let mut host = studio(EMPTY);
    let ground = |x: f64, y: f64| json!({ "at": [x, y], "ground": true });
    let sheet = |x: f64, y: f64| json!({ "at": [x, y] });
    let marker = |path: &str| json!({ "at": [0, 0], "marker": path });
    let view = act(
        &mut host,
        &json!({ "kind": "link", "points": [ground(0.0, 0.0), sheet(0.05, 0.086_602_540_378_443_87)] }),
    );
    assert_eq!(state(&view), "undriven");
    act(
        &mut host,
        &json!({ "kind": "link", "points": [marker("link.B"), sheet(0.25, 0.25)] }),
    );
    let view = act(
        &mut host,
        &json!({ "kind": "link", "points": [marker("link_2.C"), ground(0.4, 0.0)] }),
    );
    assert_eq!(
        view["status"]["text"],
        "1 degree of freedom: add a driver at a joint, or let it move freely"
    );
    let view = act(&mut host, &json!({ "kind": "driver", "joint": "A" }));
    assert_eq!(state(&view), "driven");
    insta::assert_snapshot!(host.text());
    // Undo goes back to the first bytes, redo to the last.
    let last = host.text().to_owned();
    for _ in 0..4 {
        ask(&mut host, &json!({ "do": "text_undo" }));
    }
    assert_eq!(host.text(), EMPTY);
    for _ in 0..4 {
        ask(&mut host, &json!({ "do": "text_redo" }));
    }
    assert_eq!(host.text(), last);
}

#[test]
fn another_studio_goes_on_with_the_history_of_a_text() {
    let mut host = studio(EMPTY);
    for text in ["# ä\n", "# äö and\n", "# ö\n", ""] {
        ask(
            &mut host,
            &json!({ "do": "type", "text": format!("{EMPTY}{text}") }),
        );
    }
    ask(&mut host, &json!({ "do": "text_undo" }));
    let history = ask(&mut host, &json!({ "do": "history" }))["history"].clone();
    let mut other = Host::default();
    let begin = |history: &Value| {
        json!({
            "do": "begin", "name": "a.toml", "text": format!("{EMPTY}# ö\n"), "history": history,
        })
    };
    ask(&mut other, &begin(&history));
    for word in [
        "text_redo",
        "text_undo",
        "text_undo",
        "text_undo",
        "text_undo",
        "text_redo",
    ] {
        let views = [&mut host, &mut other].map(|host| ask(host, &json!({ "do": word })));
        assert_eq!(views[0], views[1], "{word}");
    }
    assert_eq!(other.text(), format!("{EMPTY}# ä\n"));
    // A change that does not fit ends the history.
    let wrong = json!({ "before": [[0, 1, "a"], [5000, 2, "b"]], "undone": [] });
    let view = ask(&mut other, &begin(&wrong));
    assert_eq!(view["can_undo"], false);
}

#[test]
fn a_text_with_an_error_keeps_its_last_drawing_in_another_studio() {
    let mut host = studio(EMPTY);
    let points = json!([{ "at": [0, 0] }, { "at": [0.04, 0.03] }]);
    act_warned(&mut host, &json!({ "kind": "link", "points": points }));
    let mut view = Value::Null;
    for word in ["[oops", "[oops!"] {
        let text = format!("{}{word}", host.text());
        view = ask(&mut host, &json!({ "do": "type", "text": text }));
    }
    let history = ask(&mut host, &json!({ "do": "history" }))["history"].clone();
    let begin =
        json!({ "do": "begin", "name": "a.toml", "text": view["text"], "history": history });
    let other = ask(&mut Host::default(), &begin);
    assert_eq!(other["is_stale"], true);
    assert_eq!(other["sketch"]["bodies"].as_array().map(Vec::len), Some(1));
    assert_eq!(other, view);
}

#[test]
fn a_slider_crank_is_drawn_from_its_points() {
    let mut host = studio(EMPTY);
    act(
        &mut host,
        &json!({ "kind": "link", "points": [{ "at": [0, 0], "ground": true }, { "at": [0.04, 0.03] }] }),
    );
    act(
        &mut host,
        &json!({ "kind": "link", "points": [{ "at": [0, 0], "marker": "link.B" }, { "at": [0.18, 0.0] }] }),
    );
    let slide = json!({ "at": [0, 0], "marker": "link_2.C" });
    act(
        &mut host,
        &json!({ "kind": "slider", "target": slide, "angle": 0.0 }),
    );
    let view = act(&mut host, &json!({ "kind": "driver", "joint": "A" }));
    assert_eq!(state(&view), "driven");
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_moved_point_changes_lengths_estimates_and_starts_and_keeps_comments() {
    let shipped = include_str!("../../../../../mechanisms/pendulum.toml").replace("\r\n", "\n");
    let mut host = studio(&shipped);
    let by = [0.1, 0.05];
    let gesture = json!({ "kind": "shift", "markers": ["rod.P"], "by": by });
    let answer = ask(
        &mut host,
        &json!({ "do": "gesture", "keep": true, "gesture": gesture }),
    );
    // The length is a parameter, which the reader is asked about.
    assert_eq!(answer["refused"]["parameter"], "length", "{answer}");
    assert_eq!(host.text(), shipped);
}

#[test]
fn a_moved_pin_takes_both_bars_along() {
    let mut host = studio(EMPTY);
    act(
        &mut host,
        &json!({ "kind": "link", "points": [{ "at": [0, 0], "ground": true }, { "at": [0.3, 0.4] }] }),
    );
    act(
        &mut host,
        &json!({ "kind": "link", "points": [{ "at": [0, 0], "marker": "link.B" }, { "at": [0.6, 0.0], "ground": true }] }),
    );
    let view = act(
        &mut host,
        &json!({ "kind": "shift", "markers": ["link.B"], "by": [-0.3, 0.0] }),
    );
    // Two bars and three pins are rigid.
    assert_eq!(state(&view), "rigid");
    let points = view["sketch"]["points"]
        .as_array()
        .expect("there are points");
    let at = |marker: &str| {
        let has = |point: &&Value| {
            point["markers"]
                .as_array()
                .is_some_and(|m| m.contains(&json!(marker)))
        };
        let point = points.iter().find(has).expect("it is drawn");
        [0, 1].map(|k| point["at"][k].as_f64().expect("a number"))
    };
    let [x, y] = at("link_2.B");
    assert!(x.abs() < 1e-4 && (y - 0.4).abs() < 1e-4, "{x} {y}");
    insta::assert_snapshot!(host.text());
}

#[test]
fn a_typed_error_keeps_the_drawing_and_says_where_it_is() {
    let shipped = include_str!("../../../../../mechanisms/four_bar.toml");
    let mut host = studio(shipped);
    let broken = shipped.replacen("\"crank.A\"", "\"crank.Z\"", 1);
    let view = ask(&mut host, &json!({ "do": "type", "text": broken }));
    assert_eq!(view["is_stale"], true);
    assert_eq!(state(&view), "broken");
    let problem = &view["problems"][0];
    let units: Vec<u16> = broken.encode_utf16().collect();
    let place =
        |key: &str| usize::try_from(problem[key].as_u64().expect("a place")).expect("small");
    let marked = String::from_utf16(&units[place("from")..place("to")]).expect("whole letters");
    assert_eq!(marked, "Z");
    assert!(
        view["sketch"]["points"]
            .as_array()
            .is_some_and(|points| !points.is_empty())
    );
    let gesture = json!({ "kind": "driver", "joint": "A" });
    let answer = ask(
        &mut host,
        &json!({ "do": "gesture", "keep": true, "gesture": gesture }),
    );
    assert_eq!(
        answer["refused"]["message"],
        "the text has an error: mend it first"
    );
}

#[test]
fn every_shipped_mechanism_is_drawn_and_ready() {
    let (mechanisms, files) = shipped();
    for (name, text) in mechanisms {
        let mut host = Host::default();
        let begin = json!({ "do": "begin", "name": name, "text": text, "files": files });
        let view = ask(&mut host, &begin);
        let state = state(&view);
        assert!(
            ["driven", "free"].contains(&state),
            "{name}: {}",
            view["status"]
        );
    }
}

#[test]
fn a_request_with_a_key_that_it_does_not_have_is_an_error() {
    let mut host = studio(EMPTY);
    let sheet = json!({ "at": [0, 0] });
    let pivot = json!({ "kind": "pivot", "marker": "ground.O", "at": [0, 0] });
    let far = json!({ "kind": "link", "points": [{ "at": [0, 0], "far": true }] });
    let spoon = json!({ "kind": "cam", "point": sheet, "contact": [1, 0], "follower": "spoon" });
    for (request, word) in [
        (json!({ "do": "view", "size": 3 }), "size"),
        (json!({ "do": "type" }), "text"),
        (json!({ "do": "gesture", "gesture": pivot }), "at"),
        (json!({ "do": "gesture", "gesture": far }), "far"),
        (json!({ "do": "gesture", "gesture": spoon }), "spoon"),
        (
            json!({ "do": "gesture", "gesture": { "kind": "fly" } }),
            "fly",
        ),
        (json!({ "do": "fly" }), "fly"),
    ] {
        let answer = ask(&mut host, &request);
        let error = answer["error"].as_str().unwrap_or_default();
        assert!(error.contains(&format!("`{word}`")), "{request}: {answer}");
    }
    let again = ask(&mut host, &json!({ "do": "view" }));
    assert_eq!(again["text"], EMPTY);
}
