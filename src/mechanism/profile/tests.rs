//! Tests of contours.

use super::*;
use crate::mechanism::Law;
use proptest::prelude::*;

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
