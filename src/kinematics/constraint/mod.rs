//! The scalar relations between bodies, one per file, and the trait that they implement.
//!
//! A relation c(q) gives its value, its gradient (a row of the Jacobian, Eq. 3.6.4), the quadratic
//! term of its second derivative in time (the right-hand side of Eq. 3.6.11) and its unknowns. It
//! does not know its target: the equation of a constraint is c(q) − constant = 0, the equation of a
//! driver c(q) − u(t) = 0.
//!
//! | file | subject |
//! |---|---|
//! | `definition` | the traits [`Constraint`] and [`Formula`], with [`Dimension`], [`TurnEffect`], [`Incidence`]; value, gradient, quadratic term and bend of a formula |
//! | `moving_configuration`, `line` | the numbers on which formulas are evaluated |
//! | `gradient` | [`Gradient`], a row of the Jacobian |
//! | `region`, `point` | bounds around a pose; velocities and accelerations of points |
//! | the others | a relation each |
//!
//! To add a relation, add a file with its `impl Formula` and, in `impl Constraint`, its dimension and
//! its incidence, and list it in `samples` of `tests.rs`, where all tests of relations run on it. What
//! follows from the formula is written by hand only where a mechanism would otherwise take more than
//! 1.3 times as many instructions per step.

mod angle;
mod cam;
mod clearance;
mod coincidence;
pub(super) mod configuration;
mod coupling;
mod curve;
mod definition;
mod distance;
mod gradient;
mod line;
pub mod moving_configuration;
mod point;
mod projection;
mod rack_and_pinion;
mod region;
mod rope;
mod sliding;
mod wheel_pair;

use std::any::Any;

pub use angle::Angle;
pub use cam::{Contour, FlatContact, FlatFace, KnifeEdge, Roller, RollerContact};
pub use clearance::{Clearance, CoreMotion};
pub use coincidence::Coincidence;
pub use coupling::{CoupledExpression, CoupledFunction, Coupling};
pub use curve::{AlongCurve, CurveContact, CurvePath, FormulaPath, OnCurve};
pub(super) use definition::partial;
pub use definition::{
    Along, Axis, Constraint, Dimension, Formula, Incidence, JointUnknown, TurnEffect,
};
pub use distance::Distance;
pub use gradient::Gradient;
pub use point::{point_acceleration, point_velocity};
pub use projection::Projection;
pub use rack_and_pinion::RackAndPinion;
pub use region::Region;
pub use rope::{RopeLength, Station};
pub use sliding::{Sliding, SlidingContact};
pub use wheel_pair::WheelPair;

use crate::mechanism::{Coordinate, CoordinateKind};
use moving_configuration::{Moving, VariedMechanism};

/// The kind of a relation, for block solvers in closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// [`Angle`].
    Angle(Angle),
    /// [`Coincidence`].
    Coincidence(Coincidence),
    /// [`Distance`].
    Distance(Distance),
    /// [`Projection`].
    Projection(Projection),
    /// Any other relation.
    Other,
}

impl Relation {
    /// Returns the kind of a relation.
    #[must_use]
    pub fn of(constraint: &dyn Constraint) -> Self {
        let any: &dyn Any = constraint;
        if let Some(angle) = any.downcast_ref() {
            Self::Angle(*angle)
        } else if let Some(coincidence) = any.downcast_ref() {
            Self::Coincidence(*coincidence)
        } else if let Some(distance) = any.downcast_ref() {
            Self::Distance(*distance)
        } else if let Some(projection) = any.downcast_ref() {
            Self::Projection(*projection)
        } else {
            Self::Other
        }
    }
}

/// The relation of a coordinate of the mechanism file.
#[derive(Clone, Copy, Debug)]
pub enum CoordinateRelation {
    /// An angle.
    Angle(Angle),
    /// A coordinate x or y.
    Projection(Projection),
    /// A distance.
    Distance(Distance),
    /// A clearance.
    Clearance(Clearance),
}

impl CoordinateRelation {
    /// Returns the relation of a coordinate.
    #[must_use]
    pub fn of(coordinate: &Coordinate) -> Self {
        let Coordinate {
            kind,
            from,
            to,
            axes,
        } = *coordinate;
        let projection = |axis| Projection {
            from,
            to,
            axes,
            axis,
        };
        match kind {
            CoordinateKind::Angle => Self::Angle(Angle { from, to }),
            CoordinateKind::X => Self::Projection(projection(Axis::X)),
            CoordinateKind::Y => Self::Projection(projection(Axis::Y)),
            CoordinateKind::Distance => Self::Distance(Distance { from, to }),
            CoordinateKind::Clearance(shapes, runs) => Self::Clearance(Clearance { shapes, runs }),
        }
    }

    /// Returns it as a constraint.
    #[must_use]
    pub fn constraint(&self) -> &dyn Constraint {
        match self {
            Self::Angle(relation) => relation,
            Self::Projection(relation) => relation,
            Self::Distance(relation) => relation,
            Self::Clearance(relation) => relation,
        }
    }
}

impl Formula for CoordinateRelation {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        match self {
            Self::Angle(relation) => relation.evaluate(at),
            Self::Projection(relation) => relation.evaluate(at),
            Self::Distance(relation) => relation.evaluate(at),
            Self::Clearance(relation) => relation.evaluate(at),
        }
    }
}

/// Returns the relation of a coordinate of the mechanism file.
#[must_use]
pub fn of_coordinate(coordinate: &Coordinate) -> Box<dyn Constraint> {
    match CoordinateRelation::of(coordinate) {
        CoordinateRelation::Angle(relation) => Box::new(relation),
        CoordinateRelation::Projection(relation) => Box::new(relation),
        CoordinateRelation::Distance(relation) => Box::new(relation),
        CoordinateRelation::Clearance(relation) => Box::new(relation),
    }
}

#[cfg(test)]
mod tests;
