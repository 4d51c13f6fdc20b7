//! Forms of what is selected: its numbers in the file, what it is joined to, what can be done with it.
//!
//! | file | subject |
//! |---|---|
//! | `form` | the keys that a table may have |
//! | `rows` | the rows of a form |
//! | `actions` | gestures that fit |

mod actions;
mod form;
mod rows;

use serde_json::{Value, json};

use super::document::Document;
use super::gesture::{Editing, Refusal};
use super::new_names::named;
use actions::Actions;
use rows::Rows;

/// Decimals of lengths.
const DECIMALS: usize = 4;

/// Describes a thing by its name, bodies by theirs, a point by the paths of its markers, or the mechanism
/// if there is no name: `title`, `kind`, `rows` and `actions`.
///
/// A row has a `label`, the `path` of its value, with the `element` of a list there, the `value` as it
/// stands in the file, empty if it is left out, `shown` in mm or degrees, `unit`, `type` (`number`,
/// `text`, `choice`, `flag`, `length` or `read`), `choices`, `help`, and the `group` in which it is folded
/// away. A gesture of `put` sets it, that of `length` a distance of its two `markers`. An action has
/// a `label` and a `gesture`; one that cannot be done now says `why`. A gesture with a `name` that is
/// null, or a `rename` without `new`, asks for it.
///
/// # Errors
///
/// The text has an error, or there is no such thing.
pub(super) fn inspect(document: &Document, names: &[&str]) -> Result<Value, Refusal> {
    let editing = document.editing(DECIMALS)?;
    let (title, kind) = title(&editing, names)?;
    let (mut rows, mut actions) = (Rows::new(&editing), Actions::new(&editing));
    match (kind, names) {
        ("mechanism", _) => {
            rows.mechanism()?;
            actions.mechanism();
        }
        ("point", markers) => {
            for marker in markers {
                rows.marker(marker, marker);
            }
            rows.joints_at(markers)?;
            actions.point(markers)?;
        }
        ("body", names @ [_, _, ..]) => actions.bodies(names)?,
        ("body", [name, ..]) => {
            rows.body(name)?;
            actions.body(name)?;
        }
        (_, [name, ..]) => {
            let section = section_of(&editing, name).unwrap_or_default();
            rows.table(&[section, name]);
            actions.thing(section, name);
        }
        _ => {}
    }
    Ok(json!({
        "title": title,
        "kind": kind,
        "rows": rows.list,
        "actions": actions.list,
    }))
}

/// Returns the section of the file that has a thing.
fn section_of(editing: &Editing, name: &str) -> Option<&'static str> {
    let mut sections = named();
    sections.find(|section| editing.text.has(&[section, name]))
}

fn title(editing: &Editing, names: &[&str]) -> Result<(String, &'static str), Refusal> {
    let Some(name) = names.first() else {
        let name = editing.text.get(&["name"]).unwrap_or_default();
        return Ok((format!("Mechanism {}", name.trim_matches('"')), "mechanism"));
    };
    if name.contains('.') {
        for name in names {
            editing.marker(name)?;
        }
        return Ok((format!("Point {}", names.join(", ")), "point"));
    }
    let (noun, kind) = match section_of(editing, name) {
        Some("parameters") => ("Parameter", "parameter"),
        Some("bodies") if names.len() > 1 => ("Bodies", "body"),
        Some("bodies") => ("Body", "body"),
        Some("joints") => ("Joint", "joint"),
        Some("constraints") => ("Constraint", "constraint"),
        Some("drivers") => ("Driver", "driver"),
        Some("freedoms") => ("Freedom", "freedom"),
        Some("measures") => ("Measure", "measure"),
        Some("forces") => ("Force", "force"),
        Some("stops") => ("Stop", "stop"),
        Some("contacts") => ("Contact", "contact"),
        Some("functions") => ("Function", "function"),
        Some("inputs") => ("Input", "input"),
        Some("friction") => ("Friction", "friction"),
        _ => return Err(format!("there is nothing called `{name}`").into()),
    };
    let name = names.join(", ");
    Ok((format!("{noun} {name}"), kind))
}
