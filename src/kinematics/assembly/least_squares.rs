//! Damped least squares (Levenberg–Marquardt) on rows of Phi, for mechanisms of any size.

use std::f64::consts::PI;

use crate::kinematics::constraint::{Gradient, Region, Relation, TurnEffect};
use crate::kinematics::linear::{Factors, Row, SparseLu, nan_or_larger};
use crate::kinematics::plan::BlockState;
use crate::kinematics::system::{RowValue, System};
use crate::kinematics::tolerances::{AT_ROUNDING, STALLED};

/// A scaled residual beyond its rounding up to this one holds: it is five digits above the one that
/// Newton–Raphson leaves in rows that are well conditioned, and less than anyone could measure.
const GAP: f64 = 1e-9;
/// Most steps to close some rows; they converge quadratically to a regular pose that exists.
const STEPS_TO_CLOSE: usize = 60;
/// Largest step of an angle \[rad\] beyond which rows that are curved along it say nothing.
const LARGEST_TURN: f64 = PI;

/// Returns whether a row counts as satisfied.
pub(in crate::kinematics) fn holds(row: RowValue) -> bool {
    row.value.abs() <= GAP + STALLED * row.rounding
}

/// Rows of Phi and the unknowns over which they are minimised; all other unknowns are held. There
/// may be more rows than unknowns, or fewer.
///
/// The step d of least ‖J d + Φ‖² + r ‖q + d − q⁰‖² + μ ‖d‖² solves
///
/// ```text
/// ⎡ 1     J    ⎤ ⎡ y ⎤   ⎡    −Φ     ⎤
/// ⎣ Jᵀ  −r − μ ⎦ ⎣ d ⎦ = ⎣ r (q − q⁰) ⎦
/// ```
///
/// which is as sparse as J and, unlike JᵀJ, as well conditioned. The row of a distance u is
/// (d·d − u²)/(2u), which is smooth where the points coincide.
#[derive(Debug)]
pub(in crate::kinematics) struct LeastSquares {
    /// Ascending.
    pub(in crate::kinematics) rows: Vec<usize>,
    /// Ascending.
    pub(in crate::kinematics) columns: Vec<usize>,
    /// Whether a row counts turns: then a pose some turns away is another one.
    pub(in crate::kinematics) counts_turns: bool,
    lu: SparseLu,
    /// The rows of J, their columns as indices into `columns`.
    jacobian: Vec<Row>,
    phi: Vec<f64>,
    step: Vec<f64>,
}

/// A term r ‖q − q⁰‖², scaled.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Pull<'a> {
    /// q⁰, in the order of the columns.
    pub(in crate::kinematics) to: &'a [f64],
    /// r.
    pub(in crate::kinematics) strength: f64,
}

/// The rows at a place.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Residual {
    /// The sum of squares that is minimised.
    pub(in crate::kinematics) cost: f64,
    /// The largest scaled residual.
    pub(in crate::kinematics) largest: f64,
    /// Whether all rows hold.
    pub(in crate::kinematics) holds: bool,
    at_rounding: bool,
}

impl LeastSquares {
    /// Makes the storage for these rows and unknowns.
    pub(in crate::kinematics) fn new(system: &System, rows: &[usize], columns: &[usize]) -> Self {
        let sorted = |list: &[usize]| {
            let mut list = list.to_vec();
            list.sort_unstable();
            list
        };
        let (rows, columns) = (sorted(rows), sorted(columns));
        let count = rows.len();
        let order = count + columns.len();
        let mut pattern: Vec<Vec<usize>> = (0..order).map(|k| vec![k]).collect();
        for (local, &row) in rows.iter().enumerate() {
            for column in system.incidence(row).unknowns {
                if let Ok(own) = columns.binary_search(&column) {
                    pattern[local].push(count + own);
                    pattern[count + own].push(local);
                }
            }
        }
        let counts_turns = |row: &usize| {
            let constraint = &system.equations()[*row].constraint;
            constraint.turn_effect() == TurnEffect::Proportional
        };
        Self {
            counts_turns: rows.iter().any(counts_turns),
            lu: SparseLu::new(pattern),
            jacobian: vec![Row::new(); count],
            phi: vec![0.0; count],
            step: vec![0.0; order],
            rows,
            columns,
        }
    }

    /// Makes the storage for these rows and all unknowns.
    pub(in crate::kinematics) fn of_all(system: &System, rows: &[usize]) -> Self {
        let columns: Vec<_> = (0..system.unknowns()).collect();
        Self::new(system, rows, &columns)
    }

    /// Returns the unknowns at their present values.
    pub(in crate::kinematics) fn read(&self, state: &BlockState<'_>) -> Vec<f64> {
        let columns = self.columns.iter();
        columns.map(|&column| state.at.coordinate(column)).collect()
    }

    /// Sets the unknowns.
    pub(in crate::kinematics) fn write(&self, state: &mut BlockState<'_>, values: &[f64]) {
        for (&column, &value) in self.columns.iter().zip(values) {
            state.at.set_coordinate(column, value);
        }
    }

    /// Minimises the sum of squares of the rows from the present values. Returns `None` if all rows
    /// hold there, otherwise the largest scaled residual; infinity if it is no number.
    pub(in crate::kinematics) fn close(&mut self, state: &mut BlockState<'_>) -> Option<f64> {
        let found = self.minimise(state, None, |_| 1.0, STEPS_TO_CLOSE);
        if found.holds {
            None
        } else if found.largest.is_nan() {
            Some(f64::INFINITY)
        } else {
            Some(found.largest)
        }
    }

    /// Minimises Σ (weight(row) Phi_row)², and the pull, from the present values.
    pub(in crate::kinematics) fn minimise(
        &mut self,
        state: &mut BlockState<'_>,
        pull: Option<Pull<'_>>,
        weight: impl Fn(usize) -> f64,
        steps: usize,
    ) -> Residual {
        let size = state.at.size();
        let columns = self.columns.iter();
        let scales: Vec<_> = columns
            .map(|&column| state.system.column_scale(column, size))
            .collect();
        let mut q = self.read(state);
        let mut next = q.clone();
        let mut damping = 1e-6;
        let mut now = self.evaluate(state, pull, &weight, &scales);
        for _ in 0..steps {
            if now.at_rounding || !now.cost.is_finite() {
                break;
            }
            let improved = loop {
                if self.solve(pull, damping, &q, &scales) && !self.loses_turns(state) {
                    let step = &self.step[self.rows.len()..];
                    for (k, next) in next.iter_mut().enumerate() {
                        *next = q[k] + step[k] * scales[k];
                    }
                    self.write(state, &next);
                    let there = self.evaluate(state, pull, &weight, &scales);
                    if there.cost < now.cost {
                        let gain = 1.0 - there.cost / now.cost;
                        now = there;
                        std::mem::swap(&mut q, &mut next);
                        damping = (damping * 0.1).max(1e-15);
                        break gain > 1e-12;
                    }
                    self.write(state, &q);
                    self.evaluate(state, pull, &weight, &scales);
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
        now
    }

    /// Returns whether the step, from where the rows were evaluated last, leads to another turn by
    /// chance: where turns count, a body turns by more than [`LARGEST_TURN`], a row is curved along
    /// that turn, and no linear row asks for it.
    fn loses_turns(&self, state: &BlockState<'_>) -> bool {
        if !self.counts_turns {
            return false;
        }
        let steps = self.columns.iter().zip(&self.step[self.rows.len()..]);
        let mut turns = steps.enumerate().filter(|(_, (column, step))| {
            state.system.is_angle(**column) && step.abs() > LARGEST_TURN
        });
        turns.any(|(own, (&column, step))| {
            let (mut is_curved, mut is_asked_for) = (false, false);
            for ((entries, &row), phi) in self.jacobian.iter().zip(&self.rows).zip(&self.phi) {
                let own_entries = entries.iter().filter(|(other, _)| *other == own);
                let entry: f64 = own_entries.map(|(_, value)| value).sum();
                if !is_straight(state, row, &[column]) {
                    is_curved = true;
                } else if entry.abs() > 0.0 {
                    is_asked_for |= phi.abs() >= 0.5 * (entry * step).abs();
                }
            }
            is_curved && !is_asked_for
        })
    }

    /// Returns whether all rows are linear in the unknowns.
    pub(in crate::kinematics) fn is_linear(&self, state: &BlockState<'_>) -> bool {
        let mut rows = self.rows.iter();
        rows.all(|&row| is_straight(state, row, &self.columns))
    }

    /// Evaluates the rows and their gradients at the present values.
    fn evaluate(
        &mut self,
        state: &BlockState<'_>,
        pull: Option<Pull<'_>>,
        weight: impl Fn(usize) -> f64,
        scales: &[f64],
    ) -> Residual {
        let mut residual = Residual {
            cost: 0.0,
            largest: 0.0,
            holds: true,
            at_rounding: pull.is_none(),
        };
        for (local, &row) in self.rows.iter().enumerate() {
            let weight = weight(row);
            let entries = &mut self.jacobian[local];
            let value = state.system.sparse_row(row, state.values(), entries);
            let stretch = stretch(state, row);
            entries.retain_mut(|(column, value)| {
                let own = self.columns.binary_search(column);
                *value *= weight * stretch;
                own.map(|own| *column = own).is_ok()
            });
            // (d·d − u²)/(2u) = (‖d‖ − u)(1 + ‖d‖/u)/2.
            self.phi[local] = weight * value.value * 0.5 * (1.0 + stretch);
            residual.cost += self.phi[local].powi(2);
            residual.largest = nan_or_larger(residual.largest, value.value.abs());
            residual.holds &= holds(value);
            residual.at_rounding &= value.value.abs() <= AT_ROUNDING * value.rounding;
        }
        if let Some(Pull { to, strength }) = pull {
            let columns = self.columns.iter().zip(to).zip(scales);
            residual.cost += columns
                .map(|((&column, to), scale)| {
                    strength * ((state.at.coordinate(column) - to) / scale).powi(2)
                })
                .sum::<f64>();
        }
        residual
    }

    /// Solves for the step from `q`, where the rows were evaluated last. Returns false if it is
    /// not finite.
    fn solve(&mut self, pull: Option<Pull<'_>>, damping: f64, q: &[f64], scales: &[f64]) -> bool {
        let count = self.rows.len();
        self.lu.clear();
        for (local, entries) in self.jacobian.iter().enumerate() {
            self.lu.add(local, local, 1.0);
            for &(own, value) in entries {
                self.lu.add(local, count + own, value);
                self.lu.add(count + own, local, value);
            }
        }
        let strength = pull.map_or(0.0, |pull| pull.strength);
        for own in count..self.step.len() {
            self.lu.add(own, own, -(strength + damping));
        }
        if self.lu.factorise(0.0).is_err() {
            return false;
        }
        let (sides, below) = self.step.split_at_mut(count);
        for (side, phi) in sides.iter_mut().zip(&self.phi) {
            *side = -phi;
        }
        below.fill(0.0);
        if let Some(Pull { to, strength }) = pull {
            for (k, side) in below.iter_mut().enumerate() {
                *side = strength * (q[k] - to[k]) / scales[k];
            }
        }
        self.lu.solve(&mut self.step);
        self.step.iter().all(|step| step.is_finite())
    }
}

/// Returns whether a row is linear along these unknowns within a radian and a characteristic length
/// of the present place.
fn is_straight(state: &BlockState<'_>, row: usize, columns: &[usize]) -> bool {
    let size = state.at.size();
    let mut extents = vec![0.0; state.system.unknowns()];
    for &column in columns {
        extents[column] = state.system.column_scale(column, size);
    }
    let constraint = &state.system.equations()[row].constraint;
    let region = Region::around(&extents);
    let bend = constraint.bend(state.at, &region, &extents, &mut Gradient::new());
    bend.is_some_and(|bend| bend <= 0.0)
}

/// Returns ‖d‖/u for the row of a distance u, one for other rows.
fn stretch(state: &BlockState<'_>, row: usize) -> f64 {
    let constraint = &state.system.equations()[row].constraint;
    if matches!(Relation::of(&**constraint), Relation::Distance(_)) {
        constraint.value(state.at) / state.system.target(row, state.targets, state.drivers)
    } else {
        1.0
    }
}
