//! The interface of factorised matrices.

/// The matrix has a pivot of exactly zero or a value that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular;

/// A factorised matrix A.
pub trait Factors {
    /// Returns the number of rows.
    fn order(&self) -> usize;

    /// Returns the 1-norm of A, or its least norm if that is larger.
    fn norm(&self) -> f64;

    /// Solves A x = b and writes x to `b`.
    fn solve(&mut self, b: &mut [f64]);

    /// Solves Aᵀ x = b and writes x to `b`.
    fn solve_transposed(&mut self, b: &mut [f64]);
}
