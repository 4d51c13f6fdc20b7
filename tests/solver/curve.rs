//! Points on curves: carriages, parallel curves, and parameters that move.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{Error, Path, Rates, Reason, Solver};
use biela::mechanism::{Jet, Mechanism};

use crate::common::{assembled, parse, shipped, straight_to};

/// A carriage runs round a circle of radius 0.4 about (0.1, −0.2), 0.1 outside of it: counter-clockwise
/// its right is outside.
const CARRIAGE: &str = r#"
    format = 1
    name = "carriage"
    ground.markers = { C = [0.1, -0.2] }
    [bodies]
    carriage = { markers = { M = [0.05, 0.02, 0.3] }, estimate = [0.6, -0.2, 1.2] }
    [joints]
    track = { type = "curve", markers = ["ground.C", "carriage.M"], x = "0.4*cos(s)", y = "0.4*sin(s)", to = "2*pi", closed = true, offset = -0.1, follow = true }
    [drivers]
    turn = { coordinate = "angle", markers = ["ground.C", "carriage.M"], start = "90*deg" }
"#;

#[test]
fn a_carriage_goes_round_on_a_parallel_curve() {
    let (mut solver, mut path) = assembled(&parse(CARRIAGE));
    let mut rates = Rates::new(4);
    for angle in [2.0, 4.5, 20.0, -30.0] {
        straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("the track is closed");
        let motion = Jet::new(angle, [0.7, -0.4]);
        solver
            .solve_rates(|_| motion, &mut rates)
            .expect("it is regular");
        // The tangent is a quarter turn ahead of the radius.
        let (direction, phi) = (angle - 0.25 * TAU, angle - 0.3);
        let (arm, arm_turn) = (0.05_f64.hypot(0.02), phi + 0.02_f64.atan2(0.05));
        for order in 0..3 {
            let whirl = |radius: f64, turn: f64| {
                let (sin, cos) = turn.sin_cos();
                let ([u, v], (w, a)) = ([cos, sin], (motion.first(), motion.second()));
                match order {
                    0 => [radius * u, radius * v],
                    1 => [-radius * v * w, radius * u * w],
                    _ => [radius * (-u * w * w - v * a), radius * (-v * w * w + u * a)],
                }
            };
            let at_rest = f64::from(u8::from(order == 0));
            let ([x, y], [back_x, back_y]) = (whirl(0.5, direction), whirl(arm, arm_turn));
            let truth = [
                0.1 * at_rest + x - back_x,
                -0.2 * at_rest + y - back_y,
                [phi, motion.first(), motion.second()][order],
            ];
            let q = [&solver.pose().q[..], rates.velocity(), rates.acceleration()][order];
            for (found, truth) in q.iter().zip(truth) {
                assert!(
                    (found - truth).abs() < 1e-13,
                    "{angle}, {order}: {found} {truth}"
                );
            }
        }
    }
}

#[test]
fn a_groove_that_changes_at_once_ends_at_the_closed_form() {
    let mechanism = shipped("groove_cam");
    let (mut solver, mut path) = assembled(&mechanism);
    let place = |name| {
        let mut parameters = mechanism.parameters.iter();
        parameters.position(|p| p.name == name).expect("it has it")
    };
    let [radius, eccentricity] = ["groove_radius", "eccentricity"].map(place);
    let slide = 3 * mechanism.body_id("slide").expect("it has it").index();
    for (angle, r, e) in [
        (5.0_f64, 0.05, 0.03),
        (-9.0, 0.08, 0.005),
        (40.0, 0.06, 0.04),
    ] {
        path.from.copy_from_slice(&solver.pose().parameters);
        path.to.copy_from_slice(&solver.pose().parameters);
        (path.to[radius], path.to[eccentricity]) = (r, e);
        straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("the way is free");
        let (sin, cos) = angle.sin_cos();
        let aside = 0.010 - e * cos;
        let expected = e * sin + (r * r - aside * aside).sqrt();
        let found = solver.pose().q[slide + 1];
        assert!(
            (found - expected).abs() < 1e-15,
            "{found} is not {expected}"
        );
    }
}

/// A bead on an open curve, which is straight from x = -1 to 1.
fn bead(start: f64) -> Arc<Mechanism> {
    parse(&format!(
        "format = 1\nname = 'end'\nground.markers = {{ C = [0, 0] }}\n\
         bodies.bead = {{ markers = {{ B = [0, 0] }}, estimate = [{start}, 0, 0] }}\n[joints]\n\
         track = {{ type = 'curve', markers = ['ground.C', 'bead.B'], \
         points = {{ table = [[-1, 0], [1, 0]] }} }}\n[drivers]\n\
         x = {{ coordinate = 'x', markers = ['ground.C', 'bead.B'], start = {start} }}\n\
         phi = {{ coordinate = 'angle', markers = ['ground.C', 'bead.B'], start = 0 }}\n"
    ))
}

/// A motion ends where the curve does, to rounding, and goes back from there; a start beyond an end is
/// refused.
#[test]
fn a_motion_ends_at_the_end_of_a_curve() {
    for (target, end) in [(1.7, 1.0), (-1.2, -1.0)] {
        let (mut solver, mut path) = assembled(&bead(0.3));
        straight_to(&solver, &mut path, target);
        let blocked = solver.track(&path).expect_err("the curve ends");
        let Reason::Stop(limit) = &blocked.reason else {
            panic!("{blocked:?}");
        };
        assert_eq!(limit.to_string(), "the curve of joint `track` ends here");
        let x = solver.pose().drivers[0];
        assert!((x - end).abs() < 1e-13, "{x}");
        straight_to(&solver, &mut path, 0.0);
        solver.track(&path).expect("it goes back");
    }
    for start in [1.2, -1.5] {
        let mechanism = bead(start);
        let error = Solver::assembled(Arc::clone(&mechanism), &Path::new(&mechanism));
        assert!(matches!(error, Err(Error::BeyondStop { .. })), "{error:?}");
    }
}
