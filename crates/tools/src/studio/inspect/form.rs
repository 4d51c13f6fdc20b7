//! The keys that a table of the file may have, for forms.

use std::sync::LazyLock;

use biela::mechanism::Mechanism;
use serde_json::Value;

use crate::write::TomlText;

/// A key of a table.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) key: String,
    pub(super) kind: FieldKind,
    /// Meaning of the key.
    pub(super) help: String,
}

/// Kind of a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FieldKind {
    Number,
    /// A list of so many numbers.
    Numbers(usize),
    Text,
    Choice(Vec<String>),
    Flag,
    /// A list or a table, which is shown.
    Other,
}

static SCHEMA: LazyLock<Value> = LazyLock::new(Mechanism::schema);

/// Returns the keys that the table at a path may have, in the order of the schema.
pub(super) fn fields(text: &TomlText, path: &[&str]) -> Vec<Field> {
    let root = &*SCHEMA;
    let table = match path {
        [] => root,
        [section] => &root["properties"][*section],
        [section, _, ..] => {
            let entry = &root["properties"][*section]["additionalProperties"];
            shape(entry, text, path)
        }
    };
    let properties = table["properties"].as_object().into_iter().flatten();
    let fields = properties.map(|(key, schema)| {
        // The types of joints stand apart.
        let schema = match path {
            ["joints", ..] if key == "type" => {
                &root["properties"]["joints"]["additionalProperties"]["properties"]["type"]
            }
            _ => schema,
        };
        Field {
            key: key.clone(),
            kind: kind(schema),
            help: schema["description"]
                .as_str()
                .unwrap_or_default()
                .to_owned(),
        }
    });
    fields.collect()
}

/// Returns the schema of the shape that a thing has.
fn shape<'a>(entry: &'a Value, text: &TomlText, path: &[&str]) -> &'a Value {
    if let Some(branches) = entry["allOf"].as_array() {
        let own: Vec<&str> = path.iter().copied().chain(["type"]).collect();
        let is_type = |branch: &&Value| {
            let name = &branch["if"]["properties"]["type"]["const"];
            text.get(&own).map(|value| value.trim_matches('"')) == name.as_str()
        };
        let branch = branches.iter().find(is_type);
        return branch.map_or(entry, |branch| &branch["then"]);
    }
    let shapes = entry["anyOf"].as_array().map_or(&[][..], Vec::as_slice);
    let keys = text.keys(path);
    let fits = |shape: &&Value| {
        let properties = shape["properties"].as_object();
        properties.is_some_and(|known| keys.iter().all(|key| known.contains_key(key)))
    };
    shapes.iter().find(fits).unwrap_or(entry)
}

fn kind(schema: &Value) -> FieldKind {
    let is_number = |schema: &Value| schema["$ref"] == "#/$defs/number";
    let shapes = schema["anyOf"].as_array().map_or(&[][..], Vec::as_slice);
    let mut lists = [schema].into_iter().chain(shapes);
    if let Some(words) = lists.find_map(|shape| shape["enum"].as_array()) {
        let words = words.iter().filter_map(Value::as_str).map(str::to_owned);
        return FieldKind::Choice(words.collect());
    }
    if let Some(items) = schema["prefixItems"].as_array() {
        return if items.iter().all(is_number) {
            FieldKind::Numbers(items.len())
        } else {
            FieldKind::Other
        };
    }
    match schema["type"].as_str() {
        _ if is_number(schema) || shapes.iter().any(is_number) => FieldKind::Number,
        Some("boolean") => FieldKind::Flag,
        Some("string") => FieldKind::Text,
        _ if schema["$ref"] == "#/$defs/marker" => FieldKind::Text,
        _ => FieldKind::Other,
    }
}
