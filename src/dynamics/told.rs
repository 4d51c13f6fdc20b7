//! Memory of the notices that were told.

use crate::kinematics::Solver;

/// Memory of the notices that were told of a motion, so that each is told once.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Whether the singular position nearby was told.
    pub near_singular: bool,
    /// Whether each driver is beyond a limit.
    pub beyond: Vec<bool>,
    /// Whether each input is beyond a limit.
    pub inputs_beyond: Vec<bool>,
    /// Whether a rope has left each pulley.
    pub off_pulleys: Vec<bool>,
    /// Whether each contact pulls.
    pub lifted: Vec<bool>,
    /// Whether a call of each function beyond its points was told.
    pub beyond_points: Vec<bool>,
}

impl Told {
    /// Makes the memory of a motion that begins at a solver's pose, with this number of contacts. Ropes that
    /// are off their pulleys there count as told: at the file's own pose they are warnings of the mechanism.
    pub(super) fn new(solver: &Solver, contacts: usize) -> Self {
        let mechanism = solver.mechanism();
        let mut off_pulleys = vec![false; mechanism.pulleys()];
        solver.off_pulleys(&mut off_pulleys).for_each(drop);
        Self {
            near_singular: false,
            beyond: vec![false; mechanism.drivers.len()],
            inputs_beyond: vec![false; mechanism.inputs.len()],
            off_pulleys,
            lifted: vec![false; contacts],
            beyond_points: vec![false; mechanism.functions.list().len()],
        }
    }
}
