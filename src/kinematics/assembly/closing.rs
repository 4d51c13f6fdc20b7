//! Closing a mechanism on rows that may be more than enough, or too few.

use super::least_squares::{Part, SMALL_PART, STARTS};
use crate::kinematics::block::BlockState;
use crate::kinematics::linear::{Factors, Row, SparseLu, nan_or_larger};
use crate::kinematics::newton::{AT_ROUNDING, STALLED};
use crate::kinematics::state::State;
use crate::kinematics::system::{RowValue, System};

/// A scaled residual of more than this, beyond its rounding, is a gap: five digits above what
/// Newton leaves of rows that are well conditioned, and less than anyone could measure.
const GAP: f64 = 1e-9;
/// Steps of a minimisation; it converges quadratically to a regular pose that exists.
const STEPS: usize = 60;

/// Whether a row counts as satisfied.
pub(in crate::kinematics) fn holds(row: RowValue) -> bool {
    row.value.abs() <= GAP + STALLED * row.rounding
}

/// Minimises the scaled ΦᵀΦ of some rows over all unknowns (Levenberg–Marquardt), for mechanisms
/// of any size.
///
/// The step d of least ‖J d + Φ‖² + μ ‖d‖² solves
///
/// ```text
/// ⎡ 1   J  ⎤ ⎡ y ⎤   ⎡ −Φ ⎤
/// ⎣ Jᵀ  −μ ⎦ ⎣ d ⎦ = ⎣  0 ⎦
/// ```
///
/// which is as sparse as J and, unlike JᵀJ, as well conditioned.
#[derive(Debug)]
pub(in crate::kinematics) struct Closing {
    rows: Vec<usize>,
    weights: Vec<f64>,
    unknowns: usize,
    lu: SparseLu,
    jacobian: Vec<Row>,
    phi: Vec<f64>,
    step: Vec<f64>,
}

impl Closing {
    /// For these rows.
    pub(in crate::kinematics) fn new(system: &System, rows: &[usize]) -> Self {
        let (count, unknowns) = (rows.len(), system.unknowns());
        let mut pattern: Vec<Vec<usize>> = (0..count + unknowns).map(|k| vec![k]).collect();
        for (local, &row) in rows.iter().enumerate() {
            for column in system.incidence(row).unknowns {
                pattern[local].push(count + column);
                pattern[count + column].push(local);
            }
        }
        Self {
            rows: rows.to_vec(),
            weights: vec![1.0; count],
            unknowns,
            lu: SparseLu::new(pattern),
            jacobian: vec![Row::new(); count],
            phi: vec![0.0; count],
            step: vec![0.0; count + unknowns],
        }
    }

    /// Rows count this much more than others.
    pub(in crate::kinematics) fn weigh(mut self, weight: impl Fn(usize) -> f64) -> Self {
        let rows = self.rows.iter();
        self.weights = rows.map(|&row| weight(row)).collect();
        self
    }

    /// Goes to a minimum near where the mechanism is. Returns the largest scaled residual there
    /// if that is a gap, `None` if all rows are satisfied; infinity for what is no number.
    pub(in crate::kinematics) fn close(&mut self, state: &mut BlockState<'_>) -> Option<f64> {
        let size = state.at.size();
        let mut q: Vec<f64> = (0..self.unknowns).map(|k| state.at.coordinate(k)).collect();
        let mut damping = 1e-6;
        let mut now = self.evaluate(state);
        for _ in 0..STEPS {
            if !now.cost.is_finite() {
                return Some(f64::INFINITY);
            }
            if now.at_rounding {
                break;
            }
            let improved = loop {
                if self.solve(damping) {
                    for (k, q) in q.iter().enumerate() {
                        let step = self.step[self.rows.len() + k];
                        let next = q + step * state.system.column_scale(k, size);
                        state.at.set_coordinate(k, next);
                    }
                    let next = self.evaluate(state);
                    if next.cost < now.cost {
                        let gain = 1.0 - next.cost / now.cost;
                        now = next;
                        for (k, q) in q.iter_mut().enumerate() {
                            *q = state.at.coordinate(k);
                        }
                        damping = (damping * 0.1).max(1e-15);
                        break gain > 1e-12;
                    }
                    for (k, &q) in q.iter().enumerate() {
                        state.at.set_coordinate(k, q);
                    }
                    self.evaluate(state);
                }
                damping *= 10.0;
                if damping > 1e12 {
                    break false;
                }
            };
            if !improved {
                break;
            }
        }
        if now.holds {
            None
        } else if now.largest.is_nan() {
            Some(f64::INFINITY)
        } else {
            Some(now.largest)
        }
    }

    /// Evaluates the rows and their gradients where the mechanism is.
    fn evaluate(&mut self, state: &BlockState<'_>) -> Residuals {
        let mut now = Residuals {
            cost: 0.0,
            largest: 0.0,
            holds: true,
            at_rounding: true,
        };
        for (local, &row) in self.rows.iter().enumerate() {
            let entries = &mut self.jacobian[local];
            let value = state.sparse_row(row, entries);
            let weight = self.weights[local];
            entries.iter_mut().for_each(|(_, value)| *value *= weight);
            self.phi[local] = value.value * weight;
            now.cost += self.phi[local].powi(2);
            now.largest = nan_or_larger(now.largest, value.value.abs());
            now.holds &= holds(value);
            now.at_rounding &= value.value.abs() <= AT_ROUNDING * value.rounding;
        }
        now
    }

    /// Solves for the step at the pose last evaluated. False if that gives no numbers.
    fn solve(&mut self, damping: f64) -> bool {
        let count = self.rows.len();
        self.lu.clear();
        for (local, entries) in self.jacobian.iter().enumerate() {
            self.lu.add(local, local, 1.0);
            for &(column, value) in entries {
                self.lu.add(local, count + column, value);
                self.lu.add(count + column, local, value);
            }
        }
        for column in 0..self.unknowns {
            self.lu.add(count + column, count + column, -damping);
        }
        if self.lu.factorise(0.0).is_err() {
            return false;
        }
        for (side, phi) in self.step.iter_mut().zip(&self.phi) {
            *side = -phi;
        }
        self.step[count..].fill(0.0);
        self.lu.solve(&mut self.step);
        self.step.iter().all(|step| step.is_finite())
    }
}

/// What the rows are worth at a pose.
struct Residuals {
    cost: f64,
    /// The largest scaled residual.
    largest: f64,
    holds: bool,
    at_rounding: bool,
}

/// Returns whether the mechanism is small enough for several starts and dense matrices.
pub(in crate::kinematics) fn is_small(system: &System) -> bool {
    system.unknowns() <= SMALL_PART
}

/// Closes the mechanism on these rows from the estimates, or from starts near them. Returns `None`
/// if they are satisfied, otherwise the largest scaled residual of the nearest pose found, where
/// the bodies then are.
pub(in crate::kinematics) fn close_on(
    system: &System,
    state: &mut State,
    rows: &[usize],
    estimate: &[f64],
) -> Option<f64> {
    let unknowns: Vec<_> = (0..system.unknowns()).collect();
    let part = Part::new(rows, &unknowns);
    let small = is_small(system);
    let mut closing = Closing::new(system, rows);
    let mut nearest: Option<(f64, Vec<f64>)> = None;
    for attempt in 0..if small { STARTS } else { 1 } {
        let mut block_state = state.block_state(system);
        part.start(&mut block_state, estimate, attempt);
        if small {
            part.minimise_growing(&mut block_state);
        }
        let gap = closing.close(&mut block_state)?;
        if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
            let mut q = vec![0.0; unknowns.len()];
            state.at.copy_pose(&mut q);
            nearest = Some((gap, q));
        }
    }
    let (gap, q) = nearest?;
    state.at.set_pose(system.mechanism(), &q);
    Some(gap)
}
