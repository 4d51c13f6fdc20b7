//! One unknown that one linear row gives.

use super::solve::SolveBlock;
use super::step::{BlockState, Step};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::Gradient;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{EquationTarget, System, Targets};
use crate::mechanism::Jet;

/// An unknown q of a row a q + Σ b_k q_k + c = target with constant coefficients, the q_k being
/// found before. It is explicit.
#[derive(Debug)]
pub(in crate::kinematics) struct ExplicitUnknown {
    row: [usize; 1],
    column: [usize; 1],
    /// 1/a.
    per_own: f64,
    /// The q_k with b_k/a.
    known: Vec<(usize, f64)>,
    /// Ratio of a to the largest coefficient, scaled.
    regularity: f64,
    /// Scale factor of the unknown \[m or rad\].
    scale: f64,
}

/// The rounding of the unknown in units of its terms: some operations at each end of a sub-step.
const TERM_ROUNDING: f64 = 8.0 * f64::EPSILON;

impl ExplicitUnknown {
    /// Makes the solver of a row for an unknown.
    pub(super) fn new(system: &System, row: usize, column: usize) -> Self {
        Self {
            row: [row],
            column: [column],
            per_own: 1.0,
            known: Vec::with_capacity(system.incidence(row).unknowns.len()),
            regularity: 1.0,
            scale: 1.0,
        }
    }

    /// Puts the unknown where the row closes. The result depends on the q_k and the target alone.
    fn locate(&self, state: &mut BlockState<'_>) {
        let ([row], [column]) = (self.row, self.column);
        let target = state.system.target(row, state.targets, state.drivers);
        state.at.set_coordinate(column, 0.0);
        let rest = state.system.equations()[row].constraint.value(state.at);
        let value = (target - rest) * self.per_own;
        state.at.set_coordinate(column, value);
    }

    /// Bounds the deviation of the unknown from its chord, which is at `before` at the start of the
    /// sub-step. `None` without a bound.
    fn deviation(&self, state: &BlockState<'_>, step: &Step<'_>, before: f64) -> Option<f64> {
        let ([row], [column]) = (self.row, self.column);
        let now = state.at.coordinate(column);
        let target = state.system.target(row, state.targets, state.drivers);
        let mut terms = self.scale + before.abs() + now.abs() + (target * self.per_own).abs();
        let mut deviation = 0.0;
        for &(column, ratio) in &self.known {
            let ratio = ratio.abs();
            terms += ratio * (step.from[column].abs() + state.at.coordinate(column).abs());
            deviation += ratio * step.deviation(column);
        }
        let equation = &state.system.equations()[row];
        if let EquationTarget::Driver(driver) = equation.target {
            deviation += step.bounds.drivers[driver.index()] * self.per_own.abs();
        }
        let parameters = &step.bounds.parameters;
        if parameters.moves(row) {
            let bend = parameters.bend(row, equation, state.at.profiles())?;
            deviation += 0.125 * bend * self.per_own.abs();
        }
        Some(deviation + TERM_ROUNDING * terms)
    }
}

impl SolveBlock for ExplicitUnknown {
    fn rows(&self) -> &[usize] {
        &self.row
    }

    fn columns(&self) -> &[usize] {
        &self.column
    }

    fn set_parameters(
        &mut self,
        system: &System,
        at: &Configuration,
        _targets: &Targets,
        _pivots: &mut Pivots,
    ) {
        let ([row], [own]) = (self.row, self.column);
        let mut gradient = Gradient::new();
        system.equations()[row]
            .constraint
            .gradient(at, &mut gradient);
        let scale = |column: usize| system.column_scale(column, at.size());
        let mut largest = 0.0_f64;
        self.known.clear();
        for (column, value) in gradient.entries() {
            largest = largest.max((value * scale(column)).abs());
            if column == own {
                self.per_own = 1.0 / value;
            } else if value != 0.0 {
                self.known.push((column, value));
            }
        }
        for (_, value) in &mut self.known {
            *value *= self.per_own;
        }
        self.scale = scale(own);
        self.regularity = self.scale / (self.per_own * largest).abs();
    }

    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        let [column] = self.column;
        let (body, component) = (column / 3, column % 3);
        let frame = state.at.frames()[body];
        self.locate(state);
        let before = step.from[column];
        let Some(deviation) = self.deviation(state, step, before) else {
            return Err(step.bounds.reject());
        };
        let moved = state.at.coordinate(column) - before;
        step.bounds.set_unknown(column, moved, deviation);
        if component == 2 {
            let bound = step.bounds.body_mut(body);
            (bound.cos, bound.sin) = (frame.cos, frame.sin);
        }
        // One correction solves linear equations.
        Ok(Correction {
            iterations: 1,
            regularity: self.regularity,
        })
    }

    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        _limits: Limits,
    ) -> Result<Correction, Rejected> {
        self.locate(state);
        Ok(Correction::default())
    }

    fn stretch(&self, state: &mut BlockState<'_>, _estimate: &[f64]) {
        self.locate(state);
    }

    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        let ([row], [column]) = (self.row, self.column);
        let target = state.system.equations()[row].target_rates(drivers);
        let (velocity, acceleration) = state.tangent.both_mut();
        let mut rates = [target.first(), target.second()].map(|rate| rate * self.per_own);
        for &(column, ratio) in &self.known {
            rates[0] -= ratio * velocity[column];
            rates[1] -= ratio * acceleration[column];
        }
        [velocity[column], acceleration[column]] = rates;
    }

    fn solve_transposed(
        &self,
        _system: &System,
        _at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> bool {
        let ([row], [column]) = (self.row, self.column);
        let load = side[column];
        multipliers[row] = load * self.per_own;
        for &(column, ratio) in &self.known {
            side[column] -= ratio * load;
        }
        true
    }

    fn rcond(&mut self) -> f64 {
        self.regularity
    }

    fn regularity(&self) -> f64 {
        self.regularity
    }
}
