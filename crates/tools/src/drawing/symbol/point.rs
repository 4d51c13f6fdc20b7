//! Points of interest.

use super::*;

/// A point of interest.
#[derive(Clone, Debug, PartialEq)]
pub struct InterestPoint {
    /// Its name.
    pub name: String,
    /// Its place.
    pub at: Anchor,
}

/// Radius of the dot.
const DOT: f64 = 3.0;

impl Shape for InterestPoint {
    fn draw(&self, pen: &mut Pen) {
        let (center, ..) = pen.on(self.at);
        let dot = Outline::circle(center, DOT);
        pen.area(Layer::Point, dot, (Colour::INK, 1.0), None);
        let places = Candidate::around(center, PIN);
        pen.label(Named::Point, &self.name, Colour::INK, places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }

    fn tracked(&self) -> Option<Anchor> {
        Some(self.at)
    }
}
