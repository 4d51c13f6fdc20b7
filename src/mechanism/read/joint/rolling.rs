//! `rolling`: a wheel that rolls on a straight track without slip.

use crate::mechanism::read::number::{LENGTH, Quantity};
use crate::mechanism::{JointKind, Phase, RackSide};

use super::joint_type;
use super::phase::{PhaseOf, phase};
use super::rack_and_pinion::SIDE;

joint_type! {
    "rolling" => |keys, _| Some(JointKind::Rolling {
        radius: keys.radius.expression()?,
        side: keys.side.or(RackSide::Above)?,
        phase: phase(keys.phase)?,
    });

    /// A wheel, which has marker i, rolls on the x-axis of marker j, the track, and stays on it.
    struct Rolling<'a> {
        /// Radius of the wheel.
        #[required("0.3")]
        radius: Quantity = LENGTH.positive(),
        /// Side of the track on which the wheel is, the track's y-axis pointing up.
        side: RackSide = SIDE,
        /// Constant of the relation; zero if left out, which leaves the phase to the markers. "drawn"
        /// for what the estimates give.
        phase: Phase = PhaseOf(LENGTH),
    }
}
