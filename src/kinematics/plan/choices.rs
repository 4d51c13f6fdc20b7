//! Choices of a block that its pose does not determine.

use crate::kinematics::linear::PivotOrder;

/// Choices that a block with a sparse matrix has made in earlier steps and keeps.
#[derive(Debug, Default, PartialEq)]
pub struct BlockChoices {
    /// Pivots of its Jacobian, and of the one in the middle of a chord.
    pub pivots: [PivotOrder; 2],
}

impl Clone for BlockChoices {
    fn clone(&self) -> Self {
        let mut clone = Self::default();
        clone.clone_from(self);
        clone
    }

    /// Copies without allocation where the sizes agree.
    fn clone_from(&mut self, source: &Self) {
        self.pivots.clone_from(&source.pivots);
    }
}
