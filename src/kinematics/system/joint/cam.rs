//! Relations of a follower on a cam.

use super::{Held, JointParts, held_at_zero};
use crate::kinematics::Origin;
use crate::kinematics::constraint::configuration::ProfileId;
use crate::kinematics::constraint::{
    Axis, Contour, FlatContact, FlatFace, KnifeEdge, Roller, RollerContact,
};
use crate::mechanism::{CamFollower, Joint};

/// Returns the relations of a follower. The last one holds the distance of the two parts.
pub(super) fn follow(
    origin: Origin,
    joint: &Joint,
    follower: &CamFollower,
    profile: ProfileId,
    parts: &mut JointParts,
) -> Vec<Held> {
    let (cam, to) = (joint.from, joint.to);
    let contour = Contour {
        cam,
        profile,
        contact: parts.next_unknown(),
    };
    match follower {
        CamFollower::Knife => vec![held_at_zero(KnifeEdge {
            cam,
            follower: to,
            profile,
        })],
        CamFollower::Roller { radius } => {
            let contact = RollerContact {
                contour,
                follower: to,
            };
            parts.unknown(origin, Box::new(contact));
            let along = |axis| Roller {
                contour,
                follower: to,
                axis,
            };
            vec![
                held_at_zero(along(Axis::X)),
                (Box::new(along(Axis::Y)), radius.clone()),
            ]
        }
        CamFollower::Flat => {
            let contact = FlatContact {
                contour,
                follower: to,
            };
            parts.unknown(origin, Box::new(contact));
            let face = FlatFace {
                contour,
                follower: to,
            };
            vec![held_at_zero(contact), held_at_zero(face)]
        }
    }
}
