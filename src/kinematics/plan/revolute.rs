//! The revolutes of block solvers.

use crate::mechanism::MarkerId;

/// The two rows of a revolute: its points coincide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Revolute {
    /// The rows of x and y.
    pub(super) rows: [usize; 2],
    pub(super) from: MarkerId,
    pub(super) to: MarkerId,
}

impl Revolute {
    /// Returns +1 if it counts to a marker, −1 if it counts from there.
    pub(super) fn sense_to(self, marker: MarkerId) -> f64 {
        if self.to == marker { 1.0 } else { -1.0 }
    }
}
