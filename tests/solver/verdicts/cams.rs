//! A cam in reach of its follower and one that is not.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{assembled, parse, straight_to};
use crate::generated::{BAR, BAR_ANGLE, scissor_lift};
use crate::verdicts::Expected::{Closes, NotFound};
use crate::verdicts::mechanisms::{across, cranked};
use crate::verdicts::{Case, case};

/// A follower on an arm of 1 about (`pivot`, 0) and a cam of radius 1 about the origin.
fn cam_and_arm(pivot: f64) -> String {
    cranked(
        &format!("P = [{pivot}, 0]"),
        "O = [0, 0]",
        0.0,
        &[("arm", "P = [0, 0], tip = [1, 0]", "0, 0, 2")],
        r#"P = { type = "revolute", markers = ["ground.P", "arm.P"] }
contact = { type = "cam", markers = ["crank.O", "arm.tip"], follower = "knife", profile = "1 + 0*theta" }"#,
    )
}

pub(crate) fn cases() -> Vec<Case> {
    vec![
        case(
            "a cam in reach",
            cam_and_arm(1.5),
            Closes(vec![("arm.phi", PI - across(1.0, 1.0, 1.5))]),
        ),
        // 5 less both radii; there is no closed form for contours.
        case(
            "a cam out of reach",
            cam_and_arm(5.0),
            NotFound(vec![("joint `contact`", 3.0, 0.0)]),
        ),
    ]
}

/// A lift of 18 cells under a cam with a round of 5 m: in half a turn of the cam the lift rises by
/// 3.2 m, and by `depth` more in a notch there.
fn lift_under_notch(depth: f64) -> String {
    let lift = scissor_lift(18);
    let (lift, _) = lift.split_once("[drivers]").expect("it has a driver");
    let top = 18.0 * BAR * BAR_ANGLE.sin();
    lift.replace(
        "O = [0, 0]\n[bodies",
        &format!(
            "O = [0, 0]\nK = [0, {y}]\n\
             [bodies.cam]\nmarkers = {{ O = [0, 0, '-90*deg'] }}\nestimate = [0, {y}, 0]\n[bodies",
            y = top + 5.0
        ),
    ) + &format!(
        "turn = {{ type = 'revolute', markers = ['ground.K', 'cam.O'] }}\n\
         contact = {{ type = 'cam', markers = ['cam.O', 'right_18.Q'], follower = 'knife', \
         profile = '5 - 1.6*(1 - cos(theta)) - {depth}*exp(-(1 + cos(theta))/{NOTCH})' }}\n\
         [drivers]\nu = {{ coordinate = 'angle', markers = ['ground.K', 'cam.O'], \
         start = '-90*deg' }}\n"
    )
}

/// Square of the width of the notch \[rad²\].
const NOTCH: f64 = 0.005;

/// A notch of 0.1 rad in the middle of the turn is felt by a lift that comes from 2.2 rad in one
/// step to 4.6 rad, whose middle is far from the notch: where the lift would have to rise beyond its
/// full height, by 3.6 m, the motion ends.
#[test]
fn a_notch_between_two_steps_of_a_large_block_is_found() {
    let go = |depth: f64| {
        let (mut solver, mut path) = assembled(&parse(&lift_under_notch(depth)));
        straight_to(&solver, &mut path, 2.2 - FRAC_PI_2);
        solver.track(&path).expect("the lift rises evenly");
        straight_to(&solver, &mut path, 4.6 - FRAC_PI_2);
        match solver.track(&path) {
            Ok(_) => Ok(()),
            Err(_) => Err(solver.pose().drivers[0] + FRAC_PI_2),
        }
    };
    // By bisection in 1 + cos of the cam's angle, over which the lift falls.
    let rise = |y: f64| 1.6 * (2.0 - y) + 0.5 * (-y / NOTCH).exp();
    let (mut within, mut beyond) = (0.0, NOTCH);
    for _ in 0..60 {
        let middle = 0.5 * (within + beyond);
        if rise(middle) > 3.6 {
            within = middle;
        } else {
            beyond = middle;
        }
    }
    let limit = (beyond - 1.0).acos();
    let reached = go(0.5).expect_err("the lift is not high enough");
    // On the flank of the notch, near its full height, the lift may need too many steps.
    assert!((0.0..0.1).contains(&(limit - reached)), "{reached} {limit}");
    go(0.0).expect("there is no notch");
}
