//! The program, as a user calls it.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod cli;
mod first_steps;
mod served;
mod studio;
mod watch;
