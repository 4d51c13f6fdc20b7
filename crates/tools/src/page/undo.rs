//! States of a mechanism that its reader can undo and redo.

use std::sync::Arc;

use biela::dynamics::MotionState;
use biela::mechanism::Mechanism;

/// Most states that can be undone.
const MOST_KEPT: usize = 200;

/// A state to which the reader can return.
#[derive(Clone)]
pub(super) struct Kept {
    pub(super) mechanism: Arc<Mechanism>,
    pub(super) now: MotionState,
    pub(super) start: MotionState,
}

/// The states before the present one, and those that were undone.
#[derive(Default)]
pub(super) struct UndoHistory {
    /// The states before, the oldest first.
    kept: Vec<Kept>,
    /// The states in the order in which they were undone.
    undone: Vec<Kept>,
}

impl UndoHistory {
    /// Keeps a state, unless it is at the pose of the state kept last.
    pub(super) fn keep(&mut self, now: Kept) {
        if self
            .kept
            .last()
            .is_none_or(|kept| kept.now.pose != now.now.pose)
        {
            if self.kept.len() == MOST_KEPT {
                self.kept.remove(0);
            }
            self.kept.push(now);
            self.undone.clear();
        }
    }

    /// Returns the last state that is at another pose than the present one, which can be redone.
    pub(super) fn undo(&mut self, now: Kept) -> Option<Kept> {
        while let Some(kept) = self.kept.pop() {
            if kept.now.pose != now.now.pose {
                self.undone.push(now);
                return Some(kept);
            }
        }
        None
    }

    /// Returns the state that was undone last; the present one can be undone.
    pub(super) fn redo(&mut self, now: Kept) -> Option<Kept> {
        let undone = self.undone.pop()?;
        self.kept.push(now);
        Some(undone)
    }
}
