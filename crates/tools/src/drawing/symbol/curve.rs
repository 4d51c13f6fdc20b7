//! Curves along which points move.

use super::*;
use biela::mechanism::Curve;

/// A curve of a body or of ground.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveLine {
    /// Marker of the curve.
    pub at: Anchor,
    /// Points along the curve, in the frame of the anchor's body \[m\].
    pub points: Vec<[f64; 2]>,
}

/// Number of chords that are drawn.
const CHORDS: u32 = 240;

/// Composes a curve and the point on it.
pub(super) fn compose(composer: &mut Composer, [at, point]: [Anchor; 2], curve: &Curve) {
    let center = Point::from(at.position);
    let along = direction(at.angle);
    let parts = (0..=CHORDS).map(|part| f64::from(part) / f64::from(CHORDS));
    let points = parts.map(|s| {
        let [x, y] = curve.shape.at(&|id| composer.parameter(id), s);
        (center + x.value * along + y.value * across(along)).into()
    });
    let points = points.collect();
    composer.add(Pin {
        at: point.turned_to(0.0),
    });
    composer.add(CurveLine { at, points });
}

impl Shape for CurveLine {
    fn draw(&self, pen: &mut Pen) {
        let (_, _, colour) = pen.on(self.at);
        let points = self.points.iter();
        let points: Vec<Point> = points
            .map(|&position| pen.place(self.at.moved_to(position)).0)
            .collect();
        pen.line(Layer::Slot, Outline::line(&points), colour, 2.4);
    }

    fn extent(&self) -> Vec<Disc> {
        let points = self.points.iter();
        points.map(|&p| self.at.moved_to(p).into()).collect()
    }
}
