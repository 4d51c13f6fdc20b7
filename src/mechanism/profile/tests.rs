//! Tests of contours.

use super::*;
use crate::mechanism::Law;
use crate::mechanism::expression::{Scope, Variable};
use crate::mechanism::names::NameTable;
use proptest::prelude::*;
use std::f64::consts::PI;

fn table(points: &[(f64, f64)]) -> Result<ProfileInForce, ProfileError> {
    let table = Table {
        points: points
            .iter()
            .map(|(x, y)| [*x, *y].map(Expression::constant))
            .collect(),
        scale: [1.0, 1.0].map(Expression::constant),
    };
    through(table, Interpolation::Spline)
}

fn through(table: Table, interpolation: Interpolation) -> Result<ProfileInForce, ProfileError> {
    let profile = Profile::Table {
        table,
        interpolation,
    };
    let mut profile = ProfileInForce::new(&profile, 0);
    profile.set_parameters(|_| 0.0).map(|()| profile)
}

/// The contour of an expression in the polar angle.
fn contour(text: &str) -> ProfileInForce {
    let names = NameTable::new();
    let scope = Scope::new(&names, &[Variable::PolarAngle]);
    let expression = Expression::parse(text, scope).expect("it parses");
    let mut profile = ProfileInForce::new(&Profile::Expression(expression), 0);
    profile.set_parameters(|_| 0.0).expect("it makes a contour");
    profile
}

/// Smooth, with a narrow notch, and made of pieces that meet with a continuous curvature, with a
/// jump of it, exactly between two sectors, and eight pairs at one angle.
const CONTOURS: [&str; 6] = [
    "0.3*cos(theta) + sqrt(1 - (0.3*sin(theta))^2)",
    "1 - 0.002*exp(-((theta - 2)/0.003)^2)",
    "1 + 0.2*max(cos(theta), 0)^4",
    "1 + 0.2*max(cos(theta), 0)^2",
    "1 + 0.1*abs(theta - pi)^3*sin(theta/2)^4",
    "1 + 0.02*(max(cos(theta), 0)^3 + max(cos(theta), 0)^4 + max(cos(theta), 0)^5 \
     + max(cos(theta), 0)^6 + abs(cos(theta))^3 + abs(cos(theta))^5 + min(cos(theta), 0)^3 \
     + min(cos(theta), 0)^4)",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Bounds contain what is found in the region. Rounding: third derivatives of the notch reach 1e6.
    #[test]
    fn bounds_of_an_expression_contain_its_values(
        text in prop::sample::select(CONTOURS.to_vec()),
        theta in prop_oneof![-20.0..20.0_f64, 1.98..2.02_f64, Just(PI), Just(TAU), Just(0.5 * PI)],
        reach in prop_oneof![0.0..1e-6_f64, 0.0..0.05_f64, 0.0..4.0],
        parts in prop::collection::vec(-1.0..1.0_f64, 40),
    ) {
        let profile = contour(text);
        let found = profile.bounds(theta, reach).expect("its slope is continuous");
        for part in parts {
            let values = profile.radius(theta + part * reach);
            let pairs = [
                (found.radius.value, values.value),
                (found.radius.first(), values.first()),
                (found.radius.second(), values.second()),
                (found.radius.third(), values.third()),
            ];
            for (order, (bound, value)) in pairs.into_iter().enumerate() {
                let slack = 1e-13 * (1.0 + value.abs());
                prop_assert!(
                    bound.low - slack <= value && value <= bound.high + slack,
                    "{text} {order}: {bound:?} {value}"
                );
            }
        }
    }

    /// Bounds depend on the range alone, whatever was asked before; whole turns do not matter but
    /// for the rounding of the angle.
    #[test]
    fn bounds_do_not_depend_on_earlier_ones(
        text in prop::sample::select(CONTOURS.to_vec()),
        asked in prop::collection::vec((-20.0..20.0_f64, 0.0..0.5_f64), 1..30),
    ) {
        let used = contour(text);
        let bounds = |profile: &ProfileInForce, (theta, reach)| {
            let found = profile.bounds(theta, reach).expect("its slope is continuous");
            (found.radius, found.jumps)
        };
        let found: Vec<_> = asked.iter().map(|&range| bounds(&used, range)).collect();
        let (&last, &first) = (asked.last().expect("one"), asked.first().expect("one"));
        prop_assert_eq!(bounds(&contour(text), last), *found.last().expect("one"));
        prop_assert_eq!(bounds(&used, first), found[0]);
    }

    /// Bounds over a narrow range are near the truth: in it each derivative changes by no more than
    /// its half width times the next one, and a sector adds little to that.
    #[test]
    fn bounds_of_an_expression_are_near_its_values(
        theta in 0.0..TAU,
        reach in 1e-6..0.05_f64,
    ) {
        let profile = contour(CONTOURS[0]);
        let found = profile.bounds(theta, reach).expect("smooth").radius;
        let middle = profile.radius(theta);
        // The bounds of R‴ in a sector are 0.1 radii wide at most, and the radius is at most 1.3; R⁗
        // is below two.
        prop_assert!(found.third().magnitude() <= middle.third().abs() + 0.13 + 2.0 * reach);
        let pairs = [
            (found.value, middle.value, middle.first()),
            (found.first(), middle.first(), middle.second()),
            (found.second(), middle.second(), middle.third()),
        ];
        for (order, (bound, value, next)) in pairs.into_iter().enumerate() {
            // A sector that is fine enough is at most 0.2 wide.
            let of_sector = 0.1 * 0.1_f64.powi(3 - order as i32);
            let most = reach * (next.abs() + 2.0 * reach + 0.13) + of_sector;
            prop_assert!(bound.high <= value + most && bound.low >= value - most, "{order}");
        }
    }
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
        let profile = table(&points).expect("it makes a contour");
        let bounds = profile.bounds(theta, reach).expect("a spline is smooth").radius;
        for part in parts {
            let values = profile.radius(theta + part * reach);
            let pairs = [
                (bounds.value, values.value),
                (bounds.first(), values.first()),
                (bounds.second(), values.second()),
                (bounds.third(), values.third()),
            ];
            for (bound, value) in pairs {
                prop_assert!(
                    bound.low - 1e-12 <= value && value <= bound.high + 1e-12,
                    "{bound:?} {value}"
                );
            }
        }
    }

    /// The same for the motion laws, rises, returns and a dwell.
    #[test]
    fn bounds_of_laws_contain_their_values(
        radii in prop::collection::vec(1.0..2.0_f64, 2..6),
        law in prop::sample::select(Law::ALL.to_vec()),
        theta in -20.0..20.0_f64,
        reach in prop_oneof![0.0..0.05_f64, 0.0..4.0],
        parts in prop::collection::vec(-1.0..1.0_f64, 20),
    ) {
        let step = TAU / (radii.len() + 1) as f64;
        let dwell = radii.iter().chain(&radii[..1]).enumerate();
        let points = dwell.map(|(k, r)| {
            [0.7 + step * k as f64, *r].map(Expression::constant)
        });
        let table = Table {
            points: points.collect(),
            scale: [1.0, 1.0].map(Expression::constant),
        };
        let profile = through(table, Interpolation::Law(law)).expect("it makes a contour");
        let found = profile.bounds(theta, reach).expect("its slope is continuous");
        let smooth = !matches!(law, Law::Harmonic | Law::Trapezoidal);
        prop_assert_eq!(found.jumps, !smooth);
        for part in parts {
            let values = profile.radius(theta + part * reach);
            let pairs = [
                (found.radius.value, values.value),
                (found.radius.first(), values.first()),
                (found.radius.second(), values.second()),
                (found.radius.third(), values.third()),
            ];
            for (order, (bound, value)) in pairs.into_iter().enumerate() {
                // Derivatives of strokes within a radian reach some hundreds.
                prop_assert!(
                    bound.low - 1e-10 <= value && value <= bound.high + 1e-10,
                    "{law:?} {order}: {bound:?} {value}"
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
        let profile = table(&points).expect("it makes a contour");
        // Across 2e-9 rad at third derivatives up to some 100 m/rad³.
        let (before, after) = (profile.radius(-1e-9), profile.radius(1e-9));
        prop_assert!((before.value - after.value).abs() < 1e-6);
        prop_assert!((before.first() - after.first()).abs() < 1e-6);
        prop_assert!((before.second() - after.second()).abs() < 1e-6);
        prop_assert!((profile.radius(TAU).value - radii[0]).abs() < 1e-12);
    }
}

#[test]
fn angles_that_do_not_rise_within_a_turn_make_no_contour() {
    let disordered = [(0.0, 1.0), (2.0, 1.0), (1.0, 1.0)];
    let more_than_a_turn = [(0.0, 1.0), (3.0, 1.0), (7.0, 1.0)];
    for points in [disordered, more_than_a_turn] {
        assert_eq!(table(&points).expect_err("no"), ProfileError::Disordered);
    }
}

/// The corner is exactly between two of the ranges into which the turn is divided.
#[test]
fn a_corner_between_two_ranges_is_found() {
    let profile = contour("1 + 0.1*abs(theta - pi)*sin(theta/2)^2");
    let corner = profile.check_smoothness().expect_err("it has a corner");
    let ProfileError::Corner { theta } = corner else {
        panic!("{corner}");
    };
    assert!((theta - PI).abs() < 1e-6, "{theta}");
    assert!(profile.bounds(PI, 0.01).is_none());
    assert!(profile.bounds(3.0, 0.1).is_some());
}

#[test]
fn narrow_ranges_leave_a_kink_out() {
    let profile = contour("1 + 0.1*abs(theta - pi)*sin(theta/2)^2");
    assert!(profile.bounds(PI + 1e-6, 0.5e-6).is_some());
    assert!(profile.bounds(PI + 1e-6, 2e-6).is_none());
}
