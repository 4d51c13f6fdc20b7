//! Any block of equations that have to be solved together.

mod block;
mod certify;
mod corridor;
mod estimate;
mod neighbourhood;
mod proof;
#[cfg(test)]
mod tests;

use std::sync::Arc;

pub(super) use block::Place;
use block::{Block, Jacobian};
use corridor::Corridor;
use neighbourhood::Neighbourhood;
use proof::Proof;

use super::elimination::Order;
use super::work::{Substep, Work};
use crate::kinematics::configuration::Configuration;
use crate::kinematics::linear::{Condition, Factors, Lu, nan_or_larger};
use crate::kinematics::newton::{AT_ROUNDING, Correction, MAX_ITERATIONS, Rejected, STALLED};
use crate::kinematics::system::{System, Target};
use crate::mechanism::Jet;

/// Newton–Raphson on the rows of a block, whatever they are.
#[derive(Debug)]
pub(in crate::kinematics) struct Coupled {
    block: Block,
    jacobian: Jacobian,
    condition: Condition,
    residual: Vec<f64>,
    /// The largest residual in multiples of its rounding error.
    excess: f64,
    correction: Vec<f64>,
    proof: Box<Proof>,
    neighbourhood: Neighbourhood,
    corridor: Corridor,
}

impl Coupled {
    /// The block in this order of its rows and unknowns.
    pub(super) fn new(index: usize, order: Order, system: &System, places: Arc<[Place]>) -> Self {
        let lu = order.matrix(system);
        let proof = Box::new(Proof::new(system, &order, &lu, &places, index));
        let Order { rows, columns, .. } = order;
        let order = rows.len();
        Self {
            block: Block::new(index, rows, columns, places),
            jacobian: Jacobian::new(lu),
            condition: Condition::new(order),
            residual: vec![0.0; order],
            excess: 0.0,
            correction: vec![0.0; order],
            neighbourhood: Neighbourhood::new(order + proof.known.len()),
            corridor: Corridor::new(order, proof.known.len()),
            proof,
        }
    }

    pub(in crate::kinematics) fn rows(&self) -> &[usize] {
        &self.block.rows
    }

    pub(in crate::kinematics) fn columns(&self) -> &[usize] {
        &self.block.columns
    }

    /// Whether its matrix is sparse, with pivots that are kept.
    pub(super) fn is_sparse(&self) -> bool {
        matches!(self.jacobian.lu, Lu::Sparse(_))
    }

    /// Lets go of the box that earlier steps have left.
    pub(super) fn forget_box(&mut self) {
        self.neighbourhood.forget();
        self.corridor.forget();
    }

    /// Lets a sparse matrix choose its pivots anew.
    pub(super) fn forget_pivots(&mut self) {
        self.jacobian.lu.forget_pivots();
        self.proof.forget_pivots();
    }

    /// Chooses the pivots of its sparse matrices at the pose in `work`, unless that is singular.
    pub(super) fn choose_pivots(&mut self, work: &Work<'_>) {
        if self.factorise(work).is_ok() {
            self.proof.choose_pivots(&self.jacobian.lu);
        }
    }

    /// Evaluates the rows and their Jacobian at the pose in `work`, not yet factorised.
    fn evaluate(&mut self, work: &Work<'_>) {
        let mut excess = 0.0;
        self.block
            .evaluate(work, &mut self.jacobian, |local, value| {
                self.residual[local] = value.value;
                excess = nan_or_larger(excess, value.value.abs() / value.rounding);
            });
        self.excess = excess;
    }

    /// Replaces the Jacobian by its factors.
    fn decompose(&mut self) -> Result<(), Rejected> {
        // A row that hardly depends on the block's own unknowns makes them run away, however
        // well the rows of the block agree with each other.
        let Jacobian { lu, upstream } = &mut self.jacobian;
        let upstream = upstream.iter().map(|(_, _, value)| value.abs());
        lu.factorise(upstream.fold(0.0, f64::max))
            .map_err(|_| Rejected)
    }

    /// Factorises at the pose in `work`.
    pub(super) fn factorise(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        self.evaluate(work);
        self.decompose()
    }

    /// Predicts the unknowns, corrects them until the rows are at rounding, and proves that the
    /// motion leads there.
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<Correction, Rejected> {
        self.note_start(work, substep);
        for &column in &self.block.columns {
            let before = work.at.coordinate(column);
            let predicted = substep.advance.predict(column, before, work.flow);
            work.at.set_coordinate(column, predicted);
        }
        let correction = self.correct(work, MAX_ITERATIONS);
        let correction = correction.map_err(|_| substep.tubes.break_off())?;
        self.certify(work, substep)?;
        Ok(Correction {
            regularity: self.regularity(),
            ..correction
        })
    }

    /// The ratio of the extreme pivots. That of a row of loops falls with the square of their
    /// number, however far from a singular position they are: what is due to this is left out.
    pub(super) fn regularity(&self) -> f64 {
        /// So many unknowns are no row yet.
        const FEW: f64 = 24.0;
        let (low, high) = self.jacobian.lu.pivot_range();
        let row = (self.block.rows.len() as f64 / FEW).max(1.0);
        row * row * low / high.max(self.jacobian.lu.norm())
    }

    /// Corrects the block's unknowns from where they are until Phi = 0 to rounding: solves
    /// Phi_q Δq = −Phi and adds Δq, again and again (Ec. 3.6.7 and 3.6.8). The last evaluation
    /// leaves the Jacobian factorised at the accepted pose, ready for rates.
    pub(in crate::kinematics) fn correct(
        &mut self,
        work: &mut Work<'_>,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        // A single row can be had to the last bit, so that gears keep their phase.
        let at_rounding = if self.block.rows.len() == 1 {
            0.5
        } else {
            AT_ROUNDING
        };
        let mut outcome = Correction::default();
        let mut last_excess = f64::INFINITY;
        loop {
            self.evaluate(work);
            let excess = self.excess;
            if !excess.is_finite() {
                return Err(Rejected);
            }
            self.decompose()?;
            let stalled = excess <= STALLED && excess >= 0.5 * last_excess;
            if excess <= at_rounding || stalled {
                return Ok(outcome);
            }
            if outcome.iterations == max_iterations {
                return Err(Rejected);
            }
            self.correction.copy_from_slice(&self.residual);
            self.jacobian.lu.solve(&mut self.correction);
            let size = work.at.size();
            for (&column, scaled) in self.block.columns.iter().zip(&self.correction) {
                let step = scaled * work.system.column_scale(column, size);
                let value = work.at.coordinate(column) - step;
                work.at.set_coordinate(column, value);
            }
            last_excess = excess;
            outcome.iterations += 1;
        }
    }

    /// Writes the rates of the block's unknowns: Phi_q q̇ = u̇ in the drivers' rows (Ec. 3.6.10),
    /// then Phi_q q̈ = ü − q̇ᵀ (∂²c/∂q²) q̇ (Ec. 3.6.11).
    pub(super) fn solve_rates(&mut self, work: &mut Work<'_>, drivers: &[Jet]) {
        let driver = |row: usize| match work.system.equations()[row].target {
            Target::Constant(_) => Jet::constant(0.0),
            Target::Driver(driver) => drivers[driver.index()],
        };
        let scale = |row: usize| work.system.equations()[row].row_scale(work.at);
        for (side, &row) in self.correction.iter_mut().zip(&self.block.rows) {
            *side = driver(row).first() * scale(row);
        }
        let (velocity, _) = work.flow.both_mut();
        self.solve(work.system, work.at.size(), velocity);
        for (side, &row) in self.correction.iter_mut().zip(&self.block.rows) {
            let equation = &work.system.equations()[row];
            let quadratic = equation.constraint.quadratic(work.at, work.flow.velocity());
            *side = (driver(row).second() - quadratic) * scale(row);
        }
        let (_, acceleration) = work.flow.both_mut();
        self.solve(work.system, work.at.size(), acceleration);
    }

    /// Solves Phi_q x = `side`, one entry a row of the system, for the block's entries of x,
    /// those before it being known.
    pub(super) fn solve_for(
        &mut self,
        system: &crate::kinematics::System,
        at: &Configuration,
        side: &[f64],
        x: &mut [f64],
    ) {
        for (entry, &row) in self.correction.iter_mut().zip(&self.block.rows) {
            *entry = side[row] * system.equations()[row].row_scale(at);
        }
        self.solve(system, at.size(), x);
    }

    /// Solves for the block's entries of `rates`, whose entries upstream are known, with the
    /// scaled right-hand side in `correction`.
    fn solve(&mut self, system: &crate::kinematics::System, size: f64, rates: &mut [f64]) {
        for &(row, column, value) in &self.jacobian.upstream {
            self.correction[row] -= value * rates[column] / system.column_scale(column, size);
        }
        self.jacobian.lu.solve(&mut self.correction);
        for (&column, scaled) in self.block.columns.iter().zip(&self.correction) {
            rates[column] = scaled * system.column_scale(column, size);
        }
    }

    pub(super) fn rcond(&mut self) -> f64 {
        self.condition.rcond(&mut self.jacobian.lu)
    }
}
