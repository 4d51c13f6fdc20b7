//! The equations that each kind of joint stands for.

use super::constraint::{Axis, Coincidence, Constraint, of_coordinate};
use crate::mechanism::{Coordinate, CoordinateKind, Expression, Joint, JointKind};

/// The relations of a joint, and what each is held at.
#[must_use]
pub(super) fn relations(joint: &Joint) -> Vec<(Box<dyn Constraint>, Expression)> {
    let (from, to) = (joint.from, joint.to);
    let zero = || Expression::constant(0.0);
    let along = |kind| {
        of_coordinate(&Coordinate {
            kind,
            from,
            to,
            axes: from,
        })
    };
    let coincide = |axis| -> (Box<dyn Constraint>, Expression) {
        (Box::new(Coincidence { from, to, axis }), zero())
    };
    match &joint.kind {
        JointKind::Revolute => vec![coincide(Axis::X), coincide(Axis::Y)],
        JointKind::Translational => vec![
            (along(CoordinateKind::Y), zero()),
            (along(CoordinateKind::Angle), zero()),
        ],
        JointKind::Slot => vec![(along(CoordinateKind::Y), zero())],
        JointKind::Link { length } => vec![(along(CoordinateKind::Distance), length.clone())],
        JointKind::RevoluteTranslational { offset } => {
            vec![(along(CoordinateKind::Y), offset.clone())]
        }
        JointKind::Weld => vec![
            coincide(Axis::X),
            coincide(Axis::Y),
            (along(CoordinateKind::Angle), zero()),
        ],
    }
}
