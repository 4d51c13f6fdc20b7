//! Mechanisms that move: a page, or a picture, that plays a motion.
//!
//! Marks are drawn once, in the frames that they move with; each moment adds the places of these
//! frames. The page is one file that needs no other.

mod film;
mod moving;
#[cfg(feature = "program")]
mod moving_gif;
mod moving_svg;
mod page;
mod picture;
mod recorded;
mod stage;

pub use moving::MovingPicture;
#[cfg(feature = "program")]
pub use moving_gif::moving_gif;
pub use moving_svg::moving_svg;
pub use page::{STYLE, fill, page, page_with, parts_script, player};

use super::force_place::ForcePlace;
use super::scene::Scene;

/// A motion to show.
#[derive(Clone, Debug)]
pub struct Animation {
    /// The symbols, the same at every moment.
    pub scene: Scene,
    /// Times of the moments.
    pub clock: Clock,
    /// Quantities that stand in numbers beside the picture.
    pub readings: Vec<Reading>,
    /// Forces that arrows show where the reader asks for them.
    pub forces: Vec<ForcePlace>,
    /// The poses of the motion; at least one.
    pub moments: Vec<Moment>,
}

/// Times of the moments: `start`, `start + step`, and so on; the last one is `stop` \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first moment.
    pub start: f64,
    /// Time between two moments.
    pub step: f64,
    /// Time of the last moment.
    pub stop: f64,
}

/// A quantity that stands in numbers beside the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

/// A mechanism at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The generalized coordinates, \[m, m, rad\] per body.
    pub q: Vec<f64>,
    /// Their first and second time derivatives; empty for a motion without rates.
    pub rates: [Vec<f64>; 2],
    /// One value per reading, in its unit.
    pub readings: Vec<f64>,
    /// Components in ground axes \[N\] and torque \[N m\] of each force.
    pub forces: Vec<[f64; 3]>,
}
