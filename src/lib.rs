//! Planar mechanisms as text files, solved exactly and exported as FMI 2.0 FMUs.
//!
//! A mechanism is a set of rigid bodies, each with generalized coordinates q = \[x, y, phi\],
//! held together by joints and moved by drivers. Both are equations in q: with the kinematic
//! constraints and the drivers as one system
//!
//! > Phi(q, t) = 0
//!
//! its motion follows from the Jacobian Phi_q: position by Newton–Raphson, velocity and
//! acceleration from two linear systems with the same matrix.
//!
//! | layer | what it knows |
//! |---|---|
//! | [`mechanism`] | the file: bodies, markers, joints, drivers, expressions, and what is wrong with them |
//! | [`kinematics`] | the equations and their solution: assembly, position, velocity, acceleration |
//! | `drawing` | pictures: a scene in the frames of the bodies, a sheet, its files |
//! | [`fmi`] | FMI 2.0 for any model, and mechanisms as one: instance, C interface, model description, archive |
//! | `cli` | the commands of the program `biela` |
//!
//! Each knows those above it and none below.
//!
//! ```
//! use biela::kinematics::{Curve, Path, Rates, Solver};
//! use biela::mechanism::{Jet, Mechanism, Source};
//!
//! let file = Source::new("pendulum.toml", include_str!("../mechanisms/pendulum.toml"));
//! let (mechanism, _warnings) = Mechanism::parse(&file).expect("the file has no errors");
//!
//! // Assemble at the start values, then swing to 0.2 rad.
//! let mut solver = Solver::new(mechanism.into())?;
//! let mut path = Path::new(solver.mechanism());
//! solver.assemble(&path)?;
//! path.curves[0] = Curve::Input {
//!     position: 0.2,
//!     velocity: 0.0,
//!     acceleration: 0.0,
//!     jump: solver.pose().drivers[0] - 0.2,
//! };
//! solver.follow(&path).expect("nothing is in the way");
//!
//! // Rates for a driver that moves at 1 rad/s.
//! let mut rates = Rates::new(3);
//! solver.solve_rates(|_driver| Jet::new(0.2, [1.0, 0.0]), &mut rates)?;
//!
//! // The rod's middle is 0.25 m below the pivot along the rod.
//! let [x, vx, ax] = [solver.pose().q[0], rates.velocity()[0], rates.acceleration()[0]];
//! assert!((x - 0.25 * f64::sin(0.2)).abs() < 1e-15);
//! assert!((vx - 0.25 * f64::cos(0.2)).abs() < 1e-15);
//! assert!((ax + 0.25 * f64::sin(0.2)).abs() < 1e-15);
//! # Ok::<(), biela::kinematics::Error>(())
//! ```
//!
//! The crate's shared library is the runtime inside every FMU: it exports the functions of
//! `fmi2Functions.h` and reads the mechanism from the FMU's resources.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "drawing")]
pub mod drawing;
pub mod fmi;
pub mod kinematics;
pub mod mechanism;
pub mod unit;
