//! The range of motion of a driver.

#![allow(clippy::float_cmp, reason = "bounds are reached to the last bit")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::{assembled, mechanisms, parse, shipped};
use biela::kinematics::{End, RangeSettings, Reason, SingularKind, Solver};
use biela::mechanism::DriverId;

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

    let text = include_str!("../../mechanisms/tlv.toml");
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

/// An angle counts turns: a stop on one side of it ends one way, and leaves the other open.
#[test]
fn a_stop_on_one_side_ends_one_way() {
    let crank = |stop: &str, limits: &str| {
        parse(&format!(
            "format = 1\nname = 'crank'\n[ground.markers]\nO = [0, 0]\n[bodies.crank]\n\
             markers = {{ O = [0, 0] }}\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n[drivers]\n\
             turn = {{ coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 0.5{limits} \
             }}\n{stop}"
        ))
    };
    let range = |stop: &str, limits: &str| {
        let (mut solver, _) = assembled(&crank(stop, limits));
        let range = solver.range(DriverId(0), &RangeSettings::default());
        (range.lower, range.upper)
    };
    let stopped = |end: &End, at: f64| matches!(end, End::Stop { value, limit } if limit.stop == "end" && (value - at).abs() < 1e-12);
    // Near the start, and some turns away.
    for at in [-0.1, -20.0] {
        let (lower, upper) = range(&format!("[stops]\nend = {{ of = 'turn', min = {at} }}"), "");
        assert!(
            stopped(&lower, at) && upper == End::Turns(1),
            "{lower:?}, {upper:?}"
        );
        let (lower, upper) = range("", &format!(", min = {at}"));
        assert_eq!((lower, upper), (End::Bound { value: at }, End::Turns(1)));
    }
    for at in [0.6, 20.0] {
        let (lower, upper) = range(&format!("[stops]\nend = {{ of = 'turn', max = {at} }}"), "");
        assert!(
            lower == End::Turns(1) && stopped(&upper, at),
            "{lower:?}, {upper:?}"
        );
        let (lower, upper) = range("", &format!(", max = {at}"));
        assert_eq!((lower, upper), (End::Turns(1), End::Bound { value: at }));
    }
    // A stop that no turn changes ends none.
    let still = "[stops]\nend = { coordinate = 'x', markers = ['ground.O', 'crank.O'], min = -1 }";
    assert_eq!(range(still, ""), (End::Turns(1), End::Turns(1)));
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

/// A four-bar whose crank rocks, with a coupler point.
const ROCKING: &str = include_str!("range/rocking.toml");
/// A plate on three massless bars, one of them on the pin of a crank.
const PLATE: &str = include_str!("range/plate.toml");

/// Returns the coupler point's height and the angle between coupler and rocker at a crank angle, by
/// the law of cosines; `None` where the links do not reach.
fn rocking(crank: f64) -> Option<(f64, f64)> {
    let [a, b, c, base] = [0.81, 0.74, 0.85, 0.91];
    let (x, y) = (a * crank.cos(), a * crank.sin());
    let (far, along) = ((base - x).hypot(y), (-y).atan2(base - x));
    let cosine = (b * b + far * far - c * c) / (2.0 * b * far);
    let between = (b * b + c * c - far * far) / (2.0 * b * c);
    // The coupler is right of the line from the crank's pin to the rocker's.
    let coupler = along - (cosine.abs() <= 1.0).then(|| cosine.acos())?;
    let point = y - 0.7 * coupler.sin() - 0.73 * coupler.cos();
    Some((point, between.clamp(-1.0, 1.0).acos()))
}

/// The coupler point turns back 0.5 deg in front of the dead point, where the coupler runs as the
/// root of the distance. The closed form is scanned in steps of that root: near a maximum a step of
/// 1e-5 of it misses less than 1e-9.
#[test]
fn extremes_in_front_of_a_limit_are_found() {
    let mut solver = assembled(&parse(ROCKING)).0;
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let [End::Singular(lower), End::Singular(upper)] = [&range.lower, &range.upper] else {
        panic!("{range:?}")
    };
    let start = solver.pose().drivers[0];
    let [mut least, mut greatest] = [f64::INFINITY, f64::NEG_INFINITY];
    for limit in [lower.drivers[0], upper.drivers[0]] {
        for place in 0..100_000 {
            let left = 1.0 - f64::from(place) / 1e5;
            if let Some((height, _)) = rocking(limit - (limit - start) * left * left) {
                least = least.min(height);
                greatest = greatest.max(height);
            }
        }
    }
    let [found_least, found_greatest] = range.measures[0].map(|extreme| extreme.value);
    assert!((found_least - least).abs() < 1e-9, "{found_least} {least}");
    assert!(
        (found_greatest - greatest).abs() < 1e-9,
        "{found_greatest} {greatest}"
    );
    // The extreme lies between the last degree and the limit.
    let off = range.measures[0].map(|extreme| (extreme.driver - upper.drivers[0]).abs());
    assert!(
        off.into_iter()
            .any(|off| 1e-4 < off && off < 1_f64.to_radians()),
        "{off:?}"
    );
}

/// sin μ is that of the angle between the links, at all samples, with the
/// bodies in any order.
#[test]
fn the_transmission_angle_of_a_dyad_is_that_between_its_links() {
    let reordered = |text: &str| {
        let (head, rest) = text.split_once("[bodies.crank]").expect("it is there");
        let (crank, rest) = rest.split_once("[bodies.coupler]").expect("it is there");
        let (coupler, rest) = rest.split_once("[bodies.rocker]").expect("it is there");
        let (rocker, tail) = rest.split_once("[joints]").expect("it is there");
        format!(
            "{head}[bodies.rocker]{rocker}[bodies.coupler]{coupler}[bodies.crank]{crank}[joints]{tail}"
        )
    };
    let reversed = reordered(ROCKING);
    for text in [ROCKING, &reversed] {
        let mut solver = assembled(&parse(text)).0;
        let range = solver.range(DriverId(0), &RangeSettings::default());
        for sample in &range.samples {
            let (_, between) = rocking(sample.driver).unwrap_or((0.0, 0.0));
            let expected = between.min(PI - between);
            let found = sample.transmission.expect("there is a dyad");
            // At a limit the angle has half of the digits of the cosine: the root of 16 eps.
            assert!(
                (found - expected).abs() < 1e-7,
                "{} {expected}",
                sample.driver
            );
        }
        let ends = [range.samples.first(), range.samples.last()];
        for end in ends.into_iter().flatten() {
            assert!(end.transmission < Some(1e-7), "{end:?}");
        }
    }
}

/// Returns a slider-crank with this radius and rod; a marker far away makes it large.
fn slider_crank(radius: f64, rod: f64) -> String {
    let at_pin = format!("{radius}, 0, -0.3");
    let text = mechanisms::slider_crank([radius, rod], 0.0, "0.3", ["0, 0, 0", &at_pin, &at_pin]);
    text.replace(
        "markers = { O = [0, 0], A",
        "markers = { far = [0, 3], O = [0, 0], A",
    )
}

/// The angle is that between the rod and the normal of the guide, however small the rod is beside
/// the mechanism.
#[test]
fn the_transmission_angle_of_a_slide_is_that_of_its_rod() {
    let mut solver = assembled(&parse(&slider_crank(0.05, 0.2))).0;
    let range = solver.range(DriverId(0), &RangeSettings::default());
    for sample in &range.samples {
        let expected = FRAC_PI_2 - (0.05 * sample.driver.sin() / 0.2).asin().abs();
        let found = sample.transmission.expect("there is a dyad");
        assert!(
            (found - expected).abs() < 1e-6,
            "{} {expected}",
            sample.driver
        );
    }
}

/// A rod that is shorter than the crank jams where it stands at right angles to the guide.
#[test]
fn a_rod_at_right_angles_to_its_guide_is_not_in_line_with_anything() {
    let mut solver = assembled(&parse(&slider_crank(0.3, 0.2))).0;
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let End::Singular(point) = &range.upper else {
        panic!("{:?}", range.upper)
    };
    assert!(
        (point.drivers[0] - (2.0_f64 / 3.0).asin()).abs() < 1e-12,
        "{point:?}"
    );
    assert_eq!(
        point.geometry,
        "the normal of joint `guide` passes through joint `A`"
    );
}

/// Three bars hold the plate as long as their lines do not meet in one point.
#[test]
fn a_plate_on_three_bars_jams_where_their_lines_meet() {
    let (mut solver, mechanism) = {
        let mechanism = parse(PLATE);
        (assembled(&mechanism).0, mechanism)
    };
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let End::Singular(point) = &range.upper else {
        panic!("{:?}", range.upper)
    };
    assert!(
        (point.drivers[0].to_degrees() - 92.089_000_1).abs() < 1e-6,
        "{point:?}"
    );
    assert_eq!(
        point.bodies,
        ["joint `bar1`", "joint `bar2`", "joint `bar3`"]
    );
    assert_eq!(
        point.geometry,
        "joint `bar1`, joint `bar2` and joint `bar3` meet in one point"
    );
    let at = |marker: &str| {
        let (body, marker) = marker.split_once('.').expect("it is a path");
        let id = mechanism.body_id(body).expect("it is there").index();
        let [x, y, phi] = [0, 1, 2].map(|k| point.q[3 * id + k]);
        let [u, v] = match marker {
            "A" => [0.5, 0.0],
            "P" => [1.2, 1.4],
            "Q" => [2.2, 0.9],
            _ => [2.0, 2.0],
        };
        let (sin, cos) = phi.sin_cos();
        [x + cos * u - sin * v, y + sin * u + cos * v]
    };
    // A line through two points: direction, and moment about the origin.
    let line = |[x, y]: [f64; 2], [u, v]: [f64; 2]| {
        let length = (u - x).hypot(v - y);
        [(u - x) / length, (v - y) / length, (x * v - y * u) / length]
    };
    let lines = [
        line(at("crank.A"), at("plate.P")),
        line([3.0, 0.0], at("plate.Q")),
        line([3.5, 2.0], at("plate.R")),
    ];
    let [a, b, c] = lines;
    let cross = [
        b[1] * c[2] - b[2] * c[1],
        b[2] * c[0] - b[0] * c[2],
        b[0] * c[1] - b[1] * c[0],
    ];
    let determinant = a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2];
    assert!(determinant.abs() < 1e-7, "{determinant}");
    // The smallest angle falls to zero there, continuously: as the root of the distance.
    let last = range.samples.last().expect("there are some");
    assert!(
        last.driver >= point.drivers[0] && last.transmission < Some(1e-6),
        "{last:?}"
    );
    let angles = range
        .samples
        .iter()
        .filter_map(|sample| sample.transmission);
    assert_eq!(angles.clone().count(), range.samples.len());
    assert!(
        angles.clone().fold(0.0, f64::max) > 0.2,
        "it is regular in between"
    );
}

#[test]
fn change_points_are_samples() {
    let (_, range) = range("parallelogram");
    for center in [PI, TAU] {
        let at = range
            .samples
            .iter()
            .filter(|s| (s.driver - center).abs() < 1e-7);
        let angles: Vec<_> = at.filter_map(|sample| sample.transmission).collect();
        assert!(
            !angles.is_empty() && angles.iter().all(|angle| *angle < 1e-6),
            "{angles:?}"
        );
    }
}
