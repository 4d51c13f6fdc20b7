//! A matrix that can be solved with.

/// The matrix has a pivot of exactly zero or a value that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular;

/// A factorised matrix A.
pub trait Factors {
    /// The number of its rows.
    fn order(&self) -> usize;

    /// The 1-norm that A counts as having.
    fn norm(&self) -> f64;

    /// Solves A x = b, `b` becoming x.
    fn solve(&mut self, b: &mut [f64]);

    /// Solves Aᵀ x = b, `b` becoming x.
    fn solve_transposed(&mut self, b: &mut [f64]);
}
