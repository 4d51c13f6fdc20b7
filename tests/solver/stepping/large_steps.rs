//! Large steps keep to the branch and stop where the motion ends.

use std::f64::consts::TAU;

use biela::kinematics::{DriverPath, Reason};
use biela::mechanism::Jet;
use proptest::prelude::*;

use crate::common::exact::EXACT;
use crate::common::{assembled, parse, shipped, straight_to};
use crate::stepping::{SAME_POSE, difference};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A crank may jump by almost half a turn either way: the closed form, which has one branch
    /// only, tells where the continuous motion ends.
    #[test]
    fn large_steps_stay_on_the_branch(steps in prop::collection::vec(-3.1..3.1_f64, 1..20)) {
        for exact in EXACT.iter().filter(|exact| exact.file != "tlv") {
            let mechanism = shipped(exact.file);
            let (mut solver, mut path) = assembled(&mechanism);
            let mut angle = solver.pose().drivers[0];
            for step in &steps {
                angle += step;
                straight_to(&solver, &mut path, angle);
                prop_assert!(solver.track(&path).is_ok(), "{} at {angle}", exact.file);
                let truth: Vec<_> = exact
                    .solution(&mechanism, Jet::constant(angle))
                    .iter()
                    .map(|q| q.value)
                    .collect();
                let off = difference(&solver.pose().q, &truth);
                // Angles grow with the turns, and their rounding with them.
                prop_assert!(off < SAME_POSE * angle.abs().max(1.0), "{}: {off:e}", exact.file);
            }
        }
    }

    /// The same for the telescopic side, whose length has limits at 0.15 m and 0.65 m.
    #[test]
    fn large_strokes_stay_on_the_branch(lengths in prop::collection::vec(0.16..0.64_f64, 1..20)) {
        let mechanism = shipped("tlv");
        let exact = EXACT.iter().find(|exact| exact.file == "tlv").expect("it is listed");
        let (mut solver, mut path) = assembled(&mechanism);
        for length in lengths {
            straight_to(&solver, &mut path, length);
            prop_assert!(solver.track(&path).is_ok(), "at {length}");
            let solution = exact.solution(&mechanism, Jet::constant(length));
            let truth: Vec<_> = solution.iter().map(|q| q.value).collect();
            // 0.01 m from a limit of 0.65 m the arm's angle changes 12 times as fast as the length
            // does in arm lengths, and the closed form loses as much.
            prop_assert!(difference(&solver.pose().q, &truth) < 20.0 * SAME_POSE);
        }
    }
}

#[test]
fn a_whole_turn_in_one_step_is_a_whole_turn() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let before = solver.pose().q.clone();
    let target = solver.pose().drivers[0] + TAU;
    straight_to(&solver, &mut path, target);
    let progress = solver.track(&path).expect("the crank turns fully");
    // A sub-step of more than half a turn has chords that tell nothing of the way between.
    assert!((3..20).contains(&progress.substeps), "{progress:?}");
    assert_eq!(progress.checked, 0);
    let mut expected = before;
    expected[2] += TAU;
    assert!(difference(&solver.pose().q, &expected) < SAME_POSE);
}

#[test]
fn a_thousand_turns_keep_their_phase() {
    let mechanism = shipped("four_bar");
    let exact = &EXACT[2];
    let (mut solver, mut path) = assembled(&mechanism);
    let start = solver.pose().drivers[0];
    for turn in 1..=1000 {
        straight_to(&solver, &mut path, start + TAU * f64::from(turn));
        solver.track(&path).expect("the crank turns fully");
    }
    let angle = solver.pose().drivers[0];
    // The crank's equation is phi − u = 0: its angle is the driver's to the last bit or two.
    assert!((solver.pose().q[2] - angle).abs() <= 2.0 * f64::EPSILON * angle);
    let solution = exact.solution(&mechanism, Jet::constant(angle));
    for k in [5, 8] {
        // An angle of 6,000 rad has a rounding of 1e-12, and so has its sine.
        assert!((solver.pose().q[k] - solution[k].value).abs() < 2e-12);
    }
}

#[test]
fn a_step_in_two_halves_is_the_same_step() {
    for exact in EXACT {
        let mechanism = shipped(exact.file);
        let (mut whole, mut path) = assembled(&mechanism);
        let (mut halves, _) = assembled(&mechanism);
        let now = whole.pose().drivers[0];
        let target = now + if exact.file == "tlv" { 0.1 } else { 1.0 };
        straight_to(&whole, &mut path, target);
        whole.track(&path).expect("nothing is in the way");
        for part in [0.5 * (now + target), target] {
            straight_to(&halves, &mut path, part);
            halves.track(&path).expect("nothing is in the way");
        }
        assert!(
            difference(&whole.pose().q, &halves.pose().q) < SAME_POSE,
            "{}",
            exact.file
        );
    }
}

#[test]
fn the_way_back_ends_where_the_way_out_began() {
    let mechanism = shipped("slider_crank");
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    for angle in [2.0, 5.0, 9.0, 5.0, 2.0, home.drivers[0]] {
        straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("the crank turns fully");
    }
    assert!(difference(&solver.pose().q, &home.q) < SAME_POSE);
}

/// The telescopic side of the triangle ends at base + arm = 0.65 m and at base − arm = 0.15 m.
#[test]
fn a_dead_point_is_where_the_triangle_ends() {
    for (target, limit) in [(0.7, 0.65), (0.1, 0.15)] {
        let mechanism = shipped("tlv");
        let (mut solver, mut path) = assembled(&mechanism);
        straight_to(&solver, &mut path, target);
        let blocked = solver.track(&path).expect_err("the triangle cannot close");
        let reached = solver.pose().drivers[0];
        assert!((reached - limit).abs() < 1e-9, "{reached} {limit}");
        assert!((blocked.s - (limit - 0.35) / (target - 0.35)).abs() < 1e-8);
        // The pose there is a valid one, and the way back is open.
        assert!(solver.residual() < 1e-14);
        straight_to(&solver, &mut path, 0.35);
        solver.track(&path).expect("the way back is open");
        assert!((solver.pose().q[2].to_degrees() - 60.0).abs() < 1e-9);
    }
}

/// At 0.65 m exactly the side has no velocity that would give the arm one.
#[test]
fn the_dead_point_itself_is_refused() {
    let mechanism = shipped("tlv");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, 0.65);
    solver.track(&path).expect_err("arm and base are in line");
    assert!(solver.pose().drivers[0] < 0.65);
    assert!(solver.pose().drivers[0] > 0.65 - 1e-9);
}

/// A distance cannot be zero or negative: the side is blocked before, never turned inside out.
#[test]
fn a_distance_stays_positive() {
    let mechanism = shipped("tlv");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, -0.35);
    solver.track(&path).expect_err("no distance is negative");
    assert!(solver.pose().drivers[0] >= 0.15);
}

/// A crank that starts from rest and turns by most of a turn within one step, by its acceleration
/// alone, through both change points of the parallelogram.
#[test]
fn a_turn_from_rest_is_followed_all_the_way() {
    let (mut solver, mut path) = assembled(&shipped("parallelogram"));
    let start = solver.pose().drivers[0];
    path.duration = 1.0;
    path.driver_paths[0] = DriverPath::Input {
        position: start,
        velocity: 0.0,
        acceleration: 2.0 * 5.3,
        jump: 0.0,
    };
    let progress = solver.track(&path).expect("the crank turns fully");
    assert_eq!(progress.crossings, 2);
    assert!((solver.pose().q[8] - (start + 5.3)).abs() < SAME_POSE);
}

/// A stroke so long that the old value is lost beside it: refused, and nothing is lost.
#[test]
fn a_jump_beyond_all_rounding_is_refused() {
    let mechanism = parse(
        "format = 1\nname = 'slide'\n[ground.markers]\nO = [0, 0]\n[bodies.slide]\n\
         markers = { O = [0, 0] }\nestimate = [0.3, 0, 0]\n[joints]\n\
         O = { type = 'translational', markers = ['ground.O', 'slide.O'] }\n[drivers]\n\
         d = { coordinate = 'distance', markers = ['ground.O', 'slide.O'], start = 0.3 }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    let before = solver.pose().clone();
    straight_to(&solver, &mut path, -1e17);
    let blocked = solver.track(&path).expect_err("no distance is negative");
    assert!(matches!(blocked.reason, Reason::Value(_)), "{blocked:?}");
    assert_eq!(solver.pose().parameters, before.parameters);
    solver.restore(&before);
    straight_to(&solver, &mut path, 0.4);
    solver.track(&path).expect("the slide is as it was");
}
