//! Assembly of a part of the mechanism: minimises Eq. 3.6.9 from several starts.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::kinematics::block::BlockState;
use crate::kinematics::constraint::{Gradient, Relation};
use crate::kinematics::newton::{Correction, MAX_ASSEMBLY_ITERATIONS, Rejected};
use crate::kinematics::system::System;

/// The weights r of Eq. 3.6.9, from one where the estimates count as much as the constraints to
/// one where the minimum is within Newton's reach.
const WEIGHTS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];
/// Minimisation steps for each weight; Newton follows, so that none needs to converge.
const STEPS_PER_WEIGHT: usize = 20;
/// The estimates themselves, and this many less one deterministic shifts of them: estimates of
/// zero often lie on a symmetry from which no minimisation can choose a side.
pub(in crate::kinematics) const STARTS: usize = 8;
/// A part is tried straight from the estimates, then by minimisation from each of the starts.
pub(in crate::kinematics) const ATTEMPTS: usize = 1 + STARTS;
/// Minimisation steps from anywhere; a start that needs more is one of many.
const STEPS_FROM_ANYWHERE: usize = 40;
/// Points nearer than this part of the mechanism's size lie on each other.
const TOUCHING: f64 = 1e-6;
/// Unknowns that differ by less than this, scaled, are the same.
const SAME: f64 = 1e-6;
/// A part of more unknowns than this is too large for dense matrices to be the first choice.
pub(in crate::kinematics) const SMALL_PART: usize = 120;
/// One of more unknowns than this is too large for them altogether.
pub(in crate::kinematics) const LARGEST_PART: usize = 300;

/// Rows of Phi and unknowns, assembled while all others stay where they are. There may be more rows
/// than unknowns, or fewer.
#[derive(Debug)]
pub(in crate::kinematics) struct Part {
    /// Ascending.
    pub(in crate::kinematics) rows: Vec<usize>,
    /// Ascending.
    columns: Vec<usize>,
}

impl Part {
    pub(in crate::kinematics) fn new(rows: &[usize], columns: &[usize]) -> Self {
        let sorted = |list: &[usize]| {
            let mut list = list.to_vec();
            list.sort_unstable();
            list
        };
        Self {
            rows: sorted(rows),
            columns: sorted(columns),
        }
    }

    /// Its unknowns, ascending.
    pub(in crate::kinematics) fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// How many unknowns it has.
    pub(in crate::kinematics) fn unknowns(&self) -> usize {
        self.columns.len()
    }

    /// The unknowns as they are.
    pub(in crate::kinematics) fn read(&self, work: &BlockState<'_>) -> DVector<f64> {
        let columns = self.columns.iter();
        DVector::from_iterator(
            self.columns.len(),
            columns.map(|&column| work.at.coordinate(column)),
        )
    }

    /// Whether these unknowns put the bodies in the same places, whole turns apart.
    pub(in crate::kinematics) fn is_same(
        &self,
        work: &BlockState<'_>,
        a: &DVector<f64>,
        b: &DVector<f64>,
    ) -> bool {
        let (size, mut columns) = (work.at.size(), self.columns.iter().enumerate());
        columns.all(|(k, &column)| is_same(work.system, size, column, a[k], b[k]))
    }

    pub(in crate::kinematics) fn write(&self, work: &mut BlockState<'_>, values: &DVector<f64>) {
        for (&column, &value) in self.columns.iter().zip(values) {
            work.at.set_coordinate(column, value);
        }
    }

    /// What a scaled unknown of one stands for, one an unknown.
    fn scale(&self, work: &BlockState<'_>) -> DVector<f64> {
        let size = work.at.size();
        let columns = self.columns.iter();
        DVector::from_iterator(
            self.columns.len(),
            columns.map(|&column| work.system.column_scale(column, size)),
        )
    }

    /// Goes to the estimates, or to one of the starts near them. What joints bring with them
    /// comes last in the list, and starts where it suits the bodies.
    pub(in crate::kinematics) fn start(
        &self,
        work: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
    ) {
        self.start_off(work, estimate, |column| shift(attempt, column));
        self.leave_zero_distances(work);
    }

    /// Goes to the estimates and as far from them, scaled, as `off` says.
    fn start_off(&self, work: &mut BlockState<'_>, estimate: &[f64], off: impl Fn(usize) -> f64) {
        let size = work.at.size();
        for &column in &self.columns {
            let start = match work.system.estimate_joint_unknown(column, work.at) {
                Some(start) => start,
                None => estimate[column] + off(column) * work.system.column_scale(column, size),
            };
            work.at.set_coordinate(column, start);
        }
    }

    /// Where points whose distance is held lie on each other, their rows have no slope to go
    /// along: takes their bodies a little away.
    fn leave_zero_distances(&self, work: &mut BlockState<'_>) {
        let size = work.at.size();
        for &row in &self.rows {
            let constraint = &work.system.equations()[row].constraint;
            if !matches!(constraint.relation(), Relation::Distance(_))
                || constraint.value(work.at) > TOUCHING * size
            {
                continue;
            }
            let mut gradient = Gradient::new();
            constraint.gradient(work.at, &mut gradient);
            for (column, _) in gradient.entries() {
                if self.columns.binary_search(&column).is_ok() {
                    let off = shift(1, column) * work.system.column_scale(column, size);
                    let value = work.at.coordinate(column) + off;
                    work.at.set_coordinate(column, value);
                }
            }
        }
    }

    /// Tries to assemble from one of [`ATTEMPTS`] starts at and near the estimates, `correct`
    /// being Newton–Raphson with at most so many corrections.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if this did not lead to a pose.
    pub(in crate::kinematics) fn attempt(
        &self,
        work: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
        correct: impl FnOnce(&mut BlockState<'_>, u32) -> Result<Correction, Rejected>,
    ) -> Result<Correction, Rejected> {
        let Some(attempt) = attempt.checked_sub(1) else {
            // One correction solves linear rows, from wherever it starts, and estimates as good
            // as that need no more. For a large part Newton is worth a try by itself.
            self.start(work, estimate, 0);
            let large = self.columns.len() > SMALL_PART;
            return correct(work, if large { MAX_ASSEMBLY_ITERATIONS } else { 1 });
        };
        self.start(work, estimate, attempt);
        // The larger the part, the fewer minimisations anyone would wait for.
        let most = if attempt == 0 {
            LARGEST_PART
        } else {
            SMALL_PART
        };
        if self.columns.len() <= most {
            self.minimise_growing(work);
        }
        correct(work, MAX_ASSEMBLY_ITERATIONS)
    }

    /// Tries to assemble from anywhere: angles all around, points within a length or so of the
    /// estimates.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if this did not lead to a pose.
    pub(in crate::kinematics) fn attempt_anywhere(
        &self,
        work: &mut BlockState<'_>,
        estimate: &[f64],
        attempt: usize,
        correct: impl FnOnce(&mut BlockState<'_>, u32) -> Result<Correction, Rejected>,
    ) -> Result<Correction, Rejected> {
        let anywhere = |column| TAU * (scattered(attempt, column) - 0.5);
        self.start_off(work, estimate, anywhere);
        self.minimise(work, None, |_| 1.0, STEPS_FROM_ANYWHERE);
        correct(work, MAX_ASSEMBLY_ITERATIONS)
    }

    /// Minimises Eq. 3.6.9 for growing r from where the part is, which counts as the estimate.
    pub(in crate::kinematics) fn minimise_growing(&self, work: &mut BlockState<'_>) {
        let start = self.read(work);
        for weight in WEIGHTS {
            let pull = Some((&start, weight.recip()));
            self.minimise(work, pull, |_| 1.0, STEPS_PER_WEIGHT);
        }
    }

    /// Levenberg–Marquardt on pull · ‖q − q⁰‖² + Σ (weight(row) Phi_row)², scaled, from where
    /// the part is.
    pub(in crate::kinematics) fn minimise(
        &self,
        work: &mut BlockState<'_>,
        pull: Option<(&DVector<f64>, f64)>,
        weight: impl Fn(usize) -> f64,
        steps: usize,
    ) {
        let order = self.columns.len();
        let scale = self.scale(work);
        let mut damping = 1e-6;
        let mut q = self.read(work);
        let cost_of = |q: &DVector<f64>, residual: &DVector<f64>| {
            let distance = pull.map_or(0.0, |(estimate, strength)| {
                strength * (q - estimate).component_div(&scale).norm_squared()
            });
            distance + residual.norm_squared()
        };
        let (mut residual, mut jacobian) = self.weighted_equations(work, &weight);
        let mut cost = cost_of(&q, &residual);
        for _ in 0..steps {
            let mut gradient = jacobian.tr_mul(&residual);
            let mut normal = jacobian.tr_mul(&jacobian);
            if let Some((estimate, strength)) = pull {
                for k in 0..order {
                    gradient[k] += strength * (q[k] - estimate[k]) / scale[k];
                    normal[(k, k)] += strength;
                }
            }
            let improved = loop {
                let mut damped = normal.clone();
                for k in 0..order {
                    damped[(k, k)] += damping;
                }
                if let Some(factor) = damped.cholesky() {
                    let next = &q - factor.solve(&gradient).component_mul(&scale);
                    self.write(work, &next);
                    let (new_residual, new_jacobian) = self.weighted_equations(work, &weight);
                    let new_cost = cost_of(&next, &new_residual);
                    if new_cost < cost {
                        let gain = (cost - new_cost) / cost;
                        (q, residual, jacobian, cost) =
                            (next, new_residual, new_jacobian, new_cost);
                        damping = (damping * 0.1).max(1e-15);
                        break gain > 1e-12;
                    }
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
        self.write(work, &q);
    }

    /// Phi and Phi_q of the part, scaled.
    pub(in crate::kinematics) fn equations(
        &self,
        work: &BlockState<'_>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        self.weighted_equations(work, |_| 1.0)
    }

    /// Phi and Phi_q of the part, scaled, each row times its weight.
    fn weighted_equations(
        &self,
        work: &BlockState<'_>,
        weight: impl Fn(usize) -> f64,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let mut residual = DVector::zeros(self.rows.len());
        let mut jacobian = DMatrix::zeros(self.rows.len(), self.columns.len());
        for (local, &row) in self.rows.iter().enumerate() {
            let weight = weight(row);
            let entry = |column, value: f64| {
                if let Ok(column) = self.columns.binary_search(&column) {
                    jacobian[(local, column)] += value * weight;
                }
            };
            residual[local] = evaluate_smoothly(work, row, entry) * weight;
        }
        (residual, jacobian)
    }
}

/// A row of Phi and its gradient, scaled as [`System::evaluate_row`] has them. That of a distance
/// u is (d·d − u²)/(2u), which is smooth where the points lie on each other.
fn evaluate_smoothly(work: &BlockState<'_>, row: usize, mut entry: impl FnMut(usize, f64)) -> f64 {
    let equation = &work.system.equations()[row];
    let distance = matches!(equation.constraint.relation(), Relation::Distance(_));
    let stretch = if distance {
        let target = work.system.target(row, work.targets, work.drivers);
        equation.constraint.value(work.at) / target
    } else {
        1.0
    };
    let entry = |column, value: f64| entry(column, value * stretch);
    let value = work
        .system
        .evaluate_row(row, work.at, work.targets, work.drivers, entry);
    // (d·d − u²)/(2u) = (‖d‖ − u)(1 + ‖d‖/u)/2.
    value.value * 0.5 * (1.0 + stretch)
}

/// Returns whether two values of an unknown put a body in the same place, whole turns apart.
pub(in crate::kinematics) fn is_same(
    system: &System,
    size: f64,
    column: usize,
    a: f64,
    b: f64,
) -> bool {
    system.difference(column, size, a, b).abs() < SAME
}

/// A number from 0 to 1 for attempt and coordinate, one as likely as any other and all of them
/// as if by chance (the finalizer of SplitMix64).
fn scattered(attempt: usize, column: usize) -> f64 {
    let mut z = ((attempt as u64) << 32 | column as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// By how much start `attempt` differs from the estimates in coordinate k, scaled: nothing the
/// first time, then up to half a length or radian, spread evenly by the golden ratio.
fn shift(attempt: usize, k: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if attempt == 0 {
        0.0
    } else {
        (GOLDEN * (attempt * (k + 1)) as f64).fract() - 0.5
    }
}
