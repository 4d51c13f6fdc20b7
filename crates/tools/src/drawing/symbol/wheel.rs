//! Gears: wheels by their pitch circles.

use std::f64::consts::TAU;

use super::*;

/// A wheel, by its pitch circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// Its centre; the x-axis is the mark that shows its rotation.
    pub at: Anchor,
    /// Radius of the pitch circle \[m\].
    pub radius: f64,
    /// Whether its teeth are inside.
    pub ring: bool,
}

/// Thickness of a ring gear, and length of the mark on a wheel.
const RIM: f64 = 10.0;

/// Composes a gear pair: two wheels, one of them a ring gear if the teeth are internal.
pub(super) fn compose(
    composer: &mut Composer,
    centers: [Anchor; 2],
    sizes: &WheelSizes,
    internal: bool,
) {
    // The pitch circles touch.
    let distance = composer.distance(centers);
    let sum = |[a, b]: [f64; 2]| if internal { (a - b).abs() } else { a + b };
    let radii = radii(composer, sizes, distance, sum);
    let larger = usize::from(radii[1] > radii[0]);
    for (index, (at, radius)) in centers.into_iter().zip(radii).enumerate() {
        add(composer, at, radius, internal && index == larger);
    }
}

/// Returns the radii of two wheels \[m\]. Those of wheels given by teeth have `length` \[m\] as their
/// `sum`.
pub(super) fn radii(
    composer: &Composer,
    sizes: &WheelSizes,
    length: f64,
    sum: impl Fn([f64; 2]) -> f64,
) -> [f64; 2] {
    let values = sizes.expressions().each_ref().map(|s| composer.value(s));
    match sizes {
        WheelSizes::Radii(_) => values,
        WheelSizes::Teeth(_) => values.map(|teeth| length * teeth / sum(values)),
    }
}

/// Adds a wheel. A wheel that meshes twice is one wheel, though the radii may differ by rounding.
pub(super) fn add(composer: &mut Composer, at: Anchor, radius: f64, ring: bool) {
    let known = composer.symbols.iter().any(|symbol| match symbol {
        Symbol::Wheel(other) => {
            other.at == at && (other.radius - radius).abs() < 1e-9 * radius && other.ring == ring
        }
        _ => false,
    });
    if !known {
        composer.symbols.push(Wheel { at, radius, ring }.into());
    }
}

impl Shape for Wheel {
    fn draw(&self, pen: &mut Pen) {
        let &Self { at, ring, .. } = self;
        let (center, axis, colour) = pen.on(at);
        let radius = self.radius * pen.scale;
        let mark = if ring {
            let mut rim = Outline::circle(center, radius);
            rim.0.extend(Outline::circle(center, radius + RIM).0);
            pen.line(Layer::Wheel, rim, colour, LINE);
            [radius, radius + RIM]
        } else {
            let pitch = Outline::circle(center, radius);
            pen.area(Layer::Wheel, pitch.clone(), (colour, 0.2), None);
            pen.dashed(Layer::Wheel, pitch, colour, LINE, DASH_DOTS);
            [(radius - RIM).max(0.6 * radius), radius]
        };
        if at.body.is_some() {
            // The mark shows how far the wheel has turned.
            let mark = Outline::line(&mark.map(|r| center + r * axis));
            pen.line(Layer::Wheel, mark, colour.shade(0.8), 2.4);
        } else if ring {
            let outer = radius + RIM;
            let count = (TAU * outer / (2.0 * HATCH)).round();
            let mut hatching = Outline::default();
            for k in 0..count as usize {
                let out = on_sheet_direction(k as f64 / count * TAU);
                let foot = center + outer * out;
                hatching.add_line(&[foot, foot + HATCH * (out - across(out))]);
            }
            pen.line(Layer::Wheel, hatching, colour, THIN);
        }
        let outside = if ring { radius + RIM } else { radius };
        pen.offer(at.body, Candidate::around(center, outside + 1.0));
        let bonus = if ring { 0.0 } else { ON_WHEEL };
        for part in [0.35, 0.6] {
            let inside = Candidate::around(center, part * radius);
            pen.offer(at.body, inside.map(|place| place.costlier(-bonus)));
        }
    }

    fn extent(&self) -> Vec<Disc> {
        vec![Disc::new(self.at, self.radius)]
    }

    fn shows(&self) -> Option<BodyId> {
        self.at.body
    }
}
