//! Estimates of norms of inverses.

use super::factors::Factors;
use super::norm::{largest_entry, nan_or_larger, norm1};

/// Work space of the estimates.
#[derive(Clone, Debug)]
pub struct Condition {
    probe: Vec<f64>,
    signs: Vec<f64>,
    product: Vec<f64>,
}

impl Condition {
    /// Makes the work space for matrices of order `order`.
    #[must_use]
    pub fn new(order: usize) -> Self {
        Self {
            probe: vec![0.0; order],
            signs: vec![0.0; order],
            product: vec![0.0; order],
        }
    }

    /// Estimates 1 / (‖A‖₁ ‖A⁻¹‖₁), by Hager's method with Higham's extra vector
    /// (N. J. Higham, ACM Trans. Math. Softw. 14 (1988) 381–396). Never below the true value.
    pub fn rcond(&mut self, factors: &mut impl Factors) -> f64 {
        if factors.order() == 0 {
            return 1.0;
        }
        let rcond = 1.0 / (factors.norm() * self.norm(&mut Inverse(factors)));
        if rcond.is_finite() { rcond } else { 0.0 }
    }

    /// Estimates the largest component of |A⁻¹| b, for b ≥ 0, by the same method: it is the 1-norm
    /// of diag(b) A⁻ᵀ. Never above the true value.
    pub fn largest_row(&mut self, factors: &mut impl Factors, b: &[f64]) -> f64 {
        self.norm(&mut ScaledInverse { factors, b })
    }

    /// Estimates the largest sum of magnitudes in a row of A⁻¹ B, by the same method: it is the
    /// 1-norm of Bᵀ A⁻ᵀ. Never above the true value. B is the sum of `entries`: row, column, value.
    pub fn largest_row_of_product(
        &mut self,
        factors: &mut impl Factors,
        entries: &[(usize, usize, f64)],
    ) -> f64 {
        let mut before = std::mem::take(&mut self.product);
        let norm = self.norm(&mut Product {
            factors,
            entries,
            before: &mut before,
        });
        self.product = before;
        norm
    }

    /// Estimates the 1-norm of an operator.
    fn norm(&mut self, operator: &mut impl Operator) -> f64 {
        let Self { probe, signs, .. } = self;
        let n = probe.len() as f64;
        probe.fill(1.0 / n);
        let mut norm = 0.0_f64;
        let mut previous = usize::MAX;
        // Higham: five rounds are enough in practice.
        for _ in 0..5 {
            operator.apply(probe);
            norm = nan_or_larger(norm, norm1(probe));
            for (sign, value) in signs.iter_mut().zip(probe.iter()) {
                *sign = 1.0_f64.copysign(*value);
            }
            probe.copy_from_slice(signs);
            operator.apply_transposed(probe);
            let largest_entry = largest_entry(probe);
            if largest_entry == previous {
                break;
            }
            previous = largest_entry;
            probe.fill(0.0);
            probe[largest_entry] = 1.0;
        }
        // A vector of alternating, growing entries catches cases that the iteration misses.
        for (k, value) in probe.iter_mut().enumerate() {
            let grown = 1.0 + k as f64 / (n - 1.0).max(1.0);
            *value = if k % 2 == 0 { grown } else { -grown };
        }
        operator.apply(probe);
        nan_or_larger(norm, 2.0 * norm1(probe) / (3.0 * n))
    }
}

/// A matrix known by its products with vectors.
trait Operator {
    /// Replaces `x` by the product with `x`.
    fn apply(&mut self, x: &mut [f64]);

    /// Replaces `x` by the product of the transpose with `x`.
    fn apply_transposed(&mut self, x: &mut [f64]);
}

/// The operator A⁻¹.
struct Inverse<'a, F>(&'a mut F);

impl<F: Factors> Operator for Inverse<'_, F> {
    fn apply(&mut self, x: &mut [f64]) {
        self.0.solve(x);
    }

    fn apply_transposed(&mut self, x: &mut [f64]) {
        self.0.solve_transposed(x);
    }
}

/// The operator diag(b) A⁻ᵀ.
struct ScaledInverse<'a, F> {
    factors: &'a mut F,
    b: &'a [f64],
}

impl<F> ScaledInverse<'_, F> {
    fn scale(&self, x: &mut [f64]) {
        x.iter_mut().zip(self.b).for_each(|(x, b)| *x *= b);
    }
}

impl<F: Factors> Operator for ScaledInverse<'_, F> {
    fn apply(&mut self, x: &mut [f64]) {
        self.factors.solve_transposed(x);
        self.scale(x);
    }

    fn apply_transposed(&mut self, x: &mut [f64]) {
        self.scale(x);
        self.factors.solve(x);
    }
}

/// The operator Bᵀ A⁻ᵀ; B is the sum of `entries`.
struct Product<'a, F> {
    factors: &'a mut F,
    entries: &'a [(usize, usize, f64)],
    /// Work space.
    before: &'a mut [f64],
}

impl<F: Factors> Operator for Product<'_, F> {
    fn apply(&mut self, x: &mut [f64]) {
        self.factors.solve_transposed(x);
        self.before.copy_from_slice(x);
        x.fill(0.0);
        for &(row, column, value) in self.entries {
            x[column] += value * self.before[row];
        }
    }

    fn apply_transposed(&mut self, x: &mut [f64]) {
        self.before.copy_from_slice(x);
        x.fill(0.0);
        for &(row, column, value) in self.entries {
            x[row] += value * self.before[column];
        }
        self.factors.solve(x);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    use super::Condition;
    use crate::kinematics::linear::{SparseLu, nan_or_larger};

    const ORDER: usize = 12;

    /// Returns a matrix with a dominant diagonal and some entries beside it.
    fn matrix(values: &[f64]) -> (SparseLu, DMatrix<f64>) {
        let beside = |k: usize| [k, (k + 3) % ORDER, (5 * k + 1) % ORDER];
        let mut lu = SparseLu::new((0..ORDER).map(|k| beside(k).to_vec()).collect());
        let mut dense = DMatrix::zeros(ORDER, ORDER);
        lu.clear();
        for k in 0..ORDER {
            for (place, &column) in beside(k).iter().enumerate() {
                let value = values[3 * k + place] + if column == k { 3.0 } else { 0.0 };
                lu.add(k, column, value);
                dense[(k, column)] += value;
            }
        }
        lu.factorise(0.0).expect("it is regular");
        (lu, dense)
    }

    proptest! {
        /// Checks Higham's claim that such estimates are hardly ever below a third of the truth.
        #[test]
        fn estimates_come_near_the_truth_from_below(
            values in prop::collection::vec(-1.0..1.0_f64, 3 * ORDER),
            b in prop::collection::vec(0.0..1.0_f64, ORDER),
            product in prop::collection::vec((0..ORDER, 0..ORDER, -1.0..1.0_f64), 1..30),
        ) {
            let (mut lu, dense) = matrix(&values);
            let inverse = dense.try_inverse().expect("it is regular");
            let row = (inverse.abs() * nalgebra::DVector::from_column_slice(&b)).max();
            let mut other = DMatrix::zeros(ORDER, ORDER);
            for &(row, column, value) in &product {
                other[(row, column)] += value;
            }
            let rows = inverse * other;
            let rows = rows.row_iter().map(|row| row.abs().sum());
            let largest = rows.fold(0.0, f64::max);
            let mut condition = Condition::new(ORDER);
            for (estimate, truth) in [
                (condition.largest_row(&mut lu, &b), row),
                (condition.largest_row_of_product(&mut lu, &product), largest),
            ] {
                prop_assert!(estimate <= truth * (1.0 + 1e-12), "{estimate} {truth}");
                prop_assert!(estimate >= 0.1 * truth, "{estimate} {truth}");
            }
        }
    }

    #[test]
    fn the_largest_of_entries_with_nan_is_nan() {
        for place in 0..3 {
            let mut entries = [0.0, 2.0, 0.0];
            let largest = entries.into_iter().fold(0.0, nan_or_larger);
            assert!((largest - 2.0).abs() < f64::EPSILON);
            entries[place] = f64::NAN;
            assert!(entries.into_iter().fold(0.0, nan_or_larger).is_nan());
        }
    }

    #[test]
    fn estimates_with_nan_are_nan() {
        let (mut lu, _) = matrix(&[0.0; 3 * ORDER]);
        let mut condition = Condition::new(ORDER);
        let entries = [(0, 0, f64::NAN), (1, 1, 5.0)];
        assert!(condition.largest_row_of_product(&mut lu, &entries).is_nan());
        let mut b = [1.0; ORDER];
        b[0] = f64::NAN;
        assert!(condition.largest_row(&mut lu, &b).is_nan());
    }
}
