//! Poses are exact to rounding, whatever the size of the mechanism and the number of steps.

use std::f64::consts::{PI, TAU};

use biela::kinematics::{Path, Solver};

use crate::common::{assembled, parse, shipped, straight_to};
use crate::generated::scissor_lift;
use crate::stepping::SAME_POSE;

/// Two sliders on a rod of 0.5 micrometres: as accurate as one of half a metre.
#[test]
fn small_mechanisms_are_as_accurate_as_large_ones() {
    for scale in [1.0, 1e-6, 1e-9] {
        let text = format!(
            r#"
            format = 1
            name = "trammel"
            [ground.markers]
            X = [0, 0]
            Y = [0, 0, "90*deg"]
            [bodies.a]
            markers = {{ A = [0, 0] }}
            estimate = [{x}, 0, 0]
            [bodies.b]
            markers = {{ B = [0, 0] }}
            estimate = [0, {y}, "90*deg"]
            [joints]
            x = {{ type = "translational", markers = ["ground.X", "a.A"] }}
            y = {{ type = "translational", markers = ["ground.Y", "b.B"] }}
            rod = {{ type = "link", markers = ["a.A", "b.B"], length = {rod} }}
            [drivers]
            u = {{ coordinate = "x", markers = ["ground.X", "a.A"], start = {x} }}
            "#,
            x = 0.3 * scale,
            y = 0.4 * scale,
            rod = 0.5 * scale
        );
        let (mut solver, mut path) = assembled(&parse(&text));
        for u in [0.35, 0.1, 0.45] {
            straight_to(&solver, &mut path, u * scale);
            solver.track(&path).expect("the rod reaches");
            let y = (0.25 - u * u).sqrt() * scale;
            assert!(
                (solver.pose().q[4] - y).abs() < 1e-14 * scale,
                "scale {scale:e}"
            );
        }
    }
}

/// Gears keep their phase: the planet of a planetary gear turns 1 + z_sun/z_planet times as fast
/// as the arm around a sun that stands still.
#[test]
fn a_planet_keeps_its_phase_over_a_thousand_turns() {
    let mechanism = parse(
        r#"
        format = 1
        name = "planetary"
        [ground.markers]
        O = [0, 0]
        [bodies.arm]
        markers = { O = [0, 0], P = [0.06, 0] }
        [bodies.planet]
        markers = { C = [0, 0] }
        estimate = [0.06, 0, 0]
        [joints]
        O = { type = "revolute", markers = ["ground.O", "arm.O"] }
        P = { type = "revolute", markers = ["arm.P", "planet.C"] }
        mesh = { type = "gear", markers = ["ground.O", "planet.C"], teeth = [40, 20], carrier = "arm" }
        [drivers]
        turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0 }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    for turn in 1..=1000 {
        straight_to(&solver, &mut path, TAU * f64::from(turn));
        solver.track(&path).expect("gears turn fully");
    }
    let arm = solver.pose().q[2];
    let planet = solver.pose().q[5];
    assert!((planet - 3.0 * arm).abs() <= 4.0 * f64::EPSILON * planet);
}

/// A pinion of 20 mm on a rack: half a turn moves it by pi r, to the left if it turns forward.
#[test]
fn a_pinion_rolls() {
    let mechanism = parse(
        r#"
        format = 1
        name = "rack_drive"
        [ground.markers]
        R = [0, 0]
        way = [0, "20*mm"]
        [bodies.carriage]
        markers = { C = [0, 0] }
        estimate = [0, "20*mm", 0]
        [bodies.pinion]
        markers = { C = [0, 0] }
        estimate = [0, "20*mm", 0]
        [joints]
        way = { type = "translational", markers = ["ground.way", "carriage.C"] }
        axle = { type = "revolute", markers = ["carriage.C", "pinion.C"] }
        mesh = { type = "rack_and_pinion", markers = ["pinion.C", "ground.R"], radius = "20*mm" }
        [drivers]
        turn = { coordinate = "angle", markers = ["carriage.C", "pinion.C"], start = 0 }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, PI);
    solver.track(&path).expect("the rack has no end");
    assert!((solver.pose().q[0] + 0.02 * PI).abs() < 1e-15);
}

#[test]
fn a_restored_pose_goes_on_with_the_same_bits() {
    let mechanisms = [
        (shipped("four_bar"), 0.3),
        (shipped("slider_crank"), 0.3),
        (shipped("five_bar_robot"), 0.01),
        (shipped("double_rocker"), 0.01),
        // One block with a sparse matrix.
        (parse(&scissor_lift(12)), 0.01),
        // Its one block is too large to be proved.
        (parse(&scissor_lift(20)), 0.01),
    ];
    for (mechanism, step) in mechanisms {
        let (mut solver, mut path) = assembled(&mechanism);
        let home = solver.pose().clone();
        let run = |solver: &mut Solver, path: &mut Path| {
            (1..50)
                .map(|k| {
                    straight_to(solver, path, home.drivers[0] + step * f64::from(k));
                    solver.track(path).expect("nothing is in the way");
                    solver.pose().clone()
                })
                .collect::<Vec<_>>()
        };
        let first = run(&mut solver, &mut path);
        solver.restore(&home);
        assert_eq!(run(&mut solver, &mut path), first, "{}", mechanism.name);
        let mut other = Solver::new(mechanism).expect("the drivers match");
        other.restore(&home);
        assert_eq!(run(&mut other, &mut path), first);
    }
}

#[test]
fn ten_thousand_steps_leave_no_residual_behind() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let start = solver.pose().drivers[0];
    for step in 1..=10_000 {
        let position = start + TAU * f64::from(step) / 1000.0;
        straight_to(&solver, &mut path, position);
        let progress = solver.track(&path).expect("the crank turns fully");
        // A predictor of second order needs one correction, or two where the motion is fast.
        assert!(
            progress.substeps == 1 && progress.iterations <= 2,
            "{progress:?}"
        );
        // Rounding of angles up to 63 rad.
        assert!(
            solver.residual() < 64.0 * f64::EPSILON,
            "{:e}",
            solver.residual()
        );
    }
}

/// A slotted lever whose pivot lies on the pin's circle: where the pin runs over the pivot the
/// lever could point anywhere, and the smooth motion goes on. By the inscribed angle the lever
/// turns half as fast as the crank.
#[test]
fn a_pin_runs_over_the_pivot_of_its_slot() {
    let mechanism = parse(
        "format = 1\nname = 'lever'\n[ground.markers]\nO = [0, 0]\nL = [-1, 0]\n\
         [bodies.crank]\nmarkers = { O = [0, 0], A = [1, 0] }\nestimate = [0, 0, 1]\n\
         [bodies.lever]\nmarkers = { L = [0, 0], end = [2, 0] }\nestimate = [-1, 0, 0.5]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'crank.O'] }\n\
         L = { type = 'revolute', markers = ['ground.L', 'lever.L'] }\n\
         A = { type = 'slot', markers = ['lever.L', 'crank.A'] }\n[drivers]\n\
         u = { coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 1 }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    for target in [2.0, PI, 4.0, 2.0] {
        straight_to(&solver, &mut path, target);
        solver.track(&path).expect("the motion goes on");
        assert!(
            (solver.pose().q[5] - 0.5 * target).abs() < SAME_POSE,
            "{target}"
        );
    }
}
