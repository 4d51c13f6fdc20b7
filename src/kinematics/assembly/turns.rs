//! The whole turns of the angles of an assembled mechanism.

use std::f64::consts::TAU;

use crate::kinematics::constraint::TurnEffect;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// Fixes the whole turns of the angle rows: those nearest the present places of the bodies.
pub(super) fn fix_turns(system: &System, state: &mut State) {
    system.fix_turns(&state.at, &mut state.targets);
    state.pose.turns.copy_from_slice(&state.targets.turns);
}

/// Adds whole turns to the bodies so that each angle is nearest its estimate. Bodies whose angles
/// a driver ties together turn together; bodies that it ties to ground do not turn, nor do those
/// whose turns a gear counts.
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
        let effect = equation.constraint.turn_effect();
        if effect == TurnEffect::None || equation.holds_any_turn() {
            continue;
        }
        let unknowns = system.incidence(row).unknowns;
        let mut tied: Vec<_> = unknowns.iter().map(|k| (k / 3).min(ground)).collect();
        // An angle between two bodies leaves both free to turn together.
        if effect == TurnEffect::Proportional || tied.len() < 2 {
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
    let mut turns = vec![None; bodies + 1];
    turns[last_of(&mut group, ground)] = Some(0.0);
    for body in 0..bodies {
        let phi = 3 * body + 2;
        let away = ((estimate[phi] - state.pose.q[phi]) / TAU).round();
        let last = last_of(&mut group, body);
        state.pose.q[phi] += TAU * *turns[last].get_or_insert(away);
    }
    state.move_to_pose(system);
    fix_turns(system, state);
}
