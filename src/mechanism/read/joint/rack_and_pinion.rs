//! `rack_and_pinion`: a pinion that rolls on a rack.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::kind::Word;
use crate::mechanism::read::number::{LENGTH, Quantity, RATIO};
use crate::mechanism::{JointKind, Phase, RackSide};

use super::joint_type;
use super::phase::{PhaseOf, phase};

joint_type! {
    "rack_and_pinion" or "rack" or "pinion" => |keys, context| Some(JointKind::RackAndPinion {
        radius: keys.radius.expression()?,
        side: keys.side.or(RackSide::Above)?,
        phase: phase(keys.phase)?,
        play: context.backlash(keys.backlash, keys.restitution, &keys.owner)?,
    });

    /// A pinion, which has marker i, rolls along the x-axis of marker j, the rack.
    struct RackAndPinion<'a> {
        /// Radius of the pinion's pitch circle.
        #[required("0.05")]
        radius: Quantity = LENGTH.positive(),
        /// Side of the rack on which the pinion is, the rack's y-axis pointing up.
        side: RackSide = SIDE,
        /// Constant of the relation; zero if left out, which leaves the phase to the markers. "drawn"
        /// for what the estimates give.
        phase: Phase = PhaseOf(LENGTH),
        /// Way of the rack between the flanks, in free motion.
        backlash: Quantity = LENGTH.positive(),
        /// Part of the velocity with which the flanks bounce, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
    }
}

pub(super) const SIDE: Word<RackSide> = Word::new("side", code::ILLEGAL_VALUE, || {
    vec![("above", RackSide::Above), ("below", RackSide::Below)]
});
