//! Profiles of cams: the polar radius of a contour as a function of the polar angle.

use std::f64::consts::TAU;

use super::{Ends, Expression, Interval, Jet3, Number, ParameterId, Spline, Table};

/// A closed contour R(θ), θ counter-clockwise from the cam marker's x-axis \[rad, m\].
#[derive(Clone, Debug)]
pub enum Profile {
    /// An expression in `theta`, which goes from 0 to 2π, and the parameters.
    Expression(Expression),
    /// Points of the contour, joined by a closed cubic spline. They go once round; the first is
    /// not repeated.
    Table(Table),
}

impl Profile {
    /// The parameters that it uses; one may come twice.
    pub fn parameters(&self) -> Box<dyn Iterator<Item = ParameterId> + '_> {
        match self {
            Self::Expression(expression) => Box::new(expression.parameters()),
            Self::Table(table) => Box::new(table.parameters()),
        }
    }
}

/// A profile with parameter values in force.
///
/// Made once; [`set_parameters`](Self::set_parameters) then changes it without allocating.
#[derive(Clone, Debug)]
pub struct ProfileInForce {
    curve: Curve,
    parameters: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Curve {
    Expression(Expression),
    Spline {
        table: Table,
        /// Its last point is the first one, a turn later.
        spline: Spline<f64>,
        /// Whether the table's angles rise.
        valid: bool,
    },
}

/// In how many places a whole contour is looked at.
const SAMPLES: u32 = 720;

impl ProfileInForce {
    /// The profile for parameters still to be given, `parameters` of them.
    #[must_use]
    pub fn new(profile: &Profile, parameters: usize) -> Self {
        let curve = match profile {
            Profile::Expression(expression) => Curve::Expression(expression.clone()),
            Profile::Table(table) => Curve::Spline {
                spline: Spline::new(table.points.len() + 1, Ends::Periodic),
                table: table.clone(),
                valid: false,
            },
        };
        Self {
            curve,
            parameters: vec![0.0; parameters],
        }
    }

    /// Takes over parameter values.
    pub fn set_parameters(&mut self, parameter: impl Fn(ParameterId) -> f64) {
        for (index, value) in self.parameters.iter_mut().enumerate() {
            *value = parameter(ParameterId(index));
        }
        if let Curve::Spline {
            table,
            spline,
            valid,
        } = &mut self.curve
        {
            let (angles, radii) = spline.points_mut();
            table.write(&parameter, angles, radii);
            let last = angles.len() - 1;
            (angles[last], radii[last]) = (angles[0] + TAU, radii[0]);
            *valid = spline.is_valid();
            if *valid {
                spline.fit();
            }
        }
    }

    /// R and its first three derivatives at a polar angle, of any number of turns. Allocates
    /// nothing.
    ///
    /// Not finite where an expression leaves its domain or the angles of a table do not rise.
    #[must_use]
    pub fn radius(&self, theta: f64) -> Jet3 {
        match &self.curve {
            Curve::Expression(expression) => {
                let parameter = |p: ParameterId| Jet3::constant(self.parameters[p.index()]);
                expression.evaluate(&parameter, Jet3::variable(theta.rem_euclid(TAU)))
            }
            Curve::Spline { valid: false, .. } => Jet3::constant(f64::NAN),
            Curve::Spline { spline, .. } => {
                let theta = first_turn(spline, theta);
                cubic(spline, spline.segment(theta), theta)
            }
        }
    }

    /// Bounds of R and its first three derivatives for polar angles up to `reach` from `theta`.
    /// `None` where the contour is not smooth there. Allocates nothing.
    #[must_use]
    pub fn bounds(&self, theta: f64, reach: f64) -> Option<Jet3<Interval>> {
        match &self.curve {
            Curve::Expression(expression) => {
                let enclose = |low: f64, high: f64| {
                    expression.enclose(&|p| self.parameters[p.index()], Interval::new(low, high))
                };
                if 2.0 * reach >= TAU {
                    return enclose(0.0, TAU);
                }
                let low = (theta - reach).rem_euclid(TAU);
                let high = low + 2.0 * reach;
                if high <= TAU {
                    return enclose(low, high);
                }
                Some(enclose(low, TAU)?.hull(enclose(0.0, high - TAU)?))
            }
            Curve::Spline { valid: false, .. } => None,
            Curve::Spline { spline, .. } => Some(spline_bounds(spline, theta, reach)),
        }
    }

    /// The polar angles, evenly spread over a turn, at which a whole contour is looked at.
    pub fn sample_angles() -> impl Iterator<Item = f64> {
        (0..SAMPLES).map(|k| f64::from(k) * (TAU / f64::from(SAMPLES)))
    }

    /// The polar angle among [`sample_angles`](Self::sample_angles) where `cost`, a function of
    /// angle and radius, is least.
    #[must_use]
    pub fn angle_of_least(&self, cost: impl Fn(f64, f64) -> f64) -> f64 {
        let costs =
            Self::sample_angles().map(|theta| (theta, cost(theta, self.radius(theta).value)));
        costs
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map_or(0.0, |(theta, _)| theta)
    }
}

/// The angle in the turn that a closed spline covers.
fn first_turn(spline: &Spline<f64>, theta: f64) -> f64 {
    let start = spline.knots()[0];
    start + (theta - start).rem_euclid(TAU)
}

/// Value and derivatives of one segment.
fn cubic(spline: &Spline<f64>, segment: usize, theta: f64) -> Jet3 {
    let [second, third] = spline.curvature_on_segment(segment, theta);
    Jet3 {
        value: spline.on_segment(segment, theta),
        first: spline.slope_on_segment(segment, theta),
        second,
        third,
    }
}

fn spline_bounds(spline: &Spline<f64>, theta: f64, reach: f64) -> Jet3<Interval> {
    let knots = spline.knots();
    let segments = knots.len() - 1;
    let reach = reach.min(0.5 * TAU);
    let low = first_turn(spline, theta - reach);
    let high = low + 2.0 * reach;
    // The segment that contains `low`, then what else the region meets; it may go on past the
    // end of the turn, into its beginning.
    let first = spline.segment(low);
    let mut bounds = segment_bounds(spline, first, low, high.min(knots[first + 1]).max(low));
    for lap in [0.0, TAU] {
        for segment in 0..segments {
            let from = (knots[segment] + lap).max(low);
            let to = (knots[segment + 1] + lap).min(high);
            if from < to {
                bounds = bounds.hull(segment_bounds(spline, segment, from - lap, to - lap));
            }
        }
    }
    bounds
}

/// On a part of one segment each derivative differs from its value in the middle by the half
/// width times the bound of the next one.
fn segment_bounds(spline: &Spline<f64>, segment: usize, from: f64, to: f64) -> Jet3<Interval> {
    let half = 0.5 * (to - from);
    let middle = cubic(spline, segment, from + half);
    let around = |value: f64, slope: Interval| {
        let off = half * slope.magnitude();
        Interval::new(value - off, value + off)
    };
    let third = Interval::point(middle.third);
    let second = around(middle.second, third);
    let first = around(middle.first, second);
    Jet3 {
        value: around(middle.value, first),
        first,
        second,
        third,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(points: &[(f64, f64)]) -> ProfileInForce {
        let table = Table {
            points: points
                .iter()
                .map(|(x, y)| [*x, *y].map(Expression::constant))
                .collect(),
            scale: [1.0, 1.0].map(Expression::constant),
        };
        let mut profile = ProfileInForce::new(&Profile::Table(table), 0);
        profile.set_parameters(|_| 0.0);
        profile
    }

    proptest! {
        /// Bounds contain what is found in the region, wherever it lies relative to the seam of
        /// the turn. Rounding: radii up to 2 m.
        #[test]
        fn bounds_of_a_table_contain_its_values(
            radii in prop::collection::vec(1.0..2.0_f64, 3..9),
            theta in -20.0..20.0_f64,
            reach in 0.0..4.0_f64,
            parts in prop::collection::vec(-1.0..1.0_f64, 20),
        ) {
            let step = TAU / radii.len() as f64;
            let points: Vec<_> =
                radii.iter().enumerate().map(|(k, r)| (0.7 + step * k as f64, *r)).collect();
            let profile = table(&points);
            let bounds = profile.bounds(theta, reach).expect("a spline is smooth");
            for part in parts {
                let values = profile.radius(theta + part * reach);
                let pairs = [
                    (bounds.value, values.value),
                    (bounds.first, values.first),
                    (bounds.second, values.second),
                    (bounds.third, values.third),
                ];
                for (bound, value) in pairs {
                    prop_assert!(
                        bound.low - 1e-12 <= value && value <= bound.high + 1e-12,
                        "{bound:?} {value}"
                    );
                }
            }
        }

        /// The spline closes: value, slope and second derivative are the same a turn later, on
        /// either side of the seam.
        #[test]
        fn a_table_closes_smoothly(radii in prop::collection::vec(1.0..2.0_f64, 3..9)) {
            let step = TAU / radii.len() as f64;
            let points: Vec<_> =
                radii.iter().enumerate().map(|(k, r)| (step * k as f64, *r)).collect();
            let profile = table(&points);
            // Across 2e-9 rad at third derivatives up to some 100 m/rad³.
            let (before, after) = (profile.radius(-1e-9), profile.radius(1e-9));
            prop_assert!((before.value - after.value).abs() < 1e-6);
            prop_assert!((before.first - after.first).abs() < 1e-6);
            prop_assert!((before.second - after.second).abs() < 1e-6);
            prop_assert!((profile.radius(TAU).value - radii[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn angles_that_do_not_rise_give_no_radius() {
        let profile = table(&[(0.0, 1.0), (2.0, 1.0), (1.0, 1.0)]);
        assert!(profile.radius(0.5).value.is_nan());
        assert_eq!(profile.bounds(0.5, 0.1), None);
        let more_than_a_turn = table(&[(0.0, 1.0), (3.0, 1.0), (7.0, 1.0)]);
        assert!(more_than_a_turn.radius(0.5).value.is_nan());
    }
}
