//! `link`: a massless rod between two pins.

use crate::mechanism::JointKind;
use crate::mechanism::read::number::{LENGTH, Quantity};

use super::joint_type;

joint_type! {
    "link" or "rod" or "bar" or "distance" => |keys, _| Some(JointKind::Link {
        length: keys.length.expression()?,
    });

    /// A massless rod between two pins: the two points keep their distance.
    struct Link<'a> {
        /// Distance between the two points.
        #[required("0.1")]
        length: Quantity = LENGTH.positive(),
    }
}
