//! The scalar relations between bodies, one per file, and the trait that they implement.
//!
//! A relation c(q) gives its value, its gradient (a row of the Jacobian, Eq. 3.6.4), the quadratic
//! term of its second derivative in time (the right-hand side of Eq. 3.6.11) and its unknowns. It
//! does not know its target: the equation of a constraint is c(q) − constant = 0, the equation of a
//! driver c(q) − u(t) = 0.
//!
//! To add a relation, add a file with its `impl Constraint` and list it in `samples` of `tests.rs`,
//! where all tests of relations run on it.

mod angle;
mod cam;
mod coincidence;
mod coupling;
mod distance;
mod projection;
mod rack_and_pinion;

use nalgebra::Vector2;

pub use angle::Angle;
pub use cam::{Contour, FlatContact, FlatFace, KnifeEdge, Roller, RollerContact};
pub use coincidence::Coincidence;
pub use coupling::Coupling;
pub use distance::Distance;
pub use projection::Projection;
pub use rack_and_pinion::RackAndPinion;

use super::configuration::{self, Configuration, JointUnknownId, MarkerPose, perp};
use super::variation::{self, Varied, VariedConfiguration, VariedVector};
use crate::mechanism::{
    BodyId, Coordinate, CoordinateKind, Expression, MarkerId, Mechanism, ParameterId,
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
    fn of(self, u: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::X => u,
            Self::Y => perp(u),
        }
    }

    /// Returns this axis of a moving frame whose x-axis is `u`.
    fn of_varied(self, u: VariedVector) -> VariedVector {
        match self {
            Self::X => u,
            Self::Y => variation::quarter_turn(u),
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

/// A scalar relation c(q) between bodies.
pub trait Constraint: std::fmt::Debug + Send + Sync {
    /// Returns the dimension of c.
    fn dimension(&self) -> Dimension;

    /// Returns c(q) \[m or rad\].
    fn value(&self, at: &Configuration) -> f64;

    /// Adds ∂c/∂q, a row of the Jacobian (Eq. 3.6.4), to `row`.
    fn gradient(&self, at: &Configuration, row: &mut Gradient);

    /// Returns q̇ᵀ (∂²c/∂q²) q̇, which is c̈ for q̈ = 0; Eq. 3.6.11 has it with the opposite sign.
    /// `q_dot` is as long as q.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64;

    /// Returns c and its derivatives in time for a motion, each with its change along a direction.
    fn along(&self, at: &VariedConfiguration) -> Varied;

    /// Returns the kind of the relation, for block solvers in closed form.
    fn relation(&self) -> Relation {
        Relation::Other
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
    ) -> Option<f64>;

    /// Notes the unknowns and parameters in c, except those whose coefficient is zero for all
    /// values of the parameters.
    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence);
}

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

/// A joint unknown, such as the polar angle of the contact on a cam.
pub trait JointUnknown: std::fmt::Debug + Send + Sync {
    /// Returns its estimate \[rad\] for bodies at their estimates.
    fn estimate(&self, at: &Configuration) -> f64;
}

/// A neighbourhood of a pose: each unknown differs from the pose by at most its radius.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// One radius per unknown: \[m, m, rad\] for each body, then the joint unknowns.
    pub radii: &'a [f64],
}

impl Region<'_> {
    /// Returns the largest turn of a marker \[rad\].
    fn turn(&self, marker: MarkerPose) -> f64 {
        marker
            .body
            .map_or(0.0, |body| self.radii[3 * body.index() + 2])
    }

    /// Returns the largest move of a unit vector fixed to a marker's body: the chord of the turn.
    fn sway(&self, marker: MarkerPose) -> f64 {
        chord(self.turn(marker))
    }

    /// Returns a bound of the move of a marker's point \[m\].
    fn reach(&self, marker: MarkerPose) -> f64 {
        marker.body.map_or(0.0, |body| {
            let k = 3 * body.index();
            self.radii[k].hypot(self.radii[k + 1]) + marker.arm.norm() * self.sway(marker)
        })
    }
}

/// Returns the chord of an angle on the unit circle, at most two.
fn chord(angle: f64) -> f64 {
    if angle < std::f64::consts::PI {
        2.0 * (0.5 * angle).sin()
    } else {
        2.0
    }
}

/// Returns an upper bound of the speed of one marker's point relative to the point of another for
/// the rates `v`, at any angles of their bodies.
fn speed_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let origin = |marker: MarkerPose| {
        marker.body.map_or_else(Vector2::zeros, |body| {
            let k = 3 * body.index();
            Vector2::new(v[k], v[k + 1])
        })
    };
    let swing = |marker: MarkerPose| angular_velocity(marker, v).abs() * marker.arm.norm();
    (origin(to) - origin(from)).norm() + swing(to) + swing(from)
}

/// Returns an upper bound of the centripetal acceleration of P_j − P_i for the rates `v`.
fn centripetal_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let part = |marker: MarkerPose| angular_velocity(marker, v).powi(2) * marker.arm.norm();
    part(from) + part(to)
}

/// Returns the relation of a coordinate of the mechanism file.
#[must_use]
pub fn of_coordinate(coordinate: &Coordinate) -> Box<dyn Constraint> {
    let Coordinate {
        kind,
        from,
        to,
        axes,
    } = *coordinate;
    match kind {
        CoordinateKind::Angle => Box::new(Angle { from, to }),
        CoordinateKind::X => Box::new(Projection {
            from,
            to,
            axes,
            axis: Axis::X,
        }),
        CoordinateKind::Y => Box::new(Projection {
            from,
            to,
            axes,
            axis: Axis::Y,
        }),
        CoordinateKind::Distance => Box::new(Distance { from, to }),
    }
}

/// A row of the Jacobian: its entries for at most three bodies and one joint unknown.
///
/// It does not allocate. A relation has at most three markers, hence three bodies.
#[derive(Clone, Debug, Default)]
pub struct Gradient {
    len: usize,
    parts: [(usize, [f64; 3]); 3],
    /// Index in q of a joint unknown, and its entry.
    joint_unknown: Option<(usize, f64)>,
}

impl Gradient {
    /// Makes an empty row.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Removes all entries.
    pub fn clear(&mut self) {
        self.len = 0;
        self.joint_unknown = None;
    }

    /// Adds the gradient of `direction · P` with the marker's point P and a fixed `direction`.
    pub fn add_point(&mut self, marker: MarkerPose, direction: Vector2<f64>) {
        if let Some(part) = self.part(marker.body) {
            part[0] += direction.x;
            part[1] += direction.y;
            part[2] += direction.dot(&perp(marker.arm));
        }
    }

    /// Adds bounds of a point's entries: `direction` for x and y, `swing` for phi.
    fn add_point_bound(&mut self, marker: MarkerPose, direction: f64, swing: f64) {
        if let Some(part) = self.part(marker.body) {
            part[0] += direction;
            part[1] += direction;
            part[2] += swing;
        }
    }

    /// Adds the gradient of `factor * theta` with the marker's angle theta.
    pub fn add_direction(&mut self, marker: MarkerPose, factor: f64) {
        self.add_turn(marker.body, factor);
    }

    /// Adds the gradient of `factor * phi` with the body's angle phi; nothing for ground.
    pub fn add_turn(&mut self, body: Option<BodyId>, factor: f64) {
        if let Some(part) = self.part(body) {
            part[2] += factor;
        }
    }

    /// Adds the entry of a joint unknown; a relation contains at most one.
    pub fn add_joint_unknown(&mut self, column: usize, value: f64) {
        let entry = self.joint_unknown.get_or_insert((column, 0.0));
        debug_assert_eq!(entry.0, column, "a relation has at most one joint unknown");
        entry.1 += value;
    }

    /// Returns the entries as pairs of an index in q and a value, body by body.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.parts[..self.len]
            .iter()
            .flat_map(|(body, part)| (0..3).map(move |k| (3 * body + k, part[k])))
            .chain(self.joint_unknown)
    }

    /// Returns the product of the row and a vector as long as q.
    #[must_use]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.entries().map(|(k, value)| value * vector[k]).sum()
    }

    fn part(&mut self, body: Option<BodyId>) -> Option<&mut [f64; 3]> {
        let body = body?.index();
        let known = self.parts[..self.len].iter().position(|(b, _)| *b == body);
        let index = known.unwrap_or_else(|| {
            self.parts[self.len] = (body, [0.0; 3]);
            self.len += 1;
            self.len - 1
        });
        Some(&mut self.parts[index].1)
    }
}

/// Returns the velocity of a marker's point: ṙ + omega perp(A s).
#[must_use]
pub fn point_velocity(marker: MarkerPose, q_dot: &[f64]) -> Vector2<f64> {
    marker.body.map_or_else(Vector2::zeros, |body| {
        let k = 3 * body.index();
        Vector2::new(q_dot[k], q_dot[k + 1]) + q_dot[k + 2] * perp(marker.arm)
    })
}

/// Returns the acceleration of a marker's point: r̈ + alpha perp(A s) − omega² A s.
#[must_use]
pub fn point_acceleration(marker: MarkerPose, q_dot: &[f64], q_ddot: &[f64]) -> Vector2<f64> {
    point_velocity(marker, q_ddot) + centripetal(marker, q_dot)
}

/// Returns the acceleration of a marker's point for q̈ = 0: −omega² A s.
fn centripetal(marker: MarkerPose, q_dot: &[f64]) -> Vector2<f64> {
    let omega = angular_velocity(marker, q_dot);
    -omega * omega * marker.arm
}

fn angular_velocity(marker: MarkerPose, q_dot: &[f64]) -> f64 {
    marker.body.map_or(0.0, |body| q_dot[3 * body.index() + 2])
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

/// Returns whether a marker's axis can have components along the global x and y.
fn axis_components(mechanism: &Mechanism, marker: MarkerId, axis: Axis) -> [bool; 2] {
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

#[cfg(test)]
mod tests;
