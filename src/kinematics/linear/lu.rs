//! The matrix of a block of equations.

use super::dense::DenseLu;
use super::factors::{Factors, Singular};
use super::sparse::{PivotOrder, SparseLu};

/// The matrix of a block, dense or sparse.
#[derive(Clone, Debug)]
pub enum Lu {
    /// Dense, for few unknowns.
    Dense(DenseLu),
    /// Sparse, for many unknowns.
    Sparse(Box<SparseLu>),
}

impl Lu {
    /// Sets the matrix to zero.
    pub fn clear(&mut self) {
        match self {
            Self::Dense(lu) => lu.clear(),
            Self::Sparse(lu) => lu.clear(),
        }
    }

    /// Adds to an entry; one outside the pattern of a sparse matrix is left out.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        match self {
            Self::Dense(lu) => lu.add(row, column, value),
            Self::Sparse(lu) => lu.add(row, column, value),
        }
    }

    /// Returns the entries of this matrix minus those of another sparse one of the same pattern,
    /// factorised or not: row, column, value.
    ///
    /// # Panics
    ///
    /// If one of them is dense: factors take the place of its entries.
    pub fn differences<'a>(
        &'a self,
        other: &'a Self,
    ) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
        match (self, other) {
            (Self::Sparse(lu), Self::Sparse(other)) => lu.differences(other),
            _ => panic!("the entries of dense matrices are gone"),
        }
    }

    /// Replaces the matrix by its factors. Its norm counts as at least `least_norm`.
    ///
    /// # Errors
    ///
    /// [`Singular`] on a pivot that is zero or not finite.
    pub fn factorise(&mut self, least_norm: f64) -> Result<(), Singular> {
        match self {
            Self::Dense(lu) => lu.factorise(least_norm),
            Self::Sparse(lu) => lu.factorise(least_norm),
        }
    }

    /// Lets the next factorisation choose its pivots; that of a dense matrix always does.
    pub fn forget_pivots(&mut self) {
        if let Self::Sparse(lu) = self {
            lu.forget_pivots();
        }
    }

    /// Copies the pivots that the matrix keeps to `order`; none are kept by a dense matrix.
    pub fn copy_pivots(&self, order: &mut PivotOrder) {
        match self {
            Self::Dense(_) => order.clone_from(&PivotOrder::default()),
            Self::Sparse(lu) => lu.copy_pivots(order),
        }
    }

    /// Uses these pivots from the next factorisation on. Returns false if they do not fit.
    pub fn use_pivots(&mut self, order: &PivotOrder) -> bool {
        match self {
            Self::Dense(_) => *order == PivotOrder::default(),
            Self::Sparse(lu) => lu.use_pivots(order),
        }
    }

    /// Returns the magnitudes of the smallest and the largest pivot.
    #[must_use]
    pub fn pivot_range(&self) -> (f64, f64) {
        match self {
            Self::Dense(lu) => lu.pivot_range(),
            Self::Sparse(lu) => lu.pivot_range(),
        }
    }
}

impl Factors for Lu {
    fn order(&self) -> usize {
        match self {
            Self::Dense(lu) => lu.order(),
            Self::Sparse(lu) => lu.order(),
        }
    }

    fn norm(&self) -> f64 {
        match self {
            Self::Dense(lu) => lu.norm(),
            Self::Sparse(lu) => lu.norm(),
        }
    }

    fn solve(&mut self, b: &mut [f64]) {
        match self {
            Self::Dense(lu) => lu.solve(b),
            Self::Sparse(lu) => lu.solve(b),
        }
    }

    fn solve_transposed(&mut self, b: &mut [f64]) {
        match self {
            Self::Dense(lu) => lu.solve_transposed(b),
            Self::Sparse(lu) => lu.solve_transposed(b),
        }
    }
}
