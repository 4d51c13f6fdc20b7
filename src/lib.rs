//! Planar mechanisms as text files, solved exactly and exported as FMUs (FMI 2.0 and 3.0).
//!
//! The library reads a mechanism, a set of rigid bodies with joints and drivers, from a TOML file;
//! assembles it; moves it along its drivers with position, velocity and acceleration exact to
//! rounding, always on the same assembly mode; and writes it as an FMU for system simulation. The
//! shortest program that does something assembles a mechanism and prints its pose:
//!
//! ```
//! use biela::kinematics::{Path, Solver};
//! use biela::mechanism::{Mechanism, Source};
//!
//! let file = Source::new("four_bar.toml", include_str!("../mechanisms/four_bar.toml"));
//! let (mechanism, _warnings) = Mechanism::parse(&file).expect("the file has no errors");
//! let start = Path::new(&mechanism);
//! let mut solver = Solver::new(mechanism.into())?;
//! solver.assemble(&start)?;
//! for (body, q) in solver.mechanism().bodies.iter().zip(solver.pose().q.chunks_exact(3)) {
//!     println!("{}: x = {} m, y = {} m, phi = {} rad", body.name, q[0], q[1], q[2]);
//! }
//! # Ok::<(), biela::kinematics::Error>(())
//! ```
//!
//! # Layers
//!
//! | layer | subject |
//! |---|---|
//! | [`mechanism`] | the file: bodies, markers, joints, drivers, expressions, and their diagnostics |
//! | [`kinematics`] | the equations and their solution: assembly, position, velocity, acceleration |
//! | [`dynamics`] | the motion of freedoms: forces, contacts, friction, their events |
//! | [`fmi`] | FMI 2.0 and 3.0 for any model, and for mechanisms: instance, C interface, model description, archive |
//!
//! Each layer uses only layers above it in this table. The program `biela`, pictures, pages and
//! mechanisms of other programs are the package `biela-tools`.
//!
//! # Motion
//!
//! Each body has generalized coordinates q = \[x, y, phi\]. Joints and drivers are equations in
//! q, together
//!
//! > Phi(q, t) = 0
//!
//! and the motion follows from the Jacobian Phi_q: position by Newton–Raphson (Eq. 3.6.7), velocity
//! and acceleration from two linear systems with the same matrix (Eq. 3.6.10 and 3.6.11).
//!
//! ```
//! use biela::kinematics::{DriverPath, Path, Rates, Solver};
//! use biela::mechanism::{Jet, Mechanism, Source};
//!
//! let file = Source::new("pendulum.toml", include_str!("../mechanisms/pendulum.toml"));
//! let (mechanism, _warnings) = Mechanism::parse(&file).expect("the file has no errors");
//!
//! // Assemble at the start values, then swing to 0.2 rad.
//! let mut solver = Solver::new(mechanism.into())?;
//! let mut path = Path::new(solver.mechanism());
//! solver.assemble(&path)?;
//! path.driver_paths[0] = DriverPath::Input {
//!     position: 0.2,
//!     velocity: 0.0,
//!     acceleration: 0.0,
//!     jump: solver.pose().drivers[0] - 0.2,
//! };
//! solver.track(&path).expect("nothing stops it");
//!
//! // Rates for a driver that moves at 1 rad/s.
//! let mut rates = Rates::new(3);
//! solver.solve_rates(|_driver| Jet::new(0.2, [1.0, 0.0]), &mut rates)?;
//!
//! // The rod's centre is 0.25 m below the pivot, along the rod.
//! let [x, vx, ax] = [solver.pose().q[0], rates.velocity()[0], rates.acceleration()[0]];
//! assert!((x - 0.25 * f64::sin(0.2)).abs() < 1e-15);
//! assert!((vx - 0.25 * f64::cos(0.2)).abs() < 1e-15);
//! assert!((ax + 0.25 * f64::sin(0.2)).abs() < 1e-15);
//! # Ok::<(), biela::kinematics::Error>(())
//! ```
//!
//! # Free motion
//!
//! The coordinates that the file calls freedoms move by the forces, J ü + bias = 0, through impacts and
//! friction that sticks and slides:
//!
//! ```
//! use biela::dynamics::{GivenByPath, Motion};
//! use biela::kinematics::{Path, Solver};
//! use biela::mechanism::{Mechanism, Source};
//!
//! let file = Source::new("pendulum_free.toml", include_str!("../mechanisms/pendulum_free.toml"));
//! let (mechanism, _warnings) = Mechanism::parse(&file).expect("the file has no errors");
//! let path = Path::new(&mechanism);
//! let mut solver = Solver::new(mechanism.into())?;
//! solver.assemble(&path)?;
//!
//! // Nothing is driven, and no force is an input.
//! let given = GivenByPath { path: &path, load: |_input, _time| 0.0 };
//! let mut motion = Motion::new(solver);
//! motion.prepare_freedoms(Vec::new())?;
//! motion.release(&given)?;
//!
//! // The period of a swing from 120 degrees, by the arithmetic–geometric mean of 1 and cos 60°.
//! let (mut a, mut b) = (1.0, 0.5_f64);
//! for _ in 0..6 {
//!     (a, b) = ((a + b) / 2.0, f64::sqrt(a * b));
//! }
//! let (length, gravity) = (0.5, 9.81);
//! let period = std::f64::consts::TAU / a * f64::sqrt(2.0 * length / (3.0 * gravity));
//! motion.advance(&path, &given, period).expect("nothing stops it");
//! assert!((motion.pose().drivers[0] - 120_f64.to_radians()).abs() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The package `biela-runtime` makes the shared library inside every FMU from this crate. It exports
//! the functions of `fmi2Functions.h` and `fmi3Functions.h`, and reads the mechanism from the FMU's
//! resources.

pub mod dynamics;
#[cfg(feature = "fmi")]
pub mod fmi;
pub mod kinematics;
pub mod mechanism;
pub mod unit;
