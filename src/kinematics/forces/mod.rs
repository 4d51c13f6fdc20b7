//! Forces: the efforts of the drivers and the reactions of the joints for a known motion.
//!
//! With the masses M, the forces Q that act on the bodies and the centrifugal forces Q_v of centres
//! of mass off the bodies' origins, the equations of motion
//!
//! > M q̈ = Q + Q_v + Phi_qᵀ λ
//!
//! are solved for λ, the generalized forces that joints and drivers exert along their rows. What
//! they have to exert is w = M q̈ − Q_v − Q.
//!
//! | | |
//! |---|---|
//! | effort of a driver | (∂q/∂u)ᵀ w, by virtual power; it is the λ of the driver's row |
//! | inertia that drivers i and j feel | (∂q/∂u_i)ᵀ M ∂q/∂u_j |
//! | reaction of a joint | Σ λ ∂Phi/∂q over its rows, on the second marker's body |
//!
//! | file | subject |
//! |---|---|
//! | `inertial` | masses, and what they demand |
//! | `applied` | springs, dampers, actuators and loads |
//! | `results` | their numbers |
//! | `wrench` | force and torque that a joint exerts |
//! | `self_stress` | reactions of least norm |
//! | `indeterminate` | reactions that redundant constraints leave open |
//! | `solve` | [`Forces`]: all results at a pose |
//! | `equations` | [`EquationsOfMotion`]: inertia and bias in the coordinates of the drivers |
//! | `rounding` | the rounding error of efforts |
//! | `lift_off` | [`LiftOff`]: contacts that begin to pull |
//! | `friction` | [`Friction`]: along coordinates, and in joints, where it grows with a reaction |
//! | `sensitivity` | [`ForceSensitivity`]: their derivatives along a direction |

mod applied;
mod equations;
mod friction;
mod indeterminate;
mod inertial;
mod lift_off;
mod results;
mod rounding;
mod self_stress;
mod sensitivity;
mod solve;
mod wrench;

pub use crate::mechanism::{ForceQuantity, Reported};
pub use equations::EquationsOfMotion;
pub use friction::Friction;
pub(super) use indeterminate::indeterminate;
pub use lift_off::LiftOff;
pub use sensitivity::ForceSensitivity;
pub use solve::{ForceParts, Forces, KnownMotion};
