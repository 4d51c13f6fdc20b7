//! Analyses of a mechanism that no step needs.
//!
//! | file | subject |
//! |---|---|
//! | [`sensitivity`] | derivatives of a motion by drivers and parameters |
//! | [`range`](mod@range) | values that a driver can reach |
//! | [`transmission`](mod@transmission) | how well joints transmit force |
//! | [`modes`](mod@modes) | other poses for the same values of the drivers |
//! | [`instant_centre`](mod@instant_centre) | points of bodies that are at rest for an instant |
//! | [`needed_play`] | the play that constraints need that contradict each other |
//! | [`geometry_check`] | distances of wheels, hollows of cams |
//! | `off_pulley` | ropes that leave their pulleys |
//! | `start_aside` | a start beside a singular position |
//! | `drawn_apart` | markers of joints that were drawn apart |

mod drawn_apart;
mod geometry_check;
mod instant_centre;
mod modes;
mod needed_play;
mod off_pulley;
mod range;
mod sensitivity;
mod start_aside;
mod transmission;

pub use drawn_apart::DrawnApart;
pub(super) use drawn_apart::drawn_apart;
pub(super) use geometry_check::geometry_warnings;
pub use geometry_check::{GeometryWarning, GeometryWarningKind};
pub use instant_centre::InstantCentre;
pub(super) use instant_centre::instant_centre;
pub use modes::{AssemblyMode, Modes};
pub(super) use modes::{modes, poses};
pub use needed_play::NeededPlay;
pub use off_pulley::OffPulley;
pub(super) use off_pulley::off_pulleys;
pub(super) use range::range;
pub use range::{ChangePoint, End, Extreme, Range, RangeSettings, Sample};
pub use sensitivity::{Direction, Sensitivity};
pub use start_aside::offer_start;
