//! Things that the user gives: the mechanism and its files, values, times.
//!
//! | file | subject |
//! |---|---|
//! | `input` | a mechanism file, read with its diagnostics |
//! | `input_files` | the files that a command reads, which no result overwrites |
//! | `assigning` | options that assign expressions to names |
//! | `settings` | other values of parameters and starts than the file's |
//! | `conditions` | settings, and motions of drivers |
//! | `signals` | values of drivers and of inputs of forces over time |
//! | `times` | the times of a run |
//! | `bounds` | values of a driver between which it is followed |

pub(super) mod assigning;
pub(super) mod bounds;
pub(super) mod conditions;
pub(super) mod input;
pub(super) mod input_files;
pub(super) mod settings;
pub(super) mod signals;
pub(super) mod times;
