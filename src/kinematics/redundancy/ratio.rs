//! Equations between coordinates of which one moves so much farther than another that the solver
//! takes it for held.

use std::any::Any;

use crate::kinematics::Origin;
use crate::kinematics::constraint::{Constraint, Coupling, Dimension};
use crate::kinematics::error::Error;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::Equation;
use crate::kinematics::tolerances::DEPENDENT;

/// Largest ratio of the ways of two coordinates, in radians and characteristic lengths: beyond it an
/// equation counts as depending on those of the slower one.
const LARGEST_RATIO: f64 = 1.0 / DEPENDENT;

/// Returns the error of a mechanism that does not close, is singular or has dependent equations at
/// its pose: the equation with too large a ratio, if there is one, otherwise `error`.
pub(in crate::kinematics) fn explain_ratio(
    compiled: &CompiledMechanism,
    state: &State,
    error: Error,
) -> Error {
    let may_explain = matches!(
        error,
        Error::Structure { .. }
            | Error::Contradiction { .. }
            | Error::NotAssembled { .. }
            | Error::Singular { .. }
    );
    let mut equations = compiled.system.equations().iter();
    let ratio = may_explain
        .then(|| equations.find_map(|equation| ratio_of(compiled, state, equation)))
        .flatten();
    ratio.unwrap_or(error)
}

/// Returns the error of an equation between coordinates whose ratio is too large.
fn ratio_of(compiled: &CompiledMechanism, state: &State, equation: &Equation) -> Option<Error> {
    let constraint: &dyn Any = &*equation.constraint;
    let coupling: &Coupling = constraint.downcast_ref()?;
    let mechanism = compiled.system.mechanism();
    let Origin::Joint(joint) = equation.origin else {
        return None;
    };
    let own = mechanism.joints[joint].equation()?;
    let scale = |constraint: &dyn Constraint| match constraint.dimension() {
        Dimension::Length => state.at.size(),
        Dimension::Angle => 1.0,
    };
    let coordinates = coupling
        .coordinates
        .iter()
        .zip(coupling.partials(&state.at));
    let names = own.coordinates.iter().map(|(name, _)| name);
    let slopes = coordinates.map(|(s, partial)| (partial * scale(s.constraint())).abs());
    // The coordinate with the smaller slope moves farther.
    let mut slopes: Vec<_> = names
        .zip(slopes)
        .filter(|(_, slope)| *slope > 0.0)
        .collect();
    slopes.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(far, least), .., (near, most)] = slopes[..] else {
        return None;
    };
    let ratio = most / least;
    (ratio >= LARGEST_RATIO).then(|| Error::Ratio {
        origin: equation.origin.describe(mechanism),
        far: far.clone(),
        near: near.clone(),
        ratio,
        largest: LARGEST_RATIO,
    })
}
