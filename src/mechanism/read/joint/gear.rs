//! `gear`: two wheels in mesh.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::kind::Flag;
use crate::mechanism::read::number::{ANGLE, Quantity, RATIO};
use crate::mechanism::read::reference::CarrierName;
use crate::mechanism::{BodyId, JointKind, Phase};

use super::phase::{PhaseOf, phase};
use super::{joint_type, wheels};

joint_type! {
    "gear" => |keys, context| Some(JointKind::Gear {
        sizes: wheels::sizes(keys.radii, keys.teeth)?,
        internal: keys.internal.or(false)?,
        carrier: keys.carrier.or(None)?,
        phase: phase(keys.phase)?,
        play: context.backlash(keys.backlash, keys.restitution, &keys.owner)?,
    });

    /// Two toothed wheels in mesh; the directions of the two markers are the wheels' phase.
    #[one_of(radii, teeth, code::WHEEL_SIZES, wheels::HELP)]
    struct Gear<'a> {
        /// Radii of the pitch circles of i and j.
        radii: [Quantity; 2] = wheels::RADII,
        /// Numbers of teeth of i and j.
        teeth: [Quantity; 2] = wheels::TEETH,
        /// Whether one wheel runs inside the other, a ring.
        internal: bool = Flag,
        /// Body that carries both pivots; ground if left out.
        carrier: Option<BodyId> = CarrierName,
        /// Constant of the relation; zero if left out, which leaves the phase to the markers. "drawn"
        /// for what the estimates give.
        phase: Phase = PhaseOf(ANGLE),
        /// Angle by which wheel j turns between its flanks, in free motion.
        backlash: Quantity = ANGLE.positive(),
        /// Part of the velocity with which the flanks bounce, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
    }
}
