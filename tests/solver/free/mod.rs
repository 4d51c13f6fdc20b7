//! Free motion against truths written apart.
//!
//! | file | subject |
//! |---|---|
//! | `taylor`, `minimal` | Lagrange's equations in minimal coordinates |
//! | `run` | a mechanism that moves freely, and its comparison with a truth |
//! | `pendulum` | elliptic functions |
//! | `closed_form` | springs, trains of wheels, rolling |
//! | `lagrange` | minimal coordinates |
//! | `laws` | forces that are functions of what moves elsewhere |
//! | `published` | Andrews' mechanism, the problems of the IFToMM library |
//! | `invariance` | other freedoms, names, orders, places; time reversed |
//! | `dead_points` | coordinates with dead points on the way, where no joint has another |
//! | `refused` | what has no inertia, what meets a dead point |
//! | `events` | stops and friction against closed forms |
//! | `contacts` | contacts of shapes against closed forms |
//! | `unseen` | events between the ends of a step |
//! | `overlap` | parts that overlap, and what brings them apart |
//! | `corner` | corners of prescribed motions |
//! | `play` | ropes, cams and wheels that open |
//! | `joint_friction` | friction that grows with the reaction of its joint |
//! | `balance` | static equilibrium and linear equations on stops and with friction |
//! | `chains` | random chains with stops and friction |
//! | `state` | saved and restored |

mod balance;
mod chains;
mod closed_form;
mod contacts;
mod corner;
mod dead_points;
mod events;
mod invariance;
mod joint_friction;
mod lagrange;
mod laws;
mod minimal;
mod overlap;
mod pendulum;
mod play;
mod published;
mod refused;
mod run;
mod state;
mod taylor;
mod unseen;
