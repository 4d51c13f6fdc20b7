//! Forms of what is selected.

use serde_json::{Value, json};

use super::super::drawn::Drawn;
use super::super::gesture::{self, Editing};
use super::super::host::Host;
use super::{ask, read, shipped, shipped_studio};
use crate::write::TomlText;
use biela::mechanism::Source;

fn form(host: &mut Host, names: &[&str]) -> Value {
    ask(host, &json!({ "do": "inspect", "names": names }))
}

/// Writes a form in lines.
fn written(form: &Value) -> String {
    let word = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut lines = vec![format!(
        "{} ({})",
        word(&form["title"]),
        word(&form["kind"])
    )];
    for row in form["rows"].as_array().expect("rows") {
        let parts =
            ["label", "type", "value", "shown", "number", "unit"].map(|key| word(&row[key]));
        lines.push(parts.join(" | ").trim_end_matches([' ', '|']).to_owned());
    }
    for action in form["actions"].as_array().expect("actions") {
        let why = action["why"].as_str().map(|why| format!(": {why}"));
        lines.push(format!(
            "- {}{}",
            word(&action["label"]),
            why.unwrap_or_default()
        ));
    }
    lines.join("\n")
}

#[test]
fn forms_have_the_numbers_of_the_file_and_what_can_be_done() {
    let mut host = shipped_studio("excavator_arm.toml");
    let things: [&[&str]; 9] = [
        &[],
        &["bucket"],
        &["bucket", "lever"],
        &["stick.lever", "lever.pin"],
        &["rod"],
        &["boom_cylinder"],
        &["load_mass"],
        &["load"],
        &["reach"],
    ];
    let forms = things.map(|names| written(&form(&mut host, names)));
    insta::assert_snapshot!(forms.join("\n\n"));
}

#[test]
fn forms_of_wheels_cams_and_stops() {
    let mut forms = Vec::new();
    for (file, name) in [
        ("planetary_gear.toml", "outer"),
        ("cam_roller.toml", "contact"),
        ("latch.toml", "strike"),
        ("pendulum_free.toml", "swing"),
        ("wedge_press.toml", "on_bed"),
    ] {
        let mut host = shipped_studio(file);
        forms.push(written(&form(&mut host, &[name])));
    }
    insta::assert_snapshot!(forms.join("\n\n"));
}

#[test]
fn the_value_of_each_row_can_be_put_as_it_is() {
    let (mechanisms, files) = shipped();
    let mut count = 0;
    for (file, text) in mechanisms {
        let source = Source::new("a", &*text).with_files(files.clone());
        let drawn = Drawn::read(&source).0.expect("it is drawn");
        let mut host = shipped_studio(&file);
        let view = ask(&mut host, &json!({ "do": "view" }));
        let mut things: Vec<Vec<String>> = vec![Vec::new()];
        for list in [
            "bodies",
            "joints",
            "drivers",
            "forces",
            "stops",
            "parameters",
        ] {
            let named = view["sketch"][list].as_array().expect("a list");
            let names = named.iter().filter_map(|thing| thing["name"].as_str());
            things.extend(names.map(|name| vec![name.to_owned()]));
        }
        let points = view["sketch"]["points"].as_array().expect("points");
        let texts = |value: &Value| {
            let texts = value.as_array().expect("a list").iter();
            texts
                .filter_map(Value::as_str)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        things.extend(points.iter().map(|point| texts(&point["markers"])));
        for names in things {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let form = form(&mut host, &names);
            assert!(form["title"].is_string(), "{file}, {names:?}: {form}");
            for row in form["rows"].as_array().expect("rows") {
                let value = row["value"].as_str().expect("a text");
                if row["type"] == "read" || value.is_empty() {
                    continue;
                }
                let gesture = json!({
                    "kind": "put", "path": row["path"], "element": row["element"], "value": value,
                });
                let text = TomlText::new(&*text).expect("it is TOML");
                let mut editing = Editing::new(text, &drawn, &files, 4);
                let done = gesture::act(&read(&gesture), &mut editing);
                assert_eq!(done, Ok(()), "{file}, {gesture}");
                assert_eq!(editing.text.as_str(), host.text(), "{file}, {gesture}");
                count += 1;
            }
        }
    }
    assert!(count > 2_000, "{count}");
}

#[test]
fn a_value_that_is_left_out_can_be_put() {
    let mut host = shipped_studio("four_bar.toml");
    let mut put = |path: Value, element: Option<usize>, value: &str, written: &str| {
        let gesture = json!({ "kind": "put", "path": path, "element": element, "value": value });
        super::act(&mut host, &gesture);
        assert!(host.text().contains(written), "{}", host.text());
    };
    put(json!(["bodies", "crank", "mass"]), None, "2", "mass = 2");
    put(
        json!(["bodies", "crank", "center"]),
        Some(1),
        "0.1",
        "center = [0, 0.1]",
    );
    put(
        json!(["simulation", "gravity"]),
        Some(1),
        "0",
        "gravity = [0, 0]",
    );
    put(
        json!(["drivers", "crank_angle", "max"]),
        None,
        "300*deg",
        "max = \"300*deg\" }",
    );
    put(
        json!(["description"]),
        None,
        "\"A linkage\"",
        "description = \"A linkage\"",
    );
}

#[test]
fn nothing_is_known_of_what_is_not_there() {
    let mut host = shipped_studio("four_bar.toml");
    let why = |form: Value| form["refused"]["message"].as_str().map(str::to_owned);
    let nothing = why(form(&mut host, &["cranck"]));
    assert_eq!(nothing.as_deref(), Some("there is nothing called `cranck`"));
    let nothing = why(form(&mut host, &["crank.Z"]));
    assert_eq!(nothing.as_deref(), Some("there is no marker `crank.Z`"));
}
