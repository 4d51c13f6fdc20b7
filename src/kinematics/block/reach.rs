//! Whether a kernel in closed form can close at all.

/// A gap below this part of the lengths that it is a difference of may be their rounding, and
/// that of what was found before; a larger one is there.
const MARGIN: f64 = 1e-10;

/// By how much a kernel in closed form fails to close, whatever its angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct Miss {
    /// The least gap \[m\], infinite where it is no number.
    pub(in crate::kinematics) gap: f64,
    /// Whether the gap is more than rounding.
    pub(in crate::kinematics) certain: bool,
}

impl Miss {
    /// That of a gap, which is negative if there is none, between lengths of this sum.
    pub(super) fn new(gap: f64, lengths: f64) -> Self {
        if (gap + lengths).is_finite() {
            Self {
                gap: gap.max(0.0),
                certain: gap > MARGIN * lengths,
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
    /// Between the points \[m\].
    pub(in crate::kinematics) distance: f64,
    /// What the links span folded \[m\].
    pub(in crate::kinematics) shortest: f64,
    /// What they span stretched \[m\].
    pub(in crate::kinematics) longest: f64,
}

impl Reach {
    /// By how much they fail to meet \[m\], negative if they do.
    pub(super) fn gap(self) -> f64 {
        (self.distance - self.longest).max(self.shortest - self.distance)
    }
}
