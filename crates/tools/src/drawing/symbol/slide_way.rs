//! Ways on ground that blocks, points and long bodies slide along.

use super::*;

/// A way on ground along the x-axis of an anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct SlideWay {
    /// Origin and axis.
    pub along: Anchor,
    /// The part of the axis that is used \[m\].
    pub range: [f64; 2],
    /// Position of the way.
    pub side: WaySide,
    /// The part that slides along it.
    pub contact: GuideContact,
}

/// The sides of its axis on which a way on ground lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaySide {
    /// The side of the y-axis.
    Above,
    /// The other side.
    Below,
    /// Both sides: the body slides between them.
    Both,
}

/// The part of a body that slides along a way on ground: it decides how far from its axis the way
/// lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuideContact {
    /// A block.
    Block,
    /// A point.
    Point,
    /// A bar along the axis.
    Bar,
    /// The back of a rack whose pitch line is the axis.
    Rack,
}

/// Length of the way beyond the sliding part.
const BEYOND: f64 = 6.0;

/// Composes the way of a body that slides along an axis on ground: beneath a block, on the side
/// where less of the mechanism is, and on both sides of a point.
pub(super) fn compose(
    composer: &mut Composer,
    along: Anchor,
    range: [f64; 2],
    sliding: Option<BodyId>,
    contact: GuideContact,
) {
    let side = match contact {
        GuideContact::Block => free_side(composer, along, sliding),
        _ => WaySide::Both,
    };
    composer.add(SlideWay {
        along,
        range,
        side,
        contact,
    });
}

/// Returns the side of a way on which less of the mechanism is.
fn free_side(composer: &Composer, along: Anchor, sliding: Option<BodyId>) -> WaySide {
    let up = across(direction(along.angle));
    let origin = Point::from(along.position);
    let others = composer.markers();
    let lean: f64 = others
        .filter(|(body, _)| Some(*body) != sliding)
        .map(|(_, point)| up.dot(&(point - origin)))
        .sum();
    // Far less than the width of any mechanism, far more than rounding.
    if lean < -1e-6 {
        WaySide::Above
    } else {
        WaySide::Below
    }
}

impl Shape for SlideWay {
    fn draw(&self, pen: &mut Pen) {
        let (_, axis, _) = pen.on(self.along);
        let [start, end] = pen.ends(self.along, self.range);
        // On the sheet y points down.
        let up = -across(axis);
        let (half, away) = match self.contact {
            GuideContact::Point => (0.5 * slot::BLOCK[0], PIN),
            GuideContact::Block => (0.5 * BLOCK[0], 0.5 * BLOCK[1]),
            GuideContact::Bar => (0.0, BAR),
            GuideContact::Rack => (0.0, rack::BACK),
        };
        let more = (half + BEYOND) * axis;
        let sides: &[f64] = match self.side {
            WaySide::Above => &[1.0],
            WaySide::Below => &[-1.0],
            WaySide::Both => &[1.0, -1.0],
        };
        for sign in sides {
            let outwards = *sign * up;
            let aside = (away + 1.0) * outwards;
            pen.hatched([start - more + aside, end + more + aside], outwards);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        self.along.part(self.range).map(Disc::from).to_vec()
    }
}
