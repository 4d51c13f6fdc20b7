//! The yardsticks do what biela does.

use biela::mechanism::Jet;
use set_up::runtime_library;
use yardstick::generated::{BAR, Ground, chain, scissor_lift};
use yardstick::motion::{Moving, Sweep};
use yardstick::yardstick::{Chain, Cycle, Kind, OUTPUTS, four_bar};

const KINDS: [Kind; 3] = [Kind::Plain, Kind::Updated, Kind::Condition];
const GROUNDS: [Ground; 2] = [Ground::Straight, Ground::Zigzag];

/// Rounding, some eps of numbers up to 3 m and 3 rad, times what the worst block makes of it, 1/0.1;
/// velocities and accelerations, of the size of 10 rad/s and 100 rad/s², pass through the block
/// once more each.
const LIMITS: [f64; 3] = [1e-13, 1e-12, 1e-10];

/// The closed form's outputs by order and then by body.
fn closed_form(crank: Jet) -> [[f64; 9]; 3] {
    let mut out = [0.0; OUTPUTS];
    four_bar(crank, &mut out);
    by_order(&out)
}

fn by_order(out: &[f64]) -> [[f64; 9]; 3] {
    [0, 1, 2].map(|order| {
        std::array::from_fn(|unknown| out[9 * (unknown / 3) + 3 * order + unknown % 3])
    })
}

#[track_caller]
fn assert_close(found: [&[f64]; 3], truth: [&[f64]; 3], what: &str) {
    for order in 0..3 {
        assert_eq!(found[order].len(), truth[order].len(), "{what}");
        for (k, (a, b)) in found[order].iter().zip(truth[order]).enumerate() {
            let error = (a - b).abs();
            // Coordinates of pivots far away round in proportion.
            let limit = LIMITS[order] * b.abs().max(1.0);
            assert!(error <= limit, "{what}, order {order}, {k}: {a} and {b}");
        }
    }
}

#[test]
fn the_closed_form_has_the_rates_of_its_own_motion() {
    // Central differences of the motion u + u̇ t + ü t²/2: an error of h²/6 times a third or fourth
    // derivative, at most 1e6 here.
    let h = 1e-5;
    let crank = Jet {
        value: 2.0,
        first: 10.0,
        second: 3.0,
    };
    let at = |t: f64| {
        closed_form(Jet {
            value: crank.value + t * (crank.first + 0.5 * t * crank.second),
            first: crank.first + t * crank.second,
            second: crank.second,
        })
    };
    let (before, now, after) = (at(-h), at(0.0), at(h));
    for order in 0..2 {
        for k in 0..9 {
            let difference = (after[order][k] - before[order][k]) / (2.0 * h);
            let error = (difference - now[order + 1][k]).abs();
            assert!(error < 1e-4, "order {order}, {k}: {error}");
        }
    }
}

#[test]
fn a_chain_moves_as_its_first_loop() {
    for kind in KINDS {
        for ground in GROUNDS {
            for steps in [100, 360, 10_000] {
                let mut sweep = Sweep::turn(steps);
                let mut chain = Chain::new(100, ground);
                for _ in 0..steps.min(400) {
                    let crank = sweep.step();
                    chain.step(kind, crank);
                    let truth = closed_form(crank);
                    let state = chain.state();
                    assert_close(
                        state.map(|numbers| &numbers[..9]),
                        truth.each_ref().map(|numbers| &numbers[..]),
                        "the four-bar",
                    );
                    for rocker in 1..100 {
                        let phi = 6 * rocker + 8;
                        assert_close(
                            state.map(|numbers| &numbers[phi..=phi]),
                            truth.each_ref().map(|numbers| &numbers[8..=8]),
                            "a rocker",
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn biela_moves_the_four_bar_as_the_closed_form() {
    let mut mechanism = Moving::new(include_str!("../../mechanisms/four_bar.toml"));
    let mut sweep = Sweep::turn(360);
    for _ in 0..720 {
        let crank = sweep.step();
        mechanism.step(crank);
        let truth = closed_form(crank);
        assert_close(
            state(&mechanism),
            truth.each_ref().map(|numbers| &numbers[..]),
            "the four-bar",
        );
    }
}

#[test]
fn biela_moves_a_chain_as_the_yardstick() {
    for ground in GROUNDS {
        let mut mechanism = Moving::new(&chain(4, ground));
        let mut yardstick = Chain::new(4, ground);
        let mut sweep = Sweep::turn(36);
        for _ in 0..72 {
            let crank = sweep.step();
            mechanism.step(crank);
            yardstick.step(Kind::Condition, crank);
            assert_close(state(&mechanism), yardstick.state(), "the chain");
            assert!((0.1..1.0).contains(&yardstick.rcond()));
        }
    }
}

#[test]
fn biela_moves_a_scissor_lift_as_its_closed_form() {
    let cells = 3;
    let mut mechanism = Moving::new(&scissor_lift(cells));
    let mut sweep = Sweep::lift(cells);
    for _ in 0..50 {
        let height = sweep.step();
        mechanism.step(height);
        let sine = height.value / (cells as f64 * BAR);
        let phi = sine.asin();
        let omega = height.first / (cells as f64 * BAR * phi.cos());
        let alpha = (height.second / (cells as f64 * BAR) + sine * omega * omega) / phi.cos();
        for cell in 0..cells {
            let [left, right] = [6 * cell + 2, 6 * cell + 5];
            let found = state(&mechanism);
            assert_close(
                found.map(|numbers| &numbers[left..=left]),
                [&[phi], &[omega], &[alpha]],
                "a bar from the left",
            );
            assert_close(
                found.map(|numbers| &numbers[right..=right]),
                [&[std::f64::consts::PI - phi], &[-omega], &[-alpha]],
                "a bar from the right",
            );
        }
    }
}

#[test]
fn both_fmus_give_the_closed_form() {
    for mut cycle in [Cycle::yardstick(), Cycle::biela(&runtime_library())] {
        for cycles in [1, 2, 1_000] {
            cycle.run(cycles);
            let found = by_order(cycle.outputs());
            let truth = closed_form(cycle.inputs());
            assert_close(
                found.each_ref().map(|numbers| &numbers[..]),
                truth.each_ref().map(|numbers| &numbers[..]),
                "the FMU",
            );
        }
    }
}

fn state(mechanism: &Moving) -> [&[f64]; 3] {
    [
        &mechanism.solver.pose().q,
        mechanism.rates.velocity(),
        mechanism.rates.acceleration(),
    ]
}
