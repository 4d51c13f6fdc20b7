//! Assembly of a part of the mechanism: minimises Ec. 3.6.9 from several starts.

use nalgebra::{DMatrix, DVector};

use super::newton::{Correction, Rejected};
use super::plan::Work;

/// The weights r of Ec. 3.6.9, from one where the estimates count as much as the constraints to
/// one where the minimum is within Newton's reach.
const WEIGHTS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];
/// Minimisation steps for each weight; Newton follows, so that none needs to converge.
const STEPS_PER_WEIGHT: usize = 20;
/// Newton from the minimum; it also has to creep into nearly singular positions.
pub(super) const MAX_ITERATIONS: u32 = 30;
/// The estimates themselves, and this many less one deterministic shifts of them: estimates of
/// zero often lie on a symmetry from which no minimisation can choose a side.
pub(super) const STARTS: usize = 8;
/// A part of more unknowns than this is too large for dense matrices to be the first choice.
pub(super) const SMALL_PART: usize = 120;

/// Rows of Phi and unknowns, assembled while all others stay where they are. There may be more rows
/// than unknowns, or fewer.
pub(super) struct Part {
    /// Ascending.
    pub(super) rows: Vec<usize>,
    /// Ascending.
    columns: Vec<usize>,
}

impl Part {
    pub(super) fn new(rows: &[usize], columns: &[usize]) -> Self {
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

    /// The unknowns as they are.
    fn read(&self, work: &Work<'_>) -> DVector<f64> {
        let columns = self.columns.iter();
        DVector::from_iterator(
            self.columns.len(),
            columns.map(|&column| work.at.coordinate(column)),
        )
    }

    fn write(&self, work: &mut Work<'_>, values: &DVector<f64>) {
        for (&column, &value) in self.columns.iter().zip(values) {
            work.at.set_coordinate(column, value);
        }
    }

    /// What a scaled unknown of one stands for, one an unknown.
    fn scale(&self, work: &Work<'_>) -> DVector<f64> {
        let size = work.at.size();
        let columns = self.columns.iter();
        DVector::from_iterator(
            self.columns.len(),
            columns.map(|&column| work.system.column_scale(column, size)),
        )
    }

    /// Goes to the estimates, or to one of the starts near them. What joints bring with them
    /// comes last in the list, and starts where it suits the bodies.
    pub(super) fn start(&self, work: &mut Work<'_>, estimate: &[f64], attempt: usize) {
        let size = work.at.size();
        for &column in &self.columns {
            let start = match work.system.estimate_joint_unknown(column, work.at) {
                Some(start) => start,
                None => {
                    let scale = work.system.column_scale(column, size);
                    estimate[column] + shift(attempt, column) * scale
                }
            };
            work.at.set_coordinate(column, start);
        }
    }

    /// Assembles from several starts, `correct` being Newton–Raphson with at most so many
    /// corrections.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if none of them led to a pose.
    pub(super) fn assemble(
        &self,
        work: &mut Work<'_>,
        estimate: &[f64],
        mut correct: impl FnMut(&mut Work<'_>, u32) -> Result<Correction, Rejected>,
    ) -> Result<Correction, Rejected> {
        // One correction solves linear rows, from wherever it starts, and estimates as good as
        // that need no more. For a large part Newton is worth a try by itself.
        let large = self.columns.len() > SMALL_PART;
        self.start(work, estimate, 0);
        if let Ok(correction) = correct(work, if large { MAX_ITERATIONS } else { 1 }) {
            return Ok(correction);
        }
        for attempt in 0..STARTS {
            self.start(work, estimate, attempt);
            self.minimise_growing(work);
            if let Ok(correction) = correct(work, MAX_ITERATIONS) {
                return Ok(correction);
            }
        }
        Err(Rejected)
    }

    /// Minimises Ec. 3.6.9 for growing r from where the part is, which counts as the estimate.
    pub(super) fn minimise_growing(&self, work: &mut Work<'_>) {
        let start = self.read(work);
        for weight in WEIGHTS {
            let pull = Some((&start, weight.recip()));
            self.minimise(work, pull, |_| 1.0, STEPS_PER_WEIGHT);
        }
    }

    /// Levenberg–Marquardt on pull · ‖q − q⁰‖² + Σ (weight(row) Phi_row)², scaled, from where
    /// the part is.
    pub(super) fn minimise(
        &self,
        work: &mut Work<'_>,
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
    pub(super) fn equations(&self, work: &Work<'_>) -> (DVector<f64>, DMatrix<f64>) {
        self.weighted_equations(work, |_| 1.0)
    }

    /// Phi and Phi_q of the part, scaled, each row times its weight.
    fn weighted_equations(
        &self,
        work: &Work<'_>,
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
            let value = work
                .system
                .evaluate_row(row, work.at, work.targets, work.drivers, entry);
            residual[local] = value.value * weight;
        }
        (residual, jacobian)
    }
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
