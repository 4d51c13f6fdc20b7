//! Massless rods between two revolute joints.

use super::*;

/// A massless rod between two revolute joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Rod {
    /// Its ends.
    pub ends: [Anchor; 2],
}

/// Composes a link joint.
pub(super) fn compose(composer: &mut Composer, ends: [Anchor; 2]) {
    for end in ends {
        pin::compose(composer, [end, end]);
    }
    composer.add(Rod { ends });
}

impl Shape for Rod {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::between(self.ends));
        let ends = self.ends.map(|end| pen.place(end).0);
        pen.line(Layer::Block, Outline::line(&ends), Colour::INK, 2.0);
    }

    fn extent(&self) -> Vec<Disc> {
        self.ends.map(Disc::from).to_vec()
    }
}
