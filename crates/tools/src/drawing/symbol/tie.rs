//! Equations between coordinates.

use super::*;
use biela::mechanism::CoordinateEquation;

/// A dashed line between the places of two coordinates that an equation couples.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// The points of the coordinates' second markers.
    pub ends: [Anchor; 2],
}

/// Composes a coupling.
pub(super) fn compose(composer: &mut Composer, equation: &CoordinateEquation) {
    let coordinates = equation.coordinates.iter();
    let places: Vec<_> = coordinates
        .map(|(_, coordinate)| composer.anchor(coordinate.to))
        .collect();
    for pair in places.windows(2) {
        let ends = [pair[0], pair[1]];
        if composer.distance(ends) > 0.0 {
            composer.add(Tie { ends });
        }
    }
}

impl Shape for Tie {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::between(self.ends));
        let ends = self.ends.map(|end| pen.place(end).0);
        let line = Outline::line(&ends);
        pen.dashed(Layer::Trace, line, Colour::INK, THIN, DASHES);
    }

    fn extent(&self) -> Vec<Disc> {
        self.ends.map(Disc::from).to_vec()
    }
}
