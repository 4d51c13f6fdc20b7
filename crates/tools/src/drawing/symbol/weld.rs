//! Welds.

use super::*;

/// A weld.
#[derive(Clone, Debug, PartialEq)]
pub struct Weld {
    /// Its point.
    pub at: Anchor,
}

/// Length of the sides.
const SIDE: f64 = 9.0;

/// Composes a weld.
pub(super) fn compose(composer: &mut Composer, [from, to]: [Anchor; 2]) {
    composer.hold(from, to.body);
    composer.hold(to, from.body);
    composer.add(Weld { at: from });
}

impl Shape for Weld {
    fn draw(&self, pen: &mut Pen) {
        let (center, along, _) = pen.on(self.at);
        let outline = Outline::block(center, along, [SIDE, SIDE]);
        pen.area(Layer::Joint, outline, (Colour::INK, 1.0), None);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
