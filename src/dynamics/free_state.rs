//! All numbers on which a free motion depends.

use super::integrator::State;
use super::passive::{Mode, Passive};
use crate::mechanism::{Corner, Jet};

/// All numbers on which the motion depends besides the solver's pose and choices: a motion that is
/// given them goes on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeState {
    /// Values and velocities of the freedoms, the work, and the integrator's own numbers.
    pub integrator: State,
    /// Relative tolerance.
    pub tolerance: f64,
    /// The coordinates in use, one per freedom: the file's own freedoms come first, then those of
    /// joints.
    pub coordinates: Vec<usize>,
    /// Value, velocity and acceleration of each driver at the present point.
    pub drivers: Vec<Jet>,
    /// Sizes of the forces that are inputs there, then of passive forces.
    pub loads: Vec<f64>,
    /// The mode of each passive force, and the value at which its coordinate is held.
    pub modes: Vec<(Mode, f64)>,
    /// Each passive force there.
    pub passive: Vec<Passive>,
    /// Arguments there of functions on whose points forces have corners or jump.
    pub corners: Vec<Corner>,
    /// Energy of the bodies without that of springs there, its kinetic part, and that energy when the
    /// work was zero \[J\].
    pub energies: [f64; 3],
}
