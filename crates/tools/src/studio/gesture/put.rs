//! A value of the file that is set in a form.

use serde_json::Value;

use super::mass::follow_mass;
use super::{Editing, Refusal};
use crate::write::TomlText;

/// Sets the value at `path`, or an `element` of the list there, to the TOML in `value`, or takes it away
/// where that is `null` or empty. A word that is no TOML is taken as an expression: `2*a`.
pub(super) fn put(
    editing: &mut Editing,
    path: &[String],
    element: Option<usize>,
    value: &Value,
) -> Result<(), Refusal> {
    let path = path_of_value(path)?;
    let value = match value {
        Value::String(text) => text.trim().to_owned(),
        Value::Null => String::new(),
        other => other.to_string(),
    };
    // A value and no more: no comment, no further line.
    let plain = TomlText::new(format!("value = {value}"));
    let is_toml = plain.is_ok_and(|plain| plain.get(&["value"]) == Some(&*value));
    let written = if is_toml {
        value.clone()
    } else {
        toml_edit::Value::from(&*value).to_string()
    };
    if let ["parameters", name, key] = path[..]
        && let Some(number) = editing
            .text
            .get(&path[..2])
            .filter(|_| !editing.text.has_keys(&path[..2]))
    {
        // A parameter that was a number alone.
        let table = format!("{{ value = {number}, {key} = {written} }}");
        if !value.is_empty() {
            editing.text.set(&["parameters", name], &table);
        }
        return Ok(());
    }
    let owners = (1..path.len()).map(|length| &path[..length]);
    let mut plain = owners.filter(|owner| editing.text.has(owner) && !editing.text.has_keys(owner));
    if let Some(owner) = plain.next() {
        return Err(format!("`{}` is a value, which has no keys", owner.join(".")).into());
    }
    if let ["bodies", name, "mass"] = path[..]
        && let (Ok(body), Ok(mass)) = (editing.body(name), value.parse())
    {
        follow_mass(editing, body, mass);
    }
    let Some(index) = element else {
        if value.is_empty() {
            editing.text.remove(&path)
        } else {
            editing.text.set(&path, &written)
        }
        return Ok(());
    };
    if value.is_empty() && index == 2 && path.contains(&"markers") {
        editing.text.remove_element(&path, index);
        return Ok(());
    }
    if value.is_empty() {
        let at = path.join(".");
        return Err(format!("a number of `{at}` cannot be left out").into());
    }
    match editing.text.element(&path, index) {
        Some(place) => editing.text.replace(place, &written),
        None => add_element(editing, &path, index, &written)?,
    }
    Ok(())
}

/// Adds an element behind the last one of a list. Of a list that is left out the others have the values
/// that leaving it out means.
fn add_element(
    editing: &mut Editing,
    path: &[&str],
    index: usize,
    value: &str,
) -> Result<(), Refusal> {
    let mut list = match path {
        _ if editing.text.has(path) => Vec::new(),
        ["bodies", _, "center"] => vec!["0", "0"],
        ["bodies", _, "estimate"] => vec!["0", "0", "0"],
        ["simulation", "gravity"] => vec!["0", "-9.81"],
        _ => Vec::new(),
    };
    if let Some(place) = list.get_mut(index) {
        *place = value;
        editing.text.set(path, &format!("[{}]", list.join(", ")));
        return Ok(());
    }
    let last = index.checked_sub(1);
    let last = last.and_then(|last| editing.text.element(path, last));
    let Some(last) = last else {
        return Err(format!("`{}` has no number {}", path.join("."), index + 1).into());
    };
    editing
        .text
        .replace(last.end..last.end, &format!(", {value}"));
    Ok(())
}

/// Returns the path that a gesture names.
pub(super) fn path_of_value(path: &[String]) -> Result<Vec<&str>, Refusal> {
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    if path.is_empty() || !path.iter().all(|name| is_key(name)) {
        return Err("the gesture lacks the path of a value".into());
    }
    Ok(path)
}

/// Returns whether a word is a key that needs no quotes.
fn is_key(name: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(is_letter)
}
