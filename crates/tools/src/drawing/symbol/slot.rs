//! Slots in bodies, and points that slide along an axis.

use super::*;

/// A slot in a body along the x-axis of an anchor, with the block of the point that slides in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// Origin and axis.
    pub along: Anchor,
    /// The part of the axis that is used \[m\].
    pub range: [f64; 2],
    /// The point that slides in the slot.
    pub at: Anchor,
}

/// Half the width of a bar with a slot.
const SLOTTED_BAR: f64 = 8.5;
/// Half the width of a slot.
const SLOT: f64 = 4.0;
/// Length and height of the block in a slot.
pub(super) const BLOCK: [f64; 2] = [15.0, 8.0];

/// Composes a joint that keeps a point on the x-axis of its first marker, or on the parallel at
/// an offset.
pub(super) fn compose(
    composer: &mut Composer,
    [axis, to]: [Anchor; 2],
    offset: Option<&Expression>,
) {
    let aside = offset.map_or(0.0, |offset| composer.value(offset));
    let origin = Point::from(axis.position) + aside * across(direction(axis.angle));
    let along = axis.moved_to(origin.into());
    let range = composer.range(along, to);
    if along.body.is_none() {
        slide_way::compose(composer, along, range, to.body, GuideContact::Point);
    } else {
        composer.reach(along, [range[0].min(0.0), range[1].max(0.0)]);
        composer.add(Slot {
            along,
            range,
            at: to,
        });
    }
    pin::compose(composer, [to, to]);
}

impl Slot {
    /// Returns the ends of the slot on the sheet, with room for its block.
    fn ends(&self, pen: &Pen) -> [Point; 2] {
        let (_, axis) = pen.place(self.along);
        let [start, end] = pen.ends(self.along, self.range);
        let more = 0.5 * BLOCK[0] * axis;
        [start - more, end + more]
    }
}

impl Shape for Slot {
    fn draw(&self, pen: &mut Pen) {
        let (_, axis, colour) = pen.on(self.along);
        let outline = Outline::around(&self.ends(pen), SLOT);
        pen.area(Layer::Slot, outline, (Colour::WHITE, 1.0), Some(colour));
        // The block turns with the slot.
        pen.attach(Attachment::Turned {
            at: self.at,
            along: self.along,
        });
        let (center, _) = pen.place(self.at);
        let colour = colour_of(self.at.body);
        let outline = Outline::block(center, axis, BLOCK);
        pen.area(Layer::Block, outline, (colour.tint(0.6), 1.0), Some(colour));
    }

    fn extent(&self) -> Vec<Disc> {
        let [start, end] = self.along.part(self.range);
        [start, end, self.at].map(Disc::from).to_vec()
    }

    fn fitted(&self) -> Option<BodyId> {
        self.along.body
    }

    fn fit(&self, pen: &Pen, corners: &mut Vec<Point>) -> Option<f64> {
        corners.extend(self.ends(pen));
        Some(SLOTTED_BAR)
    }
}
