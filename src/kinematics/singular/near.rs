//! Blocks near a singular position.

use nalgebra::DMatrix;

use crate::kinematics::model::Model;
use crate::kinematics::state::State;
use crate::kinematics::system::System;

/// The most unknowns of a block whose singular positions are looked for, by dense matrices.
pub const LARGEST_BLOCK: usize = 120;
/// The regularity below which a singular position may be near.
pub(in crate::kinematics) const NEAR: f64 = 0.05;
/// Entries of a null vector above this part of the largest one are free to move.
const FREE: f64 = 1e-3;

/// Returns the blocks near a singular position that are small enough; all are factorised.
pub(super) fn near_singular(model: &Model) -> Vec<usize> {
    let blocks = model.plan.blocks.iter().enumerate();
    let near = blocks
        .filter(|(_, block)| block.regularity() < NEAR && block.columns().len() <= LARGEST_BLOCK);
    near.map(|(index, _)| index).collect()
}

/// Returns the names of what a null vector moves, of which `free` has the entry of each of these
/// unknowns.
pub(super) fn bodies_of(system: &System, columns: &[usize], free: &[f64]) -> Vec<String> {
    let motion = columns.iter().copied().zip(free.iter().copied());
    system.describe_moved(motion, FREE)
}

/// Returns the Jacobian of a block's rows in its own unknowns at the pose, scaled.
pub(super) fn block_jacobian(model: &Model, state: &State, block: usize) -> DMatrix<f64> {
    let block = &model.plan.blocks[block];
    let (rows, columns) = (block.rows(), block.columns());
    let mut jacobian = DMatrix::zeros(rows.len(), columns.len());
    for (place, &row) in rows.iter().enumerate() {
        for (column, value) in state.jacobian_row(&model.system, row) {
            if let Some(local) = columns.iter().position(|&own| own == column) {
                jacobian[(place, local)] += value;
            }
        }
    }
    jacobian
}
