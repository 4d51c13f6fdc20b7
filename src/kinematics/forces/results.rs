//! The numbers that [`Forces`](super::Forces) solves.

use crate::mechanism::Mechanism;

/// The numbers of one pose: w, and what follows from it.
#[derive(Debug)]
pub(super) struct Results {
    /// w, one entry per unknown. Reactions use it up.
    pub(super) demand: Vec<f64>,
    /// Per driver.
    pub(super) drivers: Vec<DriverForces>,
    /// λ, one per row.
    pub(super) multipliers: Vec<f64>,
    /// Per joint.
    pub(super) reactions: Vec<[f64; 3]>,
    /// Per joint, the effort of a coupling along each of its coordinates.
    pub(super) shares: Vec<Vec<f64>>,
    /// Size of each force.
    pub(super) sizes: Vec<[f64; 3]>,
    /// Kinetic and potential energy \[J\].
    pub(super) energies: [f64; 2],
}

/// The forces of one driver.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DriverForces {
    pub(super) effort: f64,
    pub(super) power: f64,
    pub(super) inertia: f64,
    pub(super) bias: f64,
}

impl Results {
    /// Makes the storage.
    pub(super) fn new(mechanism: &Mechanism, unknowns: usize, rows: usize) -> Self {
        Self {
            demand: vec![0.0; unknowns],
            drivers: vec![DriverForces::default(); mechanism.drivers.len()],
            multipliers: vec![0.0; rows],
            reactions: vec![[0.0; 3]; mechanism.joints.len()],
            shares: shares(mechanism),
            sizes: vec![[0.0; 3]; mechanism.forces.len()],
            energies: [0.0; 2],
        }
    }
}

/// Returns a place for each joint's efforts along the coordinates of its equation.
pub(super) fn shares(mechanism: &Mechanism) -> Vec<Vec<f64>> {
    let joints = mechanism.joints.iter();
    let count = joints.map(|joint| {
        let equation = joint.equation();
        equation.map_or(0, |equation| equation.coordinates.len())
    });
    count.map(|count| vec![0.0; count]).collect()
}
