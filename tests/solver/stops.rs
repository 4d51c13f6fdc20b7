//! Stops end a motion where a closed form says so.

use std::f64::consts::{FRAC_PI_3, PI, TAU};
use std::sync::Arc;

use proptest::prelude::*;

use crate::common::{assembled, mechanisms, parse, straight_to};
use crate::generated::{Ground, chain};
use biela::kinematics::{
    Blocked, DriverPath, End, Error, Path, RangeSettings, Reason, Solver, StopLimit,
};
use biela::mechanism::{DriverId, Mechanism};

/// A place of a stop is known to the play of its gap, 2 · 4.6e-13 of the size or of the
/// coordinate at worst, and as a rule to rounding.
const PLACE: f64 = 1e-12;

/// A crank of 0.1 m and a rod of 0.3 m, whose slider is at x = r cos θ + √(l² − r² sin² θ).
fn slider_crank(stops: &str) -> Arc<Mechanism> {
    let estimates = [
        "0, 0, '100*deg'",
        "'0.1*cos(100*deg)', '0.1*sin(100*deg)', '-0.3*sin(100*deg)'",
        "'0.1*cos(100*deg) + 0.3', 0, 0",
    ];
    let more = r#"
[parameters]
reach = { value = 0.35, unit = "m" }
[measures]
travel = { coordinate = "x", markers = ["ground.O", "slider.B"] }
"#;
    parse(&(mechanisms::slider_crank([0.1, 0.3], 0.0, "100*deg", estimates) + more + stops))
}

/// The angle from 0 to π at which the slider is at x, by the law of cosines.
fn angle_at(x: f64) -> f64 {
    ((0.01 + x * x - 0.09) / (0.2 * x)).acos()
}

fn go(solver: &mut Solver, path: &mut Path, to: f64) -> Result<(), Box<Blocked>> {
    straight_to(solver, path, to);
    solver.track(path).map(|_| ()).map_err(Box::new)
}

fn stop_of(blocked: &Blocked) -> &StopLimit {
    match &blocked.reason {
        Reason::Stop(limit) => limit,
        other => panic!("{other:?}"),
    }
}

fn angle(solver: &Solver) -> f64 {
    solver.pose().drivers[0]
}

#[test]
fn a_slider_ends_at_its_stop() {
    let stops = "[stops]\nbump = { of = \"travel\", max = 0.35 }";
    let mechanism = slider_crank(stops);
    let limit = angle_at(0.35);
    // At the end of the step, far beyond it, beyond it and back inside, and after a turn.
    for to in [limit - 1e-3, 0.2, -1.5, -TAU + 1.5] {
        let (mut solver, mut path) = assembled(&mechanism);
        let blocked = go(&mut solver, &mut path, to).expect_err("the stop is in the way");
        assert!(
            (angle(&solver) - limit).abs() < PLACE,
            "{to}: {}",
            angle(&solver) - limit
        );
        assert_eq!(
            stop_of(&blocked).to_string(),
            "stop `bump` reached: travel = 0.350000000 m"
        );
        assert!(blocked.progress.substeps < 60, "{:?}", blocked.progress);
        assert!(solver.residual() < 1e-14);
    }
}

#[test]
fn the_motion_goes_on_away_from_a_stop() {
    let mechanism = slider_crank("[stops]\nbump = { of = \"travel\", max = 0.35 }");
    let (mut solver, mut path) = assembled(&mechanism);
    go(&mut solver, &mut path, 0.0).expect_err("the stop is in the way");
    let at_stop = solver.pose().clone();
    // Outward nothing moves, however often or little it is tried.
    for to in [0.0, angle(&solver) - 1e-6, angle(&solver) - 1e-9, -1.5] {
        let blocked = go(&mut solver, &mut path, to).expect_err("it is at the stop");
        assert!(blocked.s.abs() < 1e-300, "{}", blocked.s);
        assert_eq!(solver.pose(), &at_stop);
        assert!(blocked.progress.substeps < 12, "{:?}", blocked.progress);
    }
    // It rests there, leaves inward by any amount and comes back to the same place.
    let here = angle(&solver);
    for by in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0] {
        solver.restore(&at_stop);
        go(&mut solver, &mut path, here + by).expect("it leads inward");
        assert!((angle(&solver) - here - by).abs() < 1e-15);
        let progress = solver.track(&path);
        assert!(progress.is_ok(), "it rests");
        if by > 1e-11 {
            go(&mut solver, &mut path, here - 0.1).expect_err("it is back");
        }
        assert!((angle(&solver) - here).abs() < PLACE);
    }
}

#[test]
fn a_step_into_a_stop_equals_many_small_ones() {
    let mechanism = slider_crank("[stops]\nbump = { of = \"travel\", max = 0.39 }");
    let limit = angle_at(0.39);
    for parts in [1, 7, 100, 5000] {
        let (mut solver, mut path) = assembled(&mechanism);
        let from = angle(&solver);
        let blocked = (1..=parts).find_map(|part| {
            let to = from - 2.0 * from * f64::from(part) / f64::from(parts);
            go(&mut solver, &mut path, to).err()
        });
        assert!(blocked.is_some());
        assert!((angle(&solver) - limit).abs() < PLACE, "{parts}");
    }
}

/// The slider's largest place is 0.4 m: the motion grazes a stop there, and one that is a little
/// nearer ends it.
#[test]
fn a_stop_that_is_grazed_ends_no_motion() {
    for (max, passes) in [
        ("0.4", true),
        ("0.4 + 1e-9", true),
        ("0.1 + 0.3", true),
        ("0.4 - 1e-11", false),
        ("0.4 - 1e-6", false),
    ] {
        let stops = format!("[stops]\nbump = {{ of = \"travel\", max = \"{max}\" }}");
        let mechanism = slider_crank(&stops);
        let (mut solver, mut path) = assembled(&mechanism);
        let gone = go(&mut solver, &mut path, -1.0);
        match gone {
            Ok(()) => assert!(passes, "{max}"),
            Err(blocked) => {
                assert!(!passes, "{max}: {blocked:?}");
                // The gap closes at r (1 + r/l) θ there: its error of 1e-14 is one of 1e-14/θ.
                let parameters = &solver.pose().parameters;
                let [_, most] = mechanism.stops[0].limits(&|id| parameters[id.index()]);
                let limit = angle_at(most);
                assert!((angle(&solver) - limit).abs() < 1e-13 / limit, "{max}");
            }
        }
        let (mut solver, mut path) = assembled(&mechanism);
        // Full turns in many steps pass it as often.
        let from = angle(&solver);
        let turned =
            (1..=720).all(|k| go(&mut solver, &mut path, from - f64::from(k).to_radians()).is_ok());
        assert_eq!(turned, passes, "{max}");
    }
}

#[test]
fn the_first_of_several_stops_counts() {
    let stops = r#"
[stops]
far = { of = "travel", max = 0.38 }
near = { of = "travel", max = 0.36, min = 0.1 }
turned = { coordinate = "angle", markers = ["ground.O", "crank.O"], min = "20*deg" }
same = { of = "turn", min = "20*deg" }
"#;
    let mechanism = slider_crank(stops);
    let (mut solver, mut path) = assembled(&mechanism);
    let blocked = go(&mut solver, &mut path, -1.0).expect_err("there are stops");
    assert_eq!(stop_of(&blocked).stop, "near");
    assert!((angle(&solver) - angle_at(0.36)).abs() < PLACE);
    // At the same place the first in the file.
    let stops = &stops.replace("0.36", "0.5").replace("0.38", "0.5");
    let (mut solver, mut path) = assembled(&slider_crank(stops));
    let blocked = go(&mut solver, &mut path, -1.0).expect_err("there are stops");
    assert_eq!(
        stop_of(&blocked).to_string(),
        "stop `turned` reached: angle = 0.349065850 rad (20.000000 deg)"
    );
    assert!((angle(&solver) - 20_f64.to_radians()).abs() < PLACE);
}

#[test]
fn angles_count_turns() {
    let stops = "[stops]\nwound = { of = \"turn\", max = \"2000*deg\" }";
    let (mut solver, mut path) = assembled(&slider_crank(stops));
    go(&mut solver, &mut path, 100.0).expect_err("2000 degrees are fewer");
    let limit = 2000_f64.to_radians();
    assert!((angle(&solver) - limit).abs() < PLACE * limit);
}

/// A parameter that moves a limit onto the mechanism stops where it meets it.
#[test]
fn a_limit_that_moves_ends_the_motion() {
    let stops = "[stops]\nbump = { of = \"travel\", max = \"reach\" }";
    let mechanism = slider_crank(stops);
    let (mut solver, mut path) = assembled(&mechanism);
    let reach = mechanism.parameter_id("reach").expect("it is declared");
    let x = |angle: f64| {
        let sin = 0.1 * angle.sin();
        0.1 * angle.cos() + (0.09 - sin * sin).sqrt()
    };
    // The limit alone moves, from 0.35 m to 0.2 m.
    let here = angle(&solver);
    straight_to(&solver, &mut path, here);
    path.to[reach.index()] = 0.2;
    let blocked = solver.track(&path).expect_err("the limit meets the slider");
    let met = (0.35 - x(here)) / 0.15;
    assert!((blocked.s - met).abs() < 1e-11, "{} {met}", blocked.s);
    assert!((solver.pose().parameters[reach.index()] - x(here)).abs() < PLACE);
    // From there it moves away again.
    path.from.clone_from(&solver.pose().parameters);
    path.to[reach.index()] = 0.36;
    solver.track(&path).expect("the limit leaves");
    // Both move: x(θ(s)) = 0.36 - 0.06 s, whose root bisection finds.
    path.from.clone_from(&solver.pose().parameters);
    straight_to(&solver, &mut path, 0.3);
    path.to[reach.index()] = 0.3;
    let gap = |s: f64| 0.36 - 0.06 * s - x(here + s * (0.3 - here));
    let (mut inside, mut outside) = (0.0, 1.0);
    while outside - inside > 1e-15 {
        let middle = 0.5 * (inside + outside);
        if gap(middle) > 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    let blocked = solver.track(&path).expect_err("they meet");
    assert!((blocked.s - inside).abs() < 1e-11, "{} {inside}", blocked.s);
}

#[test]
fn limits_in_the_wrong_order_are_no_mechanism() {
    let stops = "[stops]\nbump = { of = \"travel\", max = \"reach\", min = 0.1 }";
    let mechanism = slider_crank(stops);
    let (mut solver, mut path) = assembled(&mechanism);
    path.to[0] = 0.05;
    // It is refused where it happens; the limit meets the slider before.
    let blocked = solver.track(&path).expect_err("the limit meets the slider");
    assert_eq!(stop_of(&blocked).stop, "bump");
    let error = solver.assemble(&path).expect_err("0.05 is below 0.1");
    assert_eq!(
        error.to_string(),
        "stop `bump`: its `min` = 0.100000000 m is not below its `max` = 0.050000000 m"
    );
}

#[test]
fn a_start_beyond_a_stop_is_refused() {
    let mechanism = slider_crank("[stops]\nbump = { of = \"travel\", max = 0.25 }");
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism).expect("the driver matches");
    let error = solver.assemble(&path).expect_err("it is beyond");
    assert!(matches!(error, Error::BeyondStop { .. }));
    assert_eq!(
        error.to_string(),
        "the start pose is beyond stop `bump`: travel = 0.266010440 m is above its `max` = 0.250000000 m"
    );
}

/// On the way to a start the motion leads through stops, which is no motion of the mechanism.
#[test]
fn a_start_may_be_behind_a_stop_on_the_way() {
    let mechanism = slider_crank("[stops]\nbump = { of = \"travel\", max = 0.35 }");
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    straight_to(&solver, &mut path, -1.5);
    solver
        .start(&home, &path)
        .expect("the slider is inside there");
    straight_to(&solver, &mut path, 0.0);
    path.driver_paths[0] = DriverPath::held(0.1, home.drivers[0]);
    let error = solver.start(&home, &path).expect_err("it is beyond there");
    assert!(matches!(error, Error::BeyondStop { .. }), "{error}");
}

#[test]
fn a_range_ends_at_stops() {
    let stops = "[stops]\nbump = { of = \"travel\", max = 0.35, min = 0.22 }";
    let (mut solver, _) = assembled(&slider_crank(stops));
    let range = solver.range(DriverId(0), &RangeSettings::default());
    for (end, x) in [(&range.lower, 0.35), (&range.upper, 0.22)] {
        let End::Stop { value, limit } = end else {
            panic!("{end:?}")
        };
        assert_eq!(limit.stop, "bump");
        assert!((value - angle_at(x)).abs() < PLACE, "{value}");
        assert!((limit.value - x).abs() < 1e-300);
    }
    // The limits are among the samples, and so are the measure's extremes.
    let ends = [&range.samples[0], &range.samples[range.samples.len() - 1]];
    for (sample, x) in ends.into_iter().zip([0.35, 0.22]) {
        assert!((sample.measures[0] - x).abs() < PLACE);
    }
    assert!((range.measures[0][1].value - 0.35).abs() < PLACE);
}

/// The travel is given by a table of several pieces. At its start the distance has a corner.
#[test]
fn a_stop_behind_several_pieces_of_a_table_is_met() {
    let text = r#"
format = 1
name = "lead"
[bodies.nut]
markers = { N = [0, 0] }
[ground.markers]
S = [0, 0]
[joints]
guide = { type = "translational", markers = ["ground.S", "nut.N"] }
[drivers.feed]
coordinate = "x"
markers = ["ground.S", "nut.N"]
motion = { table = [[0, 0], [0.1, 0.01], [0.2, 0.05], [0.3, 0.06], [1, 0.2]], law = "trapezoidal" }
[stops]
wall = { coordinate = "distance", markers = ["ground.S", "nut.N"], max = 0.13, min = -1 }
"#;
    let (mut solver, mut path) = assembled(&parse(text));
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("the wall is on the way");
    // The law is half way between two points after half of the time.
    assert!(
        (solver.pose().time - 0.65).abs() < PLACE,
        "{}",
        solver.pose().time
    );
    assert!((blocked.s - 0.65).abs() < PLACE);
    assert_eq!(stop_of(&blocked).stop, "wall");
    assert!(blocked.progress.substeps < 100, "{:?}", blocked.progress);
}

/// A four-bar of 0.1, 0.25, 0.3 on a base of 0.4 m, whose rocker's angle follows from the law of
/// cosines in two triangles.
fn rocker_at(crank: f64) -> f64 {
    let [ax, ay] = [0.1 * crank.cos(), 0.1 * crank.sin()];
    let d = (0.4 - ax).hypot(ay);
    let inner = ((d * d + 0.09 - 0.0625) / (0.6 * d)).acos();
    PI + (-ay).atan2(0.4 - ax) - inner
}

fn four_bar(stop: &str, start: f64) -> Arc<Mechanism> {
    let text = mechanisms::four_bar_at([0.1, 0.25, 0.3, 0.4], start, 1.0).expect("it turns fully");
    parse(&format!(
        "{text}[stops]\n\
         pin = {{ coordinate = \"angle\", markers = [\"ground.O4\", \"rocker.O\"], {stop} }}\n"
    ))
}

/// Bounds of unknowns add up along a chain: beside a stop of its last rocker the rounding in them
/// neither ends the motion nor shortens sub-steps without end.
#[test]
fn a_long_chain_rests_at_a_stop_and_leaves_it() {
    for loops in [1, 30, 300] {
        let limit = rocker_at(1.6);
        let key = if limit > rocker_at(FRAC_PI_3) {
            "max"
        } else {
            "min"
        };
        let text = chain(loops, Ground::Zigzag);
        let mechanism = parse(&format!(
            "{text}\n[stops]\nlast = {{ coordinate = \"angle\", \
             markers = [\"ground.O{loops}\", \"rocker_{loops}.O\"], {key} = {limit:.17} }}\n"
        ));
        let (mut solver, mut path) = assembled(&mechanism);
        let blocked = go(&mut solver, &mut path, 2.0).expect_err("the stop is on the way");
        assert_eq!(stop_of(&blocked).stop, "last");
        println!(
            "{loops}: {:e}, {:?}",
            angle(&solver) - 1.6,
            blocked.progress
        );
        // Each loop adds a few roundings.
        let place = 1e-14 * (10.0 + loops as f64);
        assert!(
            (angle(&solver) - 1.6).abs() < place,
            "{}",
            angle(&solver) - 1.6
        );
        let here = angle(&solver);
        go(&mut solver, &mut path, here).expect("it rests");
        let inward = solver.track_or_give_up(&path);
        assert!(inward.is_ok(), "it rests");
        straight_to(&solver, &mut path, here - 0.01);
        let progress = solver.track(&path).expect("it leads inward");
        println!("{loops}: inward {progress:?}");
        assert!(progress.substeps < 100, "{progress:?}");
        go(&mut solver, &mut path, 2.0).expect_err("the stop is on the way");
        assert!((angle(&solver) - 1.6).abs() < place);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// The crank ends at the first root of the closed form, wherever it starts, whichever way it
    /// turns and however far a step goes.
    #[test]
    fn a_four_bar_ends_at_the_first_root_of_its_closed_form(
        start in -3.0..3.0_f64,
        way in 0.5..6.0_f64,
        forward: bool,
        part in 0.05..0.95_f64,
        is_max: bool,
    ) {
        // The limit lies between the rocker's value at the start and its extreme that way.
        let sign = if forward { 1.0 } else { -1.0 };
        let g = |off: f64, limit: f64| {
            let rocker = rocker_at(start + sign * off);
            if is_max { limit - rocker } else { rocker - limit }
        };
        let places = (0..=6000).map(|k| way * f64::from(k) / 6000.0);
        let reached = places.clone().map(|off| -g(off, 0.0));
        let most = reached.fold(f64::NEG_INFINITY, f64::max);
        let beyond = most + g(0.0, 0.0);
        prop_assume!(beyond > 1e-3);
        let here = rocker_at(start);
        let limit = if is_max { here + part * beyond } else { here - part * beyond };
        let outside = places.into_iter().find(|off| g(*off, limit) < 0.0);
        let outside = outside.expect("it is on the way");
        let (mut a, mut b) = (outside - way / 6000.0, outside);
        for _ in 0..60 {
            let middle = 0.5 * (a + b);
            if g(middle, limit) > 0.0 { a = middle } else { b = middle }
        }
        let key = if is_max { "max" } else { "min" };
        let mechanism = four_bar(&format!("{key} = {limit:.17}"), start);
        let (mut solver, mut path) = assembled(&mechanism);
        let blocked = go(&mut solver, &mut path, start + sign * way).expect_err("it is on the way");
        prop_assert_eq!(&stop_of(&blocked).stop, "pin");
        let off = sign * (angle(&solver) - start);
        // A gap known to 1e-13 is closed at the rate of the rocker.
        let rate = (g(a - 1e-6, limit) - g(a + 1e-6, limit)) / 2e-6;
        prop_assert!((off - a).abs() < 1e-12 + 1e-13 / rate.abs(), "{} {} {}", off, a, rate);
        prop_assert!(blocked.progress.substeps < 200, "{:?}", blocked.progress);
        // It goes back, and comes again in small steps.
        go(&mut solver, &mut path, start).expect("it leads inward");
        let again = (1..=500).find_map(|k| {
            go(&mut solver, &mut path, start + sign * way * f64::from(k) / 500.0).err()
        });
        prop_assert!(again.is_some());
        let again = sign * (angle(&solver) - start);
        prop_assert!((again - a).abs() < 1e-12 + 1e-13 / rate.abs(), "{} {}", again, a);
    }
}
