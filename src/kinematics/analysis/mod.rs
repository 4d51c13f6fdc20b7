//! Questions about a mechanism that no step asks.
//!
//! | file | question |
//! |---|---|
//! | [`sensitivity`] | the derivatives of a motion by drivers and parameters |
//! | [`range`] | the values that a driver can reach |
//! | [`modes`] | the other poses for the same values of the drivers |
//! | [`geometry_check`] | wheels whose distance does not fit, cams that a follower cannot follow |

mod geometry_check;
mod modes;
mod range;
mod sensitivity;

pub use geometry_check::{Misfit, MisfitKind};
pub use modes::{Mode, Modes};
pub use range::{ChangePoint, End, Range, RangeSettings, Sample};
pub use sensitivity::{Direction, Sensitivity};
