//! `revolute_translational`: a pin on a slider, both without mass.

use crate::mechanism::JointKind;
use crate::mechanism::read::number::{LENGTH, Quantity};

use super::joint_type;

joint_type! {
    "revolute_translational" => |keys, _| Some(JointKind::RevoluteTranslational {
        offset: keys.offset.expression()?,
    });

    /// A pin on a slider: the point j keeps its distance from the x-axis of i.
    struct RevoluteTranslational<'a> {
        /// Distance of the point j from the x-axis of i, positive to its left.
        #[required("0.1")]
        offset: Quantity = LENGTH,
    }
}
