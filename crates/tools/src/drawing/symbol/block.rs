//! Translational joints: blocks on their ways.

use super::*;

/// A block that slides along its anchor's x-axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its middle and direction.
    pub at: Anchor,
    /// The body that it slides on, `None` for ground.
    pub on: Option<BodyId>,
}

/// Composes a translational joint: a block on the way that its first marker gives. A body that is
/// guided lengthwise has no block.
pub(super) fn compose(composer: &mut Composer, [along, to]: [Anchor; 2]) {
    if guide::compose(composer, along, to) {
        return;
    }
    let range = composer.range(along, to);
    if along.body.is_none() {
        slide_way::compose(composer, along, range, to.body, GuideContact::Block);
    } else {
        composer.reach(along, [range[0].min(0.0), range[1].max(0.0)]);
    }
    composer.hold(to, along.body);
    composer.add(Block {
        at: to,
        on: along.body,
    });
}

impl Shape for Block {
    fn draw(&self, pen: &mut Pen) {
        let (center, along, colour) = pen.on(self.at);
        let outline = Outline::block(center, along, BLOCK);
        // It covers the bar that it slides on; the rod that moves it stays in sight.
        let layer = if self.on.is_some() {
            Layer::Block
        } else {
            Layer::Slider
        };
        pen.area(layer, outline, (colour.tint(0.45), 1.0), Some(colour));
        let up = across(along);
        for (side, half) in [
            (up, 0.5 * BLOCK[1]),
            (-up, 0.5 * BLOCK[1]),
            (along, 0.5 * BLOCK[0]),
            (-along, 0.5 * BLOCK[0]),
        ] {
            let line = [center, center + 16.0 * across(side)];
            let parts = [(0.0, 0.0), (1.0, 2.0), (-1.0, 2.0)];
            let gaps = [(4.0, 0.0), (16.0, 4.0), (30.0, 12.0)].map(|(gap, c)| (half + gap, c));
            let places = Candidate::beside(line, &parts, &[(side, 0.0)], &gaps);
            pen.offer(self.at.body, places);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }

    fn shows(&self) -> Option<BodyId> {
        self.at.body
    }

    fn tracked(&self) -> Option<Anchor> {
        Some(self.at)
    }
}
