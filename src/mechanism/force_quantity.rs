//! Forces, energies and inertias.

use super::id::DriverId;

/// A force, an energy or an inertia of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ForceQuantity {
    /// Generalized force that a driver exerts, conjugate to its coordinate \[N or N m\].
    Effort(DriverId),
    /// Power of a driver \[W\].
    Power(DriverId),
    /// Inertia that a driver feels: the change of its effort per acceleration \[kg or kg m²\].
    Inertia(DriverId),
    /// Effort of a driver if the accelerations of all drivers that are inputs were zero.
    Bias(DriverId),
    /// Component of the reaction of a joint, by its index: fx (component 0), fy (1) or torque (2),
    /// exerted on the second marker's body at that marker's point, in ground axes \[N, N, N m\]. The
    /// effort of a coupling is in place of the torque \[N or N m\].
    Reaction(usize, usize),
    /// Generalized force that a constraint, by its index, exerts along its coordinate.
    Held(usize),
    /// Generalized force that a coupling, by the index of its joint, exerts along a coordinate, by its
    /// place in the equation: λ ∂c/∂s \[N or N m\].
    Share(usize, usize),
    /// Size of a force, by its index: the effort along its coordinate, or a component at its marker.
    Applied(usize, usize),
    /// Sum of the efforts of the forces from one index to another, at all elements of a contact \[N\].
    Pushes(usize, usize),
    /// Kinetic energy of all bodies \[J\].
    KineticEnergy,
    /// Potential energy of gravity and springs \[J\].
    PotentialEnergy,
}

impl ForceQuantity {
    /// Returns whether the quantity is known without the reactions of joints.
    #[must_use]
    pub fn needs_reactions(self) -> bool {
        matches!(self, Self::Reaction(..) | Self::Share(..) | Self::Held(_))
    }

    /// Returns whether the quantity concerns a driver.
    #[must_use]
    pub fn needs_efforts(self) -> bool {
        matches!(
            self,
            Self::Effort(_) | Self::Power(_) | Self::Inertia(_) | Self::Bias(_)
        )
    }
}
