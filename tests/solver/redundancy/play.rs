//! The play with which a mechanism moves whose constraints contradict each other.

use biela::kinematics::{NeededPlay, Path, Solver};

use crate::common::parse;
use crate::redundancy::mechanisms::{parallelogram, with_joints};

/// Distance of neighbouring poses \[rad\].
const STEP: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Rounding, and what the open joint leaves to the closed ones: some 1e-8 of its gap.
const CLOSE: f64 = 1e-9;

/// Returns the play for a mechanism that does not assemble.
fn play_of(text: &str) -> Option<NeededPlay> {
    let mechanism = parse(text);
    let assembled = Solver::assembled(mechanism.clone(), &Path::new(&mechanism));
    assembled
        .err()
        .and_then(|error| NeededPlay::find(&mechanism, &error))
}

/// Cranks of 0.1 m of which the third has its pivot off by δ along the base: its pin is
/// √(0.1² + δ² − 2·0.1 δ cos u) from the pivot, which differs from its length by δ where it is flat.
#[test]
fn a_pivot_out_of_place_needs_a_play_as_large_where_the_cranks_are_flat() {
    for off in [1e-4, 1e-3, 5e-3] {
        let text = parallelogram(&[[0.2, 0.1]], 60.0, true);
        let text = text.replace("O5 = [0.2, 0.1]", &format!("O5 = [{}, 0.1]", 0.2 + off));
        let play = play_of(&text).expect("it moves");
        assert_eq!(play.open.origin, "joint `O5`");
        let part = play.open.gap / off;
        assert!(
            (STEP.cos() - 0.5 * off / 0.1..=1.0 + 1e-6).contains(&part),
            "{off}: {part}"
        );
        assert_eq!(play.open.angle.to_bits(), 0.0_f64.to_bits());
        let turn = play.range[1] - play.range[0];
        assert!(
            (turn - std::f64::consts::TAU).abs() < CLOSE,
            "{:?}",
            play.range
        );
    }
}

/// A crank, or a rod beside the coupler, that is too long is so at every angle.
#[test]
fn a_length_out_of_place_needs_a_play_as_large_everywhere() {
    for slip in [1e-5, 1e-3, 2e-2] {
        let crank = parallelogram(&[[0.2, 0.1]], 60.0, true);
        let crank = crank.replace("C = [0.1, 0]", &format!("C = [{}, 0]", 0.1 + slip));
        let rod = format!(
            "rod = {{ type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = {} }}",
            0.4 + slip
        );
        let rod = with_joints(&parallelogram(&[], 60.0, true), &rod);
        for (text, joint) in [(crank, "joint `O5`"), (rod, "joint `rod`")] {
            let play = play_of(&text).expect("it moves");
            assert_eq!(play.open.origin, joint);
            let off = (play.open.gap - slip).abs();
            assert!(off < 1e-5 * slip + CLOSE, "{joint}, {slip}: {off:e}");
        }
    }
}

#[test]
fn the_motion_keeps_to_the_limits_of_the_driver() {
    let text = parallelogram(&[[0.2, 0.1]], 60.0, true).replace("C = [0.1, 0]", "C = [0.101, 0]");
    let text = text.replace("start =", "min = \"30*deg\", max = \"90*deg\", start =");
    let play = play_of(&text).expect("it moves");
    let [low, high] = play.range.map(f64::to_degrees);
    assert!(
        (30.0..32.0).contains(&low.next_up()) && (88.0..=90.0).contains(&high),
        "{low} {high}"
    );
}

/// A mechanism that closes has no use for play, nor has one that does not reach.
#[test]
fn only_constraints_that_contradict_each_other_need_play() {
    let closes = parallelogram(&[[0.2, 0.1]], 60.0, true);
    assert_eq!(play_of(&closes), None);
    let far = parallelogram(&[], 60.0, true).replace("O4 = [0.4, 0]", "O4 = [2, 0]");
    assert_eq!(play_of(&far), None);
}
