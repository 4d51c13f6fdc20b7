//! Dead points are located, change points are crossed on the smooth motion.

mod common;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use biela::kinematics::{Curve, Path, Rates, Solver};
use biela::mechanism::{Jet, Mechanism};
use common::{Exact, assembled, parse, shipped, straight_to};

/// The parallelogram as shipped, and crossed: B is mirrored in the line from A to O4, so that the
/// coupler turns by twice the angle of that line.
const PARALLEL: Exact = Exact {
    file: "parallelogram",
    bodies: &[
        ("crank", ["0", "0", "t"]),
        ("coupler", ["crank_length*cos(t)", "crank_length*sin(t)", "0"]),
        ("follower", ["base", "0", "t"]),
    ],
    formulas: &[],
    range: (0.0, 0.0),
};
const CROSSED: Exact = Exact {
    file: "parallelogram",
    bodies: &[
        ("crank", ["0", "0", "t"]),
        (
            "coupler",
            ["crank_length*cos(t)", "crank_length*sin(t)", "{coupler}"],
        ),
        ("follower", ["base", "0", "{coupler} - t"]),
    ],
    formulas: &[(
        "coupler",
        "2*atan2(-crank_length*sin(t), base - crank_length*cos(t))",
    )],
    range: (0.0, 0.0),
};

/// The crossed parallelogram: the same file with other estimates.
fn crossed() -> Arc<Mechanism> {
    let text = std::fs::read_to_string("mechanisms/parallelogram.toml")
        .expect("it is shipped")
        .replace("estimate = [0.05, 0.09, 0]", "estimate = [0.05, 0.09, \"-60*deg\"]")
        .replace(
            "estimate = [\"base\", 0, \"60*deg\"]",
            "estimate = [\"base\", 0, \"-120*deg\"]",
        );
    parse(&text)
}

/// Largest errors of position, velocity and acceleration over a number of turns of `steps` steps,
/// and the change points passed.
fn turn(
    mechanism: &Arc<Mechanism>,
    exact: &Exact,
    turns: u32,
    steps: u32,
    offset: f64,
) -> ([f64; 3], u32) {
    let (mut solver, mut path) = assembled(mechanism);
    let mut rates = Rates::new(solver.pose().q.len());
    let start = PI / 3.0;
    let mut worst = [0.0; 3];
    let mut crossings = 0;
    let (u, v) = (1.0, 0.3);
    for step in 1..=turns * steps {
        let angle = start + offset + TAU * f64::from(step) / f64::from(steps);
        straight_to(&solver, &mut path, angle);
        let progress = solver
            .follow(&path)
            .unwrap_or_else(|blocked| panic!("{} at {angle}: {blocked:?}", exact.file));
        crossings += progress.crossings;
        let driver = Jet {
            value: angle,
            first: u,
            second: v,
        };
        solver
            .solve_rates(|_| driver, &mut rates)
            .expect("rates exist on the smooth motion");
        for (k, truth) in exact.solution(mechanism, driver).iter().enumerate() {
            let found = [
                solver.pose().q[k],
                rates.velocity()[k],
                rates.acceleration()[k],
            ];
            let truth = [truth.value, truth.first, truth.second];
            for order in 0..3 {
                worst[order] = f64::max(worst[order], (found[order] - truth[order]).abs());
            }
        }
    }
    (worst, crossings)
}

#[test]
fn a_parallelogram_turns_through_its_change_points() {
    for (mechanism, exact) in [(shipped("parallelogram"), PARALLEL), (crossed(), CROSSED)] {
        for (turns, steps) in [(20, 10), (5, 100), (1, 10_000)] {
            let (worst, crossings) = turn(&mechanism, &exact, turns, steps, 0.0);
            println!("{turns} {steps} {worst:?} {crossings}");
            assert_eq!(crossings, 2 * turns);
        }
    }
}
