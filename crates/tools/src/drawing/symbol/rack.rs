//! Racks.

use super::*;

/// A rack, its pitch line along the x-axis of an anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct Rack {
    /// Origin and axis.
    pub along: Anchor,
    /// The part of the axis with teeth \[m\].
    pub range: [f64; 2],
    /// Whether the teeth are on the side of the anchor's y-axis.
    pub above: bool,
}

/// Pitch and height of the teeth.
const TOOTH: [f64; 2] = [9.0, 5.0];
/// Distance of the back from the pitch line.
pub(super) const BACK: f64 = 0.5 * TOOTH[1] + 2.0 * BAR;
/// Length of a rack beyond its points of contact, as a part of the pinion's radius.
pub(super) const END: f64 = 0.6;

/// Composes a rack and its pinion.
pub(super) fn compose(
    composer: &mut Composer,
    [pinion, rack]: [Anchor; 2],
    radius: &Expression,
    side: RackSide,
) {
    let radius = composer.value(radius);
    wheel::add(composer, pinion, radius, false);
    let range = range(composer, [pinion, rack], END * radius);
    composer.add(Rack {
        along: rack,
        range,
        above: side == RackSide::Above,
    });
}

/// Returns the part of an axis that a wheel uses: its points of contact over the motion and `end`
/// beyond them, and its body's markers on the axis \[m\].
pub(super) fn range(composer: &Composer, [wheel, along]: [Anchor; 2], end: f64) -> [f64; 2] {
    let [low, high] = composer.range(along, wheel);
    composer.with_markers(along, [low - end, high + end])
}

impl Shape for Rack {
    fn draw(&self, pen: &mut Pen) {
        let (_, axis, colour) = pen.on(self.along);
        let [start, end] = pen.ends(self.along, self.range);
        let towards = if self.above {
            -across(axis)
        } else {
            across(axis)
        };
        let [pitch, height] = TOOTH;
        let length = (end - start).norm();
        let count = (length / pitch).round().max(1.0);
        let pitch = length / count;
        let (root, tip) = (-0.5 * height * towards, 0.5 * height * towards);
        let at = |s: f64| start + s * axis;
        let mut profile = vec![at(0.0) + root];
        for k in 0..count as usize {
            let s = k as f64 * pitch;
            profile.extend([
                at(s + 0.1 * pitch) + root,
                at(s + 0.3 * pitch) + tip,
                at(s + 0.7 * pitch) + tip,
                at(s + 0.9 * pitch) + root,
            ]);
        }
        profile.push(at(length) + root);
        if self.along.body.is_some() {
            let back = -BACK * towards;
            profile.extend([at(length) + back, at(0.0) + back]);
            let outline = Outline::polygon(&profile);
            pen.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
            pen.offer_beside(self.along.body, [start + back, end + back], -towards);
        } else {
            pen.line(Layer::Ground, Outline::line(&profile), Colour::GROUND, LINE);
            let under = -(0.5 * height + 4.0) * towards;
            pen.hatched([start + under, end + under], -towards);
        }
        let pitch_line = Outline::line(&[start, end]);
        pen.dashed(Layer::Slot, pitch_line, colour, THIN, DASH_DOTS);
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
