//! Reactions of least norm among those that redundant constraints leave open.

use super::wrench::ReactionRows;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::linear::{dot, subtract};
use crate::kinematics::plan::JacobianFactors;
use crate::kinematics::system::System;

/// The self-stresses at one pose, Phi_qᵀ λ = 0.
#[derive(Debug, Default)]
pub(super) struct SelfStresses {
    /// λ of each self-stress, and the reactions that it makes; these are orthonormal.
    stresses: Vec<(Vec<f64>, Vec<f64>)>,
    reactions: Vec<f64>,
    side: Vec<f64>,
}

impl SelfStresses {
    /// Adds self-stresses to λ such that the sum of squares of all reactions is least; `redundant`
    /// are the rows set aside. Allocates nothing after the first time.
    pub(super) fn minimise_norm(
        &mut self,
        system: &System,
        (rows, factors): (&ReactionRows, &mut JacobianFactors),
        at: &Configuration,
        redundant: &[usize],
        multipliers: &mut [f64],
    ) {
        let reactions = rows.reported_len();
        self.side.resize(system.unknowns(), 0.0);
        self.reactions.resize(reactions, 0.0);
        let empty = || (vec![0.0; multipliers.len()], vec![0.0; reactions]);
        self.stresses.resize_with(redundant.len(), empty);
        for (index, &row) in redundant.iter().enumerate() {
            let (before, rest) = self.stresses.split_at_mut(index);
            let (stress, made) = &mut rest[0];
            self.side.fill(0.0);
            for (column, partial) in factors.gradient(row).entries() {
                self.side[column] -= partial;
            }
            factors.solve_transposed(system, at, &mut self.side, stress);
            stress[row] = 1.0;
            rows.report(system, at, stress, made);
            // Twice, which leaves rounding only.
            for _ in 0..2 {
                for (other, others_made) in before.iter() {
                    let part = dot(made, others_made);
                    subtract(stress, part, other);
                    subtract(made, part, others_made);
                }
            }
            let norm = dot(made, made).sqrt();
            for entry in stress.iter_mut().chain(made) {
                *entry /= norm;
            }
        }
        rows.report(system, at, multipliers, &mut self.reactions);
        for (stress, made) in &self.stresses {
            let part = dot(&self.reactions, made);
            subtract(multipliers, part, stress);
            subtract(&mut self.reactions, part, made);
        }
    }
}
