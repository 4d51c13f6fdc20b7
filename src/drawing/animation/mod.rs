//! Mechanisms that move: a page that plays a motion.
//!
//! What rides on a body is drawn once, in the body's frame; for each moment there is only where
//! the frames are. The page needs nothing from elsewhere.

mod film;
mod page;
mod stage;

pub use page::{escape, fill, page, page_with, player};

use super::scene::Scene;

/// A motion to be shown.
#[derive(Clone, Debug)]
pub struct Animation {
    /// What there is to draw, the same at every moment.
    pub scene: Scene,
    /// When the moments are.
    pub clock: Clock,
    /// What is told in numbers beside the picture.
    pub readings: Vec<Reading>,
    /// The motion; at least one moment.
    pub moments: Vec<Moment>,
}

/// The time of moments: `start`, `start + step`, and so on; the last one is at `stop` \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first moment.
    pub start: f64,
    /// Time between two moments.
    pub step: f64,
    /// Time of the last moment.
    pub stop: f64,
}

/// A quantity that is told in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its name.
    pub name: String,
    /// The unit in which it is told.
    pub unit: String,
}

/// A mechanism at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The generalized coordinates, \[m, m, rad\] for each body.
    pub q: Vec<f64>,
    /// Their first and second derivatives; empty where the motion has no rates.
    pub rates: [Vec<f64>; 2],
    /// One for each reading, in its unit.
    pub readings: Vec<f64>,
}
