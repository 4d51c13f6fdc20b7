//! The trait of a relation, and the terms in which a relation describes itself.

use std::any::Any;

use nalgebra::Vector2;

use super::configuration::{self, Configuration, JointUnknownId, perp};
use super::gradient::Gradient;
use super::line::{Bounded, Line, Slopes};
use super::moving_configuration::{
    self, Enclosed, Moving, Varied, VariedConfiguration, VariedMechanism,
};
use super::region::Region;
use crate::mechanism::{
    Dual, Expression, Interval, Jet, MarkerId, Mechanism, Number, ParameterId, Taylor,
};

/// The dimension of a relation, which decides its unit and the scale of its residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Metres.
    Length,
    /// Radians.
    Angle,
}

/// One of the two axes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The x-axis, u.
    X,
    /// The y-axis, n.
    Y,
}

impl Axis {
    /// Returns this axis of a frame whose x-axis is `u`.
    pub(super) fn of(self, u: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::X => u,
            Self::Y => perp(u),
        }
    }

    /// Returns this axis of a moving frame whose x-axis is `u`.
    pub(super) fn of_varied<N: Number>(self, u: [N; 2]) -> [N; 2] {
        match self {
            Self::X => u,
            Self::Y => moving_configuration::quarter_turn(u),
        }
    }
}

/// The effect of a whole turn of a body on a relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnEffect {
    /// None: the relation depends on places only.
    None,
    /// c changes by a whole turn, so that a joint may hold it at any number of turns.
    Whole,
    /// c changes by another amount, so that turns have to be counted.
    Proportional,
}

/// A relation as a formula on the numbers of a moving mechanism.
pub trait Formula {
    /// Returns c and its derivatives for a motion.
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N;
}

/// A [`Formula`] on one type of numbers.
pub trait Along<N: Moving> {
    /// Returns c and its derivatives for a motion.
    fn along(&self, at: &VariedMechanism<'_, '_, N>) -> N;
}

impl<N: Moving, F: Formula> Along<N> for F {
    fn along(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        self.evaluate(at)
    }
}

/// Returns the derivative of a relation by q\[column\], the bodies being at rest.
pub(in crate::kinematics) fn partial<S: Number, const N: usize>(
    relation: &(impl Along<Taylor<S, N>> + ?Sized),
    bodies: &mut VariedConfiguration<Taylor<S, N>>,
    curves: <Taylor<S, N> as Moving>::Curves<'_>,
    column: usize,
) -> S
where
    Taylor<S, N>: for<'a> Moving<Bodies<'a> = VariedConfiguration<Taylor<S, N>>>,
{
    let q = bodies.coordinate(column);
    // At rest but for a unit rate of this unknown, the rate of the relation is its derivative.
    bodies.move_coordinate(column, Taylor::linear(q.value, S::constant(1.0)));
    let rate = relation.along(&VariedMechanism { bodies, curves });
    bodies.move_coordinate(column, q);
    rate.first()
}

/// Returns the value of a formula.
pub(super) fn derived_value(formula: &(impl Along<Dual> + ?Sized), at: &Configuration) -> f64 {
    formula
        .along(&Line::through(at, Slopes::Zero).mechanism())
        .value
}

/// Adds the gradient of a formula to `row` and returns its value: the rate of c for q̇ = e_k is its
/// derivative by q_k.
pub(super) fn derived_gradient(
    formula: &(impl Along<Dual> + ?Sized),
    at: &Configuration,
    row: &mut Gradient,
) -> f64 {
    let value = formula.along(&Line::noting(at, row).mechanism()).value;
    row.replace(|column, entry| {
        let line = Line::through(at, Slopes::Unit(column));
        entry + formula.along(&line.mechanism()).first()
    });
    value
}

/// Returns the quadratic term of a formula: c̈ on a straight line.
pub(super) fn derived_quadratic(
    formula: &(impl Along<Jet> + ?Sized),
    at: &Configuration,
    q_dot: &[f64],
) -> f64 {
    let line = Line::through(at, Slopes::All(q_dot));
    formula.along(&line.mechanism()).second()
}

/// Bounds the bend of a formula by enclosures of its derivatives along lines through the region.
pub(super) fn derived_bend<F: Along<Dual> + Along<Bounded> + ?Sized>(
    formula: &F,
    at: &Configuration,
    region: &Region<'_>,
    v: &[f64],
    row: &mut Gradient,
) -> Option<f64> {
    let along =
        |slopes| -> Bounded { formula.along(&Line::within(region, at, slopes).mechanism()) };
    let bend = along(Slopes::All(v)).second().magnitude();
    let mut changes = Gradient::new();
    derived_gradient(formula, at, &mut changes);
    changes.replace(|column, entry| {
        let slope = along(Slopes::Unit(column)).first();
        (slope - Interval::point(entry)).magnitude()
    });
    row.add(&changes);
    let mut entries = changes.entries();
    (bend.is_finite() && entries.all(|(_, change)| change.is_finite())).then_some(bend)
}

/// A scalar relation c(q) between bodies. It is a [`Formula`], from which value, gradient, quadratic
/// term and bend follow; a relation in most steps has them by hand as well, as they are faster.
pub trait Constraint:
    Any
    + Along<Dual>
    + Along<Jet>
    + Along<Bounded>
    + Along<Varied>
    + Along<Enclosed>
    + std::fmt::Debug
    + Send
    + Sync
{
    /// Returns the dimension of c.
    fn dimension(&self) -> Dimension;

    /// Returns c(q) \[m or rad\].
    fn value(&self, at: &Configuration) -> f64 {
        derived_value(self, at)
    }

    /// Adds ∂c/∂q, a row of the Jacobian (Eq. 3.6.4), to `row`. What is written by hand is the next
    /// method.
    fn gradient(&self, at: &Configuration, row: &mut Gradient) {
        self.value_and_gradient(at, row);
    }

    /// Adds ∂c/∂q to `row` and returns c(q).
    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        derived_gradient(self, at, row)
    }

    /// Returns q̇ᵀ (∂²c/∂q²) q̇, which is c̈ for q̈ = 0; Eq. 3.6.11 has it with the opposite sign.
    /// `q_dot` is as long as q.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64 {
        if self.is_affine() {
            0.0
        } else {
            derived_quadratic(self, at, q_dot)
        }
    }

    /// Returns whether c contains a function that the file gives: a contour, a curve, an equation that
    /// is not linear. It may bend anywhere without a trace elsewhere. All else is analytic, and bends
    /// no more than circles of the mechanism's size do.
    fn has_given_function(&self) -> bool {
        false
    }

    /// Returns whether c is linear in q: its second derivatives are zero.
    fn is_affine(&self) -> bool {
        false
    }

    /// Returns whether c is linear in q, with coefficients that are not zero for any values of the
    /// parameters.
    fn is_linear(&self, mechanism: &Mechanism) -> bool {
        let _ = mechanism;
        false
    }

    /// Returns whether c can have this value; a distance must be positive.
    fn admits(&self, value: f64) -> bool {
        let _ = value;
        true
    }

    /// Returns the effect of a whole turn of one of its bodies on c.
    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::None
    }

    /// Bounds the second derivatives of c in a region around the present pose: returns an upper
    /// bound of |vᵀ (∂²c/∂q²) v|, and adds upper bounds of the changes of the gradient's entries to
    /// `row`. Returns `None` if c is not smooth in the region.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        if self.is_affine() {
            Some(0.0)
        } else {
            derived_bend(self, at, region, v, row)
        }
    }

    /// Notes the unknowns and parameters in c, except those whose coefficient is zero for all
    /// values of the parameters.
    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence);
}

/// A joint unknown, such as the polar angle of the contact on a cam.
pub trait JointUnknown: std::fmt::Debug + Send + Sync {
    /// Returns its estimate \[rad\] for bodies at their estimates.
    fn estimate(&self, at: &Configuration) -> f64;
}

/// The unknowns and parameters in a relation, found without numbers.
#[derive(Clone, Debug, Default)]
pub struct Incidence {
    /// Indices in q, possibly repeated.
    pub unknowns: Vec<usize>,
    /// Parameters in the expressions, possibly repeated.
    pub parameters: Vec<ParameterId>,
}

impl Incidence {
    /// Notes the parameters of an expression.
    pub fn expression(&mut self, expression: &Expression) {
        self.parameters.extend(expression.parameters());
    }

    /// Notes the unknowns and parameters in the x (first) and y (second) components of a marker's
    /// point that `components` selects.
    pub fn point(&mut self, mechanism: &Mechanism, marker: MarkerId, components: [bool; 2]) {
        let marker = &mechanism.markers[marker.index()];
        let at_origin = marker.position.iter().all(|s| s.literal() == Some(0.0));
        match marker.body {
            Some(body) => {
                let k = 3 * body.index();
                self.unknowns
                    .extend((0..2).filter(|&c| components[c]).map(|c| k + c));
                if !at_origin {
                    self.unknowns.push(k + 2);
                    marker.position.iter().for_each(|s| self.expression(s));
                }
            }
            None => marker
                .position
                .iter()
                .zip(components)
                .filter(|(_, asked)| *asked)
                .for_each(|(s, _)| self.expression(s)),
        }
    }

    /// Notes a joint unknown.
    pub fn joint_unknown(&mut self, mechanism: &Mechanism, unknown: JointUnknownId) {
        self.unknowns.push(3 * mechanism.bodies.len() + unknown.0);
    }

    /// Notes the unknowns and parameters in a marker's direction.
    pub fn direction(&mut self, mechanism: &Mechanism, marker: MarkerId) {
        let marker = &mechanism.markers[marker.index()];
        self.unknowns
            .extend(marker.body.map(|body| 3 * body.index() + 2));
        self.expression(&marker.angle);
    }
}

/// Returns whether a marker's point does not depend on an angle: it is on ground, or the origin of
/// its body.
pub(super) fn is_origin_or_ground(mechanism: &Mechanism, marker: MarkerId) -> bool {
    let marker = &mechanism.markers[marker.index()];
    let at_origin = || marker.position.iter().all(|s| s.literal() == Some(0.0));
    marker.body.is_none() || at_origin()
}

/// Returns whether a marker's axis can have components along the global x and y.
pub(super) fn axis_components(mechanism: &Mechanism, marker: MarkerId, axis: Axis) -> [bool; 2] {
    let marker = &mechanism.markers[marker.index()];
    match (marker.body, marker.angle.literal()) {
        // An axis on ground with a literal angle is fixed, and often along x or y.
        (None, Some(angle)) => {
            let e = axis.of(configuration::axis(angle));
            [e.x.abs() > 0.0, e.y.abs() > 0.0]
        }
        _ => [true, true],
    }
}
