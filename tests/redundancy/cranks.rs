//! Three cranks and more on one coupler, turned through the poses where they are flat.

use std::f64::consts::{PI, TAU};

use biela::kinematics::Reason;

use crate::common::{assembled, parse, straight_to};
use crate::mechanisms::{double, parallelogram};

/// Cranks that all turn alike, their pins not in one line: regular at every angle, the flat ones
/// included, for who may choose among the equations.
#[test]
fn three_cranks_turn_through_their_flat_poses() {
    turn_three_cranks(&[(10, 100), (100, 20), (1000, 2)]);
}

/// The same for longer.
#[test]
#[ignore = "takes a minute without optimisation"]
fn three_cranks_turn_a_hundred_times() {
    turn_three_cranks(&[(10, 100), (100, 100), (1000, 100)]);
}

/// Turns them with so many steps a turn, for so many turns.
fn turn_three_cranks(runs: &[(u32, u32)]) {
    let mechanism = parse(&parallelogram(&[[0.2, 0.1]], 60.0, true));
    let phi = |name: &str| 3 * mechanism.body_id(name).expect("it has it").index() + 2;
    let phi = ["crank", "rocker", "crank_5", "coupler"].map(phi);
    for &(steps, turns) in runs {
        let (mut solver, mut path) = assembled(&mechanism);
        for step in 1..=turns * steps {
            let angle = TAU / 6.0 + TAU * f64::from(step) / f64::from(steps);
            straight_to(&solver, &mut path, angle);
            let progress = solver
                .follow(&path)
                .unwrap_or_else(|blocked| panic!("{blocked:?}"));
            assert!(progress.substeps < 30, "{step} of {steps}: {progress:?}");
            let q = &solver.pose().q;
            // Rows that are not quite fit are kept: some digits are lost, three at the most.
            let rounding = 1e3 * f64::EPSILON * angle.max(1.0);
            for &phi in &phi[..3] {
                assert!(
                    (q[phi] - angle).abs() < rounding,
                    "{step} of {steps}: {}",
                    q[phi] - angle
                );
            }
            assert!(q[phi[3]].abs() < rounding, "{step} of {steps}");
        }
    }
}

/// With their pins in line three cranks laid flat lose rank whatever rows are chosen: refused for
/// that, and not for a contradiction, though nothing holds to rounding there.
#[test]
fn three_cranks_in_line_stop_where_they_are_flat() {
    let text = parallelogram(&[[0.2, 0.0]], 60.0, true);
    let (mut solver, mut path) = assembled(&parse(&text));
    straight_to(&solver, &mut path, 1.2 * PI);
    let blocked = solver
        .follow(&path)
        .expect_err("a change point with redundant rows");
    assert!(
        !matches!(blocked.reason, Reason::Contradiction(_)),
        "{blocked:?}"
    );
    // As near as the rows set aside hold to 1e-9: rounding by the square of the distance.
    assert!((solver.pose().drivers[0] - PI).abs() < 1e-3, "{blocked:?}");
    assert!(solver.residual() < 1.1e-9);
}

/// A change point is one for all rows: redundant ones elsewhere do not keep the mechanism from
/// crossing it.
#[test]
fn a_parallelogram_with_a_doubled_pin_crosses_its_change_points() {
    let text = double(&parallelogram(&[], 60.0, true), "A");
    let (mut solver, mut path) = assembled(&parse(&text));
    let rocker = solver.mechanism().body_id("rocker").expect("it has one");
    for step in 1..=72 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step);
        straight_to(&solver, &mut path, angle);
        solver
            .follow(&path)
            .unwrap_or_else(|blocked| panic!("{step}: {blocked:?}"));
        // The change points are known to 1e-9, as is what is said next to them.
        let off = solver.pose().q[3 * rocker.index() + 2] - angle;
        assert!(off.abs() < 1e-9, "{step}: {off:e}");
    }
}
