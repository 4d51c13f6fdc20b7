//! Following a path from one pose to the next without changing the assembly mode.
//!
//! The mechanism is carried along the path in sub-steps. Each starts from the tangent and
//! curvature of the motion, ends with Newton–Raphson, and is accepted with the
//! [certificate](super::certificate) that one and only one continuous motion joins its two ends;
//! else it is shortened by as much as the certificate finds it too long.

mod drivers;
mod outcome;
mod step;
mod tracker;

pub use outcome::{Blocked, Progress, Reason};
