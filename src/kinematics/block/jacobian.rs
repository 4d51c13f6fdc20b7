//! The Jacobian in block triangular form, for any right-hand side.
//!
//! The blocks of a [`BlockPlan`](super::BlockPlan) know the right-hand sides of their own rates
//! only.

use super::coupled::{CoupledBlock, column_owners};
use super::elimination::EliminationOrder;
use super::solve::SolveBlock;
use super::step::BlockState;
use crate::kinematics::configuration::Configuration;
use crate::kinematics::newton::Rejected;
use crate::kinematics::structure::Structure;
use crate::kinematics::system::System;

/// Phi_q, one matrix per block of the structure.
#[derive(Debug)]
pub(in crate::kinematics) struct BlockJacobian {
    blocks: Vec<CoupledBlock>,
}

impl BlockJacobian {
    pub(in crate::kinematics) fn new(system: &System, structure: &Structure) -> Self {
        let blocks = structure.blocks().iter();
        let orders: Vec<_> = blocks
            .map(|block| EliminationOrder::new(system, block))
            .collect();
        let owners = column_owners(system.unknowns(), orders.iter().enumerate());
        let blocks = orders.into_iter().enumerate();
        Self {
            blocks: blocks
                .map(|(index, order)| CoupledBlock::new(index, order, system, &owners))
                .collect(),
        }
    }

    /// Factorises at the pose in `state`.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where Phi_q is singular to the last bit.
    pub(in crate::kinematics) fn factorise(
        &mut self,
        state: &mut BlockState<'_>,
    ) -> Result<(), Rejected> {
        let mut blocks = self.blocks.iter_mut();
        blocks.try_for_each(|block| block.factorise(state))
    }

    /// Solves Phi_q x = `side`, which has an entry per row of the system, at the configuration of
    /// the factorisation.
    pub(in crate::kinematics) fn solve(
        &mut self,
        system: &System,
        at: &Configuration,
        side: &[f64],
        x: &mut [f64],
    ) {
        for block in &mut self.blocks {
            block.solve_for(system, at, side, x);
        }
    }
}
