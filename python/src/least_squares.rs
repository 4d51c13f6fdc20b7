//! Least squares within bounds, by the method of Levenberg and Marquardt.

use nalgebra::{DMatrix, DVector};

/// Damping of the first step, as part of the largest squared column of the Jacobian.
const FIRST_DAMPING: f64 = 1e-4;
/// Damping that changes a step by rounding only; less would have to be raised many times before a
/// refused step becomes shorter.
const LEAST_DAMPING: f64 = f64::EPSILON;
/// Damping at which a step is shorter than rounding.
const MOST_DAMPING: f64 = 1e16;
/// Factor of the damping after a step that is refused.
const RAISE: f64 = 4.0;
/// Least factor of the damping after a step that is accepted.
const LOWER: f64 = 0.1;
/// Damping of inner unknowns, as part of that of the others: enough for a regular system where an
/// inner unknown has no effect.
const INNER: f64 = 1e-6;

/// Residuals whose sum of squares is minimised.
///
/// The unknowns come in two kinds. The outer ones are damped and have bounds. The inner ones follow
/// them: each is the best for the outer ones, as the timing of a point is for a mechanism.
pub(crate) trait Residuals {
    /// Moves to unknowns and sets the residuals there; may improve the inner ones. Returns false if
    /// there are no residuals.
    fn try_at(&mut self, unknowns: &mut [f64], residuals: &mut [f64]) -> bool;

    /// Sets the derivatives of the residuals at the unknowns tried last, by residual, then by
    /// unknown, and keeps these unknowns. Returns false and keeps none if there are no derivatives.
    fn keep(&mut self, unknowns: &[f64], derivatives: &mut [f64]) -> bool;
}

/// A point of the search: unknowns with residuals and derivatives.
#[derive(Debug)]
pub(crate) struct Point {
    pub(crate) unknowns: Vec<f64>,
    residuals: Vec<f64>,
    derivatives: Vec<f64>,
    /// Sum of squared residuals; infinite before the first evaluation.
    pub(crate) cost: f64,
    /// Damping of the next step.
    damping: f64,
    /// Whether no step leads further.
    done: bool,
}

/// Bounds and sizes of the outer unknowns, which come first.
#[derive(Debug)]
pub(crate) struct Outer {
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
    /// Sizes by which steps are scaled, greater than zero.
    pub(crate) size: Vec<f64>,
}

/// End of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Largest number of evaluations of the residuals.
    pub(crate) evaluations: usize,
    /// Relative decrease of the cost, and relative step, below which the search ends.
    pub(crate) tolerance: f64,
    /// Cost that suffices.
    pub(crate) cost: f64,
}

impl Point {
    pub(crate) fn new(unknowns: Vec<f64>, residuals: usize) -> Self {
        Self {
            residuals: vec![0.0; residuals],
            derivatives: vec![0.0; residuals * unknowns.len()],
            unknowns,
            cost: f64::INFINITY,
            damping: FIRST_DAMPING,
            done: false,
        }
    }

    /// Returns the number of residuals.
    pub(crate) fn residuals(&self) -> usize {
        self.residuals.len()
    }

    /// Improves the unknowns. Returns the number of evaluations.
    pub(crate) fn improve(
        &mut self,
        problem: &mut impl Residuals,
        outer: &Outer,
        limits: Limits,
    ) -> usize {
        let mut evaluations = 0;
        if self.cost.is_infinite() && !self.done {
            evaluations += 1;
            let found = problem.try_at(&mut self.unknowns, &mut self.residuals)
                && problem.keep(&self.unknowns, &mut self.derivatives);
            let cost = sum_of_squares(&self.residuals);
            self.done = !found || !cost.is_finite();
            if !self.done {
                self.cost = cost;
            }
        }
        let mut residuals = self.residuals.clone();
        while evaluations < limits.evaluations && !self.done && self.cost > limits.cost {
            let system = System::new(self, outer);
            let mut raise = RAISE;
            while evaluations < limits.evaluations {
                let Some((mut next, expected)) = system.step(self, outer) else {
                    self.done = true;
                    break;
                };
                if expected <= 0.0 && self.damping <= MOST_DAMPING {
                    // Cut at a bound, the step leads uphill; with more damping it leads downhill.
                    self.damping *= raise;
                    raise *= 2.0;
                    continue;
                }
                evaluations += 1;
                let found = problem.try_at(&mut next, &mut residuals);
                let cost = if found {
                    sum_of_squares(&residuals)
                } else {
                    f64::INFINITY
                };
                if cost < self.cost {
                    let before = std::mem::replace(&mut self.cost, cost);
                    self.unknowns = next;
                    self.residuals.copy_from_slice(&residuals);
                    let kept = problem.keep(&self.unknowns, &mut self.derivatives);
                    // Nielsen's rule: the better the prediction, the less damping.
                    let gain = 2.0 * (before - cost) / expected - 1.0;
                    self.damping *= (1.0 - gain.powi(3)).clamp(LOWER, 2.0);
                    self.damping = self.damping.max(LEAST_DAMPING);
                    self.done = !kept || before - cost <= limits.tolerance * before;
                    break;
                }
                if expected <= limits.tolerance * self.cost
                    || system.relative(self, &next, outer) <= limits.tolerance
                    || self.damping > MOST_DAMPING
                {
                    self.done = true;
                    break;
                }
                self.damping *= raise;
                raise *= 2.0;
            }
        }
        evaluations
    }
}

/// The linearised residuals at a point, in scaled unknowns.
struct System {
    jacobian: DMatrix<f64>,
    residuals: DVector<f64>,
    /// Whether each outer unknown stays: it is fixed, or at a bound.
    stays: Vec<bool>,
    /// Square of the largest column of outer unknowns.
    largest: f64,
}

impl System {
    fn new(at: &Point, outer: &Outer) -> Self {
        let count = at.unknowns.len();
        let mut jacobian = DMatrix::from_row_slice(at.residuals.len(), count, &at.derivatives);
        let residuals = DVector::from_column_slice(&at.residuals);
        let mut stays = vec![false; outer.size.len()];
        let mut largest = 0.0_f64;
        for (index, stays) in stays.iter_mut().enumerate() {
            let mut column = jacobian.column_mut(index);
            column *= outer.size[index];
            let uphill = column.dot(&residuals);
            let at = at.unknowns[index];
            let [low, high] = [outer.low[index], outer.high[index]];
            *stays = low >= high || (at <= low && uphill > 0.0) || (at >= high && uphill < 0.0);
            if *stays {
                column.fill(0.0);
            }
            largest = largest.max(column.norm_squared());
        }
        Self {
            jacobian,
            residuals,
            stays,
            largest,
        }
    }

    /// Returns the unknowns after a damped step, within bounds, and the decrease of the cost that
    /// the linearised residuals promise; none if there is no step.
    ///
    /// Minimises |r + J d|² + λ |d|² by a QR factorisation of J above √λ: the normal equations
    /// would square the condition.
    fn step(&self, at: &Point, outer: &Outer) -> Option<(Vec<f64>, f64)> {
        let (rows, count) = self.jacobian.shape();
        let mut system = DMatrix::zeros(rows + count, count);
        system.rows_mut(0, rows).copy_from(&self.jacobian);
        for index in 0..count {
            let damping = match self.stays.get(index) {
                Some(true) => 1.0,
                Some(false) => at.damping * self.largest,
                None => (INNER * at.damping).max(LEAST_DAMPING) * self.largest,
            };
            // Without any effect of the outer unknowns the largest column is zero.
            system[(rows + index, index)] = damping.max(f64::MIN_POSITIVE).sqrt();
        }
        let mut right = DVector::zeros(rows + count);
        right.rows_mut(0, rows).copy_from(&(-&self.residuals));
        let factors = system.qr();
        factors.q_tr_mul(&mut right);
        let top = right.rows(0, count).into_owned();
        let step = factors.r().solve_upper_triangular(&top)?;
        let mut next = at.unknowns.clone();
        let mut taken = step;
        for (index, taken) in taken.iter_mut().enumerate() {
            let Some(&size) = outer.size.get(index) else {
                next[index] += *taken;
                continue;
            };
            if !self.stays[index] {
                let to = at.unknowns[index] + size * *taken;
                next[index] = to.clamp(outer.low[index], outer.high[index]);
            }
            *taken = (next[index] - at.unknowns[index]) / size;
        }
        let linear = &self.residuals + &self.jacobian * &taken;
        let expected = at.cost - linear.norm_squared();
        let moves = next.iter().all(|value| value.is_finite()) && next != at.unknowns;
        moves.then_some((next, expected))
    }

    /// Returns the length of a step relative to the unknowns' sizes.
    fn relative(&self, at: &Point, next: &[f64], outer: &Outer) -> f64 {
        let steps = at.unknowns.iter().zip(next).enumerate();
        let relative = steps.map(|(index, (at, next))| {
            (next - at).abs() / outer.size.get(index).copied().unwrap_or(1.0)
        });
        relative.fold(0.0, f64::max)
    }
}

fn sum_of_squares(residuals: &[f64]) -> f64 {
    residuals.iter().map(|residual| residual * residual).sum()
}
