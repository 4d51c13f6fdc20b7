//! Results, to files and to stdout.
//!
//! | file | subject |
//! |---|---|
//! | `output` | the file of a result, or stdout |
//! | `new_file` | files that are written and not overwritten |
//! | `stdout` | the path `-` |
//! | `recorder` | consumers of the rows of a run |
//! | `column` | choices among its columns |
//! | `csv` | a run as CSV |
//! | `xlsx` | a run as an Excel file |
//! | `events` | the events of a run as CSV |
//! | `plot` | a run as a chart |
//! | `film` | a run as a page or a picture that moves |
//! | `picture` | pictures in the format of their file |
//! | `form` | the form in which an FMU is packed |

pub(super) mod column;
pub(super) mod csv;
pub(super) mod events;
pub(super) mod film;
pub(super) mod form;
pub(super) mod new_file;
pub(super) mod output;
pub(super) mod picture;
pub(super) mod plot;
pub(super) mod recorder;
pub(super) mod stdout;
pub(super) mod xlsx;
