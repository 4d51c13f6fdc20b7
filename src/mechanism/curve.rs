//! Curves of a body, along which a point of another one moves.

use super::expression::seams;
use super::spline::{Ends, Spline};
use super::{Expression, Interval, Jet3, Number, ParameterId, Taylor};

/// Angle between two directions that count as one \[rad\]: rounding beside a smooth join is 1e-12 of
/// the curvature. Halved or doubled, a corner of a millionth of a radian is one or none.
const STRAIGHT: f64 = 1e-6;
/// Part of a curve before its first point that is examined, too.
const SEAM_AT_ENDS: f64 = 1e-3;

/// Curve of a body, in the frame of a marker.
///
/// Its parameter runs from 0 to 1; an open curve goes on beyond its ends, a closed one goes round.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Shape of the curve.
    pub shape: CurveShape,
    /// Whether its ends are one point.
    pub closed: bool,
    /// Distance of the parallel curve that is followed, to the left of the curve \[m\].
    pub offset: Option<Expression>,
    /// Whether the x-axis of the second marker keeps the direction of the curve.
    pub follow: bool,
}

/// Shape of a curve.
#[derive(Clone, Debug)]
pub enum CurveShape {
    /// A spline through points.
    Points(PointPath),
    /// Expressions in `s`.
    Formula {
        /// x \[m\].
        x: Expression,
        /// y \[m\].
        y: Expression,
        /// `s` at the first and the last point.
        ends: [Expression; 2],
    },
}

impl CurveShape {
    /// Returns x and y \[m\] at a place, from 0 to 1 along the curve, with three derivatives by it.
    pub fn at(&self, parameter: &impl Fn(ParameterId) -> f64, place: f64) -> [Jet3; 2] {
        match self {
            Self::Points(path) => path.at(place),
            Self::Formula { x, y, ends } => Self::along([x, y], ends, parameter, place),
        }
    }

    /// Returns x and y of a formula at a place, or bounds of them over a range of places.
    fn along<S: Number>(
        components: [&Expression; 2],
        ends: &[Expression; 2],
        parameter: &impl Fn(ParameterId) -> f64,
        place: S,
    ) -> [Jet3<S>; 2] {
        let [first, last] = ends.each_ref().map(|end| end.evaluate(parameter, 0.0));
        let way = S::constant(last - first);
        let variable = Jet3::linear(S::constant(first) + way * place, way);
        let parameter = |id| Jet3::constant(parameter(id));
        components.map(|component| component.evaluate(&parameter, variable))
    }
}

impl Curve {
    /// Returns the first place, from 0 to 1, at which the direction of the curve jumps. A
    /// spline has no such place.
    pub(in crate::mechanism) fn corner(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
    ) -> Option<f64> {
        let CurveShape::Formula { x, y, ends } = &self.shape else {
            return None;
        };
        let is_smooth = |part: Interval| {
            let at = CurveShape::along([x, y], ends, parameter, part);
            at.iter().all(|c| c.second().is_finite())
        };
        let mut corner = None;
        // From before the first point, for a corner where a closed curve comes back.
        let first = if self.closed { -SEAM_AT_ENDS } else { 0.0 };
        seams(Interval::new(first, 1.0), is_smooth, |[from, to]| {
            let [before, after] = [from, to].map(|place| self.shape.at(parameter, place));
            let [before, after] = [before, after].map(|[x, y]| [x.first(), y.first()]);
            let across = before[0] * after[1] - before[1] * after[0];
            let along = before[0] * after[0] + before[1] * after[1];
            let turn = across.atan2(along).abs();
            // Beyond the ends there may be no curve.
            let is_straight = turn.is_nan() || turn <= STRAIGHT;
            if !is_straight {
                corner = Some(from.midpoint(to).max(0.0));
            }
            is_straight
        });
        corner
    }

    /// Returns the parameters that it uses; one may come twice.
    pub(crate) fn parameters(&self) -> impl Iterator<Item = ParameterId> {
        let formula = match &self.shape {
            CurveShape::Points(_) => None,
            CurveShape::Formula { x, y, ends } => Some([x, y, &ends[0], &ends[1]]),
        };
        let all = formula.into_iter().flatten().chain(&self.offset);
        all.flat_map(Expression::parameters)
    }
}

/// Cubic spline through points of the plane over the lengths of the chords between them: natural at
/// the ends of an open path, periodic on a closed one.
#[derive(Clone, Debug)]
pub struct PointPath {
    /// x and y \[m\], whose knots run from 0 to 1.
    splines: [Spline<f64>; 2],
    closed: bool,
}

impl PointPath {
    /// Makes the path through some points, two at least. A closed path goes on from the last point
    /// to the first one, which may be given again. `None` where neighbours coincide, or a closed path
    /// has fewer than three points.
    #[must_use]
    pub fn new(points: &[[f64; 2]], closed: bool) -> Option<Self> {
        let mut points = points.to_vec();
        if closed && points.first() != points.last() {
            points.extend(points.first().copied());
        }
        if points.len() < if closed { 4 } else { 2 } {
            return None;
        }
        let chord =
            |pair: &[[f64; 2]]| f64::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let mut knots = vec![0.0];
        for pair in points.windows(2) {
            knots.push(knots[knots.len() - 1] + chord(pair));
        }
        let length = knots[knots.len() - 1];
        knots.iter_mut().for_each(|knot| *knot /= length);
        let ends = if closed {
            Ends::Periodic
        } else {
            Ends::Natural
        };
        let splines = [0, 1].map(|component: usize| {
            let mut spline = Spline::new(points.len(), ends);
            let (abscissas, values) = spline.points_mut();
            abscissas.copy_from_slice(&knots);
            for (value, point) in values.iter_mut().zip(&points) {
                *value = point[component];
            }
            spline.fit();
            spline
        });
        let is_valid = splines.iter().all(Spline::is_valid);
        is_valid.then_some(Self { splines, closed })
    }

    /// Returns x and y at a place with three derivatives. Beyond its ends an open path is straight.
    #[must_use]
    pub fn at(&self, place: f64) -> [Jet3; 2] {
        let within = if self.closed {
            place - place.floor()
        } else {
            place.clamp(0.0, 1.0)
        };
        let beyond = if self.closed { 0.0 } else { place - within };
        self.splines.each_ref().map(|spline| {
            let segment = spline.segment(within);
            let value = spline.on_segment(segment, within);
            let first = spline.slope_on_segment(segment, within);
            let [second, third] = if beyond == 0.0 {
                spline.curvature_on_segment(segment, within)
            } else {
                [0.0; 2]
            };
            Jet3::new(value + beyond * first, [first, second, third])
        })
    }

    /// Encloses x and y over a range of places with three derivatives. The third one jumps at points:
    /// its bounds are those between them.
    #[must_use]
    pub fn over(&self, range: Interval) -> [Jet3<Interval>; 2] {
        let middle = range.midpoint();
        let at = self.at(middle);
        let off = range - Interval::point(middle);
        let mut found = [0, 1].map(|component: usize| self.bends(component, range));
        for (jet, at) in found.iter_mut().zip(at) {
            let second = jet.second();
            let slope = Interval::point(at.first()) + second * off;
            jet.value = Interval::point(at.value)
                + Interval::point(at.first()) * off
                + second * Interval::new(0.0, 0.5 * off.magnitude() * off.magnitude());
            jet.derivatives[0] = slope;
        }
        found
    }

    /// Returns whether it is closed.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Encloses the second and third derivative of a component over a range.
    fn bends(&self, component: usize, range: Interval) -> Jet3<Interval> {
        let spline = &self.splines[component];
        let knots = spline.knots();
        let mut second = [f64::INFINITY, f64::NEG_INFINITY];
        let mut third = second;
        let join = |bounds: &mut [f64; 2], value: f64| {
            *bounds = [bounds[0].min(value), bounds[1].max(value)];
        };
        // The first and the last round of a closed path that the range meets.
        let rounds = if self.closed {
            [range.low.floor(), range.high.floor()]
        } else {
            [0.0; 2]
        };
        let whole = self.closed && range.high - range.low >= 1.0;
        for round in rounds {
            for segment in 0..knots.len() - 1 {
                let (low, high) = if whole {
                    (knots[segment], knots[segment + 1])
                } else {
                    (
                        knots[segment].max(range.low - round),
                        knots[segment + 1].min(range.high - round),
                    )
                };
                if low <= high {
                    for place in [low, high] {
                        let [bend, jerk] = spline.curvature_on_segment(segment, place);
                        join(&mut second, bend);
                        join(&mut third, jerk);
                    }
                }
            }
        }
        if !self.closed && (range.low < 0.0 || range.high > 1.0) {
            join(&mut second, 0.0);
            join(&mut third, 0.0);
        }
        let [second, third] = [second, third].map(|[low, high]| Interval::new(low, high));
        Taylor::new(Interval::point(0.0), [Interval::point(0.0), second, third])
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A bent path whose points are unevenly spaced.
    fn path(closed: bool) -> PointPath {
        let points = [[0.0, 0.0], [0.4, 0.1], [0.5, 0.6], [0.1, 0.7], [-0.3, 0.2]];
        PointPath::new(&points, closed).expect("no point is right after itself")
    }

    /// Largest difference of jets with derivatives up to some thousands.
    const ROUNDING: f64 = 1e-11;

    proptest! {
        /// Value and derivatives at a place lie in their enclosures over a range with it, and are those
        /// a round later on a closed path.
        #[test]
        fn enclosures_hold(
            closed in any::<bool>(),
            low in -1.5..1.5_f64,
            width in prop::sample::select(vec![1e-3, 0.1, 0.6, 1.7]),
            part in 0.0..1.0_f64,
        ) {
            let path = path(closed);
            let over = path.over(Interval::new(low, low + width));
            let at = path.at(low + part * width);
            let later = path.at(low + part * width + 1.0);
            for ((over, at), later) in over.iter().zip(at).zip(later) {
                let bounds = [over.value, over.first(), over.second(), over.third()];
                let values = [at.value, at.first(), at.second(), at.third()];
                for (bounds, value) in bounds.iter().zip(values) {
                    let near = Interval::new(bounds.low - ROUNDING, bounds.high + ROUNDING);
                    prop_assert!(near.contains(value), "{value} {bounds:?}");
                }
                if closed {
                    prop_assert!((at.value - later.value).abs() < ROUNDING);
                }
            }
        }
    }

    #[test]
    fn a_path_meets_its_points_and_goes_on_straight() {
        let open = path(false);
        let [x, y] = open.at(0.0);
        assert!(x.value.abs() < ROUNDING && y.value.abs() < ROUNDING);
        let [end, beyond] = [1.0, 1.5].map(|s| open.at(s));
        for (end, beyond) in end.iter().zip(beyond) {
            assert!((end.value + 0.5 * end.first() - beyond.value).abs() < ROUNDING);
            assert!(end.second().abs() < ROUNDING && beyond.second() == 0.0);
        }
        let [[x, _], [u, _]] = [0.0, 1.0].map(|s| path(true).at(s));
        assert!(
            (x.first() - u.first()).abs() < ROUNDING && (x.second() - u.second()).abs() < ROUNDING
        );
    }

    #[test]
    fn neighbours_that_coincide_make_no_path() {
        for (points, closed) in [
            (&[[0.0, 0.0], [0.0, 0.0]][..], false),
            (&[[0.0, 0.0]], false),
            (&[[0.0, 0.0], [1.0, 0.0]], true),
            (&[[0.0, 0.0], [1.0, f64::NAN]], false),
        ] {
            assert!(PointPath::new(points, closed).is_none(), "{points:?}");
        }
    }
}
