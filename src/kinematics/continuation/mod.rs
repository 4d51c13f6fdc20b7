//! Continuation: tracks a path from one pose to the next without a change of the assembly mode.
//!
//! The tracker carries the mechanism along the path in sub-steps. Each starts from the tangent and
//! curvature of the motion, ends with Newton–Raphson, and is accepted with the
//! [certificate](super::certificate) that one and only one continuous motion joins its two ends;
//! otherwise it is shortened by the ratio that the certificate gives.

mod budget;
mod driver_bounds;
mod outcome;
mod stops;
mod sub_step;
mod tracker;

pub use budget::Budget;
pub use outcome::{Blocked, Progress, Reason};
pub(super) use stops::check_pose;
pub use sub_step::{PathWatch, SubStep};
pub(super) use tracker::{PathTracker, most_substeps};
