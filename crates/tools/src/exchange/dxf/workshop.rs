//! A mechanism at a pose as a drawing for the workshop.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::arcs::{Sample, Vertex, fit};
use super::write::Entities;
use super::{SLIDE, SLOT};
use crate::drawing::{Anchor, Scene, Symbol};
use crate::exchange::note::Note;
use biela::kinematics::Solver;
use biela::mechanism::{
    BodyId, CamFollower, Curve, Expression, Joint, MarkerId, Mechanism, Profile, ProfileInForce,
};

/// Greatest distance of arcs from the contours of cams and from curves: what a mill repeats \[mm\].
const TOLERANCE: f64 = 1e-3;

/// Radius of the circle of a pin, as a part of the drawing's size.
const PIN: f64 = 0.012;

/// A drawing with remarks on what it leaves out.
#[derive(Clone, Debug)]
pub struct WorkshopDrawing {
    /// The drawing, in DXF of release 12.
    pub text: String,
    /// Contours that it leaves out.
    pub notes: Vec<Note>,
}

impl WorkshopDrawing {
    /// Draws the scene of a mechanism at the solver's pose.
    #[must_use]
    pub fn new(scene: &Scene, solver: &Solver) -> Self {
        let mut writer = Writer::new(scene, solver);
        writer.outlines();
        writer.joints();
        writer.points();
        writer.paths();
        Self {
            text: writer.entities.drawing(),
            notes: writer.notes,
        }
    }
}

struct Writer<'a> {
    scene: &'a Scene,
    mechanism: &'a Mechanism,
    parameters: &'a [f64],
    q: &'a [f64],
    /// Radius of the circles of pins \[mm\].
    pin: f64,
    entities: Entities,
    notes: Vec<Note>,
    /// Circles that stand already: layer and place.
    drawn: BTreeSet<(String, [u64; 2])>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, solver: &'a Solver) -> Self {
        Self {
            scene,
            mechanism: solver.mechanism(),
            parameters: &solver.pose().parameters,
            q: &solver.pose().q,
            pin: 1000.0 * PIN * solver.size(),
            entities: Entities::default(),
            notes: Vec::new(),
            drawn: BTreeSet::new(),
        }
    }

    fn value(&self, expression: &Expression) -> f64 {
        expression.value(self.parameters)
    }

    fn layer(&self, body: Option<BodyId>) -> String {
        body.map_or("ground".to_owned(), |body| {
            self.mechanism.bodies[body.index()].name.clone()
        })
    }

    fn anchor(&self, marker: MarkerId) -> Anchor {
        let marker = &self.mechanism.markers[marker.index()];
        Anchor {
            body: marker.body,
            position: marker.position.each_ref().map(|e| self.value(e)),
            angle: self.value(&marker.angle),
        }
    }

    /// Returns the place of a point of a body \[mm\].
    fn place(&self, body: Option<BodyId>, position: [f64; 2]) -> [f64; 2] {
        let anchor = Anchor {
            body,
            position,
            angle: 0.0,
        };
        anchor.placed(self.q).point.map(|x| 1000.0 * x).into()
    }

    fn at(&self, anchor: Anchor) -> [f64; 2] {
        self.place(anchor.body, anchor.position)
    }

    /// Adds a pin's circle on a layer, once; returns whether it is new.
    fn pin(&mut self, layer: &str, at: [f64; 2], radius: f64) -> bool {
        let is_new = self.drawn.insert((layer.to_owned(), at.map(f64::to_bits)));
        if is_new {
            self.entities.circle(layer, at, radius);
        }
        is_new
    }

    fn name(&mut self, layer: &str, at: [f64; 2], name: &str) {
        let beside = at.map(|x| x + 0.8 * self.pin);
        self.entities.write(layer, beside, 1.5 * self.pin, name);
    }

    /// Adds bars and plates through the points of bodies, faces and wheels.
    fn outlines(&mut self) {
        for symbol in &self.scene.symbols {
            match symbol {
                Symbol::Link(link) => {
                    let hull = link.hull();
                    let layer = self.layer(Some(link.body));
                    let corners = hull.iter().map(|p| self.place(Some(link.body), *p));
                    let corners: Vec<[f64; 2]> = corners.collect();
                    match corners[..] {
                        [] | [_] => {}
                        [a, b] => self.entities.line(&layer, [a, b]),
                        _ => self.entities.polyline(&layer, &straight(&corners), true),
                    }
                }
                Symbol::Wheel(wheel) => {
                    let layer = self.layer(wheel.at.body) + "_gear";
                    let at = self.at(wheel.at);
                    self.entities.circle(&layer, at, 1000.0 * wheel.radius);
                }
                Symbol::Face(face) => {
                    let layer = self.layer(face.along.body);
                    let ends = self.part(face.along, face.range);
                    self.entities.line(&layer, ends);
                }
                Symbol::Rope(rope) => {
                    let points: Vec<_> = rope.points.iter().map(|point| self.at(*point)).collect();
                    self.entities.polyline("rope", &straight(&points), false);
                }
                _ => {}
            }
        }
    }

    /// Returns the ends of a part of an anchor's x-axis \[mm\].
    fn part(&self, along: Anchor, range: [f64; 2]) -> [[f64; 2]; 2] {
        let (sin, cos) = along.angle.sin_cos();
        range.map(|s| {
            let [x, y] = along.position;
            self.place(along.body, [x + s * cos, y + s * sin])
        })
    }

    fn joints(&mut self) {
        for joint in &self.mechanism.joints {
            let [from, to] = [joint.from, joint.to].map(|marker| self.anchor(marker));
            let layers = [from, to].map(|anchor| self.layer(anchor.body));
            if joint.is_pin() {
                // One circle for both: they coincide, up to rounding.
                let at = self.at(from);
                for layer in &layers {
                    self.pin(layer, at, self.pin);
                }
                self.name(&layers[0], at, &joint.name);
            }
            if joint.rod().is_some() {
                let ends = [from, to].map(|end| self.at(end));
                for (layer, at) in layers.iter().zip(ends) {
                    self.pin(layer, at, self.pin);
                    self.pin(&joint.name, at, self.pin);
                }
                self.entities.line(&joint.name, ends);
            }
            match joint.guide() {
                Some(guide) if guide.turns => {
                    let aside = guide.aside.map_or(0.0, |aside| self.value(aside));
                    self.way(joint, from, to, aside);
                }
                Some(_) => {
                    let range = self.range(from, to);
                    let layer = format!("{}{SLIDE}{}", layers[0], layers[1]);
                    let ends = self.part(from, range);
                    self.entities.line(&layer, ends);
                }
                None => {}
            }
            if let Some((follower, profile)) = joint.cam() {
                self.cam(from, to, follower, profile);
            }
            if let Some(curve) = joint.curve() {
                self.curve(from, to, curve);
            }
        }
    }

    /// Adds the line along which a point slides, and its pin.
    fn way(&mut self, joint: &Joint, from: Anchor, to: Anchor, aside: f64) {
        let (sin, cos) = from.angle.sin_cos();
        let [x, y] = from.position;
        let along = Anchor {
            position: [x - aside * sin, y + aside * cos],
            ..from
        };
        let range = self.range(along, to);
        let layer = self.layer(from.body) + SLOT;
        let ends = self.part(along, range);
        self.entities.line(&layer, ends);
        let (layer, at) = (self.layer(to.body), self.at(to));
        if self.pin(&layer, at, self.pin) {
            self.name(&layer, at, &joint.name);
        }
    }

    /// Returns the part of an axis that the motion needs \[m\].
    fn range(&self, along: Anchor, to: Anchor) -> [f64; 2] {
        let mut ways = self.scene.symbols.iter().filter_map(|symbol| match symbol {
            Symbol::SlideWay(way) => Some((way.along, way.range)),
            Symbol::Slot(slot) => Some((slot.along, slot.range)),
            _ => None,
        });
        let bits = |axis: &Anchor| (axis.body, axis.position.map(f64::to_bits));
        let known = ways.find(|(axis, _)| bits(axis) == bits(&along));
        if let Some((_, range)) = known {
            return range;
        }
        let (origin, point) = (along.placed(self.q), to.placed(self.q));
        let (sin, cos) = origin.angle.sin_cos();
        let way = point.point - origin.point;
        let s = way.x * cos + way.y * sin;
        let around = 4e-3 * self.pin;
        [s - around, s + around]
    }

    /// Adds the contour of a cam; of a roller's, also the way of its centre and the far side of a
    /// groove, at one and two radii.
    fn cam(&mut self, cam: Anchor, to: Anchor, follower: &CamFollower, profile: &Profile) {
        let mut in_force = ProfileInForce::new(profile, self.parameters.len());
        if in_force
            .set_parameters(|id| self.parameters[id.index()])
            .is_err()
        {
            return;
        }
        let body = self.layer(cam.body);
        let mut contours = vec![("contour", 0.0)];
        if let CamFollower::Roller { radius } = follower {
            let radius = self.value(radius);
            contours.extend([("pitch", radius), ("outer", 2.0 * radius)]);
            let (layer, at) = (self.layer(to.body), self.at(to));
            self.pin(&layer, at, 1000.0 * radius);
        }
        let frame = cam.placed(self.q);
        let origin = <[f64; 2]>::from(frame.point).map(|x| 1000.0 * x);
        for (name, offset) in contours {
            let layer = format!("{body}_{name}");
            // A parallel of a hollow narrower than the offset has cusps.
            let is_smooth = |theta: f64| {
                let point = in_force.point(theta);
                point.speed[0] + offset * point.turn[0] > 0.0
            };
            if !ProfileInForce::sample_angles().all(is_smooth) {
                self.notes.push(Note::Cusp { layer });
                continue;
            }
            let curve = |theta: f64| -> Sample {
                let point = in_force.point(theta);
                let [tx, ty] = point.tangent;
                let at = [point.arm[0] + offset * ty, point.arm[1] - offset * tx];
                placed(origin, frame.angle, at.map(|x| 1000.0 * x), point.tangent)
            };
            let mut vertices = fit(&curve, [0.0, TAU], TOLERANCE);
            // The first vertex follows the last one.
            vertices.pop();
            self.entities.polyline(&layer, &vertices, true);
        }
    }

    /// Adds the curve along which a point moves.
    fn curve(&mut self, at: Anchor, to: Anchor, curve: &Curve) {
        let layer = self.layer(at.body) + "_curve";
        let frame = at.placed(self.q);
        let origin = <[f64; 2]>::from(frame.point).map(|x| 1000.0 * x);
        let offset = curve
            .offset
            .as_ref()
            .map_or(0.0, |offset| self.value(offset));
        let parameter = |id: biela::mechanism::ParameterId| self.parameters[id.index()];
        let sample = |place: f64| -> Option<Sample> {
            let [x, y] = curve.shape.at(&parameter, place);
            let speed = x.first().hypot(y.first());
            let tangent = [x.first() / speed, y.first() / speed];
            let local = [
                1000.0 * (x.value - offset * tangent[1]),
                1000.0 * (y.value + offset * tangent[0]),
            ];
            let is_finite = local.iter().chain(&tangent).all(|x| x.is_finite());
            is_finite.then(|| placed(origin, frame.angle, local, tangent))
        };
        /// Places at which the curve is examined.
        const PLACES: u32 = 240;
        if (0..=PLACES).any(|k| sample(f64::from(k) / f64::from(PLACES)).is_none()) {
            self.notes.push(Note::Cusp { layer });
            return;
        }
        let start = sample(0.0).unwrap_or_default();
        let fitted = |place: f64| sample(place).unwrap_or(start);
        let mut vertices = fit(&fitted, [0.0, 1.0], TOLERANCE);
        if curve.closed {
            vertices.pop();
        }
        self.entities.polyline(&layer, &vertices, curve.closed);
        let (layer, at) = (self.layer(to.body), self.at(to));
        self.pin(&layer, at, self.pin);
    }

    /// Adds points of interest.
    fn points(&mut self) {
        for &marker in &self.mechanism.outputs.markers {
            let anchor = self.anchor(marker);
            let (layer, at) = (self.layer(anchor.body), self.at(anchor));
            if self.pin(&layer, at, self.pin / 2.0) {
                let name = self.mechanism.markers[marker.index()].name.clone();
                self.name(&layer, at, &name);
            }
        }
    }

    /// Adds the paths of the points of interest.
    fn paths(&mut self) {
        for symbol in &self.scene.symbols {
            if let Symbol::Trace(trace) = symbol {
                let points: Vec<_> = trace.points.iter().map(|p| p.map(|x| 1000.0 * x)).collect();
                self.entities.polyline("path", &straight(&points), false);
            }
        }
    }
}

/// Returns vertices without arcs.
fn straight(points: &[[f64; 2]]) -> Vec<Vertex> {
    let vertex = |&at| Vertex { at, bulge: 0.0 };
    points.iter().map(vertex).collect()
}

/// Returns a sample of a curve in a frame that is turned and moved.
fn placed(origin: [f64; 2], angle: f64, at: [f64; 2], tangent: [f64; 2]) -> Sample {
    let (sin, cos) = angle.sin_cos();
    let turned = |[x, y]: [f64; 2]| [x * cos - y * sin, x * sin + y * cos];
    let [x, y] = turned(at);
    ([origin[0] + x, origin[1] + y], turned(tangent))
}
