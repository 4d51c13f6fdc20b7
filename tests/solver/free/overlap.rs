//! Parts that overlap, and what brings them apart, against closed forms.

use std::sync::Arc;

use biela::dynamics::{Error, KeptStart, Overlap};
use biela::mechanism::Mechanism;

use super::run::{Fed, Run};
use crate::common::parse;

/// Values are some roundings of a few units.
const ROUNDING: f64 = 1e-13;

/// Two wheels of these inertias, with a ratio of 1/2 and a backlash of 0.02 rad.
fn wheels([one, other]: [f64; 2], start: f64) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "wheels"
[ground.markers]
O = [0, 0]
P = [0.3, 0]
[bodies]
one = {{ markers = {{ O = [0, 0] }}, mass = 1, inertia = {one} }}
other = {{ markers = {{ P = [0, 0] }}, mass = 1, inertia = {other}, estimate = [0.3, 0, 0] }}
[joints]
O = {{ type = "revolute", markers = ["ground.O", "one.O"] }}
P = {{ type = "revolute", markers = ["ground.P", "other.P"] }}
mesh = {{ type = "gear", markers = ["one.O", "other.P"], teeth = [20, 40], backlash = 0.02 }}
[freedoms]
p = {{ coordinate = "angle", markers = ["ground.O", "one.O"], start = {start} }}
q = {{ coordinate = "angle", markers = ["ground.P", "other.P"], start = 0 }}
"#
    ))
}

/// A ball on ropes that are fixed at A = (0, 0) or at B = (3, 0).
fn ball([x, y]: [f64; 2], ropes: &[(char, f64)]) -> Arc<Mechanism> {
    let ropes = ropes.iter().enumerate().map(|(k, (marker, length))| {
        format!(
            "rope{k} = {{ type = \"rope\", markers = [\"ground.{marker}\", \"ball.C\"], \
             length = {length}, unilateral = true }}\n"
        )
    });
    let ropes: String = ropes.collect();
    parse(&format!(
        r#"
format = 1
name = "ball"
[ground.markers]
A = [0, 0]
B = [3, 0]
[bodies.ball]
mass = 2
markers = {{ C = [0, 0] }}
[joints]
{ropes}
[constraints]
upright = {{ coordinate = "angle", markers = ["ground.A", "ball.C"], value = 0 }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.A", "ball.C"], start = {x} }}
y = {{ coordinate = "y", markers = ["ground.A", "ball.C"], start = {y} }}
"#
    ))
}

fn started(mechanism: &Arc<Mechanism>) -> (Run, Vec<Overlap>) {
    let mut run = Run::new(mechanism, 1e-10, Fed::default());
    let overlaps = run.free.overlaps().collect();
    (run, overlaps)
}

fn assert_all_near(values: &[f64], truths: &[f64]) {
    for (value, truth) in values.iter().zip(truths) {
        assert!((value - truth).abs() < ROUNDING, "{values:?} {truths:?}");
    }
}

/// With φ_q = −φ_p/2 ± 0.01 the wheels touch. The least ½ (J_p Δφ_p² + J_q Δφ_q²) that takes the depth δ
/// away is Δφ_p = −λ/(2 J_p), Δφ_q = −λ/J_q with λ = δ/(1/(4 J_p) + 1/J_q).
#[test]
fn wheels_that_overlap_share_the_way_by_their_inertias() {
    for inertias in [[0.01, 0.01], [0.01, 0.5], [3.0, 0.02]] {
        for start in [1.5, -0.4] {
            let (run, overlaps) = started(&wheels(inertias, start));
            let [one, other] = inertias;
            let depth = 0.5 * f64::abs(start) - 0.01;
            let push = depth.copysign(start) / (0.25 / one + 1.0 / other);
            let truth = [start - 0.5 * push / one, -push / other];
            assert_all_near(&run.state()[..2], &truth);
            let [overlap] = &overlaps[..] else {
                panic!("{overlaps:?}");
            };
            assert_all_near(&[overlap.depths[0].1], &[depth]);
            let moves = overlap.moves.iter().map(|(_, values)| *values);
            let moves: Vec<f64> = moves.flatten().collect();
            assert_all_near(&moves, &[start, truth[0], 0.0, truth[1]]);
        }
    }
}

#[test]
fn an_overlap_is_told() {
    let mechanism = wheels([0.01, 0.01], 1.5);
    let (_, overlaps) = started(&mechanism);
    // λ = 0.74/125, in degrees.
    assert_eq!(
        overlaps[0].describe(&mechanism),
        "t = 0 s: the parts of joint `mesh` overlap by 42.3989 deg; moved apart: `p` from 85.9437 deg to \
         68.9841 deg, `q` from 0 deg to -33.9191 deg"
    );
    let mechanism = ball([1.2, 0.0], &[('A', 1.0)]);
    let (_, overlaps) = started(&mechanism);
    assert_eq!(
        overlaps[0].describe(&mechanism),
        "t = 0 s: rope `rope0` is too short by 0.2 m; moved apart: `x` from 1.2 m to 1 m"
    );
}

/// Wheels that touch, or are apart by a part of the play, are where the file has them.
#[test]
fn what_does_not_overlap_is_not_moved() {
    for start in [0.02, 0.019, 0.0] {
        let mechanism = wheels([0.01, 0.02], start);
        let (run, overlaps) = started(&mechanism);
        assert_eq!(run.state()[..2], [start, 0.0]);
        assert_eq!(overlaps, []);
        assert!(KeptStart::of(&mechanism).is_none());
    }
}

/// The nearest point of a circle, and of the smaller of two: a rope that another one slackens does not
/// pull.
#[test]
fn a_ball_goes_to_the_nearest_place_that_its_ropes_leave() {
    let place = [0.9, 0.8];
    let far = f64::hypot(place[0], place[1]);
    let nearest = place.map(|x| 0.7 * x / far);
    for ropes in [&[('A', 0.7)][..], &[('A', 1.0), ('A', 0.7)]] {
        let (run, overlaps) = started(&ball(place, ropes));
        assert_all_near(&run.state()[..2], &nearest);
        let depths: Vec<f64> = overlaps[0].depths.iter().map(|(_, depth)| *depth).collect();
        let truth: Vec<f64> = ropes.iter().map(|(_, length)| far - length).collect();
        assert_all_near(&depths, &truth);
    }
}

/// Two circles of 1 m round points 3 m apart do not meet.
#[test]
fn parts_that_nothing_brings_apart_are_refused() {
    let mechanism = ball([1.5, 0.3], &[('A', 1.0), ('B', 1.0)]);
    let refused = Run::try_new(&mechanism, 1e-10, Fed::default()).map(drop);
    let Err(Error::Blocked(message)) = refused else {
        panic!("{refused:?}");
    };
    assert!(
        message.starts_with("at t = 0 s rope `rope0` is too short by ")
            && message.ends_with(", and no motion of the freedoms brings them apart"),
        "{message}"
    );
}

/// A floor that a parameter lifts by 0.1 m lifts the block that is 0.03 m above it.
#[test]
fn a_parameter_that_jumps_moves_what_it_meets() {
    let mechanism = parse(
        r#"
format = 1
name = "floor"
[parameters]
level = { value = 0, unit = "m", tunable = true }
[ground.markers]
G = [0, 0]
[bodies.block]
mass = 2
markers = { S = [0, 0] }
[joints]
guide = { type = "translational", markers = ["ground.G", "block.S"] }
[freedoms]
x = { coordinate = "x", markers = ["ground.G", "block.S"], start = 0.03, velocity = 0.5 }
[stops]
end = { coordinate = "x", markers = ["ground.G", "block.S"], min = "level" }
"#,
    );
    let (mut run, overlaps) = started(&mechanism);
    assert_eq!(overlaps, []);
    run.to(0.04);
    let jumped = run.free.jump(&mut run.solver, &run.fed, &[0.1]);
    jumped.expect("the block is moved");
    let overlaps: Vec<Overlap> = run.free.overlaps().collect();
    assert_eq!(
        overlaps[0].describe(&mechanism),
        "t = 0.04 s: stop `end` is passed by 0.05 m; moved apart: `x` from 0.05 m to 0.1 m"
    );
    run.to(0.1);
    assert_all_near(&run.state(), &[0.13, 0.5]);
}

/// The start that is kept is one: nothing overlaps there, and it begins with the same values and
/// velocities.
#[test]
fn a_kept_start_is_kept() {
    let mechanism = wheels([0.01, 0.03], 1.5);
    let kept = KeptStart::of(&mechanism).expect("the wheels overlap");
    let (run, overlaps) = started(&mechanism);
    assert_eq!(kept.overlaps, overlaps);
    let (again, none) = started(&kept.mechanism);
    assert_eq!(none, []);
    assert_all_near(&again.state(), &run.state());
    assert!(KeptStart::of(&kept.mechanism).is_none());
}
