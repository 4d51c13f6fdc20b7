//! A thing that gets another name, everywhere in the file.

use std::ops::Range;

use super::super::new_names::named;
use super::super::reference::references;
use super::{Editing, Refusal};
use crate::write::TomlText;

/// Gives a thing, or a marker by its path `body.marker`, another name, in keys, references and
/// expressions. Of a marker the new name is that of the marker alone, or its path on the same body.
pub(super) fn rename(editing: &mut Editing, old: &str, new: &str) -> Result<(), Refusal> {
    let new = match old.split_once('.') {
        Some((body, _)) => {
            let own = new
                .strip_prefix(body)
                .and_then(|rest| rest.strip_prefix('.'));
            own.unwrap_or(new)
        }
        None => new,
    };
    if old.rsplit('.').next() == Some(new) {
        return Ok(());
    }
    let path = path_of(&editing.text, old)?;
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    check_word(new)?;
    let (_, owner) = path.split_last().unwrap_or((&"", &[]));
    let sibling: Vec<&str> = owner.iter().copied().chain([new]).collect();
    let is_marker = old.contains('.');
    if editing.text.has(&sibling) || !is_marker && editing.names.is_taken(new) {
        return Err(format!("the name `{new}` is taken: choose another one").into());
    }
    let before = editing.text.as_str().to_owned();
    renamed(&mut editing.text, &path, old, new);
    // A name that means something else at a place, such as `theta` in a profile, would be lost there.
    let mut back = editing.text.clone();
    let new_path: Vec<&str> = sibling;
    let new_name = match old.rsplit_once('.') {
        Some((body, _)) => format!("{body}.{new}"),
        None => new.to_owned(),
    };
    renamed(&mut back, &new_path, &new_name, path.last().unwrap_or(&""));
    if back.as_str() != before {
        if let Some(error) = editing.errors().into_iter().next() {
            return Err(error.message.into());
        }
        return Err(format!(
            "`{new}` means something else in an expression of this file: choose another name"
        )
        .into());
    }
    Ok(())
}

/// Refuses what is no name in any place.
pub(super) fn check_word(name: &str) -> Result<(), Refusal> {
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if is_word {
        Ok(())
    } else {
        Err(format!("`{name}` is no name: a name is a letter, then letters, digits and `_`").into())
    }
}

/// Returns the path in the file of a thing by its name, or of a marker or a shape by its path.
pub(super) fn path_of(text: &TomlText, name: &str) -> Result<Vec<String>, Refusal> {
    let owned = |path: &[&str]| path.iter().map(|&part| part.to_owned()).collect();
    if let Some((body, marker)) = name.split_once('.') {
        let paths = ["markers", "shapes"].map(|list| match body {
            "ground" => vec!["ground", list, marker],
            _ => vec!["bodies", body, list, marker],
        });
        let mut paths = paths.iter();
        let path = paths.find(|path| text.has(path));
        return match path {
            Some(path) => Ok(owned(path)),
            None => Err(format!("there is no marker `{name}`").into()),
        };
    }
    let section = named().find(|section| text.has(&[section, name]));
    match section {
        Some(section) => Ok(owned(&[section, name])),
        None => Err(format!("there is nothing called `{name}`").into()),
    }
}

/// Renames the thing at a path, which references call `old`: its keys and all references.
fn renamed(text: &mut TomlText, path: &[&str], old: &str, new: &str) {
    let keys = text.places().keys.into_iter();
    let keys = keys.filter(|key| key.path.iter().eq(path.iter()));
    let own = keys.map(|key| (key.place, new.to_owned()));
    let length = old.len() - old.rfind('.').map_or(0, |at| at + 1);
    let named = references(text)
        .into_iter()
        .filter(|found| found.is_of(old) && found.implied < old.len());
    let named = named.map(|found| {
        let end = found.place.start + old.len() - found.implied;
        (end - length..end, new.to_owned())
    });
    let mut parts: Vec<(Range<usize>, String)> = own.chain(named).collect();
    parts.sort_by_key(|(place, _)| place.start);
    text.replace_all(&parts);
}
