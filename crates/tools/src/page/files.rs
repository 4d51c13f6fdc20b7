//! The files that a reader has opened one after the other, for undo.

use serde_json::{Value, json};

use super::session::Session;

/// Most files to which undo returns.
const MOST: usize = 20;

/// The sessions of files that were applied: the present one, those before it and those undone.
#[derive(Default)]
pub(super) struct Files {
    before: Vec<Session>,
    pub(super) now: Option<Session>,
    /// The sessions in the order in which they were undone.
    undone: Vec<Session>,
}

impl Files {
    /// Goes on with another session; with `kept`, undo returns to the present one.
    pub(super) fn open(&mut self, session: Session, kept: bool) {
        self.undone.clear();
        let left = self.now.replace(session);
        if kept {
            if self.before.len() == MOST {
                self.before.remove(0);
            }
            self.before.extend(left);
        } else {
            self.before.clear();
        }
    }

    /// Forgets what was undone, as the present file changes.
    pub(super) fn change(&mut self) {
        self.undone.clear();
    }

    /// Undoes a move of the present file or, without one, its opening.
    pub(super) fn undo(&mut self) -> Value {
        if self.now.as_mut().is_some_and(Session::undo) {
            return json!({ "done": true });
        }
        let back = self.before.pop();
        exchange(&mut self.now, back, &mut self.undone)
    }

    /// Returns to what [`undo`](Self::undo) left.
    pub(super) fn redo(&mut self) -> Value {
        if self.now.as_mut().is_some_and(Session::redo) {
            return json!({ "done": true });
        }
        let next = self.undone.pop();
        exchange(&mut self.now, next, &mut self.before)
    }
}

/// Goes on with another session, if there is one, and keeps the present one; answers with its page
/// and file.
fn exchange(now: &mut Option<Session>, other: Option<Session>, kept: &mut Vec<Session>) -> Value {
    let Some(session) = other else {
        return json!({ "done": false });
    };
    let answer = json!({
        "done": true,
        "page": session.description(),
        "file": { "text": session.source().text() },
    });
    kept.extend(now.replace(session));
    answer
}
