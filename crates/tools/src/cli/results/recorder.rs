//! Consumers of the rows of a run.

use crate::cli::told::error::Error;
use biela::dynamics::Motion;

/// A consumer of the rows of a run, which writes one result.
pub(in crate::cli) trait Recorder {
    /// Adds the row of the current time.
    fn add(&mut self, motion: &Motion) -> Result<(), Error>;

    /// Writes what remains to be written, after the last row; `events` are the times of the free
    /// motion's events \[s\].
    fn finish(self: Box<Self>, motion: &Motion, events: &[f64]) -> Result<(), Error>;
}
