//! Tables in CSV files.

mod file;
mod separated;

pub(super) use file::MOST_POINTS;
pub use file::TableFile;
pub use separated::{Separated, comma_hint};
