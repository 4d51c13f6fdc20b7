//! Pages: a mechanism that its reader moves by hand.
//!
//! A [`Session`] holds a mechanism at one pose, and does what a reader asks: move a driver, pull a
//! body, change a parameter, go to a time, draw, chart, save. Every move is a path that the solver
//! tracks, so the mechanism stays on its assembly mode and stops at dead points. Freedoms move by the
//! forces while time goes on, and the reader holds a body by a spring. [`Host`] answers
//! requests in JSON, which the page's scripts send; `biela-page` compiles it for browsers.
//!
//! | file | subject |
//! |---|---|
//! | `outcome` | [`Outcome`]: the end of a move, and what stopped it |
//! | `values` | outputs that are shown, and the units of their values |
//! | `ranges` | ranges and speeds of the drivers |
//! | `held` | [`assembled`]: what nothing drives is held by the hand |
//! | `undo` | states that can be undone |
//! | `spring` | a spring from the hand to a body |
//! | `session` | [`Session`]: the mechanism and its moves |
//! | `description` | names, units and limits, shown once |
//! | `free` | free motion: time goes on, the hand pulls |
//! | `hand` | a body that is pulled towards a point |
//! | `assemblies` | the other positions in which the mechanism closes |
//! | `along` | poses along time or a driver |
//! | `chart` | variables over time or over a driver |
//! | `course` | the path of a point, and poses laid over each other |
//! | `frame` | the numbers of one picture |
//! | `edit` | the mechanism's file with other values |
//! | `files` | the files opened one after the other, for undo |
//! | `request`, `host` | requests in JSON, and [`Host`], which answers them |

mod along;
mod assemblies;
mod chart;
mod course;
mod description;
mod edit;
mod files;
mod frame;
mod free_motion;
mod hand;
mod held;
mod host;
mod outcome;
mod ranges;
mod request;
mod session;
mod spring;
#[cfg(test)]
mod tests;
mod undo;
mod values;

pub use along::Over;
pub use edit::{EditError, PosePart, change_values, edit};
pub use held::assembled;
pub use host::Host;
pub use outcome::{Obstacle, Outcome};
pub use session::Session;
