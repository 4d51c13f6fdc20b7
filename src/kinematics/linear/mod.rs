//! Linear algebra: square matrices, factorised and solved in place, and the rank of sparse rows.
//!
//! It knows numbers only, no equations. Storage of factorised matrices is made once; nothing
//! allocates afterwards, unless a sparse matrix has changed so much that its pivots have to be
//! chosen again.

mod condition;
mod dense;
mod echelon;
mod factors;
mod lu;
mod norm;
mod sparse;
mod spread;

pub(super) use condition::Condition;
pub(crate) use dense::DenseLu;
pub(super) use dense::{dot, subtract};
pub(super) use echelon::{Echelon, ReducedRow, Row};
pub(crate) use factors::{Factors, Singular};
pub(super) use lu::Lu;
pub(super) use norm::nan_or_larger;
pub use sparse::PivotOrder;
pub(super) use sparse::SparseLu;
pub(super) use spread::spread;
