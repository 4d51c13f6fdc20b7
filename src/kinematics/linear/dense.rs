//! A dense matrix and its LU factorisation.

use super::factors::{Factors, Singular};

/// A dense matrix and its LU factorisation with partial pivoting.
///
/// Fill with [`clear`](Self::clear) and [`add`](Self::add), then [`factorise`](Self::factorise),
/// then solve any number of times.
#[derive(Clone, Debug)]
pub struct DenseLu {
    /// The matrix or its factors, column by column.
    entries: Vec<f64>,
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
            entries: vec![0.0; order * order],
            pivots: vec![0; order],
            norm: 0.0,
        }
    }

    /// Sets the matrix to zero.
    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Adds to an entry.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[column * self.pivots.len() + row] += value;
    }

    /// Replaces the matrix by its factors. Its norm counts as at least `least_norm`.
    ///
    /// # Errors
    ///
    /// [`Singular`] on a pivot that is zero or not finite. A matrix that is singular up to rounding
    /// passes; its condition is then near zero.
    pub fn factorise(&mut self, least_norm: f64) -> Result<(), Singular> {
        // Compiled once for each of the orders that occur most: those of small blocks, and that of a
        // dyad near a change point.
        match self.pivots.len() {
            1 => self.decompose(1, least_norm),
            2 => self.decompose(2, least_norm),
            3 => self.decompose(3, least_norm),
            4 => self.decompose(4, least_norm),
            7 => self.decompose(7, least_norm),
            order => self.decompose(order, least_norm),
        }
    }

    /// Factorises the matrix, which is of this order.
    #[inline(always)]
    fn decompose(&mut self, order: usize, least_norm: f64) -> Result<(), Singular> {
        if order == 0 {
            return Ok(());
        }
        let (entries, pivots) = (
            &mut self.entries[..order * order],
            &mut self.pivots[..order],
        );
        let columns = entries.chunks_exact(order);
        let norms = columns.map(|column| column.iter().map(|entry| entry.abs()).sum());
        self.norm = norms.fold(least_norm, f64::max);
        for k in 0..order {
            let column = &entries[k * order..(k + 1) * order];
            let mut pivot_row = k;
            if k >= self.fixed {
                for row in k + 1..order {
                    if column[row].abs() > column[pivot_row].abs() {
                        pivot_row = row;
                    }
                }
            }
            let pivot = column[pivot_row];
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(Singular);
            }
            pivots[k] = pivot_row;
            if pivot_row != k {
                for column in entries.chunks_exact_mut(order) {
                    column.swap(k, pivot_row);
                }
            }
            let (left, right) = entries.split_at_mut((k + 1) * order);
            let factors = &mut left[k * order + k + 1..];
            let per_pivot = 1.0 / pivot;
            factors.iter_mut().for_each(|factor| *factor *= per_pivot);
            for column in right.chunks_exact_mut(order) {
                let above = column[k];
                if above != 0.0 {
                    subtract(&mut column[k + 1..], above, factors);
                }
            }
        }
        Ok(())
    }

    /// Solves A x = b, which is of this order.
    #[inline(always)]
    fn substitute(&self, order: usize, b: &mut [f64]) {
        let (entries, pivots) = (&self.entries[..order * order], &self.pivots[..order]);
        let b = &mut b[..order];
        for (k, &pivot_row) in pivots.iter().enumerate() {
            b.swap(k, pivot_row);
        }
        for k in 0..order {
            let (known, below) = b.split_at_mut(k + 1);
            subtract(
                below,
                known[k],
                &entries[k * order + k + 1..(k + 1) * order],
            );
        }
        for k in (0..order).rev() {
            let column = &entries[k * order..(k + 1) * order];
            b[k] /= column[k];
            let (above, known) = b.split_at_mut(k);
            subtract(above, known[0], &column[..k]);
        }
    }

    /// Returns column k of the factors.
    fn column(&self, k: usize) -> &[f64] {
        let order = self.pivots.len();
        &self.entries[k * order..(k + 1) * order]
    }

    /// Returns the magnitudes of the smallest and the largest pivot.
    #[must_use]
    pub fn pivot_range(&self) -> (f64, f64) {
        let pivots = (0..self.pivots.len()).map(|k| self.column(k)[k].abs());
        pivots.fold((f64::INFINITY, 0.0_f64), |(low, high), pivot| {
            (low.min(pivot), high.max(pivot))
        })
    }
}

impl Factors for DenseLu {
    fn order(&self) -> usize {
        self.pivots.len()
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    fn solve(&mut self, b: &mut [f64]) {
        match self.pivots.len() {
            1 => self.substitute(1, b),
            2 => self.substitute(2, b),
            3 => self.substitute(3, b),
            4 => self.substitute(4, b),
            7 => self.substitute(7, b),
            order => self.substitute(order, b),
        }
    }

    fn solve_transposed(&mut self, b: &mut [f64]) {
        for k in 0..b.len() {
            let column = self.column(k);
            b[k] = (b[k] - dot(&column[..k], &b[..k])) / column[k];
        }
        for k in (0..b.len()).rev() {
            b[k] -= dot(&self.column(k)[k + 1..], &b[k + 1..]);
        }
        for (k, &pivot_row) in self.pivots.iter().enumerate().rev() {
            b.swap(k, pivot_row);
        }
    }
}

/// Subtracts `factor` · `column` from `from`.
pub(in crate::kinematics) fn subtract(from: &mut [f64], factor: f64, column: &[f64]) {
    for (value, entry) in from.iter_mut().zip(column) {
        *value -= factor * entry;
    }
}

/// Returns the scalar product of two vectors.
pub(in crate::kinematics) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::linear::Condition;
    use nalgebra::{DMatrix, DVector};
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
