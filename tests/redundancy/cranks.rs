//! Three cranks and more on one coupler, turned through the poses where they are flat.

use std::f64::consts::TAU;

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
                .track(&path)
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

/// With their pins in line cranks laid flat lose rank whatever rows are chosen: change points that
/// are crossed part by part, each part reading the crossing of the one before.
#[test]
fn cranks_in_line_cross_their_change_points() {
    for more in [
        &[[0.2, 0.0]][..],
        &[[0.05, 0.0]],
        &[[0.37, 0.0]],
        &[[-0.3, 0.0]],
        &[[0.8, 0.0]],
        &[[0.1, 0.0], [0.3, 0.0]],
    ] {
        let mechanism = parse(&parallelogram(more, 60.0, true));
        let turning = mechanism.bodies.iter().enumerate();
        let turning: Vec<_> = turning
            .filter(|(_, body)| body.name != "coupler")
            .map(|(place, _)| 3 * place + 2)
            .collect();
        for steps in [7, 30] {
            let (mut solver, mut path) = assembled(&mechanism);
            for step in 1..=2 * steps {
                let angle = TAU / 6.0 + TAU * f64::from(step) / f64::from(steps);
                straight_to(&solver, &mut path, angle);
                solver
                    .track(&path)
                    .unwrap_or_else(|blocked| panic!("{more:?}, {step} of {steps}: {blocked:?}"));
                for &phi in &turning {
                    // As what is interpolated next to a change point.
                    let off = solver.pose().q[phi] - angle;
                    assert!(off.abs() < 1e-9, "{more:?}, {step} of {steps}: {off:e}");
                }
            }
        }
    }
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
            .track(&path)
            .unwrap_or_else(|blocked| panic!("{step}: {blocked:?}"));
        // The change points are known to 1e-9, as is what is said next to them.
        let off = solver.pose().q[3 * rocker.index() + 2] - angle;
        assert!(off.abs() < 1e-9, "{step}: {off:e}");
    }
}
