//! The yardsticks do what biela does.

use std::f64::consts::{FRAC_PI_2, PI};

use biela::kinematics::ForceQuantity;
use biela::mechanism::Jet;
use yardstick::by_hand::{
    ByHand, FourBarForces, cam_flat, cam_knife, cam_roller, four_bar, four_bar_masses,
    slider_crank, slider_crank_of,
};
use yardstick::chain::{Chain, Kind};
use yardstick::comparisons::{counted_cases, timed_cases};
use yardstick::cycle::{Cycle, Order};
use yardstick::free::{self, Free, Motion};
use yardstick::generated::{BAR, Ground, chain, scissor_lift};
use yardstick::motion::{Loaded, Moving, Stepper, Sweep, by_order, with_masses};
use yardstick::{shipped, sizes};

const KINDS: [Kind; 3] = [Kind::Plain, Kind::Updated, Kind::Condition];
const GROUNDS: [Ground; 2] = [Ground::Straight, Ground::Zigzag];

/// Rounding, some eps of numbers up to 3 m and 3 rad, times what the worst block makes of it, 1/0.1;
/// velocities and accelerations, of the size of 10 rad/s and 100 rad/s², pass through the block
/// once more each.
const LIMITS: [f64; 3] = [1e-13, 1e-12, 1e-10];

#[track_caller]
fn assert_within(limits: [f64; 3], found: &[Vec<f64>; 3], truth: &[Vec<f64>; 3], what: &str) {
    for order in 0..3 {
        assert_eq!(found[order].len(), truth[order].len(), "{what}");
        for (k, (a, b)) in found[order].iter().zip(&truth[order]).enumerate() {
            let error = (a - b).abs();
            // Coordinates of pivots far away round in proportion.
            let limit = limits[order] * b.abs().max(1.0);
            assert!(error <= limit, "{what}, order {order}, {k}: {a} and {b}");
        }
    }
}

#[track_caller]
fn assert_close(found: &[Vec<f64>; 3], truth: &[Vec<f64>; 3], what: &str) {
    assert_within(LIMITS, found, truth, what);
}

/// Whole runs begin, and no energy appears: the tolerance is 1e-8, energies are up to some hundred joules.
#[test]
fn whole_runs_begin_and_keep_their_energy() {
    for run in &free::RUNS {
        let cost = run.cost(3);
        let what = run.what;
        assert!(cost.evaluations > 10, "{what}: {cost:?}");
        assert!(cost.energy_error.abs() < 1e-5, "{what}: {cost:?}");
    }
}

/// The same steps and evaluations, over ten seconds.
#[test]
fn free_motion_is_the_same() {
    let same = |mut biela: Free, mut by_hand: free::ByHand, what: &str| {
        for step in 0..1_000 {
            biela.step();
            by_hand.step();
            for (found, expected) in biela.state().into_iter().zip(by_hand.state()) {
                // Rounding in some thousand steps, which the swing multiplies by some hundred.
                let off = (found - expected).abs() / (1.0 + expected.abs());
                assert!(off < 1e-10, "{what}, {step}: {found} and {expected}");
            }
        }
    };
    same(Free::pendulum(), free::ByHand::pendulum(), "pendulum");
    same(Free::four_bar(), free::ByHand::four_bar(), "four-bar");
}

/// Moves biela and a yardstick along turns in steps of all sizes.
fn assert_same_motion<const L: usize, const N: usize>(
    text: &str,
    yardstick: &ByHand<L, N>,
    what: &str,
) {
    for steps in sizes::SWEEPS {
        let mut mechanism = Moving::new(text);
        let mut yardstick = yardstick.clone();
        let mut sweep = Sweep::turn(steps);
        for _ in 0..2 * steps.min(1_000) {
            let driver = [sweep.step()];
            mechanism.step(&driver);
            yardstick.step(&driver);
            assert_close(&mechanism.state(), &yardstick.state(), what);
        }
    }
}

/// Compares the rates with central differences of the motion u + u̇ t + ü t²/2: an error of h²/6
/// times a third or fourth derivative, at most 1e6 here.
fn assert_rates<const L: usize, const N: usize>(mut yardstick: ByHand<L, N>) {
    let h = 1e-5;
    let driver = Jet::new(2.0, [10.0, 3.0]);
    let mut at = |t: f64| {
        by_order(yardstick.at(Jet::new(
            driver.value + t * (driver.first() + 0.5 * t * driver.second()),
            [driver.first() + t * driver.second(), driver.second()],
        )))
    };
    let (before, now, after) = (at(-h), at(0.0), at(h));
    for order in 0..2 {
        for (k, rate) in now[order + 1].iter().enumerate() {
            let difference = (after[order][k] - before[order][k]) / (2.0 * h);
            let error = (difference - rate).abs();
            assert!(error < 1e-4, "order {order}, {k}: {error}");
        }
    }
}

#[test]
fn yardsticks_have_the_rates_of_their_own_motion() {
    assert_rates(four_bar());
    assert_rates(slider_crank());
    assert_rates(cam_roller());
    assert_rates(cam_flat());
    assert_rates(cam_knife());
}

/// The contour is a circle of radius a about a point e from the axle, the roller has the radius r:
/// the cam moves as a slider–crank with crank e and rod a + r, a quarter turn to the left.
#[test]
fn the_roller_cam_moves_as_its_slider_crank() {
    let [a, e, r, offset] = [0.040, 0.015, 0.010, 0.008];
    let mut cam = cam_roller();
    let mut slider_crank = slider_crank_of([e, a + r, -offset]);
    for steps in sizes::SWEEPS {
        let mut sweep = Sweep::turn(steps);
        for _ in 0..2 * steps {
            let angle = sweep.step();
            let follower = &cam.at(angle)[9..18];
            let slider = &slider_crank.at(Jet {
                value: angle.value - FRAC_PI_2,
                ..angle
            })[18..];
            for order in 0..3 {
                let (found, truth) = (follower[3 * order + 1], slider[3 * order]);
                let error = (found - truth).abs();
                assert!(error < LIMITS[order], "{order}: {found} and {truth}");
            }
        }
    }
}

/// The face stays a above the centre of the circle.
#[test]
fn the_flat_cam_moves_in_simple_harmonic_motion() {
    let [a, e] = [0.040, 0.015];
    let mut cam = cam_flat();
    for steps in sizes::SWEEPS {
        let mut sweep = Sweep::turn(steps);
        for _ in 0..2 * steps {
            let angle = sweep.step();
            let (sine, cosine) = angle.value.sin_cos();
            let truth = [
                a + e * sine,
                e * cosine * angle.first(),
                e * (cosine * angle.second() - sine * angle.first() * angle.first()),
            ];
            let outputs = cam.at(angle);
            for order in 0..3 {
                let (found, truth) = (outputs[10 + 3 * order], truth[order]);
                let error = (found - truth).abs();
                assert!(error < LIMITS[order], "{order}: {found} and {truth}");
            }
        }
    }
}

/// Forces of some 100 N and N m, at accelerations of 1e3 m/s², as exact as these.
#[test]
fn biela_solves_the_forces_of_the_yardstick() {
    let text = with_masses(shipped!("four_bar"), &four_bar_masses());
    for steps in sizes::SWEEPS {
        let (mut biela, mut yardstick) = (Loaded::new(&text), FourBarForces::new());
        let mechanism = biela.moving.solver.mechanism();
        let crank = mechanism.driver_id("crank_angle").expect("it has one");
        let mut quantities = vec![
            ForceQuantity::Effort(crank),
            ForceQuantity::Power(crank),
            ForceQuantity::Inertia(crank),
            ForceQuantity::Bias(crank),
        ];
        let reactions = (0..4).flat_map(|joint| [0, 1].map(|c| ForceQuantity::Reaction(joint, c)));
        quantities.extend(reactions);
        quantities.extend([ForceQuantity::KineticEnergy, ForceQuantity::PotentialEnergy]);
        let mut sweep = Sweep::turn(steps);
        for _ in 0..2 * steps.min(1_000) {
            let driver = [sweep.step()];
            biela.step(&driver);
            yardstick.step(&driver);
            assert_close(&biela.state(), &yardstick.state(), "the motion");
            for (&quantity, truth) in quantities.iter().zip(yardstick.forces) {
                let found = biela.forces.value(quantity);
                let error = (found - truth).abs() / truth.abs().max(1.0);
                assert!(error < LIMITS[2], "{quantity:?}: {found} and {truth}");
            }
        }
    }
}

#[test]
fn biela_moves_as_the_yardsticks_written_by_hand() {
    assert_same_motion(shipped!("four_bar"), &four_bar(), "the four-bar");
    assert_same_motion(
        shipped!("slider_crank"),
        &slider_crank(),
        "the slider–crank",
    );
    assert_same_motion(shipped!("cam_roller"), &cam_roller(), "the roller cam");
    assert_same_motion(shipped!("cam_flat"), &cam_flat(), "the flat cam");
    assert_same_motion(shipped!("cam_knife"), &cam_knife(), "the knife cam");
}

/// The coupler never turns; the follower turns like the crank, and its origin is its pivot.
#[test]
fn biela_turns_the_parallelogram_through_its_change_points() {
    let [length, base] = [0.10, 0.20];
    // Next to a change point biela promises errors of 1e-11 m, 1e-9 m/s and 1e-6 m/s² for a crank
    // at 1 rad/s; this one turns at 10 rad/s.
    let limits = [1e-11, 1e-8, 1e-4];
    for steps in sizes::SWEEPS {
        let mut mechanism = Moving::new(shipped!("parallelogram"));
        let mut sweep = Sweep::turn(steps);
        for _ in 0..2 * steps {
            let crank = sweep.step();
            mechanism.step(&[crank]);
            let (sine, cosine) = crank.value.sin_cos();
            let [x, y] = [length * cosine, length * sine];
            let (omega, alpha) = (crank.first(), crank.second());
            let truth = [
                vec![0.0, 0.0, crank.value, x, y, 0.0, base, 0.0, crank.value],
                vec![0.0, 0.0, omega, -y * omega, x * omega, 0.0, 0.0, 0.0, omega],
                vec![
                    0.0,
                    0.0,
                    alpha,
                    -y * alpha - x * omega * omega,
                    x * alpha - y * omega * omega,
                    0.0,
                    0.0,
                    0.0,
                    alpha,
                ],
            ];
            assert_within(limits, &mechanism.state(), &truth, "the parallelogram");
        }
    }
}

#[test]
fn a_chain_moves_as_its_first_loop() {
    let mut closed_form = four_bar();
    for kind in KINDS {
        for ground in GROUNDS {
            for steps in sizes::SWEEPS {
                let mut sweep = Sweep::turn(steps);
                let mut chain = Chain::new(100, ground, kind);
                for _ in 0..steps.min(400) {
                    let crank = [sweep.step()];
                    chain.step(&crank);
                    closed_form.step(&crank);
                    let truth = closed_form.state();
                    let state = chain.state();
                    let part = |from: usize, size: usize| {
                        state.each_ref().map(|all| all[from..from + size].to_vec())
                    };
                    assert_close(&part(0, 9), &truth, "the four-bar");
                    let rocker_truth = truth.map(|all| vec![all[8]]);
                    for rocker in 1..100 {
                        assert_close(&part(6 * rocker + 8, 1), &rocker_truth, "a rocker");
                    }
                }
            }
        }
    }
}

#[test]
fn biela_moves_a_chain_as_the_yardstick() {
    for ground in GROUNDS {
        let mut mechanism = Moving::new(&chain(4, ground));
        let mut yardstick = Chain::new(4, ground, Kind::Condition);
        let mut sweep = Sweep::turn(36);
        for _ in 0..72 {
            let crank = [sweep.step()];
            mechanism.step(&crank);
            yardstick.step(&crank);
            assert_close(&mechanism.state(), &yardstick.state(), "the chain");
            assert!((0.1..1.0).contains(&yardstick.rcond()));
        }
    }
}

#[test]
fn biela_moves_a_scissor_lift_as_its_closed_form() {
    let cells = 3;
    let mut mechanism = Moving::new(&scissor_lift(cells));
    let mut sweep = Sweep::lift(cells, 10_000);
    for _ in 0..50 {
        let height = sweep.step();
        mechanism.step(&[height]);
        let sine = height.value / (cells as f64 * BAR);
        let phi = sine.asin();
        let omega = height.first() / (cells as f64 * BAR * phi.cos());
        let alpha = (height.second() / (cells as f64 * BAR) + sine * omega * omega) / phi.cos();
        let found = mechanism.state();
        for cell in 0..cells {
            let bar = |at: usize| found.each_ref().map(|all| vec![all[at]]);
            let left = [phi, omega, alpha].map(|value| vec![value]);
            let right = [PI - phi, -omega, -alpha].map(|value| vec![value]);
            assert_close(&bar(6 * cell + 2), &left, "a bar from the left");
            assert_close(&bar(6 * cell + 5), &right, "a bar from the right");
        }
    }
}

#[test]
fn all_fmus_give_the_closed_form_in_every_order() {
    for order in Order::ALL {
        for turn in [360, 10_000] {
            for mut cycle in [
                Cycle::yardstick(turn, order),
                Cycle::biela(2, turn, order),
                Cycle::biela(3, turn, order),
            ] {
                for cycles in [1, 2, 1_000] {
                    cycle.run(cycles);
                    let truth = *four_bar().at(cycle.inputs());
                    assert_close(
                        &by_order(&cycle.outputs()),
                        &by_order(&truth),
                        &format!("the FMU, {order:?}"),
                    );
                }
            }
        }
    }
}

#[test]
fn an_order_asks_for_each_output_once() {
    for order in Order::ALL {
        let mut outputs = order.outputs();
        outputs.sort_unstable();
        assert_eq!(outputs, Order::File.outputs());
    }
    assert_eq!(Order::Quantity.outputs()[..6], [0, 9, 18, 1, 10, 19]);
}

/// Each case that is measured runs, at the least size.
#[test]
fn every_case_runs() {
    for case in timed_cases().into_iter().chain(counted_cases()) {
        if case.size <= 10 {
            let mut run = case.run().expect("the case exists");
            run(3);
        }
    }
}
