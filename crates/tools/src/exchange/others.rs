//! Entries of a source that a reader does not take.

use std::collections::BTreeSet;

use super::draft::Draft;
use super::error::start_of;
use super::note::Note;

/// Most names that a note lists.
const MOST: usize = 20;

/// Names of entries that a reader does not take.
#[derive(Debug, Default)]
pub(super) struct Others {
    seen: BTreeSet<&'static str>,
    unknown: BTreeSet<String>,
}

impl Others {
    /// Adds an entry that does not change the mechanism.
    pub(super) fn see(&mut self, name: &'static str) {
        self.seen.insert(name);
    }

    /// Adds an entry whose meaning is not known.
    pub(super) fn miss(&mut self, place: &str, name: &str) {
        if self.unknown.len() < MOST {
            let name = format!("{place} {name}");
            self.unknown.insert(start_of(name.trim()));
        }
    }

    /// Adds an entry unless it is one of those that are taken.
    pub(super) fn sort(&mut self, place: &str, name: &str, taken: &[&str], seen: &[&'static str]) {
        match seen.iter().find(|known| **known == name) {
            Some(known) => self.see(known),
            None if taken.contains(&name) => {}
            None => self.miss(place, name),
        }
    }

    /// Tells the names.
    pub(super) fn note(self, draft: &mut Draft) {
        if !self.seen.is_empty() {
            let what: Vec<&str> = self.seen.into_iter().collect();
            draft.note(Note::Display {
                what: what.join(", "),
            });
        }
        if !self.unknown.is_empty() {
            let what: Vec<String> = self.unknown.into_iter().collect();
            draft.note(Note::UnknownKeys {
                what: what.join(", "),
            });
        }
    }
}
