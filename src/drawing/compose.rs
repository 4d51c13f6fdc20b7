//! From a mechanism to the symbols of its scene.

mod cam;
mod guide;

use nalgebra::Vector2;

use super::outline::{across, angle, direction};
use super::scene::{Anchor, Held, Symbol, WaySide};
use crate::mechanism::{
    BodyId, Coordinate, CoordinateKind, Expression, Joint, JointKind, MarkerId, Mechanism,
    RackSide, WheelSizes,
};

/// Where a fixture may lie, best first: below its pivot, above, left, right.
const FIXTURES: [f64; 4] = [
    -std::f64::consts::FRAC_PI_2,
    std::f64::consts::FRAC_PI_2,
    std::f64::consts::PI,
    0.0,
];
/// A body this far (60°) or farther from a fixture's direction leaves it room.
const ROOM: f64 = 0.5;
/// Part of a pinion's radius that its rack reaches beyond the points of contact.
const RACK_END: f64 = 0.6;
/// Wheels given by teeth whose centres decide no radius share this part of their distance.
const BELT_WHEELS: f64 = 0.6;

/// Two paths this part of a path's extent from each other look like one.
const NEAR_TRACE: f64 = 2e-3;
/// Room for open paths around a mechanism, as a part of its size.
const TRACE_ROOM: f64 = 0.25;
/// How far apart along a path, in such distances, two of its points are for this to mean anything.
const FAR_ALONG: f64 = 6.0;
/// So many points in a row are a way back.
const WAY_BACK: usize = 6;

/// The symbols of a mechanism at the pose q, for a motion that passes there.
pub(super) fn symbols(
    mechanism: &Mechanism,
    parameters: &[f64],
    q: &[f64],
    motion: &[Vec<f64>],
    traces: bool,
) -> Vec<Symbol> {
    let mut composer = Composer {
        mechanism,
        parameters,
        q,
        motion,
        symbols: Vec::new(),
        spans: vec![Vec::new(); mechanism.bodies.len()],
        covered: vec![Vec::new(); mechanism.bodies.len()],
        pivots: Vec::new(),
    };
    // A knife points away from what its follower reaches, which the other joints decide.
    let is_cam = |joint: &&Joint| matches!(joint.kind, JointKind::Cam { .. });
    let (cams, others): (Vec<&Joint>, Vec<&Joint>) = mechanism.joints.iter().partition(is_cam);
    for joint in others.into_iter().chain(cams) {
        composer.joint(joint);
    }
    for driver in &mechanism.drivers {
        composer.driver(&driver.name, &driver.coordinate);
    }
    for body in 0..mechanism.bodies.len() {
        composer.body(BodyId(body));
    }
    composer.fixtures();
    let frame = composer.frame();
    for marker in &mechanism.outputs.markers {
        let name = mechanism.markers[marker.index()].name.clone();
        let at = composer.anchor(*marker);
        composer.symbols.push(Symbol::Point { name, at });
        if traces {
            composer.trace(at, frame);
        }
    }
    composer.symbols
}

struct Composer<'a> {
    mechanism: &'a Mechanism,
    parameters: &'a [f64],
    q: &'a [f64],
    motion: &'a [Vec<f64>],
    symbols: Vec<Symbol>,
    /// What each body has to reach besides its markers: the ends of its ways and slots.
    spans: Vec<Vec<[f64; 2]>>,
    /// What other symbols cover of each body.
    covered: Vec<Vec<Cover>>,
    /// What is held on ground, with the body that leaves from there.
    pivots: Vec<(Anchor, Option<BodyId>)>,
}

/// What a symbol covers of a body, in the body's frame.
#[derive(Clone)]
enum Cover {
    Block,
    Wheel { center: Vector2<f64>, radius: f64 },
    Rack { along: Anchor, range: [f64; 2] },
    Contour(Vec<[f64; 2]>),
    Face { along: Anchor, range: [f64; 2] },
}

impl Cover {
    /// Whether a point lies in it, to within what cannot be seen.
    fn has(&self, point: Vector2<f64>) -> bool {
        match self {
            Self::Block => false,
            Self::Wheel { center, radius } => (point - center).norm() <= radius * 1.001,
            Self::Rack { along, range } | Self::Face { along, range } => {
                let near = 1e-3 * (range[1] - range[0]);
                let [s, aside] = along.coordinates(point);
                aside.abs() <= near && s >= range[0] - near && s <= range[1] + near
            }
            Self::Contour(points) => {
                let corners: Vec<_> = points.iter().map(|&p| p.into()).collect();
                contains(&corners, point)
            }
        }
    }
}

impl Composer<'_> {
    fn value(&self, expression: &Expression) -> f64 {
        expression.evaluate(&|p| self.parameters[p.index()], 0.0)
    }

    fn anchor(&self, marker: MarkerId) -> Anchor {
        let marker = &self.mechanism.markers[marker.index()];
        Anchor {
            body: marker.body,
            position: [0, 1].map(|k| self.value(&marker.position[k])),
            angle: self.value(&marker.angle),
        }
    }

    /// Adds a symbol unless it is there already.
    fn add(&mut self, symbol: Symbol) {
        if !self.symbols.contains(&symbol) {
            self.symbols.push(symbol);
        }
    }

    /// The symbols of a joint. A new kind of joint has its place here.
    fn joint(&mut self, joint: &Joint) {
        let (from, to) = (self.anchor(joint.from), self.anchor(joint.to));
        match &joint.kind {
            JointKind::Revolute => self.pin(from, to),
            JointKind::Weld => {
                self.hold(from, to.body);
                self.hold(to, from.body);
                self.add(Symbol::Weld { at: from });
            }
            JointKind::Link { .. } => {
                for end in [from, to] {
                    self.pin(end, end);
                }
                self.add(Symbol::Rod { ends: [from, to] });
            }
            JointKind::Translational => self.way(from, to, true),
            JointKind::Slot => self.way(from, to, false),
            JointKind::RevoluteTranslational { offset } => {
                let aside = self.value(offset) * across(direction(from.angle));
                let [x, y] = from.position;
                let position = [x + aside.x, y + aside.y];
                self.way(Anchor { position, ..from }, to, false);
            }
            JointKind::Gear {
                sizes, internal, ..
            } => {
                let radii = self.gear_radii([from, to], sizes, *internal);
                let larger = usize::from(radii[1] > radii[0]);
                for (index, (at, radius)) in [from, to].into_iter().zip(radii).enumerate() {
                    self.wheel(at, radius, *internal && index == larger);
                }
            }
            JointKind::Belt { sizes, crossed, .. } => {
                let radii = self.belt_radii([from, to], sizes);
                for (at, radius) in [from, to].into_iter().zip(radii) {
                    self.wheel(at, radius, false);
                }
                self.add(Symbol::Belt {
                    centers: [from, to],
                    radii,
                    crossed: *crossed,
                });
            }
            JointKind::Cam { follower, profile } => self.cam([from, to], follower, profile),
            JointKind::RackAndPinion { radius, side } => {
                let radius = self.value(radius);
                self.wheel(from, radius, false);
                let range = self.rack_range([from, to], radius);
                self.cover(to.body, Cover::Rack { along: to, range });
                self.add(Symbol::Rack {
                    along: to,
                    range,
                    above: *side == RackSide::Above,
                });
            }
        }
    }

    /// A revolute joint, on ground if one of its markers is.
    fn pin(&mut self, from: Anchor, to: Anchor) {
        let (at, other) = if to.body.is_none() {
            (to, from)
        } else {
            (from, to)
        };
        self.hold(at, other.body);
        self.add(Symbol::Pin {
            at: Anchor { angle: 0.0, ..at },
        });
    }

    /// Notes a fixture for what is on ground.
    fn hold(&mut self, at: Anchor, leaving: Option<BodyId>) {
        if at.body.is_none() {
            self.pivots.push((at, leaving));
        }
    }

    /// What lies along an axis: a way for a block, or a slot for a point.
    fn way(&mut self, along: Anchor, to: Anchor, block: bool) {
        if block && self.guide(along, to) {
            return;
        }
        let range = self.range(along, to);
        if along.body.is_none() {
            let (side, holds) = if block {
                (self.free_side(along, to.body), Held::Block)
            } else {
                (WaySide::Both, Held::Point)
            };
            self.add(Symbol::SlideWay {
                along,
                range,
                side,
                holds,
            });
        } else {
            self.reach(along, [range[0].min(0.0), range[1].max(0.0)]);
            if !block {
                self.add(Symbol::Slot { along, range });
                self.add(Symbol::SlotBlock { at: to, along });
            }
        }
        if block {
            self.hold(to, along.body);
            self.cover(to.body, Cover::Block);
            self.add(Symbol::Block {
                at: to,
                on: along.body,
            });
        } else {
            self.pin(to, to);
        }
    }

    /// Where a point is along the axis of an anchor over the motion.
    fn range(&self, along: Anchor, point: Anchor) -> [f64; 2] {
        let poses = self.motion.iter().map(Vec::as_slice).chain([self.q]);
        poses.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| {
            let axis = along.placed(q);
            let s = direction(axis.angle).dot(&(point.placed(q).point - axis.point));
            [low.min(s), high.max(s)]
        })
    }

    /// A body reaches as far as what it carries along an axis.
    fn reach(&mut self, along: Anchor, range: [f64; 2]) {
        if let Some(body) = along.body {
            let origin = Vector2::from(along.position);
            let ends: [[f64; 2]; 2] = range.map(|s| (origin + s * direction(along.angle)).into());
            self.spans[body.index()].extend(ends);
        }
    }

    /// What there is of a rack: its teeth over the motion, and its body's markers on its axis.
    fn rack_range(&self, [pinion, rack]: [Anchor; 2], radius: f64) -> [f64; 2] {
        let [low, high] = self.range(rack, pinion);
        let end = RACK_END * radius;
        self.with_markers(rack, [low - end, high + end])
    }

    /// A part of an axis, stretched to the markers of its body that lie on it.
    fn with_markers(&self, along: Anchor, range: [f64; 2]) -> [f64; 2] {
        let near = 1e-6 * (range[1] - range[0]);
        self.positions(along.body)
            .into_iter()
            .map(|point| along.coordinates(point.into()))
            .filter(|[_, aside]| aside.abs() <= near)
            .fold(range, |[low, high], [s, _]| [low.min(s), high.max(s)])
    }

    /// Where the markers of a body are in its frame; none for ground, which has no shape.
    fn positions(&self, body: Option<BodyId>) -> Vec<[f64; 2]> {
        let markers = body.map(|body| &self.mechanism.bodies[body.index()].markers);
        let anchors = markers.into_iter().flatten().map(|m| self.anchor(*m));
        anchors.map(|anchor| anchor.position).collect()
    }

    /// The side of a way on which less of the mechanism is.
    fn free_side(&self, along: Anchor, sliding: Option<BodyId>) -> WaySide {
        let up = across(direction(along.angle));
        let others = (0..self.mechanism.markers.len()).map(|marker| self.anchor(MarkerId(marker)));
        let lean: f64 = others
            .filter(|other| other.body.is_some() && other.body != sliding)
            .map(|other| up.dot(&(other.placed(self.q).point - Vector2::from(along.position))))
            .sum();
        // Far less than any mechanism is wide, far more than rounding.
        if lean < -1e-6 {
            WaySide::Above
        } else {
            WaySide::Below
        }
    }

    fn cover(&mut self, body: Option<BodyId>, cover: Cover) {
        if let Some(body) = body {
            self.covered[body.index()].push(cover);
        }
    }

    fn wheel(&mut self, at: Anchor, radius: f64, ring: bool) {
        let center = at.position.into();
        self.cover(at.body, Cover::Wheel { center, radius });
        // A wheel that meshes twice is one wheel, though its radius may come from elsewhere.
        let known = self.symbols.iter().any(|symbol| match symbol {
            Symbol::Wheel {
                at: other,
                radius: r,
                ring: inside,
            } => *other == at && (r - radius).abs() < 1e-9 * radius && *inside == ring,
            _ => false,
        });
        if !known {
            self.symbols.push(Symbol::Wheel { at, radius, ring });
        }
    }

    fn center_distance(&self, centers: [Anchor; 2]) -> f64 {
        let [a, b] = centers.map(|center| center.placed(self.q).point);
        (b - a).norm()
    }

    /// Radii of the pitch circles, from the distance of the centres where teeth are given.
    fn gear_radii(&self, centers: [Anchor; 2], sizes: &WheelSizes, internal: bool) -> [f64; 2] {
        let values = sizes.expressions().each_ref().map(|size| self.value(size));
        match sizes {
            WheelSizes::Radii(_) => values,
            WheelSizes::Teeth(_) => {
                let sum = if internal {
                    (values[0] - values[1]).abs()
                } else {
                    values[0] + values[1]
                };
                values.map(|teeth| self.center_distance(centers) * teeth / sum)
            }
        }
    }

    fn belt_radii(&self, centers: [Anchor; 2], sizes: &WheelSizes) -> [f64; 2] {
        let values = sizes.expressions().each_ref().map(|size| self.value(size));
        match sizes {
            WheelSizes::Radii(_) => values,
            WheelSizes::Teeth(_) => values.map(|teeth| {
                BELT_WHEELS * self.center_distance(centers) * teeth / (values[0] + values[1])
            }),
        }
    }

    fn driver(&mut self, name: &str, coordinate: &Coordinate) {
        let name = name.to_owned();
        let [from, to, axes] =
            [coordinate.from, coordinate.to, coordinate.axes].map(|marker| self.anchor(marker));
        let turned = |angle: f64| Anchor {
            angle: axes.angle + angle,
            ..axes
        };
        let axis = match coordinate.kind {
            CoordinateKind::Angle => {
                return self.add(Symbol::AngleDriver { name, from, to });
            }
            CoordinateKind::X => Some(turned(0.0)),
            CoordinateKind::Y => Some(turned(std::f64::consts::FRAC_PI_2)),
            CoordinateKind::Distance => None,
        };
        let guided = self.mechanism.joints.iter().any(|joint| {
            let pair = (joint.from, joint.to);
            pair == (coordinate.from, coordinate.to) || pair == (coordinate.to, coordinate.from)
        });
        let beside = guided || axis.is_some();
        if !beside {
            for end in [from, to] {
                self.pin(end, end);
            }
        }
        self.add(Symbol::LengthDriver {
            name,
            from,
            to,
            axis,
            beside,
        });
    }

    fn body(&mut self, body: BodyId) {
        let spans = std::mem::take(&mut self.spans[body.index()]);
        let mut points: Vec<[f64; 2]> = Vec::new();
        for point in self.positions(Some(body)).into_iter().chain(spans) {
            if !points.contains(&point) {
                points.push(point);
            }
        }
        let covers = &self.covered[body.index()];
        let mut flat = false;
        for cover in covers {
            if let Cover::Face { along, range } = cover {
                points = self.behind_face(*along, *range, &points);
                flat = true;
            }
        }
        let covered = |point: &[f64; 2]| covers.iter().any(|c| c.has(Vector2::from(*point)));
        if covers.is_empty() && points.len() <= 1 && !points.contains(&[0.0; 2]) {
            points.push([0.0; 2]);
        }
        let drawn = if flat {
            !points.is_empty()
        } else {
            // A single point of what has a symbol already needs no other.
            covers.is_empty() || points.len() > 1 && !points.iter().all(covered)
        };
        if drawn {
            self.symbols.push(Symbol::Link { body, points });
        }
    }

    /// One fixture for each point of ground that holds something, where the bodies leave room.
    fn fixtures(&mut self) {
        let pivots = std::mem::take(&mut self.pivots);
        for (index, (at, _)) in pivots.iter().enumerate() {
            let same = |other: &Anchor| is_same_point(other, at);
            if pivots[..index].iter().any(|(other, _)| same(other)) {
                continue;
            }
            let leaving: Vec<f64> = pivots
                .iter()
                .filter(|(other, _)| same(other))
                .filter_map(|(_, body)| *body)
                .flat_map(|body| self.directions_from(*at, body))
                .collect();
            let crowded = |fixture: f64| {
                let nearest = leaving.iter().map(|leaving| (leaving - fixture).cos());
                nearest.fold(-1.0, f64::max)
            };
            let mut best = FIXTURES[0];
            for fixture in FIXTURES {
                // Rounding decides between none of the four.
                if crowded(best) > ROOM && crowded(fixture) < crowded(best) - 1e-6 {
                    best = fixture;
                }
            }
            self.symbols.push(Symbol::Fixture {
                at: Anchor { angle: best, ..*at },
            });
        }
    }

    /// The directions in which a body reaches away from a point on ground.
    fn directions_from(&self, at: Anchor, body: BodyId) -> Vec<f64> {
        let points = self.symbols.iter().find_map(|symbol| match symbol {
            Symbol::Link { body: of, points } if *of == body => Some(points),
            _ => None,
        });
        let offsets = points.into_iter().flatten().map(|&position| {
            let anchor = Anchor {
                body: Some(body),
                position,
                angle: 0.0,
            };
            anchor.placed(self.q).point - Vector2::from(at.position)
        });
        let offsets: Vec<Vector2<f64>> = offsets.collect();
        let largest = offsets.iter().fold(0.0, |l: f64, o| l.max(o.norm()));
        let away = |offset: &&Vector2<f64>| offset.norm() > 1e-6 * largest;
        offsets
            .iter()
            .filter(away)
            .map(|offset| angle(*offset))
            .collect()
    }

    /// The rectangle around the mechanism, with some room for open paths.
    fn frame(&self) -> [Vector2<f64>; 2] {
        let markers = self.mechanism.markers.iter().enumerate();
        let used = markers.filter(|(_, marker)| marker.body.is_some());
        let points = used.map(|(id, _)| self.anchor(MarkerId(id)).placed(self.q).point);
        let none = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
        let [low, high] = points.fold(none, |[low, high], p| [low.inf(&p), high.sup(&p)]);
        let room = Vector2::repeat(TRACE_ROOM * (high - low).max());
        [low - room, high + room]
    }

    /// The path of a point, unless it keeps its place. A path that does not close is cut off
    /// far outside the mechanism, which it would make too small to see.
    fn trace(&mut self, at: Anchor, [low, high]: [Vector2<f64>; 2]) {
        let path: Vec<Vector2<f64>> = self.motion.iter().map(|q| at.placed(q).point).collect();
        let extent = path
            .iter()
            .fold(0.0, |extent: f64, p| extent.max((p - path[0]).norm()));
        if extent <= 1e-9 * path.iter().fold(0.0, |far: f64, p| far.max(p.norm())) {
            return;
        }
        let near = NEAR_TRACE * extent;
        let closed = (path[path.len() - 1] - path[0]).norm() < near;
        let seen = |p: &Vector2<f64>| closed || (low.inf(p) == low && high.sup(p) == high);
        let pieces = without_ways_back(&path, near)
            .into_iter()
            .flat_map(|piece| piece.split(|p| !seen(p)))
            .filter(|piece| piece.len() > 1);
        self.symbols.extend(pieces.map(|piece| Symbol::Trace {
            body: at.body,
            points: piece.iter().map(|&p| p.into()).collect(),
        }));
    }
}

/// Whether two anchors on one body have the same point, made by the same expressions.
fn is_same_point(a: &Anchor, b: &Anchor) -> bool {
    let [a, b] = [a, b].map(|anchor| anchor.position.map(f64::to_bits));
    a == b
}

/// The pieces of a path without those on which it comes back where it has been, to within
/// `near`; dashes drawn twice would fill each other's gaps.
fn without_ways_back(path: &[Vector2<f64>], near: f64) -> Vec<&[Vector2<f64>]> {
    let mut travelled = vec![0.0];
    for ends in path.windows(2) {
        travelled.push(travelled[travelled.len() - 1] + (ends[1] - ends[0]).norm());
    }
    let comes_back = |k: usize| {
        let earlier = path.windows(2).zip(&travelled[1..]);
        earlier
            .take_while(|(_, travelled_to)| **travelled_to < travelled[k] - FAR_ALONG * near)
            .any(|(ends, _)| distance([ends[0], ends[1]], path[k]) < near)
    };
    let known: Vec<bool> = (0..path.len()).map(comes_back).collect();
    let mut pieces = Vec::new();
    let mut start = 0;
    let mut k = 0;
    while k < path.len() {
        let run = known[k..].iter().take_while(|known| **known).count();
        // A path that only crosses itself, or closes, goes on.
        if run >= WAY_BACK {
            pieces.push(&path[start..k]);
            start = k + run - 1;
        }
        k += run.max(1);
    }
    pieces.push(&path[start..]);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

/// Whether a point lies in a polygon: a ray from it meets the edges an odd number of times.
fn contains(corners: &[Vector2<f64>], p: Vector2<f64>) -> bool {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = ends.filter(|(a, b)| {
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// The distance of a point from a line between two others.
fn distance([a, b]: [Vector2<f64>; 2], p: Vector2<f64>) -> f64 {
    let along = b - a;
    let length = along.norm_squared();
    let s = if length > 0.0 {
        ((p - a).dot(&along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + s * along - p).norm()
}
