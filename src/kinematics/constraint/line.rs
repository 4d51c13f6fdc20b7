//! A configuration along a line in the space of q: the numbers from which the derivatives of a
//! relation follow by its formula.

use std::array;
use std::cell::RefCell;

use nalgebra::Vector2;

use super::configuration::{
    CoefficientId, Configuration, JointUnknownId, LawId, MarkerPose, ProfileId, perp,
};
use super::gradient::Gradient;
use super::moving_configuration::{
    Bodies, Moving, VariedMarker, VariedMechanism, of_contour, on_path,
};
use super::region::Region;
use crate::mechanism::{
    BodyId, Feature, Interval, Jet, Jet3, MarkerId, Number, PointPath, ShapeId, Taylor,
};

/// Bounds of a quantity in a region, and of its derivatives along lines through it.
pub type Bounded = Taylor<Interval, 2>;

/// The slopes of q along a line.
#[derive(Clone, Copy, Debug)]
pub(super) enum Slopes<'a> {
    /// None: everything rests.
    Zero,
    /// One of an unknown, zero of all others.
    Unit(usize),
    /// That of each unknown.
    All(&'a [f64]),
}

impl Slopes<'_> {
    fn of(self, column: usize) -> f64 {
        match self {
            Self::Zero => 0.0,
            Self::Unit(own) => f64::from(u8::from(own == column)),
            Self::All(slopes) => slopes[column],
        }
    }
}

/// A number at one pose, or anywhere in a region around it.
pub trait Around: Number {
    /// Returns a number that differs from `middle` by at most `reach`.
    fn around(middle: f64, reach: f64) -> Self;
}

impl Around for f64 {
    fn around(middle: f64, _reach: f64) -> Self {
        middle
    }
}

impl Around for Interval {
    fn around(middle: f64, reach: f64) -> Self {
        Self::new(middle - reach, middle + reach)
    }
}

/// The bodies of a configuration along a line: through its pose, or through any in a region.
#[derive(Debug)]
pub struct Line<'a> {
    at: &'a Configuration,
    region: Option<&'a Region<'a>>,
    slopes: Slopes<'a>,
    /// A row that gets an entry, of zero, for each unknown that is read.
    read: Option<RefCell<&'a mut Gradient>>,
}

impl<'a> Line<'a> {
    /// Makes the bodies along a line through their pose.
    pub(super) fn through(at: &'a Configuration, slopes: Slopes<'a>) -> Self {
        Self {
            at,
            region: None,
            slopes,
            read: None,
        }
    }

    /// Makes the bodies at rest, which give an entry in `row` to each unknown that is read.
    pub(super) fn noting(at: &'a Configuration, row: &'a mut Gradient) -> Self {
        Self {
            read: Some(RefCell::new(row)),
            ..Self::through(at, Slopes::Zero)
        }
    }

    /// Makes the bodies along lines of these slopes through any pose of a region.
    pub(super) fn within(
        region: &'a Region<'a>,
        at: &'a Configuration,
        slopes: Slopes<'a>,
    ) -> Self {
        Self {
            region: Some(region),
            ..Self::through(at, slopes)
        }
    }

    /// Returns the mechanism of these bodies.
    pub(super) fn mechanism<N>(&self) -> VariedMechanism<'_, 'a, N>
    where
        N: for<'b> Moving<Bodies<'b> = Line<'b>, Curves<'b> = &'b Configuration>,
    {
        VariedMechanism {
            bodies: self,
            curves: self.at,
        }
    }

    /// Returns the largest change of an unknown; zero without one.
    fn reach(&self, column: Option<usize>) -> f64 {
        let radius = |column| Some(self.region?.radius(column));
        column.and_then(radius).unwrap_or(0.0)
    }

    /// Returns an unknown, or its sum with a number.
    fn unknown<S: Around, const N: usize>(&self, column: usize, value: f64) -> Taylor<S, N> {
        let slope = S::constant(self.slopes.of(column));
        Taylor::linear(S::around(value, self.reach(Some(column))), slope)
    }

    /// Returns a body's angle plus a number.
    fn angle<S: Around, const N: usize>(&self, body: Option<BodyId>, angle: f64) -> Taylor<S, N> {
        match body {
            Some(body) => self.unknown(3 * body.index() + 2, angle),
            None => Taylor::constant(angle),
        }
    }

    /// Returns a vector that turns with a marker's body.
    fn turning<S: Around, const N: usize>(
        &self,
        marker: MarkerPose,
        v: Vector2<f64>,
    ) -> [Taylor<S, N>; 2] {
        let omega = (marker.body).map_or(0.0, |body| self.slopes.of(3 * body.index() + 2));
        let (across, reach) = (perp(v), self.swing(marker, v));
        [0, 1].map(|k| {
            let [value, across] = [v[k], across[k]].map(|middle| S::around(middle, reach));
            let orders = [across * omega, -(value * (omega * omega))];
            Taylor::new(value, array::from_fn(|order| orders[order]))
        })
    }

    /// Returns the largest change of a vector that turns with a marker's body.
    fn swing(&self, marker: MarkerPose, v: Vector2<f64>) -> f64 {
        (self.region).map_or(0.0, |region| v.norm() * region.sway(marker))
    }

    /// Gives entries to the unknowns of a body.
    fn note(&self, body: Option<BodyId>) {
        if let Some(row) = &self.read {
            row.borrow_mut().add_turn(body, 0.0);
        }
    }
}

impl<S: Around, const N: usize> Bodies<Taylor<S, N>> for Line<'_> {
    fn marker(&self, marker: MarkerId) -> VariedMarker<Taylor<S, N>> {
        let marker = self.at.marker(marker);
        self.note(marker.body);
        let mut point = self.turning(marker, marker.arm);
        let swing = self.swing(marker, marker.arm);
        for (k, component) in point.iter_mut().enumerate() {
            let column = marker.body.map(|body| 3 * body.index() + k);
            let slope = column.map_or(0.0, |column| self.slopes.of(column));
            component.value = S::around(marker.point[k], swing + self.reach(column));
            component.derivatives[0] += S::constant(slope);
        }
        VariedMarker {
            point,
            axis: self.turning(marker, marker.axis),
            theta: self.angle(marker.body, marker.theta),
        }
    }

    fn phi(&self, body: Option<BodyId>) -> Taylor<S, N> {
        self.note(body);
        self.angle(body, self.at.phi(body))
    }

    fn coefficient(&self, id: CoefficientId) -> Taylor<S, N> {
        Taylor::constant(self.at.coefficient(id))
    }

    fn joint_unknown(&self, id: JointUnknownId) -> Taylor<S, N> {
        let column = self.at.joint_unknown_column(id);
        if let Some(row) = &self.read {
            row.borrow_mut().add_joint_unknown(column, 0.0);
        }
        self.unknown(column, self.at.joint_unknown(id))
    }

    fn frame(&self, body: Option<BodyId>) -> ([Taylor<S, N>; 2], [Taylor<S, N>; 2]) {
        self.note(body);
        let frame = self.at.frame(body);
        let axis = Vector2::new(frame.cos, frame.sin);
        let pose = MarkerPose {
            body,
            arm: Vector2::zeros(),
            point: frame.origin,
            axis,
            theta: frame.phi,
        };
        let origin = [0, 1].map(|k| match body {
            Some(body) => self.unknown(3 * body.index() + k, frame.origin[k]),
            None => Taylor::constant(0.0),
        });
        (origin, self.turning(pose, axis))
    }

    fn carrier(&self, shape: ShapeId) -> Option<BodyId> {
        self.at.core(shape).body
    }

    fn features(&self, shape: ShapeId) -> usize {
        self.at.core(shape).core.features.len()
    }

    fn feature(&self, shape: ShapeId, k: usize) -> Feature<Taylor<S, N>> {
        self.at.core(shape).core.features[k].map(Taylor::constant)
    }

    fn core_radius(&self, shape: ShapeId) -> Taylor<S, N> {
        Taylor::constant(self.at.core(shape).core.radius)
    }
}

impl<const N: usize> Moving for Taylor<f64, N> {
    type Bodies<'a> = Line<'a>;
    type Curves<'a> = &'a Configuration;

    fn radius(at: &Configuration, profile: ProfileId, theta: Self) -> [Self; 2] {
        of_contour(at.profile(profile).radius(theta.value), theta)
    }

    fn law(at: &Configuration, law: LawId, argument: Self) -> Self {
        let law = (at.law(law).in_force).evaluate(Jet::variable(argument.value));
        argument.chain(law.value, |_| [law.first(), law.second(), f64::NAN])
    }

    fn on_points(path: &PointPath, place: Self) -> [[Self; 2]; 2] {
        on_path(path.at(place.value), place)
    }
}

impl Moving for Bounded {
    type Bodies<'a> = Line<'a>;
    type Curves<'a> = &'a Configuration;

    fn radius(at: &Configuration, profile: ProfileId, theta: Self) -> [Self; 2] {
        let middle = theta.value.midpoint();
        let reach = (theta.value - Interval::point(middle)).magnitude();
        let bounds = at.profile(profile).bounds(middle, reach);
        // R′ has no second derivative where R″ jumps.
        let smooth = bounds.filter(|bounds| !bounds.jumps);
        smooth.map_or([Self::unknown(); 2], |bounds| {
            of_contour(bounds.radius, theta)
        })
    }

    fn law(at: &Configuration, law: LawId, argument: Self) -> Self {
        let law = (at.law(law).enclosed).enclose(Jet3::variable(argument.value));
        law.map_or_else(Self::unknown, |law| {
            argument.chain(law.value, |_| law.derivatives)
        })
    }

    fn on_points(path: &PointPath, place: Self) -> [[Self; 2]; 2] {
        on_path(path.over(place.value), place)
    }
}
