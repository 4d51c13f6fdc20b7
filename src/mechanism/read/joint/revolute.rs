//! `revolute`: a pin.

use crate::mechanism::JointKind;

use super::joint_type;

joint_type! {
    "revolute" or "pin" or "hinge" or "pivot" or "rotation" or "rotational" or "rotary" => |_, _| Some(JointKind::Revolute);

    /// A pin: the two points coincide.
    struct Revolute<'a> {}
}
