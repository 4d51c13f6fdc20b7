//! Prescribed motions are followed along their own curves.

use std::f64::consts::PI;

use biela::kinematics::Reason;

use crate::common::{assembled, parse};

#[test]
fn a_prescribed_motion_is_followed_along_its_own_curve() {
    // Both ends of the step have the same value; the peak between them is beyond the limit.
    let text = std::fs::read_to_string("mechanisms/tlv.toml")
        .expect("it is shipped")
        .replace("start = 0.35", "motion = \"0.35 + 0.4*sin(pi*t)\"");
    let mechanism = parse(&text);
    let (mut solver, mut path) = assembled(&mechanism);
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("the peak is at 0.75 m");
    // 0.35 + 0.4 sin(pi t) = 0.65 at t = asin(3/4)/pi.
    let limit = 0.75_f64.asin() / PI;
    assert!((blocked.s - limit).abs() < 1e-8, "{} {limit}", blocked.s);
    assert!((solver.pose().time - limit).abs() < 1e-8);
}

#[test]
fn a_motion_at_rest_at_both_ends_is_followed_in_between() {
    // Value, velocity and acceleration are the same at both ends; the peak is at 0.75 m.
    let text = std::fs::read_to_string("mechanisms/tlv.toml")
        .expect("it is shipped")
        .replace("start = 0.35", "motion = \"0.35 + 0.4*sin(pi*t)^4\"");
    let (mut solver, mut path) = assembled(&parse(&text));
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("the peak is at 0.75 m");
    // sin(pi t)^4 = 3/4.
    let limit = 0.75_f64.powf(0.25).asin() / PI;
    assert!((blocked.s - limit).abs() < 1e-8, "{} {limit}", blocked.s);
}

#[test]
fn a_motion_that_leaves_its_domain_says_so() {
    let text = std::fs::read_to_string("mechanisms/pendulum.toml")
        .expect("it is shipped")
        .replace("start = \"30*deg\"", "motion = \"sqrt(0.5 - t)\"");
    let (mut solver, mut path) = assembled(&parse(&text));
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("no root of -0.5");
    assert!(matches!(blocked.reason, Reason::Value(_)), "{blocked:?}");
    assert!((blocked.s - 0.5).abs() < 1e-6);
}
