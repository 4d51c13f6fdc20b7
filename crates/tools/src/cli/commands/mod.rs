//! The commands of the program, one file each; what several of them share is beside this folder.

pub(super) mod balance;
pub(super) mod check;
pub(super) mod completions;
pub(super) mod convert;
pub(super) mod draw;
pub(super) mod export;
pub(super) mod import;
pub(super) mod linearize;
pub(super) mod new;
pub(super) mod page;
pub(super) mod platforms;
pub(super) mod range;
pub(super) mod report;
pub(super) mod run;
pub(super) mod schema;
pub(super) mod studio;
pub(super) mod tolerance;
pub(super) mod watch;
