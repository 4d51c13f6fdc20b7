//! A value of the file that is set in a form.

use serde_json::Value;

use super::super::text::TomlText;
use super::{Editing, Refusal};

/// Sets the value at `path` to the TOML in `value`, or takes it away where that is `null` or empty.
/// A word that is no TOML is taken as an expression: `2*a`.
pub(super) fn put(editing: &mut Editing, gesture: &Value) -> Result<(), Refusal> {
    let path = gesture["path"].as_array().map_or(&[][..], Vec::as_slice);
    let path: Option<Vec<&str>> = path.iter().map(Value::as_str).collect();
    let path = path.filter(|path| !path.is_empty() && path.iter().all(|name| is_key(name)));
    let Some(path) = path else {
        return Err("the gesture lacks the path of a value".into());
    };
    let value = gesture["value"].as_str().unwrap_or_default().trim();
    if value.is_empty() {
        editing.text.remove(&path);
        return Ok(());
    }
    let plain = TomlText::new(format!("value = {value}"));
    if plain.is_ok_and(|plain| plain.keys(&[]) == ["value"]) {
        editing.text.set(&path, value);
    } else {
        editing
            .text
            .set(&path, &toml_edit::Value::from(value).to_string());
    }
    Ok(())
}

/// Returns whether a word is a key that needs no quotes.
fn is_key(name: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(is_letter)
}
