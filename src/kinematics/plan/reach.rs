//! The gap that a block in closed form cannot close.

use crate::kinematics::tolerances::CERTAIN_GAP;

/// The gap that a block in closed form leaves, whatever its angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct ClosureGap {
    /// The least gap \[m\], infinite where it is no number.
    pub(in crate::kinematics) gap: f64,
    /// Whether the gap is more than rounding.
    pub(in crate::kinematics) certain: bool,
}

impl ClosureGap {
    /// Judges a gap, negative if there is none, between lengths of this sum.
    pub(super) fn new(gap: f64, lengths: f64) -> Self {
        if (gap + lengths).is_finite() {
            Self {
                gap: gap.max(0.0),
                certain: gap > CERTAIN_GAP * lengths,
            }
        } else {
            Self {
                gap: f64::INFINITY,
                certain: false,
            }
        }
    }
}

/// Two links between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct Reach {
    /// Distance of the points \[m\].
    pub(in crate::kinematics) distance: f64,
    /// Distance that the links span folded \[m\].
    pub(in crate::kinematics) shortest: f64,
    /// Distance that the links span stretched \[m\].
    pub(in crate::kinematics) longest: f64,
}

impl Reach {
    /// Returns the gap that the links leave \[m\], negative if they meet.
    pub(super) fn gap(self) -> f64 {
        (self.distance - self.longest).max(self.shortest - self.distance)
    }
}
