//! Drivers of angles, and freedoms: arcs with an arrow.

use std::f64::consts::{PI, TAU};

use super::*;
use biela::mechanism::Driver;

/// A driver of an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleDriver {
    /// The driver's name.
    pub name: String,
    /// Marker i.
    pub from: Anchor,
    /// Marker j, at which it is drawn.
    pub to: Anchor,
    /// Whether it is a freedom, whose arrow is open.
    pub is_free: bool,
}

/// Radius of the arc.
const ARC: f64 = 27.0;
/// Least angle with room for an arrow, 20°.
const SEEN: f64 = PI / 9.0;
/// Angle of the arc where the driven angle is too small to be seen.
const SMALL_ARC: f64 = 1.6;

/// Composes the driver of an angle.
pub(super) fn compose(composer: &mut Composer, driver: &Driver, from: Anchor, to: Anchor) {
    composer.add(AngleDriver {
        name: driver.name.clone(),
        from,
        to,
        is_free: driver.is_free(),
    });
}

impl Shape for AngleDriver {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::of(self.to));
        let reference = self.from.placed(pen.q).angle;
        let towards = self.to.placed(pen.q).angle;
        let (center, _) = pen.place(self.to);
        let turn = (towards - reference) % TAU;
        // The arrow alone can turn with its body.
        let seen = !pen.moving && (SEEN..=TAU - SEEN).contains(&turn.abs());
        let (start, turn) = if seen {
            let foot = on_sheet_direction(reference);
            let line = Outline::line(&[center + PIN * foot, center + (ARC + 8.0) * foot]);
            pen.line(Layer::Driver, line, Colour::DRIVER, THIN);
            (reference, turn)
        } else {
            (towards - 0.5 * SMALL_ARC, SMALL_ARC)
        };
        pen.open_arrows = self.is_free;
        pen.arc_arrow(
            Layer::Driver,
            (center, ARC),
            [start, turn],
            Colour::DRIVER,
            LINE,
        );
        pen.open_arrows = false;
        let mut candidates = Vec::new();
        for (part, cost) in [(0.5, 0.0), (0.7, 1.0), (0.3, 1.0), (0.9, 3.0), (0.1, 3.0)] {
            let side = on_sheet_direction(start + part * turn);
            let at = center + ARC * side;
            let gaps = [(4.0, 0.0), (12.0, 4.0), (24.0, 10.0)];
            let places = Candidate::beside([at, at], &[(0.0, cost)], &[(side, 0.0)], &gaps);
            candidates.extend(places);
        }
        // If all along the arc is taken, near it.
        let middle = on_sheet_direction(start + 0.5 * turn);
        candidates.extend(Candidate::around(center, ARC + 2.0).map(|place| {
            let off = place.side.map_or(0.0, |side| 1.0 - side.dot(&middle));
            place.costlier(2.0 + 4.0 * off)
        }));
        // The name stays beside an arrow that turns.
        if !pen.moving {
            pen.attach(Attachment::Point(self.to));
        }
        pen.label(Named::Driver, &self.name, Colour::DRIVER.shade(0.8), candidates);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.to.into()]
    }
}
