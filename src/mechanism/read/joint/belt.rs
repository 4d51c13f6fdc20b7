//! `belt`: two wheels joined by a belt or chain.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::kind::Flag;
use crate::mechanism::read::number::{ANGLE, Quantity};
use crate::mechanism::read::reference::CarrierName;
use crate::mechanism::{BodyId, JointKind, Phase};

use super::phase::{PhaseOf, phase};
use super::{joint_type, wheels};

joint_type! {
    "belt" or "chain" => |keys, _| Some(JointKind::Belt {
        sizes: wheels::sizes(keys.radii, keys.teeth)?,
        crossed: keys.crossed.or(false)?,
        carrier: keys.carrier.or(None)?,
        phase: phase(keys.phase)?,
    });

    /// Two wheels joined by a belt or chain; the directions of the two markers are their phase.
    #[one_of(radii, teeth, code::WHEEL_SIZES, wheels::HELP)]
    struct Belt<'a> {
        /// Radii of the wheels of i and j.
        radii: [Quantity; 2] = wheels::RADII,
        /// Numbers of teeth of the wheels of i and j.
        teeth: [Quantity; 2] = wheels::TEETH,
        /// Whether the belt crosses between the wheels.
        crossed: bool = Flag,
        /// Body that carries both pivots; ground if left out.
        carrier: Option<BodyId> = CarrierName,
        /// Constant of the relation; zero if left out, which leaves the phase to the markers. "drawn"
        /// for what the estimates give.
        phase: Phase = PhaseOf(ANGLE),
    }
}
