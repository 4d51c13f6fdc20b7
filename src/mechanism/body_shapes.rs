//! Shapes within a mechanism: their names, the masses that they give bodies, and their faults.

use super::number::Number;
use super::shape::{Elements, Given, elements};
use super::{
    Body, BodyId, Coordinate, CoordinateKind, Expression, MarkerId, Mechanism, ParameterId, Piece,
    Section, Shape, ShapeFault, ShapeFaultKind, ShapeForm, ShapeId, Weight,
};

impl Body {
    /// Returns whether it has mass: the file gives it, or its shapes have a density.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.mass.is_some() || self.is_weighed
    }
}

impl Mechanism {
    /// Returns a shape's name with its body's: `pawl.nose`, `ground.floor`.
    #[must_use]
    pub fn shape_path(&self, id: ShapeId) -> String {
        let shape = &self.shapes[id.index()];
        let body = shape
            .body
            .map_or("ground", |body| &self.bodies[body.index()].name);
        format!("{body}.{}", shape.name)
    }

    /// Returns whether a measure or a contact has the clearance of a shape.
    #[must_use]
    pub fn has_clearance_of(&self, id: ShapeId) -> bool {
        let measures = self.measures.iter().map(|measure| &measure.coordinate);
        let stops = self.stops.iter().map(|stop| &stop.coordinate);
        measures
            .chain(stops)
            .filter_map(Coordinate::shapes)
            .any(|shapes| shapes.contains(&id))
    }

    /// Returns the elements of the contact of two shapes for these parameters.
    pub(super) fn elements(&self, shapes: [ShapeId; 2], parameters: &[f64]) -> Elements {
        let parameter = |id: ParameterId| parameters[id.index()];
        let shapes = shapes.map(|id| &self.shapes[id.index()]);
        self.on_bodies(&parameter, |given| elements(shapes, given))
    }

    /// Adds the forces of all contacts behind the others, one per element. The elements are those for the
    /// default values of parameters.
    pub(super) fn add_forces_of_contacts(&mut self) {
        let parameters = self.default_parameters();
        let has_freedoms = self.has_freedoms();
        let mut forces = Vec::new();
        for (index, stop) in self.stops.iter().enumerate() {
            let Some(shapes) = stop
                .coordinate
                .shapes()
                .filter(|_| stop.exerts(has_freedoms))
            else {
                continue;
            };
            let elements = self.elements(shapes, &parameters).runs.into_iter();
            forces.extend(elements.map(|runs| {
                let kind = CoordinateKind::Clearance(shapes, runs);
                stop.force(
                    index,
                    Coordinate {
                        kind,
                        ..stop.coordinate
                    },
                )
            }));
        }
        self.forces.extend(forces);
    }

    /// Returns the shapes of a body, of ground for `None`.
    pub fn shapes_of(&self, body: Option<BodyId>) -> impl Iterator<Item = (ShapeId, &Shape)> {
        let all = (0..).map(ShapeId).zip(&self.shapes);
        all.filter(move |(_, shape)| shape.body == body)
    }

    /// Shows `look` the places of markers on their bodies and the values of numbers for these parameters.
    fn on_bodies<N: Number, T>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        look: impl FnOnce(&Given<'_, N>) -> T,
    ) -> T {
        let number = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        let point = |id: MarkerId| self.markers[id.index()].position.each_ref().map(number);
        look(&Given {
            point: &point,
            number: &number,
        })
    }

    /// Shows `visit` the pieces of a shape's boundary, counter-clockwise round its area, in the frame of
    /// its body \[m\].
    pub fn boundary(&self, shape: &Shape, parameters: &[f64], visit: &mut dyn FnMut(Piece<f64>)) {
        let parameter = |id: ParameterId| parameters[id.index()];
        self.on_bodies(&parameter, |given| shape.boundary(given, visit));
    }

    /// Returns the fault of the first shape without a proper outline for these parameters. Allocates
    /// nothing unless there is one.
    #[must_use]
    pub fn shape_fault(&self, parameters: &[f64]) -> Option<ShapeFault> {
        let parameter = |id: ParameterId| parameters[id.index()];
        (0..self.shapes.len()).map(ShapeId).find_map(|id| {
            let shape = &self.shapes[id.index()];
            let (kind, corner) = self.on_bodies(&parameter, |given| shape.fault(given))?;
            let at = corner.and_then(|corner| shape.markers().nth(corner));
            Some(ShapeFault {
                shape: self.shape_path(id),
                kind,
                marker: at.map(|id| self.markers[id.index()].name.clone()),
            })
        })
    }

    /// Returns the mass of a body with its distribution, `None` for a massless one. Allocates nothing.
    pub fn weight<N: Number>(
        &self,
        id: BodyId,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> Option<Weight<N>> {
        let body = &self.bodies[id.index()];
        let value = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        // Without a mass, inertia and centre have no effect.
        let Some(mass) = &body.mass else {
            return self.weight_of_shapes(id, parameter);
        };
        let center = body.center.as_ref();
        Some(Weight {
            mass: value(mass),
            center: center.map_or([N::constant(0.0); 2], |center| center.each_ref().map(value)),
            inertia: body.inertia.as_ref().map_or(N::constant(0.0), value),
        })
    }

    /// Returns the same for plain values of the parameters.
    #[must_use]
    pub fn weight_at(&self, id: BodyId, parameters: &[f64]) -> Option<Weight<f64>> {
        self.weight(id, &|id: ParameterId| parameters[id.index()])
    }

    /// Returns the numbers from which a body has its mass, centre and inertia.
    pub fn numbers_of_mass(&self, id: BodyId) -> impl Iterator<Item = &Expression> {
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
            inertia: sum.second - mass * (center[0] * center[0] + center[1] * center[1]),
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

    /// Returns the fault of the first shape whose boundary crosses itself, or of a hole that is not within
    /// a plate, for parameters for which no shape has a [fault](Self::shape_fault).
    #[must_use]
    pub fn crossing_fault(&self, parameters: &[f64]) -> Option<ShapeFault> {
        let parameter = |id: ParameterId| parameters[id.index()];
        let fault = |id: ShapeId, kind| {
            Some(ShapeFault {
                shape: self.shape_path(id),
                kind,
                marker: None,
            })
        };
        for id in (0..self.shapes.len()).map(ShapeId) {
            let shape = &self.shapes[id.index()];
            if self.on_bodies(&parameter, |given| shape.crosses_itself(given)) {
                return fault(id, ShapeFaultKind::Crossing);
            }
            let ShapeForm::Hole { marker, radius } = &shape.form else {
                continue;
            };
            let is_within = self.on_bodies(&parameter, |given| {
                let (center, radius) = ((given.point)(*marker), (given.number)(radius));
                let mut plates = self
                    .shapes_of(shape.body)
                    .filter(|(_, plate)| plate.is_plate());
                plates.any(|(_, plate)| plate.encloses(given, center, radius))
            });
            if !is_within {
                return fault(id, ShapeFaultKind::HoleOutside);
            }
        }
        None
    }
}
