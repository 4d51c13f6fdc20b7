//! Knife edges of cam followers.

use super::*;

/// The edge of a knife-edge follower; the x-axis points into the follower.
#[derive(Clone, Debug, PartialEq)]
pub struct Knife {
    /// The edge.
    pub at: Anchor,
}

/// Distance from the edge to where the knife is as wide as a bar.
const LENGTH: f64 = 17.0;

/// Composes the knife of a follower.
pub(super) fn compose(composer: &mut Composer, follower: Anchor, cam: Anchor) {
    let at = follower.turned_to(inwards(composer, follower, cam));
    composer.add(Knife { at });
}

/// Returns the direction, in the body's frame, from a follower's marker into the follower:
/// towards the middle of its other points, away from the cam if there are none.
fn inwards(composer: &Composer, follower: Anchor, cam: Anchor) -> f64 {
    let edge = Point::from(follower.position);
    let spans = follower.body.map(|body| &composer.spans[body.index()]);
    let others = composer.positions(follower.body).into_iter();
    let offsets: Point = others
        .chain(spans.into_iter().flatten().copied())
        .map(|point| Point::from(point) - edge)
        .sum();
    if offsets.norm() > 0.0 {
        return angle(offsets);
    }
    follower.angle + angle(-Point::from(composer.coordinates(follower, cam)))
}

impl Shape for Knife {
    fn draw(&self, pen: &mut Pen) {
        let (edge, inwards, colour) = pen.on(self.at);
        // The flanks touch the round end of the bar.
        let sine = BAR / LENGTH;
        let cosine = (1.0 - sine * sine).sqrt();
        let flank = LENGTH * cosine;
        let [left, right] = [1.0, -1.0]
            .map(|side| edge + flank * (cosine * inwards + side * sine * across(inwards)));
        let flanks = [left, edge, right];
        let fill = (colour.tint(0.45), 1.0);
        pen.area(Layer::Slot, Outline::polygon(&flanks), fill, None);
        pen.line(Layer::Slot, Outline::line(&flanks), colour, LINE);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }

    fn fitted(&self) -> Option<BodyId> {
        self.at.body
    }

    /// Moves the corner of the body at the edge to where the knife begins.
    fn fit(&self, pen: &Pen, corners: &mut Vec<Point>) -> Option<f64> {
        let (edge, inwards) = pen.place(self.at);
        for corner in corners.iter_mut().filter(|corner| **corner == edge) {
            *corner += LENGTH * inwards;
        }
        None
    }
}
