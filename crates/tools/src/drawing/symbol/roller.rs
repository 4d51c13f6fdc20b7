//! Rollers of cam followers.

use super::*;

/// The roller of a follower.
#[derive(Clone, Debug, PartialEq)]
pub struct Roller {
    /// Its centre.
    pub at: Anchor,
    /// Its radius \[m\].
    pub radius: f64,
}

/// Composes the roller of a follower, with its pin.
pub(super) fn compose(composer: &mut Composer, follower: Anchor, radius: &Expression) {
    let radius = composer.value(radius);
    let at = follower.turned_to(0.0);
    composer.add(Roller { at, radius });
    composer.add(Pin { at });
}

impl Shape for Roller {
    fn draw(&self, pen: &mut Pen) {
        let (center, _, colour) = pen.on(self.at);
        let radius = self.radius * pen.scale;
        let outline = Outline::circle(center, radius);
        pen.area(Layer::Slot, outline, (colour.tint(0.2), 1.0), Some(colour));
        // The part that carries the roller names the body better.
        let places = Candidate::around(center, radius.max(PIN) + 1.0);
        pen.offer(self.at.body, places.map(|place| place.costlier(4.0)));
    }

    fn extent(&self) -> Vec<Disc> {
        vec![Disc::new(self.at, self.radius)]
    }

    fn shows(&self) -> Option<BodyId> {
        self.at.body
    }

    fn tracked(&self) -> Option<Anchor> {
        Some(self.at)
    }
}
