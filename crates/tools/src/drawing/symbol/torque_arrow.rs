//! Torques: arcs with an arrow.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;

/// A torque on a body, drawn as part of the largest one.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueArrow {
    /// Its kind.
    pub kind: ForceKind,
    /// A point of the body that it turns.
    pub at: Anchor,
    /// Part of the largest torque, positive counter-clockwise.
    pub part: f64,
    /// Its size in words.
    pub size: String,
}

/// Radius of the arc.
const ARC: f64 = 19.0;
/// Angle of the arc of the largest torque, 300°.
const WIDEST: f64 = 5.0 * PI / 3.0;
/// Width of the line.
const WIDTH: f64 = 2.0;

impl Shape for TorqueArrow {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::of(self.at));
        let (center, _) = pen.place(self.at);
        let colour = self.kind.colour();
        // From below.
        let arc = [-FRAC_PI_2, WIDEST * self.part];
        pen.arc_arrow(Layer::Force, (center, ARC), arc, colour, WIDTH);
        let places = Candidate::around(center, ARC + 2.0);
        pen.label(Named::Point, &self.size, colour.shade(0.8), places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
