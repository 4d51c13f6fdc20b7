//! Revolute joints.

use super::*;

/// A revolute joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// Its point.
    pub at: Anchor,
}

/// Composes a revolute joint, on ground if one of its markers is.
pub(super) fn compose(composer: &mut Composer, [from, to]: [Anchor; 2]) {
    let (at, other) = if to.body.is_none() {
        (to, from)
    } else {
        (from, to)
    };
    composer.hold(at, other.body);
    composer.add(Pin {
        at: at.turned_to(0.0),
    });
}

impl Shape for Pin {
    fn draw(&self, pen: &mut Pen) {
        let (center, ..) = pen.on(self.at);
        let outline = Outline::circle(center, PIN);
        let edge = Some(Colour::INK);
        pen.area(Layer::Joint, outline, (Colour::WHITE, 1.0), edge);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }

    fn tracked(&self) -> Option<Anchor> {
        Some(self.at)
    }
}
