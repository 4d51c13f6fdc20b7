//! Cam pairs: a follower on a cam's contour.
//!
//! The polar radius R(θ) in the cam marker's frame gives the contour. A knife edge is a point of
//! the contour; the pose gives its polar angle, so that one relation suffices. A roller or a flat
//! face touches the contour where both have the same normal: the polar angle of the contact is a
//! joint unknown, with a second relation. Up to a factor, the second relation is the derivative of
//! the first with respect to this angle: a move of the contact along the contour does not move the
//! follower.

mod contour;
mod flat;
mod knife;
mod roller;

pub use contour::Contour;
pub use flat::{FlatContact, FlatFace};
pub use knife::KnifeEdge;
pub use roller::{Roller, RollerContact};
