//! The whole turns of the angles of an assembled mechanism.

use std::f64::consts::TAU;

use crate::kinematics::constraint::TurnEffect;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// Largest scaled change of a row that is rounding when all its bodies turn once: some eps of a
/// million turns.
const TURN_ROUNDING: f64 = 1e-9;

/// Fixes the whole turns of the angle rows: those nearest the present places of the bodies.
pub(super) fn fix_turns(system: &System, state: &mut State) {
    system.fix_turns(&state.at, &mut state.targets);
    state.pose.turns.copy_from_slice(&state.targets.turns);
}

/// Adds whole turns to the bodies so that each angle is nearest its estimate. Bodies whose angles
/// a row ties together turn together, by the median of their turns; bodies that it ties to ground do
/// not turn.
pub(in crate::kinematics) fn choose_turns(system: &System, state: &mut State, estimate: &[f64]) {
    let bodies = system.mechanism().bodies.len();
    let ground = bodies;
    // Each body points to a later one that turns with it, the last of them to itself.
    let mut group: Vec<usize> = (0..=bodies).collect();
    let last_of = |group: &mut [usize], mut body: usize| {
        while group[body] != body {
            group[body] = group[group[body]];
            body = group[body];
        }
        body
    };
    for (row, equation) in system.equations().iter().enumerate() {
        let constraint = &equation.constraint;
        if constraint.turn_effect() == TurnEffect::None || equation.holds_any_turn() {
            continue;
        }
        let unknowns = system.incidence(row).unknowns;
        let mut tied: Vec<_> = unknowns.iter().map(|k| (k / 3).min(ground)).collect();
        let turn = |state: &mut State, turn: f64| {
            for body in tied.iter().filter(|body| **body < ground) {
                let phi = 3 * body + 2;
                state.at.set_coordinate(phi, state.pose.q[phi] + turn);
            }
            constraint.value(&state.at)
        };
        let changed = turn(state, TAU) - turn(state, 0.0);
        if changed.abs() * equation.row_scale(&state.at) > TURN_ROUNDING {
            tied.push(ground);
        }
        for body in &mut tied {
            *body = last_of(&mut group, *body);
        }
        let keep = tied.iter().copied().max().unwrap_or(ground);
        for body in tied {
            group[body] = keep;
        }
    }
    let ground = last_of(&mut group, ground);
    let mut turns: Vec<_> = (0..bodies)
        .filter_map(|body| {
            let phi = 3 * body + 2;
            let away = ((estimate[phi] - state.pose.q[phi]) / TAU).round();
            let last = last_of(&mut group, body);
            (last != ground).then_some((last, away, phi))
        })
        .collect();
    turns.sort_by(|(a, x, _), (b, y, _)| a.cmp(b).then(x.total_cmp(y)));
    for together in turns.chunk_by(|(a, ..), (b, ..)| a == b) {
        let (_, median, _) = together[(together.len() - 1) / 2];
        for (.., phi) in together {
            state.pose.q[*phi] += TAU * median;
        }
    }
    state.move_to_pose(system);
    fix_turns(system, state);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::reference::assembled;
    use crate::kinematics::solver::Solver;
    use crate::mechanism::Source;

    /// A wheel rolls on a track that a link holds, and drives another wheel by a belt on ground.
    const TRACK: &str = r#"
        format = 1
        name = "track"
        [ground.markers]
        O = [0, 0]
        P = [1, 0]
        [bodies.track]
        markers = { O = [0, 0], Q = [0.8, 0] }
        estimate = [0, 0, 0.3]
        [bodies.wheel]
        markers = { W = [0, 0] }
        estimate = [0.16, 0.15, -1.7]
        [bodies.large]
        markers = { O = [0, 0], T = [1, 0] }
        [bodies.small]
        markers = { P = [0, 0] }
        estimate = [1, 0, 0]
        [joints]
        O = { type = "revolute", markers = ["ground.O", "track.O"] }
        l = { type = "link", markers = ["ground.P", "track.Q"], length = 0.3 }
        r = { type = "rolling", markers = ["wheel.W", "track.O"], radius = 0.1 }
        o = { type = "revolute", markers = ["ground.O", "large.O"] }
        p = { type = "revolute", markers = ["ground.P", "small.P"] }
        b = { type = "belt", markers = ["large.O", "small.P"], radii = [3, 2] }
        [drivers]
        x = { coordinate = "x", markers = ["track.O", "wheel.W"], start = 0.2 }
        y = { coordinate = "y", markers = ["ground.O", "large.T"], start = 0.5 }
        "#;

    /// Track and wheel turn back together. The belt counts the turns of its wheels: three of one
    /// are two of the other.
    #[test]
    fn bodies_that_a_row_ties_turn_together() {
        let mut solver = assembled(&Source::new("track.toml", TRACK)).0;
        let Solver {
            compiled, state, ..
        } = &mut solver;
        let estimate = state.pose.q.clone();
        for (body, turns) in [(0, 1000.0), (1, 1000.0), (2, 2.0), (3, 3.0)] {
            state.pose.q[3 * body + 2] += turns * TAU;
        }
        state.move_to_pose(&compiled.system);
        choose_turns(&compiled.system, state, &estimate);
        for (body, turns) in [(0, 0.0), (1, 0.0), (2, 2.0), (3, 3.0)] {
            let phi = 3 * body + 2;
            let off = state.pose.q[phi] - estimate[phi] - turns * TAU;
            // Half an eps of 1000 turns, and of their removal.
            assert!(off.abs() <= 1000.0 * TAU * f64::EPSILON, "{body}: {off:e}");
        }
    }
}
