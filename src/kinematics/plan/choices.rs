//! The effects of earlier steps on a block, apart from its pose.

use crate::kinematics::linear::PivotOrder;

/// Numbers that a block with a sparse matrix takes over from earlier steps, besides the pose.
///
/// Proofs of smaller blocks that hold for several steps have no effect on further results and are
/// no part of it.
#[derive(Debug, Default, PartialEq)]
pub struct BlockChoices {
    /// Pivots of its Jacobian, and of the one in the middle of a chord.
    pub pivots: [PivotOrder; 2],
    /// The line along which it was tested last.
    pub segment: CheckedSegment,
}

/// A line along which a block was tested to be regular.
#[derive(Debug, Default, PartialEq)]
pub struct CheckedSegment {
    /// Whether the test was passed; otherwise the numbers have no meaning.
    pub holds: bool,
    /// The block's own unknowns at its beginning, then the upstream ones.
    pub start: Vec<f64>,
    /// The moves of the own unknowns from its beginning to its end.
    pub way: Vec<f64>,
    /// Index of the own unknown that moves most.
    pub leading: usize,
    /// Scaled radius within which there is one root.
    pub radius: f64,
    /// Scaled bound of the distance of the root from the line.
    pub off: f64,
    /// Scaled bound of the distance of the root from the chord of the first step.
    pub off_single: f64,
    /// Largest deviation of the driver from the chord of a step.
    pub driver_deviation: f64,
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
        self.segment.clone_from(&source.segment);
    }
}

impl Clone for CheckedSegment {
    fn clone(&self) -> Self {
        let mut clone = Self::default();
        clone.clone_from(self);
        clone
    }

    /// Copies without allocation where the sizes agree.
    fn clone_from(&mut self, source: &Self) {
        // Destructured, so that the compiler reports a new field.
        let Self {
            holds,
            start,
            way,
            leading,
            radius,
            off,
            off_single,
            driver_deviation,
        } = source;
        self.start.clone_from(start);
        self.way.clone_from(way);
        (self.holds, self.leading) = (*holds, *leading);
        (self.radius, self.off) = (*radius, *off);
        (self.off_single, self.driver_deviation) = (*off_single, *driver_deviation);
    }
}
