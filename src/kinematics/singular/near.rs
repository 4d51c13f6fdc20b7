//! Blocks near a singular position.

use nalgebra::DMatrix;

use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;

/// Most unknowns of a block whose singular positions are located, by dense matrices.
pub const LARGEST_BLOCK: usize = 120;
/// Regularity below which a singular position may be near.
pub(in crate::kinematics) const NEAR: f64 = 0.05;
/// Entries of a null vector above this part of the largest one are free to move.
pub(super) const FREE: f64 = 1e-3;

/// Returns the blocks near a singular position that are small enough; all are factorised.
pub(super) fn near_singular(compiled: &CompiledMechanism) -> Vec<usize> {
    let blocks = compiled.plan.blocks.iter().enumerate();
    let near = blocks
        .filter(|(_, block)| block.regularity() < NEAR && block.columns().len() <= LARGEST_BLOCK);
    near.map(|(index, _)| index).collect()
}

/// Returns the Jacobian of a block's rows in its own unknowns at the pose, scaled.
pub(super) fn block_jacobian(
    compiled: &CompiledMechanism,
    state: &State,
    block: usize,
) -> DMatrix<f64> {
    let block = &compiled.plan.blocks[block];
    let columns = block.columns();
    let place = |column: usize| columns.iter().position(|&own| own == column);
    let system = &compiled.system;
    let (_, jacobian) = system.dense_rows(block.rows(), columns.len(), place, state.values());
    jacobian
}
