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
        let turn = WIDEST * self.part;
        let ahead = turn.signum();
        // From below; on the sheet angles count clockwise.
        let start = -FRAC_PI_2;
        let shaft = turn - ahead * (0.8 * ARROW[0] / ARC).min(turn.abs());
        let arc = Outline::arc(center, ARC, -start, -shaft);
        pen.line(Layer::Force, arc, colour, WIDTH);
        let tip = center + ARC * on_sheet_direction(start + turn);
        let chord = on_sheet_direction(start + turn + ahead * (FRAC_PI_2 - 0.5 * ARROW[0] / ARC));
        pen.force_tip(tip, chord, colour);
        let places = Candidate::around(center, ARC + 2.0).collect();
        pen.name_force(&self.size, colour, places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
