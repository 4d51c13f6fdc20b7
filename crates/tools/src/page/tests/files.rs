//! Files that are opened, undone and saved, and what ends ranges.

use serde_json::{Value, json};

use super::{FOUR_BAR, open, parameter};
use crate::page::{Host, Outcome};
use biela::kinematics::OutputSource;
use biela::mechanism::DriverId;

/// Returns a four-bar that its rocker drives.
fn rocker_drives() -> String {
    let crank = r#"crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "60*deg" }"#;
    let rocker = r#"rocker_angle = { coordinate = "angle", markers = ["ground.O4", "rocker.O"], start = "122.8*deg" }"#;
    assert!(FOUR_BAR.contains(crank));
    FOUR_BAR.replace(crank, rocker)
}

#[test]
fn undo_returns_to_the_file_before() {
    let mut host = Host::default();
    let mut ask = |request: Value| host.answer(&request.to_string());
    let file = |text: &str, kept: bool| json!({ "do": "open", "name": "a.toml", "text": text, "files": [], "kept": kept });
    let word = |word: &str| json!({ "do": word });
    let drive = |value: f64| json!({ "do": "drive", "driver": 0, "value": value });
    let longer = FOUR_BAR.replace("value = 0.40,", "value = 0.41,");
    assert_ne!(longer, FOUR_BAR);
    ask(file(FOUR_BAR, false));
    assert_eq!(ask(word("undo"))["done"], false);
    ask(word("keep"));
    ask(drive(1.5));
    ask(file(&longer, true));
    ask(word("keep"));
    ask(drive(2.0));
    // The move in the second file, the file, the move in the first one.
    assert_eq!(ask(word("undo")), json!({ "done": true }));
    let before = ask(word("undo"));
    assert_eq!(before["file"]["text"], FOUR_BAR);
    assert_eq!(before["page"]["drivers"][0]["value"], 1.5);
    assert_eq!(ask(word("undo")), json!({ "done": true }));
    assert_eq!(ask(word("undo"))["done"], false);
    // And forth again.
    assert_eq!(ask(word("redo")), json!({ "done": true }));
    let after = ask(word("redo"));
    assert_eq!(after["file"]["text"], longer);
    assert_eq!(after["page"]["parameters"][3]["value"], 0.41);
    assert_eq!(ask(word("redo")), json!({ "done": true }));
    assert_eq!(ask(word("redo"))["done"], false);
    // A change forgets what was undone.
    ask(word("undo"));
    ask(word("undo"));
    ask(word("keep"));
    ask(drive(1.0));
    assert_eq!(ask(word("redo"))["done"], false);
}

#[test]
fn estimates_keep_their_units() {
    assert!(FOUR_BAR.contains("estimate = [0, 0, \"60*deg\"]"));
    let mut session = open(FOUR_BAR);
    session.drive(DriverId(0), 2.0);
    let saved = session.text().expect("the file was read");
    // 2 rad in degrees, nine digits.
    let estimate = "estimate = [0, 0, \"114.591559026*deg\"]";
    assert!(saved.contains(estimate), "{saved}");
    let again = open(&saved);
    for (a, b) in again.pose().q.iter().zip(&session.pose().q) {
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
}

#[test]
fn ranges_say_what_ends_them() {
    let ends = |text: &str| {
        let page = open(text).description();
        ["low_end", "high_end"].map(|key| page["ranges"][0][key].clone())
    };
    assert_eq!(ends(FOUR_BAR), [Value::Null, Value::Null]);
    assert_eq!(ends(&rocker_drives()), ["dead point", "dead point"]);
    let latch = include_str!("../../../../../mechanisms/latch.toml");
    assert_eq!(ends(latch)[1], "stop `strike`");
    let bounded = FOUR_BAR.replace("start = \"60*deg\"", "start = 1, min = 0.5, max = 1.5");
    assert_eq!(ends(&bounded), ["`min`", "`max`"]);
}

// The rates of a four-bar grow without bound where the rocker that drives turns back.
#[test]
fn a_dead_point_has_no_rates() {
    let mut session = open(&rocker_drives());
    let is_rate = |source: OutputSource| matches!(source, OutputSource::Signal(_, order) if order != biela::mechanism::Order::Position);
    let rates = |session: &super::Session| -> Vec<f64> {
        let outputs = session.outputs.iter().filter(|o| is_rate(o.source));
        outputs.map(|output| session.value(output)).collect()
    };
    assert!(rates(&session).iter().all(|rate| rate.is_finite()));
    let outcome = session.drive(DriverId(0), 0.3);
    assert!(matches!(outcome, Outcome::Stopped(_)), "{outcome:?}");
    assert!(rates(&session).iter().all(|rate| rate.is_nan()));
    // They are finite next to it.
    let limit = session.pose().drivers[0];
    session.drive(DriverId(0), limit + 1e-3);
    assert!(rates(&session).iter().all(|rate| rate.is_finite()));
    let base = parameter(&session, "base");
    session.set(base, 0.39, false);
    assert!(rates(&session).iter().all(|rate| rate.is_finite()));
}
