//! A moving mechanism with the derivatives of its motion along a direction.
//!
//! The direction is in the space of values, velocities and accelerations of the drivers, and of the
//! parameters. Each quantity is a [`Varied`] number, on which the relations are evaluated; its
//! arithmetic differentiates exactly.

use super::configuration::{CamProfile, Coefficient, CoefficientId, JointUnknownId, ProfileId};
use crate::mechanism::{
    BodyId, Dual, Expression, MarkerId, Mechanism, Number, ParameterId, ProfileAlong, Taylor,
};

/// A quantity with its first two derivatives in time, each with its change along the direction.
pub type Varied = Taylor<Dual, 2>;

/// A vector in the plane.
pub type VariedVector = [Varied; 2];

/// A marker in a moving mechanism.
#[derive(Clone, Copy, Debug)]
pub struct VariedMarker {
    /// P \[m\].
    pub point: VariedVector,
    /// u, the marker's x-axis.
    pub axis: VariedVector,
    /// theta, its direction \[rad\].
    pub theta: Varied,
}

/// A marker in its body's frame.
#[derive(Clone, Copy, Debug)]
struct VariedFrame {
    body: Option<BodyId>,
    position: VariedVector,
    angle: Varied,
    axis: VariedVector,
}

/// The bodies of a moving mechanism: the counterpart of [`Configuration`](super::Configuration) on
/// [`Varied`] numbers.
#[derive(Clone, Debug)]
pub struct VariedConfiguration {
    frames: Vec<VariedFrame>,
    coefficients: Vec<Varied>,
    profiles: Vec<ProfileAlong>,
    bodies: usize,
    /// The generalized coordinates, then the joint unknowns.
    q: Vec<Varied>,
    /// The x-axes of the bodies, which follow from q.
    axes: Vec<VariedVector>,
}

impl VariedConfiguration {
    /// Makes a mechanism that moves with q, q̇ and q̈ and whose parameters change; the changes of q
    /// are still to be set.
    pub(super) fn new(
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        profiles: &[CamProfile],
        parameter: impl Fn(ParameterId) -> Varied,
        motion: impl Iterator<Item = [f64; 3]>,
    ) -> Self {
        let value = |expression: &Expression| evaluate(expression, &parameter);
        let frames = mechanism.markers.iter().map(|marker| {
            let angle = value(&marker.angle);
            VariedFrame {
                body: marker.body,
                position: marker.position.each_ref().map(value),
                angle,
                axis: direction(angle),
            }
        });
        let q = motion.map(|motion| {
            let [value, first, second] = motion.map(Dual::constant);
            Varied::new(value, [first, second])
        });
        let change = |p| parameter(p).value.first();
        let bodies = mechanism.bodies.len();
        let mut made = Self {
            frames: frames.collect(),
            coefficients: coefficients.iter().map(|c| value(&c.expression)).collect(),
            profiles: profiles.iter().map(|p| p.in_force.along(change)).collect(),
            bodies,
            q: q.collect(),
            axes: vec![[Varied::constant(0.0); 2]; bodies],
        };
        made.turn_bodies();
        made
    }

    /// Makes the axes of all bodies those that q gives.
    fn turn_bodies(&mut self) {
        for body in 0..self.bodies {
            self.turn_body(body);
        }
    }

    fn turn_body(&mut self, body: usize) {
        self.axes[body] = direction(self.q[3 * body + 2]);
    }

    /// Returns q\[column\].
    #[must_use]
    pub fn coordinate(&self, column: usize) -> Varied {
        self.q[column]
    }

    /// Sets the changes of q (order 0), q̇ (order 1) or q̈ (order 2).
    pub(super) fn change(&mut self, order: usize, changes: &[f64]) {
        for (q, change) in self.q.iter_mut().zip(changes) {
            let coefficient = match order {
                0 => &mut q.value,
                _ => &mut q.derivatives[order - 1],
            };
            coefficient.derivatives = [*change];
        }
        self.turn_bodies();
    }

    /// Returns the mechanism at rest, with the same changes of q and of the parameters.
    pub(super) fn at_rest(&self) -> Self {
        let mut still = self.clone();
        for q in &mut still.q {
            *q = Varied::fixed(q.value);
        }
        still.turn_bodies();
        still
    }

    /// Sets the rate of q\[column\], which does not change along the direction.
    pub(super) fn set_velocity(&mut self, column: usize, velocity: f64) {
        self.q[column].derivatives[0] = Dual::constant(velocity);
        if column < 3 * self.bodies && column % 3 == 2 {
            self.turn_body(column / 3);
        }
    }

    /// Returns a marker.
    #[must_use]
    pub fn marker(&self, marker: MarkerId) -> VariedMarker {
        let VariedFrame {
            body,
            position,
            angle,
            axis,
        } = self.frames[marker.index()];
        let Some(body) = body.map(BodyId::index) else {
            return VariedMarker {
                point: position,
                axis,
                theta: angle,
            };
        };
        let (k, turn) = (3 * body, self.axes[body]);
        VariedMarker {
            point: add([self.q[k], self.q[k + 1]], turned(turn, position)),
            axis: turned(turn, axis),
            theta: self.q[k + 2] + angle,
        }
    }

    /// Returns a body's angle \[rad\], zero for ground.
    #[must_use]
    pub fn phi(&self, body: Option<BodyId>) -> Varied {
        body.map_or(Varied::constant(0.0), |body| self.q[3 * body.index() + 2])
    }

    /// Returns a coefficient.
    #[must_use]
    pub fn coefficient(&self, id: CoefficientId) -> Varied {
        self.coefficients[id.0]
    }

    /// Returns a joint unknown.
    #[must_use]
    pub fn joint_unknown(&self, id: JointUnknownId) -> Varied {
        self.q[3 * self.bodies + id.0]
    }

    /// Returns the radius R of a cam at a moving polar angle θ, and R′(θ).
    #[must_use]
    pub fn radius(&self, profile: ProfileId, theta: Varied) -> [Varied; 2] {
        let radius = self.profiles[profile.0].radius(theta.value);
        let [r_1, r_2, r_3] = radius.derivatives;
        [
            theta.chain(radius.value, |_| [r_1, r_2, r_3]),
            theta.chain(r_1, |_| [r_2, r_3, Dual::unknown()]),
        ]
    }
}

/// Returns the value of an expression without time.
pub(super) fn evaluate(
    expression: &Expression,
    parameter: &impl Fn(ParameterId) -> Varied,
) -> Varied {
    expression.evaluate(parameter, Varied::constant(0.0))
}

/// Returns the unit vector at an angle \[rad\].
#[must_use]
pub fn direction(theta: Varied) -> VariedVector {
    [theta.cos(), theta.sin()]
}

/// Returns a vector turned by an angle.
#[must_use]
pub fn rotate(angle: Varied, vector: VariedVector) -> VariedVector {
    turned(direction(angle), vector)
}

/// Returns a vector turned as the x-axis is to the unit vector (cos, sin).
fn turned([cos, sin]: VariedVector, [x, y]: VariedVector) -> VariedVector {
    [cos * x - sin * y, sin * x + cos * y]
}

/// Returns a vector turned by a quarter turn.
#[must_use]
pub fn quarter_turn([x, y]: VariedVector) -> VariedVector {
    [-y, x]
}

/// Returns a + b.
#[must_use]
pub fn add(a: VariedVector, b: VariedVector) -> VariedVector {
    [a[0] + b[0], a[1] + b[1]]
}

/// Returns a − b.
#[must_use]
pub fn subtract(a: VariedVector, b: VariedVector) -> VariedVector {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns a · b.
#[must_use]
pub fn dot(a: VariedVector, b: VariedVector) -> Varied {
    a[0] * b[0] + a[1] * b[1]
}
