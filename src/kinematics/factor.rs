//! Linear algebra of the solver: one square matrix, factorised and solved in place.
//!
//! This is the other side of the seam to the equations: it knows numbers only. Storage is made
//! once; nothing here allocates afterwards.

use nalgebra::linalg::{gauss_step, gauss_step_swap};
use nalgebra::{DMatrix, DVector};

/// A dense matrix and its LU factorisation with partial pivoting.
///
/// Fill with [`clear`](Self::clear) and [`add`](Self::add), then [`factorise`](Self::factorise),
/// then solve as often as wanted.
#[derive(Clone, Debug)]
pub struct DenseLu {
    matrix: DMatrix<f64>,
    /// Row exchanged with row k at step k.
    pivots: Vec<usize>,
    /// Leading pivots that are taken from the diagonal as they come.
    fixed: usize,
    /// 1-norm of the matrix before factorisation, or what it is measured against if larger.
    norm: f64,
    /// Work space of the condition estimate.
    probe: DVector<f64>,
    signs: Vec<f64>,
}

/// The matrix has a pivot of exactly zero or a value that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular;

impl DenseLu {
    /// Storage for a matrix of order `order`, whose first `fixed` diagonal entries are ±1
    /// throughout the elimination: they need no search, and where their rows and columns are
    /// nearly empty they cost next to nothing.
    #[must_use]
    pub fn new(order: usize, fixed: usize) -> Self {
        Self {
            fixed,
            matrix: DMatrix::zeros(order, order),
            pivots: vec![0; order],
            norm: 0.0,
            probe: DVector::zeros(order),
            signs: vec![0.0; order],
        }
    }

    /// Sets the matrix to zero.
    pub fn clear(&mut self) {
        self.matrix.fill(0.0);
    }

    /// Adds to an entry.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.matrix[(row, column)] += value;
    }

    /// Replaces the matrix by its factors. [`rcond`](Self::rcond) counts the matrix as at least
    /// `least_norm` large.
    ///
    /// # Errors
    ///
    /// [`Singular`] on a pivot that is zero or not finite. A matrix that is singular only up to
    /// rounding passes; [`rcond`](Self::rcond) tells.
    pub fn factorise(&mut self, least_norm: f64) -> Result<(), Singular> {
        self.norm = self
            .matrix
            .column_iter()
            .map(|column| column.lp_norm(1))
            .fold(least_norm, f64::max);
        for k in 0..self.fixed {
            self.eliminate(k)?;
        }
        for k in self.fixed..self.matrix.nrows() {
            let pivot_row = k + self.matrix.view_range(k.., k).icamax();
            let pivot = self.matrix[(pivot_row, k)];
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(Singular);
            }
            self.pivots[k] = pivot_row;
            if pivot_row == k {
                gauss_step(&mut self.matrix, pivot, k);
            } else {
                self.matrix.columns_range_mut(..k).swap_rows(k, pivot_row);
                gauss_step_swap(&mut self.matrix, pivot, k, pivot_row);
            }
        }
        Ok(())
    }

    /// Step k of the elimination with the pivot on the diagonal, leaving alone what is zero.
    fn eliminate(&mut self, k: usize) -> Result<(), Singular> {
        let pivot = self.matrix[(k, k)];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular);
        }
        self.pivots[k] = k;
        let order = self.matrix.nrows();
        let (mut left, mut right) = self.matrix.columns_range_pair_mut(0..k + 1, k + 1..);
        let mut factors = left.view_range_mut(k + 1.., k);
        factors /= pivot;
        for mut column in right.column_iter_mut() {
            let above = column[k];
            if above != 0.0 {
                column
                    .rows_range_mut(k + 1..order)
                    .axpy(-above, &factors, 1.0);
            }
        }
        Ok(())
    }

    /// Solves A x = b, `b` becoming x.
    pub fn solve(&self, b: &mut DVector<f64>) {
        for (k, &pivot_row) in self.pivots.iter().enumerate() {
            b.swap_rows(k, pivot_row);
        }
        self.matrix.solve_lower_triangular_with_diag_mut(b, 1.0);
        self.matrix.solve_upper_triangular_mut(b);
    }

    /// Solves Aᵀ x = b, `b` becoming x.
    pub fn solve_transposed(&self, b: &mut DVector<f64>) {
        self.matrix.tr_solve_upper_triangular_mut(b);
        for k in (0..b.len()).rev() {
            let below = self.matrix.view_range(k + 1.., k);
            let known = below.dot(&b.rows_range(k + 1..));
            b[k] -= known;
        }
        for (k, &pivot_row) in self.pivots.iter().enumerate().rev() {
            b.swap_rows(k, pivot_row);
        }
    }

    /// Whether the determinant is negative.
    #[must_use]
    pub fn determinant_is_negative(&self) -> bool {
        self.pivots
            .iter()
            .enumerate()
            .fold(false, |negative, (k, &pivot_row)| {
                negative ^ (pivot_row != k) ^ (self.matrix[(k, k)] < 0.0)
            })
    }

    /// Whether the reciprocal condition is below `limit`. Cheap where it clearly is not.
    pub fn is_singular(&mut self, limit: f64) -> bool {
        let pivots = (0..self.pivots.len()).map(|k| self.matrix[(k, k)].abs());
        let (low, high) = pivots.fold((f64::INFINITY, self.norm), |(low, high), pivot| {
            (low.min(pivot), high.max(pivot))
        });
        // With rows and columns scaled, pivots of similar size mean a good condition; the factor
        // leaves room for the cases where they hide a bad one.
        low < 1e3 * limit * high && self.rcond() < limit
    }

    /// Estimate of 1 / (‖A‖₁ ‖A⁻¹‖₁), by Hager's method with Higham's extra vector
    /// (N. J. Higham, ACM Trans. Math. Softw. 14 (1988) 381–396). Never below the true value.
    pub fn rcond(&mut self) -> f64 {
        let order = self.matrix.nrows();
        if order == 0 {
            return 1.0;
        }
        let n = order as f64;
        let mut probe = std::mem::replace(&mut self.probe, DVector::zeros(0));
        probe.fill(1.0 / n);
        let mut inverse_norm = 0.0_f64;
        let mut previous = usize::MAX;
        // Higham: more than five rounds are never needed in practice.
        for _ in 0..5 {
            self.solve(&mut probe);
            inverse_norm = inverse_norm.max(probe.lp_norm(1));
            for (sign, value) in self.signs.iter_mut().zip(&probe) {
                *sign = 1.0_f64.copysign(*value);
            }
            probe.copy_from_slice(&self.signs);
            self.solve_transposed(&mut probe);
            let steepest = probe.icamax();
            if steepest == previous {
                break;
            }
            previous = steepest;
            probe.fill(0.0);
            probe[steepest] = 1.0;
        }
        // A vector of alternating, growing entries catches what the iteration may miss.
        for (k, value) in probe.iter_mut().enumerate() {
            let grown = 1.0 + k as f64 / (n - 1.0).max(1.0);
            *value = if k % 2 == 0 { grown } else { -grown };
        }
        self.solve(&mut probe);
        inverse_norm = inverse_norm.max(2.0 * probe.lp_norm(1) / (3.0 * n));
        self.probe = probe;
        let rcond = 1.0 / (self.norm * inverse_norm);
        if rcond.is_finite() { rcond } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn filled(order: usize, values: &[f64]) -> (DenseLu, DMatrix<f64>) {
        let matrix = DMatrix::from_column_slice(order, order, &values[..order * order]);
        let mut lu = DenseLu::new(order, 0);
        lu.clear();
        for row in 0..order {
            for column in 0..order {
                lu.add(row, column, matrix[(row, column)]);
            }
        }
        (lu, matrix)
    }

    proptest! {
        // The oracle is nalgebra's own LU and inverse; the error bound of a backward stable
        // solve is some n eps / rcond.
        #[test]
        fn agrees_with_nalgebra(order in 1_usize..8, values in prop::collection::vec(-1.0..1.0_f64, 64)) {
            let (mut lu, matrix) = filled(order, &values);
            let Some(inverse) = matrix.clone().try_inverse() else { return Ok(()) };
            let norm1 = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
            let rcond = 1.0 / (norm1(&matrix) * norm1(&inverse));
            prop_assume!(rcond > 1e-8);
            lu.factorise(0.0).unwrap();
            let b = DVector::from_fn(order, |k, _| values[63 - k]);
            let tolerance = 100.0 * order as f64 * f64::EPSILON / rcond;
            let mut x = b.clone();
            lu.solve(&mut x);
            let truth = &inverse * &b;
            prop_assert!((&x - &truth).amax() <= tolerance * truth.amax().max(b.amax()));
            let mut x = b.clone();
            lu.solve_transposed(&mut x);
            let truth = inverse.transpose() * &b;
            prop_assert!((&x - &truth).amax() <= tolerance * truth.amax().max(b.amax()));
            prop_assert_eq!(lu.determinant_is_negative(), matrix.determinant() < 0.0);
            // Hager's estimate is an upper bound of rcond and seldom off by more than three.
            let estimate = lu.rcond();
            prop_assert!(estimate >= rcond * (1.0 - 1e-6), "{estimate} {rcond}");
            prop_assert!(estimate <= rcond * 10.0, "{estimate} {rcond}");
        }
    }

    #[test]
    fn zero_column_is_singular() {
        let (mut lu, _) = filled(2, &[0.0, 0.0, 1.0, 2.0]);
        assert_eq!(lu.factorise(0.0), Err(Singular));
    }

    #[test]
    fn infinite_entry_is_singular() {
        let (mut lu, _) = filled(2, &[f64::INFINITY, 0.0, 1.0, 2.0]);
        assert_eq!(lu.factorise(0.0), Err(Singular));
    }
}
