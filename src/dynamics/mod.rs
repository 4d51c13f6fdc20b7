//! Dynamics: the motion of coordinates that nobody drives.
//!
//! A freedom is a coordinate u whose effort is zero. With J and bias as in
//! [`EquationsOfMotion`](crate::kinematics::EquationsOfMotion) its acceleration follows from
//! J ü + bias = 0: Haug's coordinate partitioning with the freedoms as independent coordinates. Their
//! values and velocities are integrated; the positions of all bodies are solved at each instant, so
//! that joints stay closed to rounding, and the mechanism never changes its assembly mode.
//!
//! | file or folder | subject |
//! |---|---|
//! | [`integrator`] | ordinary differential equations, one step at a time |
//! | `error` | reasons for which a motion stops |
//! | `moving` | [`Motion`]: a mechanism in motion, driven or free, which hosts move |
//! | `notice` | [`Notice`]: what is worth knowing of a motion, found and in words |
//! | `told` | [`Told`]: what has been told, so that it is told once |
//! | `given` | what comes from outside: inputs |
//! | `state` | [`FreeState`]: all numbers on which a motion depends |
//! | `charts` | the coordinates in which the freedoms are integrated |
//! | `triangular`, `bounded` | triangular factors; forces between bounds |
//! | `event` | [`Event`]s, and how they are called |
//! | `function` | a function that is positive while a passive force keeps its mode |
//! | `passive` | [`Passive`] forces, those of stops and friction: their modes, a file per cause |
//! | `stages` | bounds of speeds and forces between the ends of a step |
//! | `gaps` | the proof that no gap closes between the ends of a step |
//! | `watch` | the search for the instants at which modes end |
//! | `equations` | the right-hand side |
//! | `energy` | the balance of energy of a step |
//! | `overlap`, `apart` | [overlaps](Overlap) of parts, and the least move that brings them apart |
//! | `corner` | corners of prescribed motions |
//! | `impact` | velocities after impacts |
//! | `strike` | a strike of contacts, as far as its changes need it |
//! | `settle` | the modes after an event |
//! | `choose` | the choice of what is held after an event |
//! | `variations` | the changes of a motion along directions |
//! | `saltation` | those changes at events |
//! | `trials` | the system that the integrator steps |
//! | `motion` | [`FreeMotion`]: the motion of one mechanism |
//! | `starts` | the [start](KeptStart) that a motion keeps |
//! | `held` | [`Held`]: what holds coordinates, in words |
//! | `linear` | its linearisation at a pose |
//! | `statics` | forces and stiffness at rest |
//! | `balance` | static equilibrium |
//! | `explore` | the search for several equilibria |

mod apart;
mod balance;
mod bounded;
mod charts;
mod choose;
mod corner;
mod energy;
mod equations;
mod error;
mod event;
mod explore;
mod free_state;
mod function;
mod gaps;
mod given;
mod held;
mod impact;
pub mod integrator;
mod linear;
mod motion;
mod moving;
mod notice;
mod overlap;
mod passive;
mod saltation;
mod settle;
mod stages;
mod starts;
mod statics;
mod strike;
mod told;
mod trials;
mod triangular;
mod turns;
mod variations;
mod watch;

pub use balance::Equilibrium;
pub use charts::keeps_coordinates;
pub use error::Error;
pub use event::{Event, EventKind};
pub use free_state::FreeState;
pub use given::{Given, GivenByPath, on_cubic};
pub use held::Held;
pub use linear::StateSpace;
pub use motion::FreeMotion;
pub use moving::{Motion, MotionState, Stop};
pub use notice::Notice;
pub use overlap::Overlap;
pub use passive::{Mode, Passive};
pub use starts::KeptStart;
pub use told::Told;
pub use watch::event_indicators;
