//! The commands as a user types them; `watch` and `studio` have tests of their own.

mod check;
mod draw;
mod exit_codes;
mod export;
mod free;
mod help;
mod import;
mod input;
mod new;
mod overwriting;
mod pictures_of_runs;
pub(crate) mod program;
mod range;
mod report;
mod run;
mod settings;
mod tolerance;
