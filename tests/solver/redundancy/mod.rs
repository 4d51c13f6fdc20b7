//! Constraints that say nothing new or contradict each other, and drivers that are too few, too
//! many or on the wrong things.

mod bumps;
mod chains;
mod cranks;
mod endings;
mod mechanisms;
mod play;
mod rings;
mod twins;
mod verdicts;
mod warning;
