//! A run as an Excel file: one row per time, one column per quantity.

use std::path::PathBuf;

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, XlsxError};

use super::column::Output;
use super::output::{tell_written, write};
use super::recorder::Recorder;
use crate::cli::told::error::Error;
use biela::dynamics::{Event, Motion};

/// Most rows of a sheet, with the line of names.
pub(in crate::cli) const MOST_ROWS: u64 = 1_048_576;
/// Most columns of a sheet, with the times.
pub(in crate::cli) const MOST_COLUMNS: usize = 16_384;

/// Collects rows, and writes them at the end.
pub(in crate::cli) struct Xlsx {
    path: PathBuf,
    columns: Vec<Output>,
    rows: Vec<Vec<f64>>,
}

impl Xlsx {
    pub(in crate::cli) fn new(path: PathBuf, columns: Vec<Output>) -> Self {
        Self {
            path,
            columns,
            rows: Vec::new(),
        }
    }

    /// Returns the file. The same rows give the same bytes.
    fn content(&self, name: &str) -> Result<Vec<u8>, XlsxError> {
        let mut workbook = Workbook::new();
        // Otherwise the file has the time at which it is written.
        let date = ExcelDateTime::from_ymd(1980, 1, 1)?;
        workbook.set_properties(&DocProperties::new().set_creation_datetime(&date));
        let sheet = workbook.add_worksheet();
        // Longer names, and some characters, are none of a sheet; names of mechanisms have letters.
        sheet.set_name(name.chars().take(31).collect::<String>())?;
        sheet.set_freeze_panes(1, 1)?;
        let bold = Format::new().set_bold();
        let names = std::iter::once("time").chain(self.columns.iter().map(|c| &*c.name));
        for (column, name) in (0..).zip(names) {
            sheet.write_string_with_format(0, column, name, &bold)?;
            sheet.set_column_width(column, 1.1 * name.len().max(9) as f64)?;
        }
        for (row, values) in (1..).zip(&self.rows) {
            // A sheet has no numbers that are not finite: their cells stay empty.
            for (column, value) in (0..).zip(values).filter(|(_, value)| value.is_finite()) {
                sheet.write_number(row, column, *value + 0.0)?;
            }
        }
        workbook.save_to_buffer()
    }
}

impl Recorder for Xlsx {
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        let time = std::iter::once(motion.pose().time);
        let values = self.columns.iter().map(|column| motion.value(column));
        self.rows.push(time.chain(values).collect());
        Ok(())
    }

    fn finish(self: Box<Self>, motion: &Motion, _events: &[Event]) -> Result<(), Error> {
        let content = self.content(&motion.mechanism().name);
        let content = content.map_err(|error| Error::Usage(format!("--output: {error}")))?;
        write(&self.path, &content)?;
        tell_written(&self.path);
        Ok(())
    }
}
