//! Cylinders: a barrel, and a rod that slides in it.

use super::*;

/// Length of a barrel as a part of the cylinder's least length: the rod never leaves it.
const BARREL: f64 = 0.6;
/// Half the width of a barrel, and the width of a rod.
pub(super) const HALF: f64 = 4.5;
const ROD: f64 = 2.4;
/// Least length of a barrel beyond the pin.
const SHORT: f64 = 6.0;

/// Returns the length of a barrel between two points that come no nearer to each other than over
/// the motion and than `least` \[m\].
pub(super) fn barrel(composer: &Composer, ends: [Anchor; 2], least: Option<f64>) -> f64 {
    let lengths = composer.poses().map(|q| {
        let [a, b] = ends.map(|end| end.placed(q).point);
        (b - a).norm()
    });
    BARREL * lengths.chain(least).fold(f64::INFINITY, f64::min)
}

/// Draws a cylinder along a line, with its barrel, of a length \[m\], at the line's first end.
pub(super) fn draw(pen: &mut Pen, layer: Layer, line: Line, barrel: f64, colour: Colour) {
    pen.attach(Attachment::Line {
        line,
        end: End::First,
    });
    let [start, end] = line.ends(pen.q, pen.scale);
    let along = unit(end - start);
    let length = (pen.scale * barrel).max(PIN + SHORT);
    let rod = vec![
        [Point::new(length, 0.0), Point::zeros()],
        [Point::new(-PIN, 0.0), Point::x()],
    ];
    pen.elastic(layer, Measure::Length(line), rod, colour, ROD);
    let aside = HALF * across(along);
    let [back, front] = [PIN, length].map(|s| start + s * along);
    let outline = [back - aside, front - aside, front + aside, back + aside];
    let tint = colour.tint(0.3);
    pen.area(layer, Outline::polygon(&outline), (tint, 1.0), Some(colour));
}
