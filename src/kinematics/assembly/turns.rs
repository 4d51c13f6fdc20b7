//! On which whole turn the angles of an assembled mechanism are.

use std::f64::consts::TAU;

use crate::kinematics::Solver;
use crate::kinematics::constraint::{Incidence, TurnEffect};

impl Solver {
    /// Fixes the whole turns of the angle rows: the ones nearest the present configuration.
    pub(in crate::kinematics) fn fix_turns(&mut self) {
        self.system.fix_turns(&self.at, &mut self.targets);
        self.pose.turns.copy_from_slice(&self.targets.turns);
    }

    /// Adds whole turns to the bodies so that each angle is nearest its estimate. Bodies whose
    /// angles a driver ties together turn together, those it ties to ground not at all, nor do
    /// those whose turns a gear counts.
    pub(in crate::kinematics) fn choose_turns(&mut self, estimate: &[f64]) {
        let bodies = self.system.mechanism().bodies.len();
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
        for equation in self.system.equations() {
            let effect = equation.constraint.turn_effect();
            if effect == TurnEffect::None || equation.holds_any_turn() {
                continue;
            }
            let mut incidence = Incidence::default();
            equation
                .constraint
                .incidence(self.system.mechanism(), &mut incidence);
            let mut tied: Vec<_> = incidence
                .unknowns
                .iter()
                .map(|k| (k / 3).min(ground))
                .collect();
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
            let away = ((estimate[phi] - self.pose.q[phi]) / TAU).round();
            let last = last_of(&mut group, body);
            self.pose.q[phi] += TAU * *turns[last].get_or_insert(away);
        }
        self.stand_at_pose();
        self.fix_turns();
    }
}
