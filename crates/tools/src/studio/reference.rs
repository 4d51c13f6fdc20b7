//! The names by which the texts of a file refer to its things: in expressions, to markers, in lists.

use std::ops::Range;

use crate::write::{TomlText, WrittenText};
use biela::mechanism::names_in;

/// Keys whose texts are words or are for the reader; they refer to nothing in the file.
const WORDS: [&str; 21] = [
    "author",
    "columns",
    "coordinate",
    "copyright",
    "description",
    "display",
    "ends",
    "extrapolation",
    "file",
    "follower",
    "format",
    "indeterminate",
    "law",
    "license",
    "name",
    "points",
    "rates",
    "side",
    "type",
    "unit",
    "version",
];

/// A name in a text.
#[derive(Debug)]
pub(super) struct Reference {
    /// Path of the text.
    pub(super) path: Vec<String>,
    /// Names joined by points, such as `crank.A`.
    pub(super) name: String,
    /// Length of the part of the name that is not written: shapes name markers of their body alone.
    pub(super) implied: usize,
    pub(super) place: Range<usize>,
    /// Place of the whole text with its quotes, if it is nothing but the name.
    pub(super) alone: Option<Range<usize>>,
}

impl Reference {
    /// Returns whether the name is that of a thing, `arm`, or of a marker, `arm.A`, or begins with it.
    pub(super) fn is_of(&self, name: &str) -> bool {
        let rest = self.name.strip_prefix(name);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }

    /// Returns whether it is part of the thing with this path.
    pub(super) fn is_in(&self, path: &[&str]) -> bool {
        let own = self.path.iter().take(path.len());
        own.eq(path.iter())
    }
}

/// Returns all references of a file, in its order.
pub(super) fn references(text: &TomlText) -> Vec<Reference> {
    let texts = text.places().texts;
    let found = texts
        .into_iter()
        .filter(|found| !is_word(found, text.as_str()));
    let named = found.flat_map(|found| {
        let inside = &text.as_str()[found.inside.clone()];
        let names = names_in(inside).into_iter().filter_map(|name| {
            let place = found.inside.start + name.start..found.inside.start + name.end;
            let is_alone = inside.trim() == &inside[name.clone()];
            let name = inside[name].to_owned();
            let is_variable = variable(&found.path) == Some(&*name);
            let owner = owner_of_markers(&found.path);
            let implied = owner.map_or_else(String::new, |owner| format!("{owner}."));
            (!is_variable).then(|| Reference {
                path: found.path.clone(),
                implied: implied.len(),
                name: implied + &name,
                place,
                alone: is_alone.then(|| found.place.clone()),
            })
        });
        names.collect::<Vec<_>>()
    });
    named.collect()
}

/// Returns whether a text refers to nothing.
fn is_word(found: &WrittenText, text: &str) -> bool {
    let path: Vec<&str> = found.path.iter().map(String::as_str).collect();
    match path[..] {
        // The law of a coupling is an expression, those of motions and profiles are words.
        ["joints", _, "law"] => false,
        [.., "phase"] => &text[found.inside.clone()] == "drawn",
        // Markers and parameters may have any of these names.
        ["bodies", _, "markers", ..] | ["ground", "markers", ..] | ["parameters", _] => false,
        [.., key] => WORDS.contains(&key),
        [] => true,
    }
}

/// Returns the body, or ground, whose markers a text at a path names alone: the corners of a shape.
fn owner_of_markers(path: &[String]) -> Option<&str> {
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    let (owner, rest) = match path[..] {
        ["ground", "shapes", _, ref rest @ ..] => ("ground", rest),
        ["bodies", body, "shapes", _, ref rest @ ..] => (body, rest),
        _ => return None,
    };
    let is_corner = matches!(
        rest,
        ["disc" | "bar" | "outline" | "hole" | "wall"] | ["outline", "marker"]
    );
    is_corner.then_some(owner)
}

/// Returns the variable of the expression at a path, which is no name of the file.
fn variable(path: &[String]) -> Option<&'static str> {
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    match path[..] {
        ["joints", _, "profile"] => Some("theta"),
        ["joints", _, "law"] => Some("x"),
        ["joints", _, "x" | "y"] => Some("s"),
        _ => None,
    }
}
