//! Relation of an equation between coordinates.

use super::{Held, JointParts, held_at};
use crate::kinematics::constraint::{
    CoordinateRelation, CoupledExpression, CoupledFunction, Coupling, Dimension,
};
use crate::mechanism::{CoordinateEquation, LinearForm, Mechanism};

/// Returns the relation of an equation between coordinates.
pub(super) fn couple(
    mechanism: &Mechanism,
    equation: &CoordinateEquation,
    what: &str,
    parts: &mut JointParts,
) -> Held {
    let coordinates = equation.coordinates.iter();
    let coordinates: Vec<_> = coordinates
        .map(|(_, coordinate)| CoordinateRelation::of(coordinate))
        .collect();
    let function = match equation.difference.linear_form(coordinates.len()) {
        Some(LinearForm { factors, rest }) => CoupledFunction::Linear {
            is_fixed: factors
                .iter()
                .all(|factor| factor.literal().is_some_and(|literal| literal != 0.0)),
            factors: factors
                .iter()
                .map(|factor| parts.coefficient(factor, what))
                .collect(),
            rest: parts.coefficient(&rest, what),
        },
        None => CoupledFunction::Expression(CoupledExpression {
            expression: equation.difference.clone(),
            parameters: parts.parameter_coefficients([&equation.difference], what),
            jumps_by: match equation.difference.jumping_coordinates()[..] {
                [place] => Some(place),
                _ => None,
            },
            law: (equation.law.as_ref()).map(|law| parts.law(law, mechanism, what.to_owned())),
        }),
    };
    let relation = Coupling {
        coordinates,
        function,
        dimension: if equation.is_angle {
            Dimension::Angle
        } else {
            Dimension::Length
        },
    };
    (Box::new(relation), held_at(&equation.phase))
}
