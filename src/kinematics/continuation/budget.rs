//! The work that may be spent.

use crate::mechanism::{Joint, Mechanism, rounded};

/// Work of a usual budget \[s\], on a processor of 3 GHz: twice as much keeps a host waiting twice as
/// long for a step that leads nowhere.
const WORK: f64 = 1.0;
/// Work of a sub-step to a trial pose per body \[s\].
const OF_BODY: f64 = 0.3e-6;
/// Number of freedoms whose equations of motion take as long as the poses.
const FREEDOMS: f64 = 10.0;
/// Work of a sub-step per contour of a cam \[s\].
const OF_CONTOUR: f64 = 30e-6;
/// Most sub-steps of a usual budget. The shipped mechanism that takes the most, an engine, takes 11,700
/// for a second in one step: half as many would do, twice as many only wait longer.
const MOST: f64 = 300_000.0;
/// Fewest sub-steps, for a mechanism of any size: some 700 steps of the integrator, with which a chain of
/// forty links moves for a second. Half as many would refuse some motions that people wait for.
const FEWEST: f64 = 10_000.0;

/// The number of sub-steps that a solver may take, over all its paths: rejected ones and those to trial
/// poses included. A count, and no time, so that the same input has the same result on each machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    most: u32,
    pub(super) left: u32,
}

impl Budget {
    /// No limit.
    pub const UNLIMITED: Self = Self::of(u32::MAX);

    /// Returns the budget of a step of a mechanism, unless another one is asked for: about a second of
    /// free motion. Without freedoms paths have [limits of their own](super::Reason::TooLong).
    #[must_use]
    pub fn usual(mechanism: &Mechanism) -> Self {
        let freedoms = mechanism.drivers.iter().filter(|driver| driver.is_free());
        let freedoms = freedoms.count();
        if freedoms == 0 {
            return Self::of(MOST as u32);
        }
        let contours = mechanism.joints.iter().filter_map(Joint::cam).count();
        let poses = OF_BODY * mechanism.bodies.len() as f64 + OF_CONTOUR * contours as f64;
        let work = poses * (1.0 + (freedoms as f64 / FREEDOMS).powi(2));
        Self::of(rounded(WORK / work, 1).clamp(FEWEST, MOST) as u32)
    }

    /// Makes a budget of this many sub-steps.
    #[must_use]
    pub const fn of(most: u32) -> Self {
        Self { most, left: most }
    }

    /// Returns the number of sub-steps that it had at first.
    #[must_use]
    pub fn most(self) -> u32 {
        self.most
    }

    /// Returns the number of sub-steps that were taken.
    #[must_use]
    pub fn spent(self) -> u32 {
        self.most - self.left
    }

    /// Spends sub-steps.
    pub(in crate::kinematics) fn spend(&mut self, substeps: u32) {
        self.left = self.left.saturating_sub(substeps);
    }
}
