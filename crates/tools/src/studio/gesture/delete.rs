//! Things that are taken away, with all that cannot stand without them.

use std::collections::BTreeSet;

use super::super::new_names::named;
use super::super::reference::{Reference, references};
use super::rename::path_of;
use super::{Editing, Refusal};

/// Most rounds in which what an error names is taken away: each takes one thing at least.
const ROUNDS: usize = 10_000;

/// Takes things away by their names, and markers by their paths. What refers to them goes along, as far
/// as the file would have an error otherwise, and points of ground that only deleted joints used. The
/// value of a deleted parameter takes its place.
pub(super) fn delete(editing: &mut Editing, names: &[String]) -> Result<(), Refusal> {
    if names.is_empty() {
        return Err("choose what is to be taken away".into());
    }
    let before = references(&editing.text);
    for name in names {
        path_of(&editing.text, name)?;
    }
    for name in names {
        // It may be gone with another one.
        let Ok(path) = path_of(&editing.text, name) else {
            continue;
        };
        let path: Vec<&str> = path.iter().map(String::as_str).collect();
        if let ["parameters", name] = path[..] {
            put_value_in_place(editing, name);
        }
        editing.text.remove(&path);
    }
    for _ in 0..ROUNDS {
        if !delete_faulty(editing)? {
            break;
        }
    }
    delete_points_of_ground(editing, &before);
    Ok(())
}

/// Takes away what the errors of the file name; returns whether there was any.
fn delete_faulty(editing: &mut Editing) -> Result<bool, Refusal> {
    let errors = editing.errors();
    let Some(first) = errors.first() else {
        return Ok(false);
    };
    let keys = editing.text.places().keys;
    let mut faulty = BTreeSet::new();
    for error in &errors {
        let Some(label) = error.labels.first() else {
            continue;
        };
        let at = label.span.start;
        let before = keys.partition_point(|key| key.place.start <= at);
        if let Some(key) = before.checked_sub(1).and_then(|index| keys.get(index)) {
            let path: Vec<&str> = key.path.iter().map(String::as_str).collect();
            match path[..] {
                ["outputs", list] => {
                    let elements = (0..).map_while(|index| editing.text.element(&path, index));
                    let index = elements.take_while(|place| place.end <= at).count();
                    faulty.insert((vec!["outputs".to_owned(), list.to_owned()], Some(index)));
                }
                ["bodies", _, "shapes", _, ..] => {
                    let shape = path[..4].iter().map(|&part| part.to_owned());
                    faulty.insert((shape.collect(), None));
                }
                ["ground", "shapes", _, ..] => {
                    let shape = path[..3].iter().map(|&part| part.to_owned());
                    faulty.insert((shape.collect(), None));
                }
                [section, name, ..] if named().any(|known| known == section) => {
                    faulty.insert((vec![section.to_owned(), name.to_owned()], None));
                }
                _ => {}
            }
        }
    }
    if faulty.is_empty() {
        return Err(first.message.clone().into());
    }
    // The last elements of a list first, whose places do not move then.
    for (path, element) in faulty.into_iter().rev() {
        let path: Vec<&str> = path.iter().map(String::as_str).collect();
        match element {
            Some(index) => {
                editing.text.remove_element(&path, index);
                // An empty list of bodies or reactions leaves all of them out.
                if path == ["outputs", "markers"] && editing.text.element(&path, 0).is_none() {
                    editing.text.remove(&path);
                }
            }
            None => editing.text.remove(&path),
        }
    }
    Ok(true)
}

/// Takes away the points of ground that joints used which are gone, and nothing uses any more.
fn delete_points_of_ground(editing: &mut Editing, before: &[Reference]) {
    let after = references(&editing.text);
    let used: BTreeSet<&str> = (before.iter())
        .filter(|found| match &found.path[..] {
            [section, joint, ..] => section == "joints" && !editing.text.has(&["joints", joint]),
            _ => false,
        })
        .filter_map(|found| found.name.strip_prefix("ground."))
        .collect();
    for marker in used {
        let path = format!("ground.{marker}");
        if !after.iter().any(|found| found.is_of(&path)) {
            editing.text.remove(&["ground", "markers", marker]);
        }
    }
}

/// Puts the value of a parameter where its name stands.
fn put_value_in_place(editing: &mut Editing, name: &str) {
    let own = ["parameters", name];
    let whole = ["parameters", name, "value"];
    let value = editing.text.get(&whole).or_else(|| editing.text.get(&own));
    let Some(value) = value.map(str::to_owned) else {
        return;
    };
    let inside = value.trim_matches(['"', '\'']);
    let is_plain = inside
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "._".contains(c));
    let inside = if is_plain {
        inside.to_owned()
    } else {
        format!("({inside})")
    };
    let places = references(&editing.text).into_iter();
    let places = places.filter(|found| found.name == name && !found.is_in(&own));
    let parts: Vec<_> = places
        .map(|found| match found.alone {
            Some(alone) => (alone, value.clone()),
            None => (found.place, inside.clone()),
        })
        .collect();
    editing.text.replace_all(&parts);
}
