//! Forces: straight arrows.

use super::*;

/// A force at a point, drawn as part of the largest one.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceArrow {
    /// Its kind.
    pub kind: ForceKind,
    /// The point at which it acts.
    pub at: Anchor,
    /// Components along ground's axes, as parts of the largest force.
    pub part: [f64; 2],
    /// Its size in words.
    pub size: String,
}

/// Kind of a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceKind {
    /// Exerted by a joint.
    Reaction,
    /// Exerted by a driver.
    Effort,
    /// Exerted by a spring, a damper, an actuator or a load.
    Load,
}

impl ForceKind {
    /// Returns its word in pictures.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Reaction => "reaction",
            Self::Effort => "effort",
            Self::Load => "load",
        }
    }

    pub(super) fn colour(self) -> Colour {
        match self {
            Self::Reaction => Colour::REACTION,
            Self::Effort => Colour::DRIVER,
            Self::Load => Colour::INK,
        }
    }
}

/// Length of the largest force.
const LONGEST: f64 = 84.0;
/// Width of the line.
const WIDTH: f64 = 2.0;

impl Shape for ForceArrow {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::of(self.at));
        let (from, _) = pen.place(self.at);
        let [x, y] = self.part;
        let way = LONGEST * Point::new(x, -y);
        let (tip, along) = (from + way, unit(way));
        let colour = self.kind.colour();
        pen.straight_arrow(Layer::Force, [from, tip], colour, WIDTH);
        let sides = [(along, 0.0), (across(along), 1.0), (-across(along), 1.0)];
        let gaps = [(4.0, 0.0), (12.0, 4.0), (24.0, 10.0)];
        let parts = [(1.0, 0.0), (0.6, 3.0)];
        let places = Candidate::beside([from, tip], &parts, &sides, &gaps);
        pen.label(Named::Point, &self.size, colour.shade(0.8), places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
