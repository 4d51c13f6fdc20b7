//! A run as CSV: one row per time, one column per quantity.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use super::column::Output;
use super::output::tell_written;
use super::recorder::Recorder;
use super::stdout::is_stdout;
use crate::cli::told::error::Error;
use biela::dynamics::{Event, Motion};

/// Writes rows as they come.
pub(in crate::cli) struct Csv {
    out: BufWriter<Box<dyn Write>>,
    path: PathBuf,
    columns: Vec<Output>,
}

impl Csv {
    /// Creates the file, or takes stdout for `-`, and writes the line of names.
    pub(in crate::cli) fn create(path: PathBuf, columns: Vec<Output>) -> Result<Self, Error> {
        let out: Box<dyn Write> = if is_stdout(&path) {
            Box::new(io::stdout().lock())
        } else {
            Box::new(File::create(&path).map_err(Error::write(&path))?)
        };
        let mut csv = Self {
            out: BufWriter::new(out),
            path,
            columns,
        };
        csv.write(|out, columns| {
            write!(out, "time")?;
            columns.iter().try_for_each(|c| write!(out, ",{}", c.name))
        })?;
        Ok(csv)
    }

    /// Writes one line.
    fn write(
        &mut self,
        line: impl FnOnce(&mut dyn Write, &[Output]) -> io::Result<()>,
    ) -> Result<(), Error> {
        line(&mut self.out, &self.columns)
            .and_then(|()| writeln!(self.out))
            .map_err(Error::write(&self.path))
    }
}

impl Recorder for Csv {
    /// Writes numbers such that reading them gives the same bits; zero has no sign.
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        self.write(|out, columns| {
            write!(out, "{:?}", motion.pose().time)?;
            let mut values = columns.iter().map(|column| motion.value(column));
            values.try_for_each(|value| write!(out, ",{:?}", value + 0.0))
        })
    }

    fn finish(mut self: Box<Self>, _motion: &Motion, _events: &[Event]) -> Result<(), Error> {
        self.out.flush().map_err(Error::write(&self.path))?;
        tell_written(&self.path);
        Ok(())
    }
}
