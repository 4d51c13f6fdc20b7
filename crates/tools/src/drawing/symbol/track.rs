//! Tracks that wheels roll on.

use super::*;

/// A straight track along the x-axis of an anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Origin and axis.
    pub along: Anchor,
    /// The part of the axis that the wheel uses \[m\].
    pub range: [f64; 2],
    /// The wheel's centre, whose side of the axis stays free.
    pub wheel: Anchor,
}

/// Length of a track beyond the points of contact, as a part of the wheel's radius.
const END: f64 = 0.5;

/// Composes a track and the wheel that rolls on it.
pub(super) fn compose(composer: &mut Composer, [wheel, along]: [Anchor; 2], radius: &Expression) {
    let radius = composer.value(radius);
    wheel::add(composer, wheel, radius, false);
    let range = rack::range(composer, [wheel, along], END * radius);
    composer.add(Track {
        along,
        range,
        wheel,
    });
}

impl Shape for Track {
    fn draw(&self, pen: &mut Pen) {
        let (origin, axis, colour) = pen.on(self.along);
        let ends = pen.ends(self.along, self.range);
        let (centre, _) = pen.place(self.wheel);
        let up = across(axis);
        let away = if up.dot(&(centre - origin)) > 0.0 {
            -up
        } else {
            up
        };
        if self.along.body.is_none() {
            pen.hatched(ends, away);
            return;
        }
        let middle = ends.map(|end| end + BAR * away);
        let outline = Outline::around(&middle, BAR);
        pen.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
        pen.offer_beside(self.along.body, middle, -away);
    }

    fn extent(&self) -> Vec<Disc> {
        self.along.part(self.range).map(Disc::from).to_vec()
    }

    fn shows(&self) -> Option<BodyId> {
        self.along.body
    }

    fn covers(&self, point: Point) -> bool {
        self.along.has_on_axis(self.range, point)
    }
}
