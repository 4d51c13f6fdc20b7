//! Closing a mechanism on rows that may be more than enough, or too few.

use crate::kinematics::block::Work;
use crate::kinematics::constraint::Incidence;
use crate::kinematics::linear::{Factors, Row, SparseLu, nan_or_larger};
use crate::kinematics::newton::{AT_ROUNDING, STALLED};
use crate::kinematics::system::{RowValue, System};

/// A scaled residual of more than this, beyond its rounding, is a gap: five digits above what
/// Newton leaves of rows that are well conditioned, and less than anyone could measure.
const GAP: f64 = 1e-9;
/// Steps of a minimisation; it converges quadratically to a regular pose that exists.
const STEPS: usize = 60;

/// Whether a row counts as satisfied.
pub(super) fn holds(row: RowValue) -> bool {
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
pub(super) struct Closing {
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
    pub(super) fn new(system: &System, rows: &[usize]) -> Self {
        let (count, unknowns) = (rows.len(), system.unknowns());
        let mut pattern: Vec<Vec<usize>> = (0..count + unknowns).map(|k| vec![k]).collect();
        for (local, &row) in rows.iter().enumerate() {
            let mut incidence = Incidence::default();
            let constraint = &system.equations()[row].constraint;
            constraint.incidence(system.mechanism(), &mut incidence);
            incidence.unknowns.sort_unstable();
            incidence.unknowns.dedup();
            for column in incidence.unknowns {
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
    pub(super) fn weigh(mut self, weight: impl Fn(usize) -> f64) -> Self {
        let rows = self.rows.iter();
        self.weights = rows.map(|&row| weight(row)).collect();
        self
    }

    /// Goes to a minimum near where the mechanism is. Returns the largest scaled residual there
    /// if that is a gap, `None` if all rows are satisfied; infinity for what is no number.
    pub(super) fn close(&mut self, work: &mut Work<'_>) -> Option<f64> {
        let size = work.at.size();
        let mut q: Vec<f64> = (0..self.unknowns).map(|k| work.at.coordinate(k)).collect();
        let mut damping = 1e-6;
        let mut state = self.evaluate(work);
        for _ in 0..STEPS {
            if !state.cost.is_finite() {
                return Some(f64::INFINITY);
            }
            if state.at_rounding {
                break;
            }
            let improved = loop {
                if self.solve(damping) {
                    for (k, q) in q.iter().enumerate() {
                        let step = self.step[self.rows.len() + k];
                        let next = q + step * work.system.column_scale(k, size);
                        work.at.set_coordinate(k, next);
                    }
                    let next = self.evaluate(work);
                    if next.cost < state.cost {
                        let gain = 1.0 - next.cost / state.cost;
                        state = next;
                        for (k, q) in q.iter_mut().enumerate() {
                            *q = work.at.coordinate(k);
                        }
                        damping = (damping * 0.1).max(1e-15);
                        break gain > 1e-12;
                    }
                    for (k, &q) in q.iter().enumerate() {
                        work.at.set_coordinate(k, q);
                    }
                    self.evaluate(work);
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
        if state.holds {
            None
        } else if state.largest.is_nan() {
            Some(f64::INFINITY)
        } else {
            Some(state.largest)
        }
    }

    /// Evaluates the rows and their gradients where the mechanism is.
    fn evaluate(&mut self, work: &Work<'_>) -> State {
        let mut state = State {
            cost: 0.0,
            largest: 0.0,
            holds: true,
            at_rounding: true,
        };
        for (local, &row) in self.rows.iter().enumerate() {
            let entries = &mut self.jacobian[local];
            let value = evaluate_row(work, row, entries);
            let weight = self.weights[local];
            entries.iter_mut().for_each(|(_, value)| *value *= weight);
            self.phi[local] = value.value * weight;
            state.cost += self.phi[local].powi(2);
            state.largest = nan_or_larger(state.largest, value.value.abs());
            state.holds &= holds(value);
            state.at_rounding &= value.value.abs() <= AT_ROUNDING * value.rounding;
        }
        state
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
struct State {
    cost: f64,
    /// The largest scaled residual.
    largest: f64,
    holds: bool,
    at_rounding: bool,
}

/// Evaluates a row of Phi and writes the entries of its gradient, scaled, each column once.
pub(super) fn evaluate_row(work: &Work<'_>, row: usize, entries: &mut Row) -> RowValue {
    entries.clear();
    work.system.evaluate_row(
        row,
        work.at,
        work.targets,
        work.drivers,
        |column, value| match entries.iter_mut().find(|(c, _)| *c == column) {
            Some((_, sum)) => *sum += value,
            None if value != 0.0 => entries.push((column, value)),
            None => {}
        },
    )
}
