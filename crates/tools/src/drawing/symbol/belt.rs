//! Belts and chains around two wheels.

use super::*;

/// A belt around two wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct Belt {
    /// Their centres.
    pub centers: [Anchor; 2],
    /// Their radii \[m\].
    pub radii: [f64; 2],
    /// Whether the belt crosses between them.
    pub crossed: bool,
}

/// Sum of the radii of wheels given by teeth, as a part of the distance of their centres.
const WHEELS: f64 = 0.6;

/// Composes a belt joint: two wheels with the belt around them.
pub(super) fn compose(
    composer: &mut Composer,
    centers: [Anchor; 2],
    sizes: &WheelSizes,
    crossed: bool,
) {
    let length = WHEELS * composer.distance(centers);
    let radii = wheel::radii(composer, sizes, length, |[a, b]| a + b);
    for (at, radius) in centers.into_iter().zip(radii) {
        wheel::add(composer, at, radius, false);
    }
    composer.add(Belt {
        centers,
        radii,
        crossed,
    });
}

impl Shape for Belt {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::between(self.centers));
        let [a, b] = self.centers.map(|center| pen.place(center).0);
        let [r, s] = self.radii.map(|radius| radius * pen.scale);
        let (along, distance) = (unit(b - a), (b - a).norm());
        let far = if self.crossed { -s } else { s };
        // The tangents touch both circles under the same angle from the line of centres.
        let cosine = (r - far) / distance;
        if cosine.abs() >= 1.0 {
            return;
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        for side in [1.0, -1.0] {
            let normal = cosine * along + side * sine * across(along);
            let tangent = Outline::line(&[a + r * normal, b + far * normal]);
            pen.line(Layer::Wheel, tangent, Colour::INK, LINE);
        }
        for (center, radius) in [(a, r), (b, s)] {
            let circle = Outline::circle(center, radius);
            pen.line(Layer::Wheel, circle, Colour::INK, LINE);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        let wheels = self.centers.into_iter().zip(self.radii);
        wheels
            .map(|(center, radius)| Disc::new(center, radius))
            .collect()
    }
}
