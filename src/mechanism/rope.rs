//! Ropes over points and pulleys.

use super::{Expression, MarkerId, Play};

/// Most moving bodies that one rope runs over: a row of the Jacobian holds the entries of so many.
pub(crate) const MOST_BODIES: usize = 8;

/// Rope that keeps its length: Σ parts · length of a leg = length.
#[derive(Clone, Debug)]
pub struct Rope {
    /// Sum of the lengths of its legs and arcs, each times its number of parts \[m\], positive.
    pub length: Expression,
    /// Points from the first to the last marker, two at least.
    pub points: Vec<RopePoint>,
    /// Number of parts of each leg, from a point to the next one, positive.
    pub parts: Vec<Expression>,
    /// Whether, and how, it goes slack in free motion.
    pub play: Option<Box<Play>>,
}

/// Point over which a rope runs, or at which it ends.
#[derive(Clone, Debug)]
pub struct RopePoint {
    /// Marker at the point, or at the centre of the pulley.
    pub marker: MarkerId,
    /// Pulley round the point, `None` where the rope runs straight over it.
    pub pulley: Option<Pulley>,
}

impl RopePoint {
    /// Returns the radius of the pulley \[m\], positive on the left of the rope; zero without one.
    pub fn radius(&self, parameter: &impl Fn(super::ParameterId) -> f64) -> f64 {
        let pulley = self.pulley.as_ref();
        pulley.map_or(0.0, |pulley| {
            pulley.side.sign() * pulley.radius.evaluate(parameter, 0.0)
        })
    }
}

/// Pulley round which a rope runs.
#[derive(Clone, Debug)]
pub struct Pulley {
    /// Radius of the rope's arc \[m\], positive.
    pub radius: Expression,
    /// Side of the rope on which the pulley is.
    pub side: PulleySide,
}

/// Side of a rope, seen along its way from the first to the last marker, on which a pulley is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulleySide {
    /// To the left: the rope turns counter-clockwise round the pulley.
    Left,
    /// To the right: the rope turns clockwise.
    Right,
}

impl PulleySide {
    /// Returns 1 for the left side, −1 for the right one.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}
