//! `translational`: a slider without rotation.

use crate::mechanism::JointKind;

use super::joint_type;

joint_type! {
    "translational" or "prismatic" or "slider" or "sliding" or "translation" => |_, _| Some(JointKind::Translational);

    /// A guide: j slides along the x-axis of i and does not turn against it.
    struct Translational<'a> {}
}
