//! The approach to a singular position, of which a user is warned.

use std::fmt;

use super::{LARGEST_BLOCK, NEAR};
use crate::kinematics::error::in_line;
use crate::kinematics::solver::Solver;

/// A mechanism that has come near a singular position.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// Scaled reciprocal condition.
    pub rcond: f64,
    /// The bodies that all but line up.
    pub bodies: Vec<String>,
}

/// A reciprocal condition below this is worth a warning: links are in line to less than a tenth
/// of a degree, and what drives them moves some thousand times as slowly as they do.
const WARNED: f64 = 1e-3;
/// Above this the mechanism is away again, and the next approach another one.
const AWAY: f64 = 1e-2;

impl fmt::Display for Approach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "near a singular position, with a reciprocal condition of {:.1e}: {}",
            self.rcond,
            in_line(&self.bodies, "all but ")
        )
    }
}

impl Solver {
    /// Whether the mechanism, at the end of a path, has come near a singular position since
    /// `near` was last false, which is true from then on until it is away again. Next to a change
    /// point that is crossed there is nothing to warn of. Away from all of them it costs a
    /// comparison.
    pub fn approach(&mut self, near: &mut bool) -> Option<Approach> {
        if !self.pose.crossings.is_empty() || (!*near && self.regularity >= NEAR) {
            return None;
        }
        let rcond = self.rcond();
        if rcond > AWAY {
            *near = false;
        }
        if *near || rcond >= WARNED {
            return None;
        }
        *near = true;
        Some(Approach {
            rcond,
            bodies: self.weakest_bodies(),
        })
    }

    /// The bodies of the kernel that is nearest to a singular position, those that its weakest
    /// direction moves if that can be found.
    pub(super) fn weakest_bodies(&mut self) -> Vec<String> {
        let mut weakest = (f64::INFINITY, 0);
        for (index, kernel) in self.plan.kernels.iter_mut().enumerate() {
            let rcond = kernel.rcond();
            if rcond < weakest.0 {
                weakest = (rcond, index);
            }
        }
        let Some(kernel) = self.plan.kernels.get(weakest.1) else {
            return Vec::new();
        };
        let columns = kernel.columns();
        let mut free = vec![1.0; columns.len()];
        if columns.len() <= LARGEST_BLOCK {
            let svd = self.block_jacobian(weakest.1).svd(false, true);
            if let Some(right) = svd.v_t {
                let least = right.row(right.nrows() - 1);
                let largest = least.amax();
                free = least.iter().map(|value| value / largest).collect();
            }
        }
        self.bodies_of(columns, &free)
    }
}
