//! From a mechanism to its symbols.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use super::*;
use biela::mechanism::{
    Coordinate, CoordinateKind, Driver, Force, Load, MarkerId, Mechanism, ParameterId,
};

/// Returns the symbols of a mechanism at the pose q, for a motion through this pose.
pub(in crate::drawing) fn compose(
    mechanism: &Mechanism,
    parameters: &[f64],
    q: &[f64],
    motion: &[Vec<f64>],
    traces: bool,
) -> Vec<Symbol> {
    let mut composer = Composer::new(mechanism, parameters, q, motion);
    silhouette::compose(&mut composer);
    // The other joints decide where a follower reaches, which its knife points to.
    let is_cam = |joint: &&Joint| joint.cam().is_some();
    let (cams, others): (Vec<&Joint>, Vec<&Joint>) = mechanism.joints.iter().partition(is_cam);
    for joint in others.into_iter().chain(cams) {
        let ends = [joint.from, joint.to].map(|marker| composer.anchor(marker));
        compose_joint(&mut composer, joint, ends);
    }
    for driver in &mechanism.drivers {
        composer.driver(driver);
    }
    for stop in &mechanism.stops {
        end_stop::compose(&mut composer, stop);
    }
    for force in &mechanism.forces {
        composer.force(force);
    }
    composer.note_shown();
    for body in 0..mechanism.bodies.len() {
        link::compose(&mut composer, BodyId(body));
    }
    fixture::compose(&mut composer);
    for marker in &mechanism.outputs.markers {
        let name = point_name(mechanism, *marker);
        let at = composer.anchor(*marker);
        composer.symbols.push(InterestPoint { name, at }.into());
        if traces {
            trace::compose(&mut composer, at);
        }
    }
    composer.symbols
}

/// Returns letters of joints and lengths of bodies at the pose q, and sentences about them.
pub(in crate::drawing) fn compose_dimensions(
    mechanism: &Mechanism,
    parameters: &[f64],
    q: &[f64],
) -> (Vec<Symbol>, Vec<String>) {
    let mut composer = Composer::new(mechanism, parameters, q, &[]);
    let places = joint_letter::places(&composer);
    let mut notes = joint_letter::compose(&mut composer, &places);
    notes.extend(dimension::compose(&mut composer, &places));
    (composer.symbols, notes)
}

/// Returns the name of a point of interest, with its body where another one has the same name.
pub(super) fn point_name(mechanism: &Mechanism, id: MarkerId) -> String {
    let marker = &mechanism.markers[id.index()];
    let is_alike = |other: &&MarkerId| mechanism.markers[other.index()].name == marker.name;
    let body = marker.body.map(|body| &mechanism.bodies[body.index()].name);
    match body {
        Some(body) if mechanism.outputs.markers.iter().filter(is_alike).count() > 1 => {
            format!("{body}.{}", marker.name)
        }
        _ => marker.name.clone(),
    }
}

/// Returns the bits of a point; zeros of either sign are the same.
pub(super) fn bits(point: [f64; 2]) -> [u64; 2] {
    point.map(|x| (x + 0.0).to_bits())
}

/// The symbols so far, and the mechanism that they stand for.
pub(super) struct Composer<'a> {
    pub(super) mechanism: &'a Mechanism,
    parameters: &'a [f64],
    /// The pose, \[m, m, rad\] per body.
    pub(super) q: &'a [f64],
    /// Poses along the motion.
    pub(super) motion: &'a [Vec<f64>],
    pub(super) symbols: Vec<Symbol>,
    /// Indices of the symbols that show each body, known once all but the links are there.
    pub(super) shown_by: Vec<Vec<usize>>,
    /// Indices of the symbols [added](Self::add) at each place.
    added: HashMap<(Option<BodyId>, [u64; 2]), Vec<usize>>,
    /// Points that each body reaches besides its markers: the ends of its ways and slots.
    pub(super) spans: Vec<Vec<[f64; 2]>>,
    /// Points of ground that hold a body, with the body.
    pub(super) pivots: Vec<(Anchor, Option<BodyId>)>,
}

impl<'a> Composer<'a> {
    fn new(
        mechanism: &'a Mechanism,
        parameters: &'a [f64],
        q: &'a [f64],
        motion: &'a [Vec<f64>],
    ) -> Self {
        Self {
            mechanism,
            parameters,
            q,
            motion,
            symbols: Vec::new(),
            shown_by: vec![Vec::new(); mechanism.bodies.len()],
            added: HashMap::new(),
            spans: vec![Vec::new(); mechanism.bodies.len()],
            pivots: Vec::new(),
        }
    }

    pub(super) fn value(&self, expression: &Expression) -> f64 {
        expression.value(self.parameters)
    }

    pub(super) fn parameters(&self) -> &'a [f64] {
        self.parameters
    }

    /// Returns the value of a parameter.
    pub(super) fn parameter(&self, id: ParameterId) -> f64 {
        self.parameters[id.index()]
    }

    pub(super) fn anchor(&self, marker: MarkerId) -> Anchor {
        Anchor::of_marker(self.mechanism, self.parameters, marker)
    }

    /// Adds a symbol unless it is there already.
    pub(super) fn add(&mut self, symbol: impl Into<Symbol>) {
        let symbol = symbol.into();
        let place = symbol.shape().extent().first().map_or_else(
            || (None, [0.0; 2]),
            |disc| (disc.center.body, disc.center.position),
        );
        let place = (place.0, bits(place.1));
        let added = self.added.entry(place).or_default();
        if !added.iter().any(|&index| self.symbols[index] == symbol) {
            added.push(self.symbols.len());
            self.symbols.push(symbol);
        }
    }

    /// Notes which symbols show each body.
    fn note_shown(&mut self) {
        for (index, symbol) in self.symbols.iter().enumerate() {
            if let Some(body) = symbol.shape().shows() {
                self.shown_by[body.index()].push(index);
            }
        }
    }

    /// Notes a fixture for a point on ground that holds a body.
    pub(super) fn hold(&mut self, at: Anchor, held: Option<BodyId>) {
        if at.body.is_none() {
            self.pivots.push((at, held));
        }
    }

    /// Stretches a body along an axis as far as the parts that it carries there.
    pub(super) fn reach(&mut self, along: Anchor, range: [f64; 2]) {
        if let Some(body) = along.body {
            let ends = range.map(|s| along.on_axis(s));
            self.spans[body.index()].extend(ends.map(<[f64; 2]>::from));
        }
    }

    fn driver(&mut self, driver: &Driver) {
        let coordinate = &driver.coordinate;
        let [from, to] = [coordinate.from, coordinate.to].map(|marker| self.anchor(marker));
        if coordinate.kind.is_angle() {
            return angle_driver::compose(self, driver, from, to);
        }
        let axis = self.axis(coordinate);
        let guided = self.mechanism.joints.iter().any(|joint| {
            let pair = (joint.from, joint.to);
            pair == (coordinate.from, coordinate.to) || pair == (coordinate.to, coordinate.from)
        });
        length_driver::compose(self, driver, [from, to], axis, guided);
    }

    /// Returns the axis along which a length is measured, `None` for a distance.
    pub(super) fn axis(&self, coordinate: &Coordinate) -> Option<Anchor> {
        let axes = self.anchor(coordinate.axes);
        match coordinate.kind {
            CoordinateKind::X => Some(axes),
            CoordinateKind::Y => Some(axes.turned_to(axes.angle + FRAC_PI_2)),
            CoordinateKind::Angle | CoordinateKind::Distance | CoordinateKind::Clearance(..) => {
                None
            }
        }
    }

    /// Composes the symbol of a force: a spring, a damper, a cylinder, or an arrow.
    fn force(&mut self, force: &Force) {
        let (coordinate, law) = match &force.load {
            Load::Coordinate { coordinate, law } => (coordinate, law.as_ref()),
            Load::Passive { .. } => return,
            Load::Marker { marker, axes, law } => {
                let at = self.anchor(*marker);
                let axes = axes.map_or(Anchor::origin(None), |axes| self.anchor(axes));
                return load::compose_at(self, &force.name, [at, axes], law.as_ref());
            }
        };
        let ends = [coordinate.from, coordinate.to].map(|marker| self.anchor(marker));
        let axis = self.axis(coordinate);
        let is_elastic = law.is_some_and(|law| law.spring.is_some() || law.is_constant);
        let is_damped = law.is_some_and(|law| law.damping.is_some());
        match coordinate.kind {
            CoordinateKind::Angle if is_elastic || is_damped => self.add(Torsion {
                at: ends[1],
                is_elastic,
                is_damped,
            }),
            // A cylinder shows an actuator or a gas spring, which pushes along itself.
            CoordinateKind::Distance => spring::compose(self, ends, axis, [is_elastic, is_damped]),
            CoordinateKind::X | CoordinateKind::Y if is_elastic || is_damped => {
                spring::compose(self, ends, axis, [is_elastic, is_damped]);
            }
            // Its shapes show a contact.
            CoordinateKind::Clearance(..) => {}
            CoordinateKind::Angle | CoordinateKind::X | CoordinateKind::Y => {
                load::compose_along(self, &force.name, ends, axis, law);
            }
        }
    }

    /// Returns the poses of the motion and the present one.
    pub(super) fn poses(&self) -> impl Iterator<Item = &[f64]> {
        self.motion.iter().map(Vec::as_slice).chain([self.q])
    }

    /// Returns the range of a point along the axis of an anchor over the motion \[m\].
    pub(super) fn range(&self, along: Anchor, point: Anchor) -> [f64; 2] {
        extremes(self.poses().map(|q| {
            let axis = along.placed(q);
            direction(axis.angle).dot(&(point.placed(q).point - axis.point))
        }))
    }

    /// Returns a part of an axis, stretched to the markers of its body that lie on the axis.
    pub(super) fn with_markers(&self, along: Anchor, range: [f64; 2]) -> [f64; 2] {
        let near = 1e-6 * (range[1] - range[0]);
        self.positions(along.body)
            .into_iter()
            .map(|point| along.coordinates(point.into()))
            .filter(|[_, aside]| aside.abs() <= near)
            .fold(range, |[low, high], [s, _]| [low.min(s), high.max(s)])
    }

    /// Returns the markers of a body in its frame; none for ground, which has no shape.
    pub(super) fn positions(&self, body: Option<BodyId>) -> Vec<[f64; 2]> {
        let markers = body.map(|body| &self.mechanism.bodies[body.index()].markers);
        let anchors = markers.into_iter().flatten().map(|m| self.anchor(*m));
        anchors.map(|anchor| anchor.position).collect()
    }

    /// Returns the coordinates of a point along an anchor's axes at the present pose \[m\].
    pub(super) fn coordinates(&self, axes: Anchor, point: Anchor) -> [f64; 2] {
        let (axes, point) = (axes.placed(self.q), point.placed(self.q).point);
        let axis = direction(axes.angle);
        [axis, across(axis)].map(|axis| axis.dot(&(point - axes.point)))
    }

    /// Returns the distance of two points at the present pose \[m\].
    pub(super) fn distance(&self, points: [Anchor; 2]) -> f64 {
        let [a, b] = points.map(|point| point.placed(self.q).point);
        (b - a).norm()
    }

    /// Returns the symbols that show a body.
    pub(super) fn showing(&self, body: BodyId) -> impl Iterator<Item = &Symbol> {
        let shown_by = self.shown_by[body.index()].iter();
        shown_by.map(|&index| &self.symbols[index])
    }

    /// Returns the points of all markers on bodies at the present pose, with the bodies.
    pub(super) fn markers(&self) -> impl Iterator<Item = (BodyId, Point)> {
        (0..self.mechanism.markers.len()).filter_map(|marker| {
            let anchor = self.anchor(MarkerId(marker));
            Some((anchor.body?, anchor.placed(self.q).point))
        })
    }
}
