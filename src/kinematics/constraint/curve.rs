//! A point on a curve of another body.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::Vector2;

use super::configuration::{
    CoefficientId, Configuration, JointUnknownId, MarkerPose, ParameterCoefficients, perp,
};
use super::definition::{Axis, Constraint, Dimension, Formula, Incidence, JointUnknown};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism, dot, quarter_turn};
use super::point::angular_velocity;
use super::projection::Projection;
use super::region::{Region, chord};
use crate::mechanism::{
    Expression, Interval, Jet, Jet3, MarkerId, Mechanism, Number, PointPath, Taylor,
};

/// Parts of a curve that a search for its nearest point begins with.
const PARTS: u32 = 256;
/// Most iterations of the search.
const ITERATIONS: usize = 20;

/// A curve in the frame of a marker, C(s), with s from 0 at its first to 1 at its last point, to a
/// whole turn on a closed curve.
///
/// A joint unknown counts as an angle, which comes back after a turn: on closed curves s does. The
/// length of a curve per unit of s makes its column about as large as those of angles.
#[derive(Clone, Debug)]
pub struct CurvePath {
    shape: Shape,
    /// Distance of the parallel curve to the left.
    offset: Option<CoefficientId>,
    /// Part of the curve per unit of s.
    part: f64,
    is_closed: bool,
}

/// The shape of a curve without its offset.
#[derive(Clone, Debug)]
enum Shape {
    Points(Arc<PointPath>),
    Formula(Arc<FormulaPath>),
}

/// Expressions of a curve.
#[derive(Clone, Debug)]
pub struct FormulaPath {
    /// x and y as functions of a variable.
    pub components: [Expression; 2],
    /// The variable at both ends.
    pub ends: [CoefficientId; 2],
    /// The parameters in `components`.
    pub parameters: ParameterCoefficients,
}

/// A number for which a curve gives derivatives: plain, or bounds.
trait Base: Number {
    fn on_points(path: &PointPath, s: Self) -> [Jet3<Self>; 2];
}

impl Base for f64 {
    fn on_points(path: &PointPath, s: Self) -> [Jet3<Self>; 2] {
        path.at(s)
    }
}

impl Base for Interval {
    fn on_points(path: &PointPath, s: Self) -> [Jet3<Self>; 2] {
        path.over(s)
    }
}

/// The place on a curve at one pose, with derivatives by s.
struct CurvePoint<S> {
    /// C on the axes of the curve's marker.
    point: [Taylor<S, 2>; 2],
    /// C′ of the curve without its offset.
    along: [S; 2],
    /// First and second derivative of its direction.
    turn: [S; 2],
}

impl CurvePath {
    /// Makes a spline through points.
    pub fn through_points(path: PointPath, offset: Option<CoefficientId>) -> Self {
        let is_closed = path.is_closed();
        Self::new(Shape::Points(Arc::new(path)), offset, is_closed)
    }

    /// Makes a curve of expressions.
    pub fn of_formula(
        formula: FormulaPath,
        offset: Option<CoefficientId>,
        is_closed: bool,
    ) -> Self {
        Self::new(Shape::Formula(Arc::new(formula)), offset, is_closed)
    }

    fn new(shape: Shape, offset: Option<CoefficientId>, is_closed: bool) -> Self {
        Self {
            shape,
            offset,
            part: if is_closed { TAU.recip() } else { 1.0 },
            is_closed,
        }
    }

    /// Returns s at the last end of an open curve.
    fn last_end(&self) -> Option<f64> {
        (!self.is_closed).then_some(1.0 / self.part)
    }

    /// Returns x and y of the curve without its offset.
    fn jets<S: Base>(&self, coefficient: impl Fn(CoefficientId) -> f64, s: S) -> [Jet3<S>; 2] {
        match &self.shape {
            Shape::Points(path) => {
                let part = self.part;
                let jets = S::on_points(path, s * part);
                jets.map(|c| {
                    let [first, second, third] = c.derivatives;
                    let scaled = [first * part, second * part.powi(2), third * part.powi(3)];
                    Jet3::new(c.value, scaled)
                })
            }
            Shape::Formula(formula) => {
                let part = Jet3::linear(s * self.part, S::constant(self.part));
                formula.at(part, |id| Jet3::constant(coefficient(id)))
            }
        }
    }

    fn place<S: Base>(&self, coefficient: impl Fn(CoefficientId) -> f64, s: S) -> CurvePoint<S> {
        let jets = self.jets(&coefficient, s);
        let point = jets.map(|c| Taylor::<S, 2>::new(c.value, [c.first(), c.second()]));
        let slope = jets.map(|c| Taylor::<S, 2>::new(c.first(), [c.second(), c.third()]));
        let offset = self.offset.map(coefficient);
        let offset = offset.map(|offset| Taylor::<S, 2>::constant(offset));
        let along = jets.map(|c| Taylor::<S, 1>::new(c.first(), [c.second()]));
        let bend = jets.map(|c| Taylor::<S, 1>::new(c.second(), [c.third()]));
        let turn = dot(quarter_turn(along), bend) / dot(along, along);
        CurvePoint {
            point: beside(point, slope, offset),
            along: jets.map(|c| c.first()),
            turn: [turn.value, turn.first()],
        }
    }

    /// Returns the curve at a place, and its slope without the offset, on the numbers of a moving
    /// mechanism.
    fn along<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>, s: N) -> [[N; 2]; 2] {
        let s = s * self.part;
        let [point, slope] = match &self.shape {
            Shape::Points(path) => N::on_points(path, s),
            Shape::Formula(formula) => {
                type WithSlope<N> = Taylor<N, 1>;
                let part = WithSlope::linear(s, N::constant(1.0));
                let [x, y] = formula.at(part, |id| WithSlope::fixed(at.coefficient(id)));
                [[x.value, y.value], [x.first(), y.first()]]
            }
        };
        let offset = self.offset.map(|offset| at.coefficient(offset));
        [beside(point, slope, offset), slope]
    }

    /// Returns the slope of the curve without its offset, whose direction is that of the parallel curve.
    pub(super) fn slope<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>, s: N) -> [N; 2] {
        let [_, slope] = self.along(at, s);
        slope
    }

    /// Returns a component of the curve with its offset at a place, with two derivatives.
    fn component<S: Base>(
        &self,
        coefficient: impl Fn(CoefficientId) -> f64,
        s: S,
        component: usize,
    ) -> Taylor<S, 2> {
        match &self.shape {
            _ if self.offset.is_some() => self.place(coefficient, s).point[component],
            Shape::Points(_) => {
                let c = self.jets(coefficient, s)[component];
                Taylor::new(c.value, [c.first(), c.second()])
            }
            Shape::Formula(formula) => {
                let part = Taylor::linear(s * self.part, S::constant(self.part));
                formula.component(component, part, |id| Taylor::constant(coefficient(id)))
            }
        }
    }

    /// Returns the curve with its offset at a place, with two derivatives.
    fn point(&self, at: &Configuration, s: f64) -> [Jet; 2] {
        self.place(|id| at.coefficient(id), s).point
    }
}

impl FormulaPath {
    /// Returns x and y at a part of the way between the ends.
    fn at<N: Number>(&self, part: N, coefficient: impl Fn(CoefficientId) -> N) -> [N; 2] {
        [0, 1].map(|component| self.component(component, part, &coefficient))
    }

    fn component<N: Number>(
        &self,
        component: usize,
        part: N,
        coefficient: impl Fn(CoefficientId) -> N,
    ) -> N {
        let [first, last] = self.ends.map(&coefficient);
        let variable = first + (last - first) * part;
        let parameter = |id| coefficient(self.parameters.of(id));
        self.components[component].evaluate(&parameter, variable)
    }
}

/// Returns the point at a distance to the left of a curve.
fn beside<N: Number>(point: [N; 2], slope: [N; 2], offset: Option<N>) -> [N; 2] {
    let Some(offset) = offset else {
        return point;
    };
    let [x, y] = quarter_turn(slope);
    let speed = x.hypot(y);
    [point[0] + offset * x / speed, point[1] + offset * y / speed]
}

/// c = e · (P_j − P_i) − C(s) · e, with the x- or y-axis e of marker i.
#[derive(Clone, Debug)]
pub struct OnCurve {
    /// The coordinate of marker j on the axes of marker i.
    pub coordinate: Projection,
    /// The curve.
    pub path: CurvePath,
    /// s.
    pub place: JointUnknownId,
}

impl OnCurve {
    /// Returns s at the last end of an open curve, which begins at zero; `None` for a closed curve.
    pub(in crate::kinematics) fn last_end(&self) -> Option<f64> {
        self.path.last_end()
    }

    /// Returns the place on the curve as a relation of its own.
    pub(in crate::kinematics) fn place(&self) -> PlaceOnCurve {
        PlaceOnCurve(self.place)
    }

    /// Returns the component of the curve at its place.
    fn on_curve(&self, at: &Configuration) -> Jet {
        let s = at.joint_unknown(self.place);
        (self.path).component(|id| at.coefficient(id), s, self.component())
    }

    fn component(&self) -> usize {
        match self.coordinate.axis {
            Axis::X => 0,
            Axis::Y => 1,
        }
    }
}

/// c = s, the place of a point on a curve.
#[derive(Clone, Copy, Debug)]
pub struct PlaceOnCurve(JointUnknownId);

impl Formula for PlaceOnCurve {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        at.joint_unknown(self.0)
    }
}

impl Constraint for PlaceOnCurve {
    fn dimension(&self) -> Dimension {
        Dimension::Angle
    }

    fn is_affine(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.joint_unknown(mechanism, self.0);
    }
}

impl Formula for OnCurve {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let [point, _] = self.path.along(at, at.joint_unknown(self.place));
        self.coordinate.evaluate(at) - point[self.component()]
    }
}

impl Constraint for OnCurve {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        self.coordinate.value(at) - self.on_curve(at).value
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let point = self.on_curve(at);
        row.add_joint_unknown(at.joint_unknown_column(self.place), -point.first());
        self.coordinate.value_and_gradient(at, row) - point.value
    }

    /// Bounds C″ over the part of the curve in the region.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let column = at.joint_unknown_column(self.place);
        let slide = region.radius(column);
        let range = around(at.joint_unknown(self.place), slide);
        let path = &self.path;
        let point = path.component(|id| at.coefficient(id), range, self.component());
        let second = point.second();
        if !second.is_finite() {
            return None;
        }
        let second = second.magnitude();
        row.add_joint_unknown(column, second * slide);
        let bend = self.coordinate.bend(at, region, v, row)?;
        Some(bend + second * v[column] * v[column])
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        self.coordinate.incidence(mechanism, incidence);
        incidence.joint_unknown(mechanism, self.place);
    }
}

/// c = sin β with the angle β from the curve's direction to the x-axis of marker j.
#[derive(Clone, Debug)]
pub struct AlongCurve {
    /// Marker i, in whose frame the curve is.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
    /// The curve.
    pub path: CurvePath,
    /// s.
    pub place: JointUnknownId,
}

impl AlongCurve {
    /// Returns the markers, the cosine and the sine of β, and the derivatives of the curve's
    /// direction.
    fn turned(&self, at: &Configuration) -> ([MarkerPose; 2], [f64; 2], [f64; 2]) {
        let place = self
            .path
            .place(|id| at.coefficient(id), at.joint_unknown(self.place));
        let [i, j] = [self.from, self.to].map(|marker| at.marker(marker));
        let along = place.along[0] * i.axis + place.along[1] * perp(i.axis);
        let along = along / along.norm();
        let turned = [along.dot(&j.axis), along.perp(&j.axis)];
        ([i, j], turned, place.turn)
    }
}

impl Formula for AlongCurve {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let [_, slope] = self.path.along(at, at.joint_unknown(self.place));
        let (x, axis) = (at.marker(self.from).axis, at.marker(self.to).axis);
        let own = [dot(x, axis), dot(quarter_turn(x), axis)];
        dot(quarter_turn(slope), own) / slope[0].hypot(slope[1])
    }
}

impl Constraint for AlongCurve {
    fn dimension(&self) -> Dimension {
        Dimension::Angle
    }

    fn value(&self, at: &Configuration) -> f64 {
        let (_, [_, sin], _) = self.turned(at);
        sin
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let ([i, j], [cos, sin], turn) = self.turned(at);
        row.add_direction(j, cos);
        row.add_direction(i, -cos);
        row.add_joint_unknown(at.joint_unknown_column(self.place), -cos * turn[0]);
        sin
    }

    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let [i, j] = [self.from, self.to].map(|marker| at.marker(marker));
        let column = at.joint_unknown_column(self.place);
        let slide = region.radius(column);
        let range = around(at.joint_unknown(self.place), slide);
        let place = self.path.place(|id| at.coefficient(id), range);
        if !place.turn.iter().all(|turn| turn.is_finite()) {
            return None;
        }
        let turn = place.turn.map(Interval::magnitude);
        let changed = chord(region.turn(i) + region.turn(j) + turn[0] * slide);
        row.add_direction(i, changed);
        row.add_direction(j, changed);
        row.add_joint_unknown(column, turn[0] * changed + turn[1] * slide);
        let rate = v[column].abs();
        let omega = (angular_velocity(j, v) - angular_velocity(i, v)).abs() + turn[0] * rate;
        Some(omega * omega + turn[1] * rate * rate)
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.direction(mechanism, self.from);
        incidence.direction(mechanism, self.to);
        incidence.joint_unknown(mechanism, self.place);
    }
}

/// Returns the range of numbers within a distance of one.
fn around(middle: f64, reach: f64) -> Interval {
    Interval::new(middle - reach, middle + reach)
}

/// The place of a point on a curve, for assembly.
#[derive(Clone, Debug)]
pub struct CurveContact {
    /// Marker i, in whose frame the curve is.
    pub from: MarkerId,
    /// Marker j, whose point is on the curve.
    pub to: MarkerId,
    /// The curve.
    pub path: CurvePath,
}

impl JointUnknown for CurveContact {
    /// Returns the place on the curve that is nearest to the point.
    fn estimate(&self, at: &Configuration) -> f64 {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        let d = j.point - i.point;
        let own = Vector2::new(i.axis.dot(&d), perp(i.axis).dot(&d));
        let off = |s: f64| {
            let [x, y] = self.path.point(at, s);
            [x - Jet::constant(own.x), y - Jet::constant(own.y)]
        };
        let square = |s: f64| {
            let [x, y] = off(s).map(|c| c.value);
            x * x + y * y
        };
        let step_length = (self.path.part * f64::from(PARTS)).recip();
        let places = (0..=PARTS).map(|part| f64::from(part) * step_length);
        let nearest = places
            .map(|s| (square(s), s))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let mut s = nearest.map_or(0.0, |(_, s)| s);
        for _ in 0..ITERATIONS {
            let [x, y] = off(s);
            let half = (x * x + y * y) * 0.5;
            let step = -half.first() / half.second();
            if !step.is_finite() || half.second() <= 0.0 {
                break;
            }
            let step = step.clamp(-step_length, step_length);
            s = if self.path.is_closed {
                s + step
            } else {
                (s + step).clamp(0.0, 1.0)
            };
            if step.abs() < f64::EPSILON {
                break;
            }
        }
        s
    }
}
