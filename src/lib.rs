//! Placeholder front page.
#[cfg(feature = "cli")]
pub mod cli;
pub mod fmi;
pub mod kinematics;
pub mod mechanism;
