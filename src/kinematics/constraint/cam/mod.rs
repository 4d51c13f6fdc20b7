//! Cam pairs: a follower on a cam's contour.
//!
//! The contour is given by its polar radius R(θ) in the cam marker's frame. A knife edge is a
//! point of the contour; its polar angle follows from the pose, so that one relation is enough. A
//! roller and a flat face touch the contour where its normal is theirs: the contact's polar
//! angle is an unknown that the joint brings with it, together with a second relation. In both
//! pairs that relation is the derivative of the first with respect to the contact's angle, up to
//! a factor: moving the contact along the contour does not move the follower.

mod contour;
mod flat;
mod knife;
mod roller;

pub use contour::Contour;
pub use flat::{FlatContact, FlatFace};
pub use knife::KnifeEdge;
pub use roller::{Roller, RollerContact};
