//! Consumers of the rows of a run.

use crate::cli::told::error::Error;
use biela::dynamics::{Event, Motion};

/// A consumer of the rows of a run, which writes one result.
pub(in crate::cli) trait Recorder {
    /// Adds the row of the current time.
    fn add(&mut self, motion: &Motion) -> Result<(), Error>;

    /// Writes what remains to be written, after the last row; `events` are those of the free
    /// motion.
    fn finish(self: Box<Self>, motion: &Motion, events: &[Event]) -> Result<(), Error>;
}
