//! Lower triangular factors L, in the first rows and columns of a matrix. Nothing allocates.

use nalgebra::DMatrix;

/// Solves L y = x in place.
pub(super) fn descend(l: &DMatrix<f64>, x: &mut [f64]) {
    for row in 0..x.len() {
        let sum: f64 = (0..row).map(|k| l[(row, k)] * x[k]).sum();
        x[row] = (x[row] - sum) / l[(row, row)];
    }
}

/// Solves Lᵀ y = x in place.
pub(super) fn ascend(l: &DMatrix<f64>, x: &mut [f64]) {
    for row in (0..x.len()).rev() {
        let sum: f64 = (row + 1..x.len()).map(|k| l[(k, row)] * x[k]).sum();
        x[row] = (x[row] - sum) / l[(row, row)];
    }
}

/// Replaces the lower triangle of a symmetric matrix of `order` rows by its factor L, W = L Lᵀ. A row
/// that depends on those before it gets an infinite diagonal: its solution is zero.
pub(super) fn factorise(w: &mut DMatrix<f64>, order: usize) {
    /// Part of the diagonal at which a pivot is rounding.
    const DEPENDENT: f64 = 1e-11;
    for column in 0..order {
        let square = |k: usize| w[(column, k)] * w[(column, k)];
        let pivot = w[(column, column)] - (0..column).map(square).sum::<f64>();
        let is_dependent = pivot.is_nan() || pivot <= DEPENDENT * w[(column, column)];
        w[(column, column)] = if is_dependent {
            f64::INFINITY
        } else {
            pivot.sqrt()
        };
        for row in column + 1..order {
            let products = (0..column).map(|k| w[(row, k)] * w[(column, k)]);
            let rest = w[(row, column)] - products.sum::<f64>();
            w[(row, column)] = rest / w[(column, column)];
        }
    }
}
