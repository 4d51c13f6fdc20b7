//! Relations of a point on a curve.

use super::{Held, JointParts, held_at_zero};
use crate::kinematics::Origin;
use crate::kinematics::constraint::{
    AlongCurve, Axis, CurveContact, CurvePath, FormulaPath, OnCurve, Projection,
};
use crate::mechanism::{Curve, CurveShape, Joint};

/// Returns the relations of a point on a curve.
pub(super) fn lie(
    origin: Origin,
    joint: &Joint,
    curve: &Curve,
    parts: &mut JointParts,
) -> Vec<Held> {
    let (from, to) = (joint.from, joint.to);
    let what = format!("a number of joint `{}`", joint.name);
    let offset = curve.offset.as_ref();
    let offset = offset.map(|offset| parts.coefficient(offset, what.clone()));
    let path = match &curve.shape {
        CurveShape::Points(path) => CurvePath::through_points(path.clone(), offset),
        CurveShape::Formula { x, y, ends } => {
            let formula = FormulaPath {
                components: [x.clone(), y.clone()],
                ends: ends
                    .each_ref()
                    .map(|end| parts.coefficient(end, what.clone())),
                parameters: parts.parameter_coefficients([x, y], &what),
            };
            CurvePath::of_formula(formula, offset, curve.closed)
        }
    };
    let place = parts.next_unknown();
    let contact = CurveContact {
        from,
        to,
        path: path.clone(),
    };
    parts.unknown(origin, Box::new(contact));
    let mut rows = Vec::new();
    for axis in [Axis::X, Axis::Y] {
        rows.push(held_at_zero(OnCurve {
            coordinate: Projection {
                from,
                to,
                axes: from,
                axis,
            },
            path: path.clone(),
            place,
        }));
    }
    if curve.follow {
        rows.push(held_at_zero(AlongCurve {
            from,
            to,
            path,
            place,
        }));
    }
    rows
}
