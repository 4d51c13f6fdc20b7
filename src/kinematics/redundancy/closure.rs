//! Closing a mechanism on all its rows, which may be more than enough.

use super::rank::{drivers_first, jacobian_rows};
use crate::kinematics::assembly::closure::{close_on, is_small};
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::assembly::part::SMALL_PART;
use crate::kinematics::assembly::search::{NoBranch, search};
use crate::kinematics::linear::Echelon;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::EquationTarget;
use crate::kinematics::system::structure::Structure;
use crate::kinematics::tolerances::SINGULAR;

/// Scaled remainder after elimination up to which a row is superfluous in its block. A block with
/// such a row is singular and closes only to the square root of the residual, far above rounding.
const SUPERFLUOUS: f64 = 1e-3;

/// Closes the mechanism on all rows. Returns `None` if they are satisfied; otherwise moves the
/// bodies to the nearest pose found and returns its largest scaled residual.
pub(super) fn close_on_all(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Option<f64> {
    let all: Vec<_> = (0..compiled.system.equations().len()).collect();
    if !is_small(&compiled.system) {
        // Too many unknowns for a minimisation to go far: most blocks close by themselves.
        find_start(compiled, state, estimate);
        let mut problem = LeastSquares::of_all(&compiled.system, &all);
        problem.close(&mut state.block_state(&compiled.system))?;
    }
    close_on(&compiled.system, state, &all, estimate)
}

/// Assembles block by block on rows that are paired with unknowns: drivers' rows first, the others
/// in the order of declaration. If a block does not close, leaves out one of its superfluous rows
/// and pairs the rest again. Returns the failure if no pose is found.
pub(super) fn find_start(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    estimate: &[f64],
) -> Option<NoBranch> {
    let mut left_out = Vec::new();
    loop {
        let order = drivers_first(&compiled.system).into_iter();
        let order = order.filter(|row| !left_out.contains(row));
        compiled.redundant.now = Structure::left_over(&compiled.system, order)?;
        state.compile(compiled);
        state.at.set_pose(compiled.system.mechanism(), estimate);
        let failure = search(compiled, state, estimate).err();
        let block = match &failure {
            Some(failure) => failure.block,
            // Dependent rows may close by chance; their block is singular.
            None => {
                let mut blocks = compiled.plan.blocks.iter_mut();
                blocks.position(|block| block.rcond() < SINGULAR)?
            }
        };
        match superfluous_in(compiled, state, block, estimate) {
            Some(row) => left_out.push(row),
            None => return failure,
        }
    }
}

/// Returns the last superfluous row of a block, at a pose where all its rows are closed. Returns
/// `None` if there is no such row or pose, or if the block is large.
fn superfluous_in(
    compiled: &CompiledMechanism,
    state: &mut State,
    block: usize,
    estimate: &[f64],
) -> Option<usize> {
    let block = &compiled.plan.blocks[block];
    let columns = block.columns();
    if columns.len() > SMALL_PART {
        return None;
    }
    let mut part = LeastSquares::new(&compiled.system, block.rows(), columns);
    let mut block_state = state.block_state(&compiled.system);
    part.start(&mut block_state, estimate, 0);
    part.minimise_growing(&mut block_state);
    if part.close(&mut block_state).is_some() {
        return None;
    }
    let mut rows = jacobian_rows(compiled, state);
    for row in &mut rows {
        row.retain(|(column, _)| columns.contains(column));
    }
    let own = part.rows.iter().map(|&row| &rows[row]);
    let mut echelon = Echelon::new(compiled.system.unknowns(), own);
    let is_driver = |row: &usize| {
        let target = &compiled.system.equations()[*row].target;
        matches!(target, EquationTarget::Driver(_))
    };
    let (drivers, others): (Vec<_>, Vec<_>) = part.rows.iter().partition(|row| is_driver(row));
    let order = drivers.into_iter().chain(others);
    order.fold(None, |last, row| {
        let left_out = echelon.offer(row, &rows[row], SUPERFLUOUS);
        left_out.map(|left_out| left_out.row).or(last)
    })
}
