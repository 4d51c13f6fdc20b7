//! Any block of equations that have to be solved together.

mod certify;
mod contraction;
mod equations;
mod estimate;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use contraction::ContractionTest;
use equations::{BlockEquations, ColumnOwner, Jacobian};

use super::choices::BlockChoices;
use super::elimination::EliminationOrder;
use super::solve::{BlockBranches, SolveBlock};
use super::step::{BlockState, Step};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::linear::{Condition, Factors, Lu, nan_or_larger};
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{System, Targets};
use crate::kinematics::tolerances::{NEGLIGIBLE_LENGTH, STALLED};
use crate::mechanism::{Jet, MarkerId};

pub(super) use equations::column_owners;

/// Newton–Raphson on all rows of a block.
#[derive(Debug)]
pub(in crate::kinematics) struct CoupledBlock {
    equations: BlockEquations,
    jacobian: Jacobian,
    condition: Condition,
    residual: Vec<f64>,
    /// Largest residual in multiples of its rounding error, at the last evaluation and at the start
    /// of the sub-step.
    excess: f64,
    start_excess: f64,
    correction: Vec<f64>,
    test: Box<ContractionTest>,
    /// The markers of its bodies.
    markers: Vec<MarkerId>,
    /// Largest distance of a marker from its body's origin, divided by the size of the block's part
    /// of the mechanism: a small angle moves the marker by that many sizes per radian.
    length: f64,
    /// Size of the block's part of the mechanism, divided by the mechanism's size.
    part: f64,
}

impl CoupledBlock {
    /// Makes the solver of the block with this index, for this order of its rows and unknowns.
    pub(super) fn new(
        index: usize,
        order: EliminationOrder,
        system: &System,
        owners: &Arc<[ColumnOwner]>,
    ) -> Self {
        let lu = order.matrix(system);
        let test = Box::new(ContractionTest::new(system, &order, &lu, owners, index));
        let first = order.rows.first();
        let part = first.map_or(1.0, |&row| system.equations()[row].part());
        let bodies = &system.mechanism().bodies;
        let columns = order.columns.iter();
        let mut own: Vec<_> = columns
            .filter_map(|column| bodies.get(column / 3))
            .collect();
        own.dedup_by_key(|body| &body.name);
        let markers = own.iter().flat_map(|body| &body.markers).copied().collect();
        let equations = BlockEquations::new(index, order, Arc::clone(owners));
        let order = equations.rows.len();
        Self {
            equations,
            jacobian: Jacobian::new(lu),
            condition: Condition::new(order),
            residual: vec![0.0; order],
            excess: 0.0,
            start_excess: 0.0,
            correction: vec![0.0; order],
            test,
            markers,
            length: 1.0,
            part,
        }
    }

    /// Evaluates the rows and their Jacobian at the pose in `state`, not yet factorised.
    fn evaluate(&mut self, state: &BlockState<'_>) {
        let mut excess = 0.0;
        self.equations
            .evaluate(state, &mut self.jacobian, |local, value| {
                self.residual[local] = value.value;
                excess = nan_or_larger(excess, value.value.abs() / value.rounding);
            });
        self.excess = excess;
    }

    /// Replaces the Jacobian by its factors.
    fn decompose(&mut self) -> Result<(), Rejected> {
        // Pivots are compared with the upstream entries too: a row that hardly depends on the
        // block's own unknowns makes these run away when upstream ones move.
        let Jacobian { lu, upstream } = &mut self.jacobian;
        let upstream = upstream.iter().map(|entry| entry.value.abs());
        lu.factorise(upstream.fold(0.0, f64::max))
            .map_err(|_| Rejected)
    }

    /// Solves for the block's entries of `rates`, those of earlier blocks being known, with the
    /// scaled right-hand side in `correction`.
    fn solve(&mut self, rates: &mut [f64]) {
        for entry in &self.jacobian.upstream {
            self.correction[entry.row] -= entry.by_row * rates[entry.column];
        }
        self.jacobian.lu.solve(&mut self.correction);
        for ((&column, scale), scaled) in self.equations.scaled_columns().zip(&self.correction) {
            rates[column] = scaled * scale;
        }
    }
}

impl SolveBlock for CoupledBlock {
    fn rows(&self) -> &[usize] {
        &self.equations.rows
    }

    fn columns(&self) -> &[usize] {
        &self.equations.columns
    }

    /// Returns the work of evaluating, factorising and bounding the rows a few times, and of
    /// computing the inverse if there is one.
    fn work(&self) -> f64 {
        let order = self.equations.rows.len() as f64;
        let inverse = if self.test.inverse.is_empty() {
            0.0
        } else {
            order.powi(3)
        };
        100.0 * order + 0.1 * inverse
    }

    fn set_parameters(
        &mut self,
        system: &System,
        at: &Configuration,
        _targets: &Targets,
        _pivots: &mut Pivots,
    ) {
        self.equations.set_size(system, at);
        let arms = self.markers.iter().map(|&marker| at.local(marker).0.norm());
        let longest = arms.fold(0.0, f64::max);
        self.length = if longest > NEGLIGIBLE_LENGTH {
            (longest / (at.size() * self.part)).min(1.0)
        } else {
            1.0
        };
    }

    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        self.note_start(state, step);
        for &column in &self.equations.columns {
            let before = state.at.coordinate(column);
            let predicted = step.extrapolation.predict(column, before, state.tangent);
            state.at.set_coordinate(column, predicted);
        }
        let correction = self
            .close(state, Limits::STEP)
            .map_err(|Rejected| step.bounds.reject())?;
        self.certify(state, step)?;
        Ok(Correction {
            regularity: self.regularity(),
            ..correction
        })
    }

    /// Solves Phi_q Δq = −Phi and adds Δq until Phi = 0 to rounding (Eq. 3.6.7 and 3.6.8). The
    /// last evaluation leaves the Jacobian factorised at the accepted pose, ready for rates.
    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        // A single row is solved to the last bit, so that gears keep their phase.
        let at_rounding = if self.equations.rows.len() == 1 {
            limits.residual.min(0.5)
        } else {
            limits.residual
        };
        let mut outcome = Correction::default();
        let mut last_excess = f64::INFINITY;
        loop {
            self.evaluate(state);
            let excess = self.excess;
            if !excess.is_finite() {
                return Err(Rejected);
            }
            self.decompose()?;
            let stalled = excess <= STALLED && excess >= 0.5 * last_excess;
            if excess <= at_rounding || stalled {
                return Ok(outcome);
            }
            if outcome.iterations == limits.iterations {
                return Err(Rejected);
            }
            self.correction.copy_from_slice(&self.residual);
            self.jacobian.lu.solve(&mut self.correction);
            for ((&column, scale), scaled) in self.equations.scaled_columns().zip(&self.correction)
            {
                let value = state.at.coordinate(column) - scaled * scale;
                state.at.set_coordinate(column, value);
            }
            last_excess = excess;
            outcome.iterations += 1;
        }
    }

    fn branches(&self, _state: &mut BlockState<'_>, _estimate: &[f64]) -> BlockBranches {
        BlockBranches::Unlisted
    }

    fn is_closed_form(&self) -> bool {
        false
    }

    fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        self.evaluate(state);
        self.decompose()
    }

    /// Solves Phi_q q̇ = u̇ in the drivers' rows (Eq. 3.6.10), then
    /// Phi_q q̈ = ü − q̇ᵀ (∂²c/∂q²) q̇ (Eq. 3.6.11).
    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        let Self {
            equations,
            correction,
            ..
        } = self;
        let equation = |row: usize| &state.system.equations()[row];
        let rows = || equations.rows.iter().zip(&equations.row_scales);
        for (side, (&row, scale)) in correction.iter_mut().zip(rows()) {
            *side = equation(row).target_rates(drivers).first() * scale;
        }
        let (velocity, _) = state.tangent.both_mut();
        self.solve(velocity);
        let Self {
            equations,
            correction,
            ..
        } = self;
        let rows = equations.rows.iter().zip(&equations.row_scales);
        for (side, (&row, scale)) in correction.iter_mut().zip(rows) {
            let equation = equation(row);
            let velocity = state.tangent.velocity();
            let quadratic = equation.constraint.quadratic(state.at, velocity);
            *side = (equation.target_rates(drivers).second() - quadratic) * scale;
        }
        let (_, acceleration) = state.tangent.both_mut();
        self.solve(acceleration);
    }

    fn rcond(&mut self) -> f64 {
        self.condition.rcond(&mut self.jacobian.lu)
    }

    /// Returns the ratio of the smallest to the largest pivot. In a row of loops the ratio falls
    /// with the square of the number of loops, even far from singular positions; a factor cancels
    /// this effect.
    fn regularity(&self) -> f64 {
        /// Unknowns up to which a block does not count as a row of loops.
        const FEW: f64 = 24.0;
        let (low, high) = self.jacobian.lu.pivot_range();
        let row = (self.equations.rows.len() as f64 / FEW).max(1.0);
        row * row * low / high.max(self.jacobian.lu.norm())
    }

    fn keeps_pivots(&self) -> bool {
        matches!(self.jacobian.lu, Lu::Sparse(_))
    }

    fn choose_pivots(&mut self, state: &mut BlockState<'_>) {
        if self.factorise(state).is_ok() {
            self.test.choose_pivots(&self.jacobian.lu);
        }
    }

    fn copy_choices(&self, to: &mut BlockChoices) {
        self.jacobian.lu.copy_pivots(&mut to.pivots[0]);
        self.test.middle.lu.copy_pivots(&mut to.pivots[1]);
    }

    fn take_choices(&mut self, from: &BlockChoices) -> bool {
        let [own, middle] = &from.pivots;
        self.jacobian.lu.use_pivots(own) && self.test.middle.lu.use_pivots(middle)
    }

    fn forget_pivots(&mut self) {
        self.jacobian.lu.forget_pivots();
        self.test.forget_pivots();
    }
}
