//! Analyses of a mechanism that no step needs.
//!
//! | file | subject |
//! |---|---|
//! | [`sensitivity`] | derivatives of a motion by drivers and parameters |
//! | [`range`](mod@range) | values that a driver can reach |
//! | [`transmission`](mod@transmission) | how well joints transmit force |
//! | [`modes`](mod@modes) | other poses for the same values of the drivers |
//! | [`instant_centre`](mod@instant_centre) | points of bodies that are at rest for an instant |
//! | [`play`] | the play that constraints need that contradict each other |
//! | [`geometry_check`] | distances of wheels, hollows of cams |
//! | `off_pulley` | ropes that leave their pulleys |
//! | `aside` | a start beside a singular position |
//! | `drawn` | markers of joints that were drawn apart |

mod aside;
mod drawn;
mod geometry_check;
mod instant_centre;
mod modes;
mod off_pulley;
mod play;
mod range;
mod sensitivity;
mod transmission;

pub use aside::offer_start;
pub use drawn::DrawnApart;
pub(super) use drawn::drawn_apart;
pub(super) use geometry_check::geometry_warnings;
pub use geometry_check::{GeometryWarning, GeometryWarningKind};
pub use instant_centre::InstantCentre;
pub(super) use instant_centre::instant_centre;
pub use modes::{Mode, Modes};
pub(super) use modes::{modes, poses};
pub use off_pulley::OffPulley;
pub(super) use off_pulley::off_pulleys;
pub use play::Play;
pub(super) use range::range;
pub use range::{ChangePoint, End, Extreme, Range, RangeSettings, Sample};
pub use sensitivity::{Direction, Sensitivity};
