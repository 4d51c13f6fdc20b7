//! Area, centre and second moment of shapes by Green's theorem, and what they weigh.

use super::chain::{Piece, cross, dot, sub, zero};
use super::{Given, Shape};
use crate::mechanism::Number;

/// Area A, first moments ∫r dA and second moment ∫r·r dA about the origin of a body.
#[derive(Clone, Copy, Debug)]
pub struct Section<N> {
    /// Area \[m²\].
    pub area: N,
    /// First moments \[m³\].
    pub first: [N; 2],
    /// Polar second moment \[m⁴\].
    pub second: N,
}

/// Mass of a body with its distribution.
#[derive(Clone, Copy, Debug)]
pub struct Weight<N> {
    /// Mass \[kg\].
    pub mass: N,
    /// Centre of mass in the body's frame \[m\].
    pub center: [N; 2],
    /// Moment of inertia about the centre of mass \[kg m²\].
    pub inertia: N,
}

impl<N> Weight<N> {
    /// Returns the numbers in the order mass, x and y of the centre, inertia.
    pub fn numbers(self) -> [N; 4] {
        let [x, y] = self.center;
        [self.mass, x, y, self.inertia]
    }
}

impl<N: Number> Section<N> {
    pub(in crate::mechanism) fn nothing() -> Self {
        Self {
            area: zero(),
            first: [zero(); 2],
            second: zero(),
        }
    }

    /// Adds the area between a piece of the boundary and the origin.
    fn add_piece(&mut self, piece: &Piece<N>) {
        let [a, b] = piece.ends;
        let Some((c, radius, turn)) = piece.arc else {
            let k = cross(a, b);
            self.area += k * 0.5;
            for i in 0..2 {
                self.first[i] += (a[i] + b[i]) * k * (1.0 / 6.0);
            }
            self.second += k * (dot(a, a) + dot(a, b) + dot(b, b)) * (1.0 / 12.0);
            return;
        };
        let unit = |end| {
            let arm = sub(end, c);
            [arm[0] / radius, arm[1] / radius]
        };
        let (u, v) = (unit(a), unit(b));
        // Integrals of the cosine, the sine and their products over the arc.
        let (cos, sin) = (v[1] - u[1], u[0] - v[0]);
        let products = (v[0] * v[1] - u[0] * u[1]) * 0.5;
        let (cos_cos, sin_sin) = (turn * 0.5 + products, turn * 0.5 - products);
        let cos_sin = (v[1] * v[1] - u[1] * u[1]) * 0.5;
        let [x, y] = c;
        let q = x * cos + y * sin;
        let swept = q + radius * turn;
        self.area += radius * swept * 0.5;
        let third = radius * (1.0 / 3.0);
        self.first[0] += third * (x * swept + radius * (x * cos_cos + y * cos_sin + radius * cos));
        self.first[1] += third * (y * swept + radius * (x * cos_sin + y * sin_sin + radius * sin));
        let bent = x * x * cos_cos + x * y * cos_sin * 2.0 + y * y * sin_sin + radius * q;
        self.second +=
            radius * 0.25 * ((dot(c, c) + radius * radius) * swept + radius * bent * 2.0);
    }

    /// Adds the multiple of another section.
    pub(in crate::mechanism) fn add(&mut self, factor: N, other: &Self) {
        self.area += factor * other.area;
        for i in 0..2 {
            self.first[i] += factor * other.first[i];
        }
        self.second += factor * other.second;
    }
}

impl Shape {
    /// Returns the section of the area within the boundary.
    pub(in crate::mechanism) fn section<N: Number>(&self, given: &Given<'_, N>) -> Section<N> {
        let mut section = Section::nothing();
        self.boundary(given, &mut |piece| section.add_piece(&piece));
        section
    }

    /// Returns whether a point of the body's frame lies within the boundary.
    pub(in crate::mechanism) fn contains<N: Number>(
        &self,
        given: &Given<'_, N>,
        point: [f64; 2],
    ) -> bool {
        let mut turns = 0.0;
        self.boundary(given, &mut |piece| {
            let mut from = sub(piece.ends[0].map(Number::real), point);
            // An arc goes round the point as a chain of short chords does, if none of these passes it.
            let (count, arc) = match piece.arc {
                None => (1, None),
                Some((center, _, turn)) => (64, Some((center.map(Number::real), turn.real()))),
            };
            for k in 1..=count {
                let to = match arc {
                    Some((center, turn)) if k < count => {
                        let arm = sub(piece.ends[0].map(Number::real), center);
                        let (sin, cos) = (turn * k as f64 / count as f64).sin_cos();
                        let at = [cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]];
                        sub([center[0] + at[0], center[1] + at[1]], point)
                    }
                    _ => sub(piece.ends[1].map(Number::real), point),
                };
                turns += cross(from, to).atan2(dot(from, to));
                from = to;
            }
        });
        turns.abs() > std::f64::consts::PI
    }
}
