//! Springs and dampers of an angle: a spiral, a ring.

use super::*;

/// A spring of an angle, a damper, or both, about a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Torsion {
    /// Marker j, about which they turn.
    pub at: Anchor,
    /// Whether the torque has a stiffness.
    pub is_elastic: bool,
    /// Whether the torque has a damping.
    pub is_damped: bool,
}

/// Radii and turns of a spiral.
const RADII: [f64; 2] = [PIN + 2.0, 15.0];
const TURNS: f64 = 2.25;
/// Points of the spiral.
const POINTS: usize = 54;
/// Radius of a ring.
const RING: f64 = 18.0;

impl Shape for Torsion {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::of(self.at));
        let (center, _) = pen.place(self.at);
        if self.is_elastic {
            let point = |k: usize| {
                let part = k as f64 / POINTS as f64;
                let radius = RADII[0] + part * (RADII[1] - RADII[0]);
                center + radius * direction(part * TURNS * std::f64::consts::TAU)
            };
            let spiral: Vec<Point> = (0..=POINTS).map(point).collect();
            pen.line(Layer::Joint, Outline::line(&spiral), Colour::INK, THIN);
        }
        if self.is_damped {
            let ring = Outline::circle(center, RING);
            pen.line(Layer::Joint, ring, Colour::INK, THIN);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
