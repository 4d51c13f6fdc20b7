//! New names.

use std::collections::BTreeSet;

use crate::write::{TomlText, sections};

/// Sections whose keys are no names of things.
const NAMELESS: [&str; 3] = ["ground", "outputs", "simulation"];

/// Returns the sections whose keys share one name space.
pub(super) fn named() -> impl Iterator<Item = &'static str> {
    let sections = sections().into_iter();
    sections.filter(|section| !NAMELESS.contains(section))
}

/// The names that a file gives.
pub(super) struct Names {
    /// Names of parameters, bodies, joints and the like.
    shared: BTreeSet<String>,
    /// Names of markers, of all bodies together.
    markers: BTreeSet<String>,
}

impl Names {
    /// Collects the names of a file.
    pub(super) fn of(text: &TomlText) -> Self {
        let shared = named().flat_map(|section| text.keys(&[section]));
        let mut markers: BTreeSet<String> = text.keys(&["ground", "markers"]).into_iter().collect();
        for body in text.keys(&["bodies"]) {
            markers.extend(text.keys(&["bodies", &body, "markers"]));
        }
        Self {
            shared: shared.collect(),
            markers,
        }
    }

    /// Returns a name that is not in use yet: the word, or the word with a number.
    pub(super) fn new_name(&mut self, word: &str) -> String {
        let numbered = (2..).map(|number| format!("{word}_{number}"));
        let mut names = std::iter::once(word.to_owned()).chain(numbered);
        let is_free = |name: &String| !self.shared.contains(name);
        let name = names.find(is_free).unwrap_or_default();
        self.shared.insert(name.clone());
        name
    }

    /// Returns a capital letter, maybe with a number, that no marker and no joint has.
    pub(super) fn new_letter(&mut self) -> String {
        let rounds = std::iter::once(String::new()).chain((2..).map(|number| number.to_string()));
        let mut letters =
            rounds.flat_map(|round| ('A'..='Z').map(move |letter| format!("{letter}{round}")));
        let is_free = |name: &String| !self.markers.contains(name) && !self.shared.contains(name);
        let letter = letters.find(is_free).unwrap_or_default();
        self.markers.insert(letter.clone());
        letter
    }

    /// Returns whether a name is in use for a parameter, a body, a joint or the like.
    pub(super) fn is_taken(&self, name: &str) -> bool {
        self.shared.contains(name)
    }
}
