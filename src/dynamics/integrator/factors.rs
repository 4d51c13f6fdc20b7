//! LU factors of a small matrix, in place.

use nalgebra::DMatrix;

/// The matrix has a pivot that is zero or not finite.
#[derive(Debug)]
pub(super) struct Singular;

/// A square matrix and its LU factors with partial pivoting.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    /// The matrix, or its factors.
    pub(super) matrix: DMatrix<f64>,
    /// Row exchanged with row k at elimination k.
    pivots: Vec<usize>,
}

impl Factors {
    /// Makes the storage.
    pub(super) fn new(order: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(order, order),
            pivots: vec![0; order],
        }
    }

    /// Replaces the matrix by its factors.
    pub(super) fn factorise(&mut self) -> Result<(), Singular> {
        let order = self.pivots.len();
        let columns = self.matrix.as_mut_slice();
        for k in 0..order {
            let (left, right) = columns.split_at_mut((k + 1) * order);
            let column = &mut left[k * order..];
            let larger = |a: usize, b: usize| {
                if column[b].abs() > column[a].abs() {
                    b
                } else {
                    a
                }
            };
            let pivot = (k + 1..order).fold(k, larger);
            if column[pivot] == 0.0 || !column[pivot].is_finite() {
                return Err(Singular);
            }
            self.pivots[k] = pivot;
            column.swap(k, pivot);
            for row in k + 1..order {
                column[row] /= column[k];
            }
            for other in right.chunks_exact_mut(order) {
                other.swap(k, pivot);
                let factor = other[k];
                for row in k + 1..order {
                    other[row] -= column[row] * factor;
                }
            }
        }
        Ok(())
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let order = x.len();
        let columns = || {
            self.matrix
                .as_slice()
                .chunks_exact(order.max(1))
                .enumerate()
        };
        // The left factors are stored without the exchanges of later eliminations.
        for (k, column) in columns() {
            x.swap(k, self.pivots[k]);
            for row in k + 1..order {
                x[row] -= column[row] * x[k];
            }
        }
        for (k, column) in columns().rev() {
            x[k] /= column[k];
            for row in 0..k {
                x[row] -= column[row] * x[k];
            }
        }
    }
}
