//! Integration of ordinary differential equations ẋ = f(t, x), one accepted step at a time.
//!
//! Two methods, and a test that changes between them:
//!
//! | | order | per step | for |
//! |---|---|---|---|
//! | Dormand and Prince 8(5,3) | 8, dense output 7 | 12 evaluations | motion without fast decay |
//! | Rodas5P | 5, dense output 4 | 8 evaluations, one Jacobian, one factorisation | stiff equations |
//!
//! A [`System`] has the right-hand side, which may fail at a trial point: the step is then
//! shortened. An [`Integrator`] makes steps; its [`State`] has all numbers on which further steps
//! depend, so that a run that was saved and restored goes on with the same bits.
//!
//! Each file uses only those above it in this list:
//!
//! | file or folder | subject |
//! |---|---|
//! | `error` | failures of an evaluation, of a step and of the input |
//! | `control` | tolerance, scales, the norm of an error |
//! | `stiffness` | the counters that decide when the other method is tried |
//! | `state` | the numbers on which further steps depend |
//! | `step_length` | the length of the next step |
//! | `system` | the right-hand side; evaluations that are counted and checked |
//! | `dense` | the solution between the ends of a step |
//! | `dormand_prince` | the explicit method |
//! | `rosenbrock` | the stiff method |
//! | `first_step` | the length of the first step |
//! | `advance` | the integrator |

mod advance;
mod control;
mod dense;
mod dormand_prince;
mod error;
mod first_step;
mod rosenbrock;
mod state;
mod step_length;
mod stiffness;
mod system;
#[cfg(test)]
mod tests;

pub use advance::{Integrator, Method, Step};
pub use control::{ErrorControl, STEP_TOLERANCE_RATIO};
pub use dense::DenseOutput;
pub use error::{Error, Failure, Invalid, Reason};
pub use state::{State, Statistics};
pub use stiffness::Stiffness;
pub use system::System;
