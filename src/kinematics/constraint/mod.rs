//! The trait that every scalar relation between bodies implements, one kind a file.
//!
//! A relation c(q) supplies its value, its gradient row (a row of the Jacobian, Ec. 3.6.4), the
//! quadratic term of its second derivative in time (the right-hand side of Ec. 3.6.11) and the
//! unknowns it contains. It knows nothing of what it is held at: the equation of a constraint is
//! c(q) − constant = 0, that of a driver c(q) − u(t) = 0.
//!
//! A new kind is a new file here with its `impl Constraint`; the tests in `tests.rs` check
//! it once it is listed in `samples`.

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

/// What a scalar measures: decides its unit and how its residual is scaled.
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
    /// This axis of a frame whose x-axis is `u`.
    fn of(self, u: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::X => u,
            Self::Y => perp(u),
        }
    }

    /// The same of a frame that moves.
    fn of_varied(self, u: VariedVector) -> VariedVector {
        match self {
            Self::X => u,
            Self::Y => variation::quarter_turn(u),
        }
    }
}

/// What a whole turn of a body does to a relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnEffect {
    /// Nothing: the body is back where it was.
    None,
    /// c changes by a whole turn, so that a joint may hold it at any number of turns.
    Whole,
    /// c changes by something else, so that turns have to be counted.
    Proportional,
}

/// A scalar relation c(q) between bodies.
pub trait Constraint: std::fmt::Debug + Send + Sync {
    /// What the value measures.
    fn dimension(&self) -> Dimension;

    /// c(q) \[m or rad\].
    fn value(&self, at: &Configuration) -> f64;

    /// Adds ∂c/∂q, a row of the Jacobian (Ec. 3.6.4), to `row`.
    fn gradient(&self, at: &Configuration, row: &mut Gradient);

    /// q̇ᵀ (∂²c/∂q²) q̇: what remains of c̈ where q̈ = 0 (Ec. 3.6.11 has it with the opposite
    /// sign). `q_dot` is as long as q.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64;

    /// c along a motion, with its changes along a direction. In value and derivatives it agrees
    /// with all of the above.
    fn along(&self, at: &VariedConfiguration) -> Varied;

    /// Whether this is one of the relations that special kernels know.
    fn relation(&self) -> Relation {
        Relation::Other
    }

    /// Whether c contains the contour of a cam, which may have pieces; all else is analytic.
    fn has_contour(&self) -> bool {
        false
    }

    /// Whether c can be held at this value; a distance cannot at zero or below.
    fn admits(&self, value: f64) -> bool {
        let _ = value;
        true
    }

    /// What a whole turn of one of its bodies does to c.
    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::None
    }

    /// Bounds how far c can bend in a region around the present pose: an upper bound of
    /// |vᵀ (∂²c/∂q²) v| for `v` and of the change of each entry of the gradient, which is added
    /// to `row`. `None` if the region reaches a place where c is not smooth.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64>;

    /// Notes the unknowns and parameters that c contains. What is zero whatever the parameters
    /// is left out.
    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence);
}

/// What a relation is, for kernels that solve particular ones by straight code.
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
    /// Known by its trait only.
    Other,
}

/// An unknown that a joint brings with it, such as where on a cam the contact is.
pub trait JointUnknown: std::fmt::Debug + Send + Sync {
    /// Where to look for it when the bodies are at their estimates \[rad\].
    fn estimate(&self, at: &Configuration) -> f64;
}

/// A neighbourhood of a pose: each unknown may be off by a radius of its own.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// One radius an unknown: \[m, m, rad\] for each body, then the joints' own.
    pub radii: &'a [f64],
}

impl Region<'_> {
    /// How far the direction of a marker can turn \[rad\].
    fn turn(&self, marker: MarkerPose) -> f64 {
        marker
            .body
            .map_or(0.0, |body| self.radii[3 * body.index() + 2])
    }

    /// How far a unit vector fixed to a marker's body can move: the chord of the turn.
    fn sway(&self, marker: MarkerPose) -> f64 {
        chord(self.turn(marker))
    }

    /// How far a marker's point can move \[m\].
    fn reach(&self, marker: MarkerPose) -> f64 {
        marker.body.map_or(0.0, |body| {
            let k = 3 * body.index();
            self.radii[k].hypot(self.radii[k + 1]) + marker.arm.norm() * self.sway(marker)
        })
    }
}

/// The chord of an angle on the unit circle, two at the most.
fn chord(angle: f64) -> f64 {
    if angle < std::f64::consts::PI {
        2.0 * (0.5 * angle).sin()
    } else {
        2.0
    }
}

/// An upper bound of the speed of a marker's point for the rates `v`, wherever its body points.
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

/// An upper bound of the centripetal part of P_j − P_i for the rates `v`.
fn centripetal_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let part = |marker: MarkerPose| angular_velocity(marker, v).powi(2) * marker.arm.norm();
    part(from) + part(to)
}

/// The relation that a coordinate of the mechanism file measures.
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

/// A row of the Jacobian: the few bodies it touches, without allocation.
///
/// Three markers, and so three bodies, take part in a relation at most.
#[derive(Clone, Debug, Default)]
pub struct Gradient {
    len: usize,
    parts: [(usize, [f64; 3]); 3],
    /// Index in q of a joint's own unknown, and the entry there.
    joint_unknown: Option<(usize, f64)>,
}

impl Gradient {
    /// An empty row.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes the row empty again.
    pub fn clear(&mut self) {
        self.len = 0;
        self.joint_unknown = None;
    }

    /// Adds the gradient of `direction · P`, P being the marker's point and `direction` fixed.
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

    /// Adds the gradient of `factor * theta`, theta being the marker's direction.
    pub fn add_direction(&mut self, marker: MarkerPose, factor: f64) {
        self.add_turn(marker.body, factor);
    }

    /// Adds the gradient of `factor * phi`, phi being the body's angle; nothing for ground.
    pub fn add_turn(&mut self, body: Option<BodyId>, factor: f64) {
        if let Some(part) = self.part(body) {
            part[2] += factor;
        }
    }

    /// Adds the entry of a joint's own unknown, of which a relation contains one at most.
    pub fn add_joint_unknown(&mut self, column: usize, value: f64) {
        let entry = self.joint_unknown.get_or_insert((column, 0.0));
        debug_assert_eq!(entry.0, column, "a relation has one unknown of its joint's");
        entry.1 += value;
    }

    /// The entries as pairs of an index in q and a value, body by body.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.parts[..self.len]
            .iter()
            .flat_map(|(body, part)| (0..3).map(move |k| (3 * body + k, part[k])))
            .chain(self.joint_unknown)
    }

    /// The product of the row with a vector over q.
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

/// Velocity of a marker's point: ṙ + omega perp(A s).
#[must_use]
pub fn point_velocity(marker: MarkerPose, q_dot: &[f64]) -> Vector2<f64> {
    marker.body.map_or_else(Vector2::zeros, |body| {
        let k = 3 * body.index();
        Vector2::new(q_dot[k], q_dot[k + 1]) + q_dot[k + 2] * perp(marker.arm)
    })
}

/// Acceleration of a marker's point: r̈ + alpha perp(A s) − omega² A s.
#[must_use]
pub fn point_acceleration(marker: MarkerPose, q_dot: &[f64], q_ddot: &[f64]) -> Vector2<f64> {
    point_velocity(marker, q_ddot) + centripetal(marker, q_dot)
}

/// What remains of the point's acceleration where q̈ = 0: −omega² A s.
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
    /// Indices in q; one may come twice.
    pub unknowns: Vec<usize>,
    /// Parameters, as the expressions name them; one may come twice.
    pub parameters: Vec<ParameterId>,
}

impl Incidence {
    /// Notes what an expression uses.
    pub fn expression(&mut self, expression: &Expression) {
        self.parameters.extend(expression.parameters());
    }

    /// Notes what the x (first) and y (second) components of a marker's point contain, as far as
    /// `components` asks for them.
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

    /// Notes a joint's own unknown.
    pub fn joint_unknown(&mut self, mechanism: &Mechanism, unknown: JointUnknownId) {
        self.unknowns.push(3 * mechanism.bodies.len() + unknown.0);
    }

    /// Notes what a marker's direction contains.
    pub fn direction(&mut self, mechanism: &Mechanism, marker: MarkerId) {
        let marker = &mechanism.markers[marker.index()];
        self.unknowns
            .extend(marker.body.map(|body| 3 * body.index() + 2));
        self.expression(&marker.angle);
    }
}

/// Whether a marker's axis can have a component along the global x and y.
fn axis_components(mechanism: &Mechanism, marker: MarkerId, axis: Axis) -> [bool; 2] {
    let marker = &mechanism.markers[marker.index()];
    match (marker.body, marker.angle.literal()) {
        // On ground with a literal angle the axis has a fixed direction, which often runs along
        // x or y.
        (None, Some(angle)) => {
            let e = axis.of(configuration::axis(angle));
            [e.x.abs() > 0.0, e.y.abs() > 0.0]
        }
        _ => [true, true],
    }
}

#[cfg(test)]
mod tests;
