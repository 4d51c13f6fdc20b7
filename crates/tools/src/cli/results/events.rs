//! The events of a run as CSV: one row per event.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::output::{tell_written, write};
use super::recorder::Recorder;
use crate::cli::told::error::Error;
use biela::dynamics::{Event, EventKind, Motion};

/// Writes the events of a free motion: time, kind, the name of the stop, the joint or the friction, and
/// at an impact the speed before, in SI units.
pub(in crate::cli) struct Events {
    pub(in crate::cli) path: PathBuf,
}

impl Recorder for Events {
    fn add(&mut self, _motion: &Motion) -> Result<(), Error> {
        Ok(())
    }

    fn finish(self: Box<Self>, motion: &Motion, events: &[Event]) -> Result<(), Error> {
        let mut rows = ["time", "kind", "name", "speed"].join(",") + "\n";
        for Event { time, force, kind } in events {
            let name = &motion.mechanism().forces[*force].name;
            let _ = write!(rows, "{time:?},{},{name},", kind.as_str());
            if let EventKind::Impact { speed } = kind {
                let _ = write!(rows, "{speed:?}");
            }
            rows.push('\n');
        }
        write(&self.path, rows.as_bytes())?;
        tell_written(&self.path);
        Ok(())
    }
}
