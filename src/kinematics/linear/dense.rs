//! A dense matrix and its LU factorisation.

use nalgebra::linalg::{gauss_step, gauss_step_swap};
use nalgebra::{DMatrix, DVectorViewMut};

use super::factors::{Factors, Singular};

/// A dense matrix and its LU factorisation with partial pivoting.
///
/// Fill with [`clear`](Self::clear) and [`add`](Self::add), then [`factorise`](Self::factorise),
/// then solve any number of times.
#[derive(Clone, Debug)]
pub struct DenseLu {
    matrix: DMatrix<f64>,
    /// Row exchanged with row k at step k.
    pivots: Vec<usize>,
    /// Number of leading pivots that are taken from the diagonal in order.
    fixed: usize,
    /// 1-norm of the matrix before factorisation, or the least norm if that is larger.
    norm: f64,
}

impl DenseLu {
    /// Makes the storage of a matrix of order `order`, whose first `fixed` diagonal entries are ±1
    /// throughout the elimination: they need no search, and cost next to nothing where their rows
    /// and columns are nearly empty.
    #[must_use]
    pub fn new(order: usize, fixed: usize) -> Self {
        Self {
            fixed,
            matrix: DMatrix::zeros(order, order),
            pivots: vec![0; order],
            norm: 0.0,
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

    /// Replaces the matrix by its factors. Its norm counts as at least `least_norm`.
    ///
    /// # Errors
    ///
    /// [`Singular`] on a pivot that is zero or not finite. A matrix that is singular up to rounding
    /// passes; its condition is then near zero.
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

    /// Does step k of the elimination with the pivot on the diagonal, without the zeros.
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

    /// Returns the magnitudes of the smallest and the largest pivot.
    #[must_use]
    pub fn pivot_range(&self) -> (f64, f64) {
        let pivots = (0..self.pivots.len()).map(|k| self.matrix[(k, k)].abs());
        pivots.fold((f64::INFINITY, 0.0_f64), |(low, high), pivot| {
            (low.min(pivot), high.max(pivot))
        })
    }
}

impl Factors for DenseLu {
    fn order(&self) -> usize {
        self.matrix.nrows()
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    fn solve(&mut self, b: &mut [f64]) {
        let order = b.len();
        let mut b = DVectorViewMut::from_slice(b, order);
        for (k, &pivot_row) in self.pivots.iter().enumerate() {
            b.swap_rows(k, pivot_row);
        }
        self.matrix
            .solve_lower_triangular_with_diag_mut(&mut b, 1.0);
        self.matrix.solve_upper_triangular_mut(&mut b);
    }

    fn solve_transposed(&mut self, b: &mut [f64]) {
        let order = b.len();
        let mut b = DVectorViewMut::from_slice(b, order);
        self.matrix.tr_solve_upper_triangular_mut(&mut b);
        for k in (0..order).rev() {
            let below = self.matrix.view_range(k + 1.., k);
            let known = below.dot(&b.rows_range(k + 1..));
            b[k] -= known;
        }
        for (k, &pivot_row) in self.pivots.iter().enumerate().rev() {
            b.swap_rows(k, pivot_row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::linear::Condition;
    use nalgebra::DVector;
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
            lu.solve(x.as_mut_slice());
            let truth = &inverse * &b;
            prop_assert!((&x - &truth).amax() <= tolerance * truth.amax().max(b.amax()));
            let mut x = b.clone();
            lu.solve_transposed(x.as_mut_slice());
            let truth = inverse.transpose() * &b;
            prop_assert!((&x - &truth).amax() <= tolerance * truth.amax().max(b.amax()));
            // Hager's estimate is an upper bound of rcond, seldom by more than a factor of three.
            let estimate = Condition::new(order).rcond(&mut lu);
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
