//! `slot`: a pin in a slot.

use crate::mechanism::JointKind;

use super::joint_type;

joint_type! {
    "slot" or "pin_slot" or "pin_in_slot" => |_, _| Some(JointKind::Slot);

    /// A pin in a slot: the point j stays on the x-axis of i.
    struct Slot<'a> {}
}
