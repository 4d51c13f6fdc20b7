//! The range of motion of a driver.

#![allow(clippy::float_cmp, reason = "bounds are reached to the last bit")]

mod common;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use biela::kinematics::{End, RangeSettings, Reason, SingularKind, Solver};
use biela::mechanism::DriverId;
use common::{assembled, parse, shipped};

fn range(name: &str) -> (Solver, biela::kinematics::Range) {
    let (mut solver, _) = assembled(&shipped(name));
    let start = solver.pose().clone();
    let range = solver.range(DriverId(0), &RangeSettings::default());
    assert_eq!(*solver.pose(), start);
    assert!(range.samples.is_sorted_by(|a, b| a.driver < b.driver));
    assert!(range.samples.iter().any(|sample| sample.pose == start));
    // Rounding of angles of up to some turns.
    assert!(range.samples.iter().all(|sample| sample.residual < 1e-13));
    (solver, range)
}

#[test]
fn a_crank_turns_fully() {
    let (_, range) = range("four_bar");
    assert_eq!([&range.lower, &range.upper], [&End::Turns(1); 2]);
    assert_eq!(range.samples.len(), 361);
    assert_eq!(range.crossings, []);
    // The transmission angle is worst where the crank lies along the base: coupler and rocker
    // span 0.3 m or 0.5 m there.
    let worst = range
        .samples
        .iter()
        .filter_map(|sample| sample.transmission)
        .fold(FRAC_PI_2, f64::min);
    let spanned = |d: f64| {
        let cosine: f64 = (0.25 * 0.25 + 0.3 * 0.3 - d * d) / (2.0 * 0.25 * 0.3);
        cosine.acos().min(PI - cosine.acos())
    };
    // Sampled each degree, near a minimum.
    assert!((worst - spanned(0.3).min(spanned(0.5))).abs() < 1e-3);
}

/// The angle between coupler and rocker is extreme where the crank lies along the base; the
/// coupler's links then span 0.3 m or 0.5 m. Some rounding of the angle: 4e-16 for each radian.
#[test]
fn extremes_of_measures_are_located_to_rounding() {
    let (_, range) = range("four_bar");
    let [[least, greatest]] = range.measures[..] else {
        panic!("{:?}", range.measures)
    };
    for (found, spanned, crank) in [(least, 0.3_f64, TAU), (greatest, 0.5, PI)] {
        let cosine = (0.25 * 0.25 + 0.3 * 0.3 - spanned * spanned) / (2.0 * 0.25 * 0.3);
        assert!((found.value - cosine.acos()).abs() < 4e-15, "{found:?}");
        assert!((found.driver - crank).abs() < 1e-13, "{found:?}");
    }
}

#[test]
fn a_range_ends_at_the_bounds_of_the_search_and_of_the_driver() {
    let (mut solver, _) = assembled(&shipped("tlv"));
    let bounds = |from, to| RangeSettings {
        bounds: [from, to],
        ..RangeSettings::default()
    };
    // The side starts at 0.35 m.
    let range = solver.range(DriverId(0), &bounds(Some(0.2), Some(0.5)));
    assert_eq!(range.lower, End::Bound { value: 0.2 });
    assert_eq!(range.upper, End::Bound { value: 0.5 });
    let ends = [0, range.samples.len() - 1].map(|k| range.samples[k].driver);
    assert_eq!(ends, [0.2, 0.5]);
    // Beyond the start.
    let range = solver.range(DriverId(0), &bounds(Some(0.4), Some(0.5)));
    let ends = [0, range.samples.len() - 1].map(|k| range.samples[k].driver);
    assert_eq!(ends, [0.4, 0.5]);
    assert!(range.samples.is_sorted_by(|a, b| a.driver < b.driver));

    let text = include_str!("../mechanisms/tlv.toml");
    let text = text.replace("start = 0.35", "start = 0.35, min = 0.3, max = 0.6");
    let (mut solver, _) = assembled(&parse(&text));
    let range = solver.range(DriverId(0), &RangeSettings::default());
    assert_eq!(range.lower, End::Bound { value: 0.3 });
    assert_eq!(range.upper, End::Bound { value: 0.6 });
}

#[test]
fn a_side_of_a_triangle_ends_where_the_others_line_up() {
    let (_, range) = range("tlv");
    for (end, limit) in [(&range.lower, 0.15), (&range.upper, 0.65)] {
        let End::Singular(point) = end else {
            panic!("{end:?}")
        };
        assert_eq!(point.kind, SingularKind::DeadPoint);
        assert!(
            (point.drivers[0] - limit).abs() < 1e-14,
            "{:?}",
            point.drivers
        );
        assert_eq!(point.bodies, ["body `arm`", "body `rod`"]);
    }
    let last = range.samples.last().expect("there are some");
    assert!(last.rcond < 1e-5 && last.transmission < Some(1e-4));
}

#[test]
fn a_parallelogram_turns_fully_through_its_change_points() {
    let (_, range) = range("parallelogram");
    assert_eq!(range.upper, End::Turns(1));
    let values: Vec<_> = range.crossings.iter().map(|point| point.value).collect();
    assert!((values[0] - PI).abs() < 1e-14 && (values[1] - TAU).abs() < 1e-14);
    for point in &range.crossings {
        assert_eq!(point.bodies, ["body `coupler`", "body `follower`"]);
    }
}

/// The second crank turns half as fast.
#[test]
fn gears_come_back_after_some_turns() {
    let (_, range) = range("geared_five_bar");
    assert_eq!(range.upper, End::Turns(2));
    assert_eq!(range.samples.len(), 721);
}

#[test]
fn a_length_that_nothing_blocks_is_followed_far() {
    let mechanism = parse(
        "format = 1\nname = 'slide'\n[ground.markers]\nO = [0, 0]\n[bodies.slide]\n\
         markers = { O = [0, 0], tip = [0.5, 0] }\nestimate = [0.31, 0, 0]\n[joints]\n\
         O = { type = 'translational', markers = ['ground.O', 'slide.O'] }\n[drivers]\n\
         d = { coordinate = 'distance', markers = ['ground.O', 'slide.O'], start = 0.31 }\n",
    );
    let (mut solver, _) = assembled(&mechanism);
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let End::NotFound { value } = range.upper else {
        panic!("{:?}", range.upper)
    };
    // A hundred of its own lengths.
    assert!((50.0..52.0).contains(&(value - 0.31)));
    // No distance is negative; next to zero its direction is lost in rounding.
    let End::Blocked { value, reason } = range.lower else {
        panic!("{:?}", range.lower)
    };
    assert!(
        matches!(reason, Reason::Value(_)) && (0.0..1e-9).contains(&value),
        "{value} {reason:?}"
    );
}

/// The pantograph's tracer runs along y = 0 up to where its bars line up, 240 mm from O, and down
/// to O itself: there the folded bars could turn about O together, a change point in which two
/// drivers have a part.
#[test]
fn one_of_several_drivers_is_blocked_where_the_bars_line_up() {
    let (_, range) = range("pantograph");
    for (end, kind, limit) in [
        (&range.lower, SingularKind::ChangePoint, 0.0),
        (&range.upper, SingularKind::DeadPoint, 0.24),
    ] {
        let End::Singular(point) = end else {
            panic!("{end:?}")
        };
        assert_eq!(point.kind, kind);
        assert!((point.drivers[0] - limit).abs() < 1e-14, "{point:?}");
        assert_eq!(point.drivers[1].to_bits(), 0);
        assert_eq!(point.bodies, ["body `fixed_bar`", "body `tracer_bar`"]);
    }
}
