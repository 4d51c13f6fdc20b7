//! The factorised Jacobian, for any right-hand side, plain and transposed.

use std::collections::BTreeSet;

use super::elimination::EliminationOrder;
use super::{BlockPlan, BlockSolver};
use crate::kinematics::constraint::Gradient;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::linear::{Factors, Lu, PivotOrder};
use crate::kinematics::newton::Rejected;
use crate::kinematics::system::System;
use crate::kinematics::system::structure::Structure;

/// The factors of Phi_q, block by block, with the gradients of all rows.
///
/// Rows that are set aside have a gradient and no part in the factors.
#[derive(Debug)]
pub(in crate::kinematics) struct JacobianFactors {
    blocks: Vec<BlockFactors>,
    /// For each block solver of the plan its blocks, last first.
    of_solvers: Vec<Vec<usize>>,
    /// The block that finds each unknown, and the index of the unknown there.
    owners: Vec<(usize, usize)>,
    gradients: Vec<Gradient>,
}

/// The factors of one block, scaled.
#[derive(Debug)]
struct BlockFactors {
    rows: Vec<usize>,
    columns: Vec<usize>,
    lu: Lu,
    /// Pivots that a sparse matrix tries first, chosen at a pose that belongs to no motion: results
    /// depend on the pose alone.
    first_pivots: PivotOrder,
    /// Entries at unknowns of earlier blocks: row of the block, column, value.
    upstream: Vec<(usize, usize, f64)>,
    work: Vec<f64>,
}

impl JacobianFactors {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(
        system: &System,
        structure: &Structure,
        plan: &BlockPlan,
    ) -> Self {
        let mut owners = vec![(usize::MAX, 0); system.unknowns()];
        let blocks = structure.blocks().iter().enumerate().map(|(index, block)| {
            let order = EliminationOrder::new(system, block);
            let lu = order.matrix(system);
            let EliminationOrder { rows, columns, .. } = order;
            for (local, &column) in columns.iter().enumerate() {
                owners[column] = (index, local);
            }
            BlockFactors {
                // A row has the entries of three bodies and one joint unknown.
                upstream: Vec::with_capacity(10 * rows.len()),
                work: vec![0.0; rows.len()],
                rows,
                columns,
                lu,
                first_pivots: PivotOrder::default(),
            }
        });
        let blocks = blocks.collect();
        let of_solver = |solver: &BlockSolver| {
            let columns = solver.columns().iter();
            let own: BTreeSet<usize> = columns.map(|&column| structure.block_of(column)).collect();
            own.into_iter().rev().collect()
        };
        let mut factors = Self {
            blocks,
            of_solvers: plan.blocks.iter().map(of_solver).collect(),
            owners,
            gradients: vec![Gradient::new(); system.equations().len()],
        };
        factors.choose_pivots(system);
        factors
    }

    /// Chooses the pivots that sparse matrices try first, for the file's parameters.
    fn choose_pivots(&mut self, system: &System) {
        let mut blocks = self.blocks.iter();
        if !blocks.any(|block| matches!(block.lu, Lu::Sparse(_))) {
            return;
        }
        let (mut at, mut targets) = (system.configuration(), system.targets());
        let parameters = system.mechanism().default_parameters();
        let set = system.set_parameters(&parameters, &mut at, &mut targets);
        // Without pivots at hand each factorisation chooses its own.
        if set.is_ok() && self.factorise(system, &system.anywhere(&at)).is_ok() {
            for block in &mut self.blocks {
                block.lu.copy_pivots(&mut block.first_pivots);
            }
        }
    }

    /// Factorises Phi_q at a configuration. Allocates nothing, unless a sparse matrix has to choose
    /// its pivots again.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where Phi_q is singular to the last bit.
    pub(in crate::kinematics) fn factorise(
        &mut self,
        system: &System,
        at: &Configuration,
    ) -> Result<(), Rejected> {
        for (gradient, equation) in self.gradients.iter_mut().zip(system.equations()) {
            gradient.clear();
            equation.constraint.gradient(at, gradient);
        }
        (0..self.blocks.len()).try_for_each(|index| self.factorise_block(index, system, at))
    }

    /// Factorises a block, whose rows have their gradients.
    fn factorise_block(
        &mut self,
        index: usize,
        system: &System,
        at: &Configuration,
    ) -> Result<(), Rejected> {
        let size = at.size();
        let block = &mut self.blocks[index];
        block.lu.clear();
        block.upstream.clear();
        for (local, &row) in block.rows.iter().enumerate() {
            let row_scale = system.equations()[row].row_scale(at);
            for (column, partial) in self.gradients[row].entries() {
                let value = partial * row_scale * system.column_scale(column, size);
                match self.owners[column] {
                    (owner, own) if owner == index => block.lu.add(local, own, value),
                    _ if value != 0.0 => block.upstream.push((local, column, value)),
                    _ => {}
                }
            }
        }
        let fits = block.lu.use_pivots(&block.first_pivots);
        debug_assert!(fits, "they were chosen for this matrix");
        block.lu.factorise(0.0).map_err(|_| Rejected)
    }

    /// Returns the gradient of a row at the configuration of the factorisation.
    pub(in crate::kinematics) fn gradient(&self, row: usize) -> &Gradient {
        &self.gradients[row]
    }

    /// Solves Phi_q x = `side`, which has an entry per row of the system. Allocates nothing.
    pub(in crate::kinematics) fn solve(
        &mut self,
        system: &System,
        at: &Configuration,
        side: &[f64],
        x: &mut [f64],
    ) {
        let size = at.size();
        for block in &mut self.blocks {
            for (work, &row) in block.work.iter_mut().zip(&block.rows) {
                *work = side[row] * system.equations()[row].row_scale(at);
            }
            for &(local, column, value) in &block.upstream {
                block.work[local] -= value * x[column] / system.column_scale(column, size);
            }
            block.lu.solve(&mut block.work);
            for (&column, scaled) in block.columns.iter().zip(&block.work) {
                x[column] = scaled * system.column_scale(column, size);
            }
        }
    }

    /// Solves Phi_qᵀ λ = `side`, which has an entry per unknown and is used up: the blocks in
    /// reverse order. `multipliers` has an entry per row of the system; rows set aside get zero.
    /// Allocates nothing.
    pub(in crate::kinematics) fn solve_transposed(
        &mut self,
        system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) {
        multipliers.fill(0.0);
        for index in (0..self.blocks.len()).rev() {
            self.solve_block_transposed(index, system, at, side, multipliers);
        }
    }

    /// Solves Phi_qᵀ λ = `side` as [`solve_transposed`](Self::solve_transposed) does, by the closed
    /// forms of the plan where there are some; factorises the other blocks. The factors are then
    /// those of several configurations. Leaves the entries of rows set aside as they are.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where one of these is singular to the last bit.
    pub(in crate::kinematics) fn solve_transposed_at(
        &mut self,
        plan: &BlockPlan,
        system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> Result<(), Rejected> {
        for (place, solver) in plan.blocks.iter().enumerate().rev() {
            if solver.solve_transposed(system, at, side, multipliers) {
                continue;
            }
            for own in 0..self.of_solvers[place].len() {
                let index = self.of_solvers[place][own];
                for &row in &self.blocks[index].rows {
                    let gradient = &mut self.gradients[row];
                    gradient.clear();
                    system.equations()[row].constraint.gradient(at, gradient);
                }
                self.factorise_block(index, system, at)?;
                self.solve_block_transposed(index, system, at, side, multipliers);
            }
        }
        Ok(())
    }

    fn solve_block_transposed(
        &mut self,
        index: usize,
        system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) {
        let size = at.size();
        let block = &mut self.blocks[index];
        for (work, &column) in block.work.iter_mut().zip(&block.columns) {
            *work = side[column] * system.column_scale(column, size);
        }
        block.lu.solve_transposed(&mut block.work);
        for &(local, column, value) in &block.upstream {
            side[column] -= value * block.work[local] / system.column_scale(column, size);
        }
        for (&row, scaled) in block.rows.iter().zip(&block.work) {
            multipliers[row] = scaled * system.equations()[row].row_scale(at);
        }
    }
}
