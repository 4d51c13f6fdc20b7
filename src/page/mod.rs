//! Pages: a mechanism that its reader moves by hand.
//!
//! A [`Session`] holds a mechanism at one pose, and does what a reader asks: move a driver, pull a
//! body, change a parameter, go to a time, draw, chart, save. Every move is a path that the solver
//! tracks, so the mechanism stays on its assembly mode and stops at dead points. [`Host`] answers
//! requests in JSON, which the page's scripts send; `biela-page` compiles it for browsers.
//!
//! | file | subject |
//! |---|---|
//! | `outcome` | [`Outcome`]: the end of a move, and what stopped it |
//! | `quantity` | the variables of a mechanism, by name |
//! | `session` | [`Session`]: the mechanism and its moves |
//! | `hand` | a body that is pulled towards a point |
//! | `assemblies` | the other positions in which the mechanism closes |
//! | `chart` | variables over time or over a driver |
//! | `frame` | the numbers of one picture |
//! | `edit` | the mechanism's file with other values |
//! | `host` | [`Host`]: requests in JSON |

mod assemblies;
mod chart;
mod edit;
mod frame;
mod hand;
mod host;
mod outcome;
mod quantity;
mod session;
#[cfg(test)]
mod tests;

pub use chart::Over;
pub use edit::{EditError, Place, edit};
pub use host::Host;
pub use outcome::{Obstacle, Outcome};
pub use session::Session;
