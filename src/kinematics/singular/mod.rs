//! Singular positions: dead points, change points, and positions that are refused.
//!
//! At a pose where the Jacobian of a block loses rank Newton–Raphson does not converge, and the
//! motion may have more than one continuation. [`reduced`] reduces the block's equations to one smooth
//! function of two numbers. [`locate`] finds the singular position of this function to rounding,
//! and its kind. Where two motions cross, [`interpolate`] takes the smooth continuation: parallel
//! links stay parallel.
//!
//! A crossing belongs to the pose: while the driver's value is within its ends, the block's
//! unknowns and their rates come from it. It belongs to the redundant rows set aside as well: as long
//! as a pose has crossings, these stay. Blocks that several drivers move, and those with more
//! than [`LARGEST_BLOCK`] unknowns, have no crossings; nor has any block while parameters move.
//!
//! | file | subject |
//! |---|---|
//! | [`near`] | blocks near a singular position |
//! | [`upstream`] | the blocks that a block reads, moved along a line |
//! | [`reduced`] | the reduced equation of a block |
//! | [`locate`] | the singular position near a pose, and its kind |
//! | [`fold`] | the dead point at which a block loses several ranks |
//! | [`interpolate`] | the motion through a change point |
//! | [`crossings`] | the crossings of a pose |
//! | [`limit`] | reactions and derivatives next to a change point |
//! | [`lines`] | the lines that meet at a singular position |
//! | [`obstacle`] | the position that stops the motion along a path |
//! | [`approach`](mod@approach) | the warning of a singular position |

mod approach;
mod crossings;
mod fold;
mod interpolate;
mod limit;
mod lines;
mod locate;
mod near;
mod obstacle;
mod reduced;
mod upstream;

pub use approach::Approach;
pub use locate::SingularKind;
pub use near::LARGEST_BLOCK;
pub use obstacle::SingularPoint;

pub(super) use approach::approach;
pub(super) use crossings::{CROSSING_END, admits_crossings, describe_crossing, leave_crossings};
pub(super) use limit::{Kind, MotionPoint, NearPoint, near_point};
pub(super) use near::NEAR;
pub(super) use obstacle::{DriverLimit, FruitlessSearches, find_end, look_ahead, settle};
