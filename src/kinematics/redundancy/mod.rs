//! Rows of Phi that follow from the others, and the rows that are solved instead.

mod choice;
mod closing;
mod contradiction;
mod rank;
mod set_aside;

pub use choice::Redundancy;
pub(super) use set_aside::SetAside;
