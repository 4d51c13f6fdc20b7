//! A number of the file that becomes a parameter.

use super::super::unit_of::unit_of;
use super::put::path_of_value;
use super::rename::check_word;
use super::{Editing, Refusal};
use biela::mechanism::constant;

/// Makes the number at `path`, or an `element` of the list there, a parameter called `name`.
pub(super) fn parameter(
    editing: &mut Editing,
    path: &[String],
    element: Option<usize>,
    name: &str,
) -> Result<(), Refusal> {
    let path = path_of_value(path)?;
    if path.first() == Some(&"parameters") {
        return Err("this is a parameter already: rename it".into());
    }
    let place = editing.text.number(&path, element);
    let place = place.ok_or("the file has no number there: give it one first")?;
    let old = editing.text.as_str()[place.clone()].to_owned();
    if !is_number(&old) {
        return Err(format!(
            "only a number becomes a parameter, and `{}` is none",
            old.trim_matches('"')
        )
        .into());
    }
    let unit = unit_of(editing.drawn, &path, element);
    check_name(editing, name)?;
    editing.text.replace(place, &format!("\"{name}\""));
    add_parameter(editing, name, &old, unit);
    Ok(())
}

/// Refuses what is no name, and a name that something has.
pub(super) fn check_name(editing: &Editing, name: &str) -> Result<(), Refusal> {
    check_word(name)?;
    if editing.names.is_taken(name) {
        return Err(format!("the name `{name}` is taken: choose another one").into());
    }
    Ok(())
}

/// Adds a parameter with its value, which is TOML.
pub(super) fn add_parameter(editing: &mut Editing, name: &str, value: &str, unit: Option<&str>) {
    let display = match unit {
        Some("m") => ", display = \"mm\"",
        Some("rad") => ", display = \"deg\"",
        _ => "",
    };
    let unit = unit
        .map(|unit| format!(", unit = \"{unit}\""))
        .unwrap_or_default();
    let value = format!("{{ value = {value}{unit}{display} }}");
    editing.text.set(&["parameters", name], &value);
}

/// Returns whether a value is a number, or one in a unit, such as `"60*deg"`.
pub(super) fn is_number(value: &str) -> bool {
    let is_plain = |text: &str| text.trim().replace('_', "").parse::<f64>().is_ok();
    let inside = value
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    match inside.map(|inside| inside.split_once('*')) {
        None => is_plain(value),
        Some(None) => is_plain(value.trim_matches('"')),
        Some(Some((number, unit))) => is_plain(number) && constant(unit.trim()).is_some(),
    }
}
