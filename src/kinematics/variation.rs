//! A moving mechanism on numbers with derivatives.
//!
//! Relations are formulas on these numbers, written once for each purpose:
//!
//! | number | derivatives | use |
//! |---|---|---|
//! | [`Varied`] | in time, each with its change along a direction in the space of drivers and parameters | [`Sensitivity`](super::Sensitivity) |
//! | [`Enclosed`] | along a sub-step, each enclosed over all of it | the certificate while parameters move |

use super::configuration::{CamProfile, Coefficient, CoefficientId, JointUnknownId, ProfileId};
use crate::mechanism::{
    BodyId, Dual, Expression, Interval, Jet3, MarkerId, Mechanism, Number, ProfileAlong, Taylor,
};

/// A quantity with its first two derivatives in time, each with its change along a direction.
pub type Varied = Taylor<Dual, 2>;

/// Bounds of a quantity and of its derivatives along a sub-step.
pub type Enclosed = Jet3<Interval>;

/// A number that the quantities of a moving mechanism are made of.
pub trait Moving: Number {
    /// The profile of a cam.
    type Profile: std::fmt::Debug;

    /// Returns the radius R of a cam at a moving polar angle θ, and R′(θ). Derivatives that do not
    /// exist are not finite.
    fn radius(profile: &Self::Profile, theta: Self) -> [Self; 2];
}

impl Moving for Varied {
    type Profile = ProfileAlong;

    fn radius(profile: &ProfileAlong, theta: Self) -> [Self; 2] {
        of_contour(profile.radius(theta.value), theta)
    }
}

impl Moving for Enclosed {
    /// A profile that no parameter moves.
    type Profile = CamProfile;

    fn radius(profile: &CamProfile, theta: Self) -> [Self; 2] {
        let middle = theta.value.midpoint();
        let reach = (theta.value - Interval::point(middle)).magnitude();
        let Some(bounds) = profile.in_force.bounds(middle, reach) else {
            return [Self::unknown(); 2];
        };
        let mut radius = bounds.radius;
        if bounds.jumps {
            radius.derivatives[2] = Interval::unknown();
        }
        of_contour(radius, theta)
    }
}

/// Returns R(θ) and R′(θ) for a moving θ, from R and its derivatives with respect to θ.
fn of_contour<S: Number, const N: usize>(
    radius: Jet3<S>,
    theta: Taylor<S, N>,
) -> [Taylor<S, N>; 2] {
    let [r_1, r_2, r_3] = radius.derivatives;
    [
        theta.chain(radius.value, |_| [r_1, r_2, r_3]),
        theta.chain(r_1, |_| [r_2, r_3, S::unknown()]),
    ]
}

/// A marker in a moving mechanism.
#[derive(Clone, Copy, Debug)]
pub struct VariedMarker<N = Varied> {
    /// P \[m\].
    pub point: [N; 2],
    /// u, the marker's x-axis.
    pub axis: [N; 2],
    /// theta, its direction \[rad\].
    pub theta: N,
}

/// A marker in its body's frame.
#[derive(Clone, Copy, Debug)]
struct VariedFrame<N> {
    body: Option<BodyId>,
    position: [N; 2],
    angle: N,
    axis: [N; 2],
}

/// The bodies of a moving mechanism: the counterpart of [`Configuration`](super::Configuration).
#[derive(Clone, Debug)]
pub struct VariedConfiguration<N = Varied> {
    frames: Vec<VariedFrame<N>>,
    coefficients: Vec<N>,
    bodies: usize,
    /// The generalized coordinates, then the joint unknowns.
    q: Vec<N>,
    /// The x-axes of the bodies, which follow from q.
    axes: Vec<[N; 2]>,
}

/// A moving mechanism, as relations read it.
#[derive(Debug)]
pub struct VariedMechanism<'a, N: Moving = Varied> {
    /// Its bodies.
    pub bodies: &'a VariedConfiguration<N>,
    /// The profiles of its cams.
    pub profiles: &'a [N::Profile],
}

impl<N> Default for VariedConfiguration<N> {
    /// Makes a mechanism without bodies.
    fn default() -> Self {
        Self {
            frames: Vec::new(),
            coefficients: Vec::new(),
            bodies: 0,
            q: Vec::new(),
            axes: Vec::new(),
        }
    }
}

impl<N: Number> VariedConfiguration<N> {
    /// Makes a mechanism at rest at the origin, whose parameters are all zero.
    pub(super) fn new(
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        unknowns: usize,
    ) -> Self {
        let zero = N::constant(0.0);
        let axis = [N::constant(1.0), zero];
        let frames = mechanism.markers.iter().map(|marker| VariedFrame {
            body: marker.body,
            position: [zero; 2],
            angle: zero,
            axis,
        });
        let bodies = mechanism.bodies.len();
        let mut origin = Self {
            frames: frames.collect(),
            coefficients: vec![zero; coefficients.len()],
            bodies,
            q: vec![zero; unknowns],
            axes: vec![axis; bodies],
        };
        let parameters = vec![zero; mechanism.parameters.len()];
        origin.set_parameters(mechanism, coefficients, &parameters, None);
        origin
    }

    /// Evaluates the numbers in the relations for these parameters, or only those numbers that use
    /// parameters which have `changed`. Allocates nothing.
    pub(super) fn set_parameters(
        &mut self,
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        parameters: &[N],
        changed: Option<&[bool]>,
    ) {
        let evaluated = |expression: &Expression| {
            let mut used = expression.parameters();
            let is_stale = changed.is_none_or(|changed| used.any(|p| changed[p.index()]));
            is_stale.then(|| evaluate(expression, parameters))
        };
        for (frame, marker) in self.frames.iter_mut().zip(&mechanism.markers) {
            for (s, expression) in frame.position.iter_mut().zip(&marker.position) {
                if let Some(value) = evaluated(expression) {
                    *s = value;
                }
            }
            if let Some(angle) = evaluated(&marker.angle) {
                frame.angle = angle;
                frame.axis = direction(angle);
            }
        }
        for (value, coefficient) in self.coefficients.iter_mut().zip(coefficients) {
            if let Some(now) = evaluated(&coefficient.expression) {
                *value = now;
            }
        }
    }

    /// Returns q\[column\].
    #[must_use]
    pub fn coordinate(&self, column: usize) -> N {
        self.q[column]
    }

    /// Sets q\[column\].
    pub(super) fn set_coordinate(&mut self, column: usize, q: N) {
        self.q[column] = q;
        if column < 3 * self.bodies && column % 3 == 2 {
            self.axes[column / 3] = direction(q);
        }
    }

    /// Returns a marker's point and angle in its body's frame.
    pub(super) fn local(&self, marker: MarkerId) -> ([N; 2], N) {
        let frame = &self.frames[marker.index()];
        (frame.position, frame.angle)
    }

    /// Returns a marker.
    #[must_use]
    pub fn marker(&self, marker: MarkerId) -> VariedMarker<N> {
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
    pub fn phi(&self, body: Option<BodyId>) -> N {
        body.map_or(N::constant(0.0), |body| self.q[3 * body.index() + 2])
    }

    /// Returns a coefficient.
    #[must_use]
    pub fn coefficient(&self, id: CoefficientId) -> N {
        self.coefficients[id.0]
    }

    /// Returns a joint unknown.
    #[must_use]
    pub fn joint_unknown(&self, id: JointUnknownId) -> N {
        self.q[3 * self.bodies + id.0]
    }
}

impl VariedConfiguration {
    /// Returns the mechanism at rest, with the values that it has.
    pub(super) fn at_rest(&self) -> Self {
        let mut still = self.clone();
        for column in 0..still.q.len() {
            still.set_coordinate(column, Varied::fixed(still.q[column].value));
        }
        still
    }

    /// Sets the changes of q (order 0), q̇ (order 1) or q̈ (order 2) along the direction.
    pub(super) fn change(&mut self, order: usize, changes: &[f64]) {
        self.take_changes(order, |column| Some(changes[column]));
    }

    /// Sets those changes that `change` returns for a column.
    pub(super) fn take_changes(&mut self, order: usize, change: impl Fn(usize) -> Option<f64>) {
        for column in 0..self.q.len() {
            let Some(change) = change(column) else {
                continue;
            };
            let mut q = self.q[column];
            let coefficient = match order {
                0 => &mut q.value,
                _ => &mut q.derivatives[order - 1],
            };
            coefficient.derivatives = [change];
            self.set_coordinate(column, q);
        }
    }

    /// Returns the change of q\[column\] or of its derivative of this order.
    pub(super) fn change_of(&self, order: usize, column: usize) -> f64 {
        let q = &self.q[column];
        [q.value, q.first(), q.second()][order].first()
    }
}

impl<N: Moving> std::ops::Deref for VariedMechanism<'_, N> {
    type Target = VariedConfiguration<N>;

    fn deref(&self) -> &Self::Target {
        self.bodies
    }
}

impl<N: Moving> VariedMechanism<'_, N> {
    /// Returns the radius R of a cam at a moving polar angle θ, and R′(θ).
    #[must_use]
    pub fn radius(&self, profile: ProfileId, theta: N) -> [N; 2] {
        N::radius(&self.profiles[profile.0], theta)
    }
}

/// Returns the value of an expression without time.
// Inlined, it would be many times in the libraries of FMUs.
#[inline(never)]
pub(super) fn evaluate<N: Number>(expression: &Expression, parameters: &[N]) -> N {
    expression.evaluate(&|p| parameters[p.index()], N::constant(0.0))
}

/// Returns the unit vector at an angle \[rad\].
#[must_use]
pub fn direction<N: Number>(theta: N) -> [N; 2] {
    [theta.cos(), theta.sin()]
}

/// Returns a vector turned by an angle.
#[must_use]
pub fn rotate<N: Number>(angle: N, vector: [N; 2]) -> [N; 2] {
    turned(direction(angle), vector)
}

/// Returns a vector turned as the x-axis is to the unit vector (cos, sin).
fn turned<N: Number>([cos, sin]: [N; 2], [x, y]: [N; 2]) -> [N; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

/// Returns a vector turned by a quarter turn.
#[must_use]
pub fn quarter_turn<N: Number>([x, y]: [N; 2]) -> [N; 2] {
    [-y, x]
}

/// Returns a + b.
#[must_use]
pub fn add<N: Number>(a: [N; 2], b: [N; 2]) -> [N; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Returns a − b.
#[must_use]
pub fn subtract<N: Number>(a: [N; 2], b: [N; 2]) -> [N; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns a · b.
#[must_use]
pub fn dot<N: Number>(a: [N; 2], b: [N; 2]) -> N {
    a[0] * b[0] + a[1] * b[1]
}
