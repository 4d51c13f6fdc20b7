//! The Jacobian in block triangular form, for any right-hand side.
//!
//! The kernels of a [`Plan`](super::Plan) know the right-hand sides of their own rates only.

use std::sync::Arc;

use super::coupled::{Coupled, Place};
use super::elimination;
use super::work::Work;
use crate::kinematics::configuration::Configuration;
use crate::kinematics::newton::Rejected;
use crate::kinematics::structure::Structure;
use crate::kinematics::system::System;

/// Phi_q, one matrix a block of the structure.
#[derive(Debug)]
pub(in crate::kinematics) struct General {
    blocks: Vec<Coupled>,
}

impl General {
    pub(in crate::kinematics) fn new(system: &System, structure: &Structure) -> Self {
        let none = Place {
            kernel: usize::MAX,
            local: 0,
        };
        let mut places = vec![none; system.unknowns()];
        let mut orders = Vec::new();
        for (kernel, block) in structure.blocks().iter().enumerate() {
            let order = elimination::Order::new(system, block);
            for (local, &column) in order.columns.iter().enumerate() {
                places[column] = Place { kernel, local };
            }
            orders.push(order);
        }
        let places: Arc<[Place]> = places.into();
        let blocks = orders
            .into_iter()
            .enumerate()
            .map(|(index, order)| Coupled::new(index, order, system, Arc::clone(&places)));
        Self {
            blocks: blocks.collect(),
        }
    }

    /// Factorises at the pose in `work`.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where Phi_q is singular to the last bit.
    pub(in crate::kinematics) fn factorise(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        let mut blocks = self.blocks.iter_mut();
        blocks.try_for_each(|block| block.factorise(work))
    }

    /// Solves Phi_q x = `side`, which has an entry a row of the system, at the configuration of
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
