//! Names of a source as names of a mechanism file.

use std::collections::{BTreeSet, HashMap};

use biela::mechanism::{COMPONENTS, is_taken};

/// Length of a name that stays legible.
const LONGEST: usize = 60;

/// Names that are given, each once.
#[derive(Debug)]
pub(super) struct Names {
    given: BTreeSet<String>,
    /// Next number to try after a name that was given already.
    next: HashMap<String, usize>,
    /// Whether they are those of markers.
    of_markers: bool,
}

impl Names {
    /// Names of bodies, joints, drivers and the like, which share one space.
    pub(super) fn shared() -> Self {
        Self::new(false)
    }

    /// Names of the markers of one body.
    pub(super) fn of_markers() -> Self {
        Self::new(true)
    }

    fn new(of_markers: bool) -> Self {
        Self {
            given: BTreeSet::new(),
            next: HashMap::new(),
            of_markers,
        }
    }

    /// Returns a legal name that is not given yet: the source's own if that is possible. `word`
    /// stands in for a name without letters, and tells names apart.
    pub(super) fn give(&mut self, name: &str, word: &str) -> String {
        let base = legal(name, word);
        if self.is_free(&base) {
            self.given.insert(base.clone());
            return base;
        }
        let next = self.next.entry(base.clone()).or_insert(2);
        loop {
            let candidate = format!("{base}_{next}");
            *next += 1;
            if self.given.insert(candidate.clone()) {
                return candidate;
            }
        }
    }

    fn is_free(&self, name: &str) -> bool {
        let is_component = self.of_markers && COMPONENTS.as_flattened().contains(&name);
        !is_taken(name) && !is_component && !self.given.contains(name)
    }
}

/// Returns the letters, digits and `_` of a name, with `_` for all else between them.
fn legal(name: &str, word: &str) -> String {
    let mut legal = String::new();
    for c in name.chars() {
        if legal.len() >= LONGEST {
            break;
        }
        if c.is_ascii_alphanumeric() || c == '_' {
            legal.push(c);
        } else if !legal.ends_with('_') && !legal.is_empty() {
            legal.push('_');
        }
    }
    let trimmed = legal.trim_end_matches('_');
    match trimmed.chars().next() {
        None => word.to_owned(),
        Some(c) if c.is_ascii_alphabetic() => trimmed.to_owned(),
        Some('_') => format!("{word}{trimmed}"),
        Some(_) => format!("{word}_{trimmed}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_if_they_are_legal_and_free() {
        let mut names = Names::shared();
        for (name, given) in [
            ("crank", "crank"),
            ("Part 001 #2", "Part_001_2"),
            ("2_bars", "body_2_bars"),
            ("crank", "crank_2"),
            ("crank", "crank_3"),
            ("crank_2", "crank_2_2"),
            ("sin", "sin_2"),
            ("", "body"),
            ("ñ", "body_2"),
            ("_a", "body_a"),
        ] {
            assert_eq!(names.give(name, "body"), given);
        }
        let mut markers = Names::of_markers();
        assert_eq!(markers.give("x", "point"), "x_2");
        assert_eq!(markers.give("A", "point"), "A");
    }
}
