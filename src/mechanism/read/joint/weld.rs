//! `weld`: a rigid connection.

use crate::mechanism::JointKind;

use super::joint_type;

joint_type! {
    "weld" or "fixed" or "rigid" => |_, _| Some(JointKind::Weld);

    /// A rigid connection: the two frames coincide.
    struct Weld<'a> {}
}
