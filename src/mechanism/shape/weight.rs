//! Area, centre and second moment of shapes by Green's theorem, and what they weigh.

use super::chain::{Piece, cross, dot, sub, zero};
use super::{Given, Shape, ShapeForm};
use crate::mechanism::{Body, BodyId, Expression, Mechanism, Number, ParameterId};

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

impl<N: Number> Section<N> {
    fn nothing() -> Self {
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
    fn add(&mut self, factor: N, other: &Self) {
        self.area += factor * other.area;
        for i in 0..2 {
            self.first[i] += factor * other.first[i];
        }
        self.second += factor * other.second;
    }
}

impl Shape {
    /// Returns the section of the area within the boundary.
    pub(super) fn section<N: Number>(&self, given: &Given<'_, N>) -> Section<N> {
        let mut section = Section::nothing();
        self.boundary(given, &mut |piece| section.add_piece(&piece));
        section
    }

    /// Returns whether a point of the body's frame lies within the boundary.
    pub(super) fn contains<N: Number>(&self, given: &Given<'_, N>, point: [f64; 2]) -> bool {
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

impl Body {
    /// Returns whether it has mass: the file gives it, or its shapes have a density.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.mass.is_some() || self.is_weighed
    }
}

impl Mechanism {
    /// Returns the mass of a body with its distribution, `None` for a massless one. Allocates nothing.
    pub fn weight<N: Number>(
        &self,
        id: BodyId,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> Option<Weight<N>> {
        let body = &self.bodies[id.index()];
        let value = |expression: &Expression| expression.evaluate(parameter, zero());
        // Without a mass, inertia and centre have no effect.
        let Some(mass) = &body.mass else {
            return self.weight_of_shapes(id, parameter);
        };
        let center = body.center.as_ref();
        Some(Weight {
            mass: value(mass),
            center: center.map_or([zero(); 2], |center| center.each_ref().map(value)),
            inertia: body.inertia.as_ref().map_or(zero(), value),
        })
    }

    /// Returns the same for plain values of the parameters.
    #[must_use]
    pub fn weight_at(&self, id: BodyId, parameters: &[f64]) -> Option<Weight<f64>> {
        self.weight(id, &|id: ParameterId| parameters[id.index()])
    }

    /// Returns the numbers from which a body has its mass, centre and inertia.
    pub fn numbers_of_mass<'a>(&'a self, id: BodyId) -> impl Iterator<Item = &'a Expression> {
        let body = &self.bodies[id.index()];
        let center = body.center.iter().flatten();
        let given = body.mass.iter().chain(&body.inertia).chain(center);
        let shapes = body.is_weighed.then_some(&self.shapes);
        let shapes = shapes.into_iter().flatten();
        let shapes = shapes.filter(move |shape| shape.body == Some(id));
        let numbers = shapes.flat_map(|shape| {
            let markers = shape.markers();
            let places = markers.flat_map(|id| &self.markers[id.index()].position);
            let weight = shape.weight.iter().flatten();
            shape.numbers().chain(places).chain(weight)
        });
        given.chain(numbers)
    }

    /// Returns the section of a body's shapes that have an area, without holes; those that overlap count
    /// twice. `None` without such a shape.
    #[must_use]
    pub fn section_of(&self, id: BodyId, parameters: &[f64]) -> Option<Section<f64>> {
        let parameter = |id: ParameterId| parameters[id.index()];
        self.on_bodies(&parameter, |given| {
            self.sum_of_plates(id, given, &|_| Some(1.0))
        })
    }

    /// Returns the mass of a body that its shapes give it, `None` if they have no density. Allocates
    /// nothing.
    fn weight_of_shapes<N: Number>(
        &self,
        id: BodyId,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> Option<Weight<N>> {
        if !self.bodies[id.index()].is_weighed {
            return None;
        }
        let sum = self.on_bodies(parameter, |given| {
            self.sum_of_plates(id, given, &|shape| {
                let [thickness, density] = shape.weight.as_ref()?;
                Some((given.number)(thickness) * (given.number)(density))
            })
        })?;
        let mass = sum.area;
        let center = sum.first.map(|first| first / mass);
        Some(Weight {
            mass,
            center,
            inertia: sum.second - mass * dot(center, center),
        })
    }

    /// Returns whether a point of its body's frame lies in a shape.
    #[must_use]
    pub fn covers(&self, shape: &Shape, point: [f64; 2], parameters: &[f64]) -> bool {
        let parameter = |id: ParameterId| parameters[id.index()];
        self.on_bodies(&parameter, |given| shape.contains(given, point))
    }

    /// Returns whether a hole is taken out of another shape of its body: whether its centre lies in it.
    #[must_use]
    pub fn lies_in(&self, hole: &Shape, plate: &Shape, parameters: &[f64]) -> bool {
        let ShapeForm::Hole { marker, .. } = &hole.form else {
            return false;
        };
        let parameter = |id: ParameterId| parameters[id.index()];
        self.on_bodies(&parameter, |given| {
            plate.is_plate() && plate.contains(given, (given.point)(*marker))
        })
    }

    /// Adds the sections of a body's plates, without the holes in them, each multiplied by a factor; those
    /// without a factor are left out. `None` if all are.
    fn sum_of_plates<N: Number>(
        &self,
        id: BodyId,
        given: &Given<'_, N>,
        factor: &dyn Fn(&Shape) -> Option<N>,
    ) -> Option<Section<N>> {
        let mut sum = None;
        for (_, plate) in self.shapes_of(Some(id)) {
            let Some(factor) = plate.is_plate().then(|| factor(plate)).flatten() else {
                continue;
            };
            let sum = sum.get_or_insert_with(Section::nothing);
            sum.add(factor, &plate.section(given));
            for (_, hole) in self.shapes_of(Some(id)) {
                let ShapeForm::Hole { marker, .. } = &hole.form else {
                    continue;
                };
                let center = (given.point)(*marker).map(Number::real);
                if plate.contains(given, center) {
                    sum.add(-factor, &hole.section(given));
                }
            }
        }
        sum
    }
}
