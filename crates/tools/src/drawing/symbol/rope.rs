//! Ropes over points and pulleys.

use super::*;
use biela::mechanism::Rope as RopeJoint;

/// A rope, taut between points and pulleys.
#[derive(Clone, Debug, PartialEq)]
pub struct Rope {
    /// The points and the centres of the pulleys, in order.
    pub points: Vec<Anchor>,
    /// Radii of the pulleys \[m\], positive on the left of the rope; zero for a point.
    pub radii: Vec<f64>,
}

/// Composes a rope with its pulleys.
pub(super) fn compose(composer: &mut Composer, rope: &RopeJoint) {
    let points = rope.points.iter();
    let points: Vec<Anchor> = points.map(|point| composer.anchor(point.marker)).collect();
    let radii = rope.points.iter();
    let radii = radii.map(|point| point.radius(&|id| composer.parameter(id)));
    let radii = radii.collect();
    for point in &points {
        pin::compose(composer, [*point; 2]);
    }
    composer.add(Rope { points, radii });
}

impl Rope {
    /// Returns the straight legs.
    fn legs(&self) -> impl Iterator<Item = Line> + '_ {
        let pairs = self.points.windows(2).zip(self.radii.windows(2));
        pairs.map(|(points, radii)| Line {
            radii: [radii[0], radii[1]],
            ..Line::between([points[0], points[1]])
        })
    }
}

impl Shape for Rope {
    fn draw(&self, pen: &mut Pen) {
        for (&center, &radius) in self.points.iter().zip(&self.radii) {
            if radius != 0.0 {
                let (center, _, colour) = pen.on(center);
                let circle = Outline::circle(center, radius.abs() * pen.scale);
                pen.area(Layer::Wheel, circle.clone(), (colour, 0.2), None);
                pen.line(Layer::Wheel, circle, Colour::INK, LINE);
            }
        }
        for line in self.legs() {
            pen.attach(Attachment::Line {
                line,
                end: End::First,
            });
            let ends = vec![[Point::zeros(); 2], [Point::zeros(), Point::x()]];
            pen.elastic(Layer::Wheel, Measure::Length(line), ends, Colour::INK, LINE);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        let discs = self.points.iter().zip(&self.radii);
        discs.map(|(center, radius)| Disc::new(*center, radius.abs())).collect()
    }
}
