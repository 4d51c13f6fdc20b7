//! Kinematics: the constraint equations of a mechanism and their solution.
//!
//! The formulation is Haug's with Cartesian generalized coordinates, q = \[x, y, phi\] for each
//! moving body. With the kinematic constraints and the drivers as one system Phi(q, t) = 0
//! (Eq. 3.6.3):
//!
//! | | | |
//! |---|---|---|
//! | position | Phi_q Δq = −Phi | Newton–Raphson, Eq. 3.6.7 and 3.6.8 |
//! | velocity | Phi_q q̇ = −Phi_t = ν | Eq. 3.6.10 |
//! | acceleration | Phi_q q̈ = −(Phi_q q̇)_q q̇ − 2 Phi_qt q̇ − Phi_tt = γ | Eq. 3.6.11 |
//! | sensitivity | Phi_q δq = δu − Phi_p δp | and the derivatives of Eq. 3.6.10 and 3.6.11 |
//! | assembly | min (q − q⁰)ᵀ(q − q⁰) + r PhiᵀPhi, r growing | Eq. 3.6.9 |
//!
//! The system is solved block by block: [`Structure`] finds the blocks and their order, and a plan
//! compiled from it has a solver for each, straight code for the dyads of which most mechanisms
//! consist. The work of a step is proportional to the number of bodies. Position, velocity and
//! acceleration share one factorisation per block.
//!
//! Redundant equations are found by rank, set aside and watched: see [`Solver::redundancies`].
//!
//! [`System`] has the equations. [`Solver`] has a mechanism at one pose, which it can
//! [assemble](Solver::assemble), [track along a path](Solver::track) and give
//! [rates](Solver::solve_rates) to. Neither knows of FMI.
//!
//! Each file uses only those above it in this list:
//!
//! | file or folder | subject |
//! |---|---|
//! | `tolerances` | the tolerances that several files share |
//! | `linear` | dense and sparse matrices, condition, rank |
//! | `origin`, `stop_limit`, `error`, `alignment`, `newton` | names for messages; errors; lines that meet; limits of Newton–Raphson |
//! | [`constraint`] | the bodies and markers at one q; one relation per file, with its derivatives |
//! | `system` | the equations, their scales, their linearisation and their structure |
//! | `path` | time, parameters and drivers over one step |
//! | `certificate` | the proof that one motion joins the ends of a sub-step |
//! | `plan` | the compiled mechanism: one solver per block |
//! | `state` | all that moves |
//! | `assembly` | a pose from the estimates |
//! | `redundancy` | rows that follow from others, and those that are solved |
//! | `singular` | dead points and change points |
//! | `continuation` | sub-steps along a path |
//! | `start` | the first pose; the motion from there to the values of a start |
//! | `analysis` | sensitivity, range, modes, instant centres, checks of the geometry |
//! | `forces` | efforts of drivers, reactions of joints, energies |
//! | `solver` | the facade |
//! | `results` | the outputs by name; values of signals and measures; rates and forces at a pose |

mod alignment;
mod analysis;
mod assembly;
mod certificate;
pub mod constraint;
mod continuation;
mod error;
mod forces;
mod linear;
mod newton;
mod origin;
mod path;
mod plan;
mod redundancy;
#[cfg(test)]
mod reference;
mod results;
mod singular;
mod solver;
mod start;
mod state;
mod stop_limit;
mod system;
mod tolerances;

pub use alignment::{Alignment, LineRelation, Member};
pub use analysis::{
    AssemblyMode, ChangePoint, Direction, DrawnApart, End, Extreme, GeometryWarning,
    GeometryWarningKind, InstantCentre, Modes, NeededPlay, OffPulley, Range, RangeSettings, Sample,
    Sensitivity, offer_start,
};
pub use assembly::estimate::Move;
pub use constraint::configuration::{
    CamProfile, Coefficient, CoefficientId, Configuration, CouplingLaw, JointUnknownId, LawId,
    MarkerPose, ParameterCoefficients, ProfileId,
};
pub use continuation::{Blocked, Budget, PathWatch, Progress, Reason, SubStep};
pub use error::{Error, Fit, NoLimit, OpenJoint, OpenPose, Proof, Remedy, Verdict};
pub use forces::{
    EquationsOfMotion, ForceParts, ForceQuantity, ForceSensitivity, Forces, Friction, KnownMotion,
    LiftOff, Reported,
};
pub use linear::PivotOrder;
pub(crate) use linear::{DenseLu, Factors, Singular};
pub use origin::Origin;
pub use path::{DriverPath, Path, Rates};
pub use plan::{BlockChoices, Crossing, Polynomial};
pub use redundancy::{Redundancy, Undriven, undriven};
pub use results::{ForceNeed, Output, OutputSource, Solution, omitted_reactions};
pub use singular::{Approach, LARGEST_BLOCK, SingularKind, SingularPoint};
pub use solver::Solver;
pub use start::Assembly;
pub use state::{Pose, SolverChoices};
pub use stop_limit::StopLimit;
pub use system::structure::{Dependencies, Structure};
pub use system::{Equation, EquationTarget, System, Targets};
