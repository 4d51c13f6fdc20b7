//! A moving mechanism on numbers with derivatives.
//!
//! Relations are formulas on these numbers, written once for each purpose:
//!
//! | number | derivatives | use |
//! |---|---|---|
//! | [`Dual`], [`Jet`](crate::mechanism::Jet) | along a straight line in the space of q | gradients and quadratic terms |
//! | [`Varied`] | in time, each with its change along a direction in the space of drivers and parameters | [`Sensitivity`](crate::kinematics::Sensitivity) |
//! | [`Enclosed`] | along a sub-step, each enclosed over all of it | the certificate while parameters move |

use super::configuration::{
    CamProfile, Coefficient, CoefficientId, JointUnknownId, LawId, ProfileId, ShapeCore,
};
use crate::mechanism::{
    BodyId, Dual, Expression, Feature, Interval, Jet3, MarkerId, Mechanism, MotionInForce,
    MovingProfile, Number, PointPath, ProfileAlong, ShapeId, Taylor,
};

/// A quantity with its first two derivatives in time, each with its change along a direction.
pub type Varied = Taylor<Dual, 2>;

/// Bounds of a quantity and of its derivatives along a sub-step.
pub type Enclosed = Jet3<Interval>;

/// A number that the quantities of a moving mechanism are made of.
pub trait Moving: Number {
    /// The bodies and coefficients of the mechanism.
    type Bodies<'a>: Bodies<Self>;

    /// The profiles of all cams and the laws of all couplings.
    type Curves<'a>: Copy + std::fmt::Debug;

    /// Returns the radius R of a cam at a moving polar angle θ, and R′(θ). Derivatives that do not
    /// exist are not finite.
    fn radius(curves: Self::Curves<'_>, profile: ProfileId, theta: Self) -> [Self; 2];

    /// Returns a law at a moving argument. Derivatives that do not exist are not finite.
    fn law(curves: Self::Curves<'_>, law: LawId, argument: Self) -> Self;

    /// Returns x and y of a path at a moving place, and their derivatives by the place.
    fn on_points(path: &PointPath, place: Self) -> [[Self; 2]; 2];
}

/// The bodies of a mechanism on some type of numbers.
pub trait Bodies<N> {
    /// Returns a marker.
    fn marker(&self, marker: MarkerId) -> VariedMarker<N>;

    /// Returns the point P of a marker.
    fn point(&self, marker: MarkerId) -> [N; 2] {
        self.marker(marker).point
    }

    /// Returns a body's angle \[rad\], zero for ground.
    fn phi(&self, body: Option<BodyId>) -> N;

    /// Returns a coefficient.
    fn coefficient(&self, id: CoefficientId) -> N;

    /// Returns a joint unknown.
    fn joint_unknown(&self, id: JointUnknownId) -> N;

    /// Returns origin and x-axis of a body, those of ground for `None`.
    fn frame(&self, body: Option<BodyId>) -> ([N; 2], [N; 2]);

    /// Returns the body of a shape.
    fn carrier(&self, shape: ShapeId) -> Option<BodyId>;

    /// Returns the number of features of a shape's core.
    fn features(&self, shape: ShapeId) -> usize;

    /// Returns one of them, in the frame of its body.
    fn feature(&self, shape: ShapeId, k: usize) -> Feature<N>;

    /// Returns the radius round a shape's core.
    fn core_radius(&self, shape: ShapeId) -> N;
}

/// The profiles of all cams and the laws of all couplings along a direction.
#[derive(Clone, Debug, Default)]
pub struct CurvesAlong {
    /// The profiles.
    pub profiles: Vec<ProfileAlong>,
    /// The laws.
    pub laws: Vec<MotionInForce<Varied>>,
}

impl CurvesAlong {
    /// Returns whether there are none.
    pub(in crate::kinematics) fn is_empty(&self) -> bool {
        self.profiles.is_empty() && self.laws.is_empty()
    }
}

impl Moving for Varied {
    type Bodies<'a> = VariedConfiguration;
    type Curves<'a> = &'a CurvesAlong;

    fn radius(curves: &CurvesAlong, profile: ProfileId, theta: Self) -> [Self; 2] {
        of_contour(curves.profiles[profile.0].radius(theta.value), theta)
    }

    fn law(curves: &CurvesAlong, law: LawId, argument: Self) -> Self {
        curves.laws[law.0].evaluate(argument)
    }

    fn on_points(path: &PointPath, place: Self) -> [[Self; 2]; 2] {
        let at = path.at(place.value.value);
        let along = place.value.first();
        // Cubics have no further derivatives.
        let jet = |c: Jet3| {
            let [first, second, third] = c.derivatives;
            Jet3::new(
                Dual::new(c.value, [first * along]),
                [
                    Dual::new(first, [second * along]),
                    Dual::new(second, [third * along]),
                    Dual::constant(third),
                ],
            )
        };
        on_path(at.map(jet), place)
    }
}

/// The profiles of all cams and the laws of all couplings along a sub-step.
#[derive(Clone, Copy, Debug)]
pub struct EnclosedCurves<'a> {
    /// The profiles with the parameters in force at its end.
    pub in_force: &'a [CamProfile],
    /// The same with parameters that may move; empty if none does.
    pub moving: &'a [MovingProfile],
    /// The laws with parameters that may move.
    pub laws: &'a [MotionInForce<Enclosed>],
}

impl Moving for Enclosed {
    type Bodies<'a> = VariedConfiguration<Self>;
    type Curves<'a> = EnclosedCurves<'a>;

    fn law(curves: EnclosedCurves<'_>, law: LawId, argument: Self) -> Self {
        let law = curves.laws[law.0].enclose(argument);
        law.unwrap_or_else(Self::unknown)
    }

    fn radius(curves: EnclosedCurves<'_>, profile: ProfileId, theta: Self) -> [Self; 2] {
        let EnclosedCurves {
            in_force, moving, ..
        } = curves;
        let in_force = &in_force[profile.0].in_force;
        if let Some(moving) = moving.get(profile.0).filter(|profile| profile.moves()) {
            return (moving.radius(in_force, theta)).unwrap_or([Self::unknown(); 2]);
        }
        let middle = theta.value.midpoint();
        let reach = (theta.value - Interval::point(middle)).magnitude();
        let Some(bounds) = in_force.bounds(middle, reach) else {
            return [Self::unknown(); 2];
        };
        let mut radius = bounds.radius;
        if bounds.jumps {
            radius.derivatives[2] = Interval::unknown();
        }
        of_contour(radius, theta)
    }

    fn on_points(path: &PointPath, place: Self) -> [[Self; 2]; 2] {
        let mut found = on_path(path.over(place.value), place);
        // The third derivative jumps at points.
        for component in found.as_flattened_mut() {
            component.derivatives[2] = Interval::unknown();
        }
        found
    }
}

/// Bounds eight times the distance of a quantity along a sub-step from its chord: by its second
/// derivative, at a corner by the range of the first one, at a jump by its own range.
pub(in crate::kinematics) fn bend(quantity: &Enclosed) -> f64 {
    let width = |range: Interval| range.high - range.low;
    if quantity.second().is_finite() {
        quantity.second().magnitude()
    } else if quantity.first().is_finite() {
        2.0 * width(quantity.first())
    } else {
        8.0 * width(quantity.value)
    }
}

/// Returns the components of a path and their derivatives by a moving place, from those with three
/// derivatives by it.
pub(super) fn on_path<S: Number, const N: usize>(
    at: [Jet3<S>; 2],
    place: Taylor<S, N>,
) -> [[Taylor<S, N>; 2]; 2] {
    let [x, y] = at.map(|c| {
        let [first, second, third] = c.derivatives;
        [
            place.chain(c.value, |_| [first, second, third]),
            place.chain(first, |_| [second, third, S::constant(0.0)]),
        ]
    });
    [[x[0], y[0]], [x[1], y[1]]]
}

/// Returns R(θ) and R′(θ) for a moving θ, from R and its derivatives with respect to θ.
pub(super) fn of_contour<S: Number, const N: usize>(
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

/// The core of a shape, with the numbers that it has.
#[derive(Clone, Debug)]
struct VariedCore<N> {
    numbers: Vec<N>,
    core: ShapeCore<N>,
}

/// The bodies of a moving mechanism: the counterpart of [`Configuration`](crate::kinematics::Configuration).
#[derive(Clone, Debug)]
pub struct VariedConfiguration<N = Varied> {
    frames: Vec<VariedFrame<N>>,
    coefficients: Vec<N>,
    cores: Vec<VariedCore<N>>,
    bodies: usize,
    /// The generalized coordinates, then the joint unknowns.
    q: Vec<N>,
    /// The x-axes of the bodies, which follow from q.
    axes: Vec<[N; 2]>,
}

/// A moving mechanism, as relations read it.
#[derive(Debug)]
pub struct VariedMechanism<'a, 'p, N: Moving = Varied> {
    /// Its bodies.
    pub bodies: &'a N::Bodies<'p>,
    /// The curves in its relations.
    pub curves: N::Curves<'p>,
}

impl<N> Default for VariedConfiguration<N> {
    /// Makes a mechanism without bodies.
    fn default() -> Self {
        Self {
            frames: Vec::new(),
            coefficients: Vec::new(),
            cores: Vec::new(),
            bodies: 0,
            q: Vec::new(),
            axes: Vec::new(),
        }
    }
}

impl<N: Number> VariedConfiguration<N> {
    /// Makes a mechanism at rest at the origin, whose parameters are all zero.
    pub(in crate::kinematics) fn new(
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
        let cores = ShapeCore::all(mechanism).into_iter().zip(&mechanism.shapes);
        let cores = cores.map(|(core, shape)| VariedCore {
            numbers: vec![zero; shape.numbers().count()],
            core,
        });
        let mut origin = Self {
            frames: frames.collect(),
            coefficients: vec![zero; coefficients.len()],
            cores: cores.collect(),
            bodies,
            q: vec![zero; unknowns],
            axes: vec![axis; bodies],
        };
        let parameters = vec![zero; mechanism.parameters.len()];
        let at_zero = |expression: &Expression| Some(evaluate(expression, &parameters));
        origin.set_numbers(mechanism, coefficients, &at_zero);
        origin
    }

    /// Sets the numbers in the relations to those that `value` gives; the others stay. Allocates
    /// nothing.
    pub(in crate::kinematics) fn set_numbers(
        &mut self,
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        value: &dyn Fn(&Expression) -> Option<N>,
    ) {
        for (frame, marker) in self.frames.iter_mut().zip(&mechanism.markers) {
            for (s, expression) in frame.position.iter_mut().zip(&marker.position) {
                if let Some(value) = value(expression) {
                    *s = value;
                }
            }
            if let Some(angle) = value(&marker.angle) {
                frame.angle = angle;
                frame.axis = direction(angle);
            }
        }
        for (number, coefficient) in self.coefficients.iter_mut().zip(coefficients) {
            if let Some(value) = value(&coefficient.expression) {
                *number = value;
            }
        }
        let frames = &self.frames;
        for (core, shape) in self.cores.iter_mut().zip(&mechanism.shapes) {
            for (number, expression) in core.numbers.iter_mut().zip(shape.numbers()) {
                if let Some(value) = value(expression) {
                    *number = value;
                }
            }
            let numbers = &core.numbers;
            let point = |id: MarkerId| frames[id.index()].position;
            core.core.set(shape, &point, &|number| {
                let mut known = shape.numbers().zip(numbers);
                let found = known.find(|(own, _)| std::ptr::eq(*own, number));
                found.map_or_else(N::unknown, |(_, value)| *value)
            });
        }
    }

    /// Returns q\[column\].
    #[must_use]
    pub fn coordinate(&self, column: usize) -> N {
        self.q[column]
    }

    /// Sets q\[column\].
    pub(in crate::kinematics) fn set_coordinate(&mut self, column: usize, q: N) {
        self.q[column] = q;
        if column < 3 * self.bodies && column % 3 == 2 {
            self.axes[column / 3] = direction(q);
        }
    }

    /// Returns a point of a body's frame.
    fn placed(&self, body: usize, position: [N; 2]) -> [N; 2] {
        let origin = [self.q[3 * body], self.q[3 * body + 1]];
        add(origin, turned(self.axes[body], position))
    }

    /// Returns a marker's point and angle in its body's frame.
    pub(in crate::kinematics) fn local(&self, marker: MarkerId) -> ([N; 2], N) {
        let frame = &self.frames[marker.index()];
        (frame.position, frame.angle)
    }
}

impl<N: Number> Bodies<N> for VariedConfiguration<N> {
    fn marker(&self, marker: MarkerId) -> VariedMarker<N> {
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
        VariedMarker {
            point: self.placed(body, position),
            axis: turned(self.axes[body], axis),
            theta: self.q[3 * body + 2] + angle,
        }
    }

    fn point(&self, marker: MarkerId) -> [N; 2] {
        let VariedFrame { body, position, .. } = self.frames[marker.index()];
        body.map_or(position, |body| self.placed(body.index(), position))
    }

    fn phi(&self, body: Option<BodyId>) -> N {
        body.map_or(N::constant(0.0), |body| self.q[3 * body.index() + 2])
    }

    fn coefficient(&self, id: CoefficientId) -> N {
        self.coefficients[id.0]
    }

    fn joint_unknown(&self, id: JointUnknownId) -> N {
        self.q[3 * self.bodies + id.0]
    }

    fn frame(&self, body: Option<BodyId>) -> ([N; 2], [N; 2]) {
        let zero = N::constant(0.0);
        let Some(body) = body.map(BodyId::index) else {
            return ([zero; 2], [N::constant(1.0), zero]);
        };
        ([self.q[3 * body], self.q[3 * body + 1]], self.axes[body])
    }

    fn carrier(&self, shape: ShapeId) -> Option<BodyId> {
        self.cores[shape.index()].core.body
    }

    fn features(&self, shape: ShapeId) -> usize {
        self.cores[shape.index()].core.core.features.len()
    }

    fn feature(&self, shape: ShapeId, k: usize) -> Feature<N> {
        self.cores[shape.index()].core.core.features[k]
    }

    fn core_radius(&self, shape: ShapeId) -> N {
        self.cores[shape.index()].core.core.radius
    }
}

impl VariedConfiguration<Enclosed> {
    /// Sets the numbers in the relations to those of another mechanism, at rest anywhere in their
    /// ranges. Allocates nothing.
    pub(in crate::kinematics) fn rest_at_numbers_of(&mut self, other: &Self) {
        let still = |number: Enclosed| Enclosed::fixed(number.value);
        for (frame, from) in self.frames.iter_mut().zip(&other.frames) {
            frame.position = from.position.map(still);
            frame.angle = still(from.angle);
            frame.axis = from.axis.map(still);
        }
        for (number, from) in self.coefficients.iter_mut().zip(&other.coefficients) {
            *number = still(*from);
        }
    }
}

impl<S: Number, const N: usize> VariedConfiguration<Taylor<S, N>> {
    /// Sets q\[column\], whose value stays, and with it sine and cosine.
    pub(super) fn move_coordinate(&mut self, column: usize, q: Taylor<S, N>) {
        self.q[column] = q;
        if column < 3 * self.bodies && column % 3 == 2 {
            let axis = &mut self.axes[column / 3];
            let [cos, sin] = axis.map(|component| component.value);
            *axis = [
                q.chain(cos, |_| [-sin, -cos, sin]),
                q.chain(sin, |_| [cos, -sin, -cos]),
            ];
        }
    }
}

impl VariedConfiguration {
    /// Returns the mechanism at rest, with the values that it has.
    pub(in crate::kinematics) fn at_rest(&self) -> Self {
        let mut still = self.clone();
        for column in 0..still.q.len() {
            still.move_coordinate(column, Varied::fixed(still.q[column].value));
        }
        still
    }

    /// Sets the rates of q, which do not change along the direction; there are no accelerations.
    pub(in crate::kinematics) fn move_at(&mut self, rates: &[f64]) {
        let zero = Dual::constant(0.0);
        for (column, rate) in rates.iter().enumerate() {
            let rates = [Dual::constant(*rate), zero];
            self.move_coordinate(column, Varied::new(self.q[column].value, rates));
        }
    }

    /// Returns whether a number in the relations changes along the direction.
    pub(in crate::kinematics) fn numbers_change(&self) -> bool {
        let of_frames = self.frames.iter().flat_map(|frame| {
            let [x, y] = frame.position;
            [x, y, frame.angle]
        });
        let of_cores = self.cores.iter().flat_map(|core| &core.numbers);
        let mut numbers = of_frames.chain(self.coefficients.iter().chain(of_cores).copied());
        numbers.any(|number| number.value.first() != 0.0)
    }

    /// Sets the changes of q (order 0), q̇ (order 1) or q̈ (order 2) along the direction.
    pub(in crate::kinematics) fn change(&mut self, order: usize, changes: &[f64]) {
        self.take_changes(order, |column| Some(changes[column]));
    }

    /// Sets those changes that `change` returns for a column.
    pub(in crate::kinematics) fn take_changes(
        &mut self,
        order: usize,
        change: impl Fn(usize) -> Option<f64>,
    ) {
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
            if order == 0 {
                self.set_coordinate(column, q);
            } else {
                self.move_coordinate(column, q);
            }
        }
    }

    /// Returns the change of q\[column\] or of its derivative of this order.
    pub(in crate::kinematics) fn change_of(&self, order: usize, column: usize) -> f64 {
        let q = &self.q[column];
        [q.value, q.first(), q.second()][order].first()
    }
}

impl<'p, N: Moving> std::ops::Deref for VariedMechanism<'_, 'p, N> {
    type Target = N::Bodies<'p>;

    fn deref(&self) -> &Self::Target {
        self.bodies
    }
}

impl<N: Moving> VariedMechanism<'_, '_, N> {
    /// Returns a marker.
    #[must_use]
    pub fn marker(&self, marker: MarkerId) -> VariedMarker<N> {
        self.bodies.marker(marker)
    }

    /// Returns the point of a marker.
    #[must_use]
    pub fn point(&self, marker: MarkerId) -> [N; 2] {
        self.bodies.point(marker)
    }

    /// Returns a body's angle \[rad\], zero for ground.
    #[must_use]
    pub fn phi(&self, body: Option<BodyId>) -> N {
        self.bodies.phi(body)
    }

    /// Returns a coefficient.
    #[must_use]
    pub fn coefficient(&self, id: CoefficientId) -> N {
        self.bodies.coefficient(id)
    }

    /// Returns a joint unknown.
    #[must_use]
    pub fn joint_unknown(&self, id: JointUnknownId) -> N {
        self.bodies.joint_unknown(id)
    }

    /// Returns origin and x-axis of a body, those of ground for `None`.
    #[must_use]
    pub fn frame(&self, body: Option<BodyId>) -> ([N; 2], [N; 2]) {
        self.bodies.frame(body)
    }

    /// Returns the body of a shape.
    #[must_use]
    pub fn carrier(&self, shape: ShapeId) -> Option<BodyId> {
        self.bodies.carrier(shape)
    }

    /// Returns the number of features of a shape's core.
    #[must_use]
    pub fn features(&self, shape: ShapeId) -> usize {
        self.bodies.features(shape)
    }

    /// Returns one of them, in the frame of its body.
    #[must_use]
    pub fn feature(&self, shape: ShapeId, k: usize) -> Feature<N> {
        self.bodies.feature(shape, k)
    }

    /// Returns the radius round a shape's core.
    #[must_use]
    pub fn core_radius(&self, shape: ShapeId) -> N {
        self.bodies.core_radius(shape)
    }

    /// Returns the radius R of a cam at a moving polar angle θ, and R′(θ).
    #[must_use]
    pub fn radius(&self, profile: ProfileId, theta: N) -> [N; 2] {
        N::radius(self.curves, profile, theta)
    }

    /// Returns a law at a moving argument.
    #[must_use]
    pub fn law(&self, law: LawId, argument: N) -> N {
        N::law(self.curves, law, argument)
    }
}

/// Returns the value of an expression without time.
// Inlined, it would be many times in the libraries of FMUs.
#[inline(never)]
pub(in crate::kinematics) fn evaluate<N: Number>(expression: &Expression, parameters: &[N]) -> N {
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
pub(super) fn turned<N: Number>([cos, sin]: [N; 2], [x, y]: [N; 2]) -> [N; 2] {
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
