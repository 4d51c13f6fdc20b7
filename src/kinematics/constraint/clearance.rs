//! The clearance of two shapes: the least distance of their outlines.

use nalgebra::Vector2;

use super::configuration::{BodyPose, Configuration, MarkerPose, perp};
use super::definition::{Constraint, Dimension, Formula, Incidence};
use super::gradient::Gradient;
use super::moving_configuration::{
    Moving, VariedMechanism, add, dot, quarter_turn, subtract, turned,
};
use super::point::{angular_velocity, centripetal, point_velocity};
use super::region::Region;
use crate::mechanism::{
    BodyId, Feature, FeatureKind, FeatureRun, Mechanism, Number, ShapeForm, ShapeId,
};

#[cfg(test)]
mod tests;

/// c = the least distance of the cores of two shapes, or of runs of their features, less the radii round
/// them.
///
/// The distance of cores has no sign: c becomes negative as far as the radii reach. It is smooth where the
/// nearest place of each core moves along one edge or stays at one corner, and has a continuous gradient
/// where one place passes from an edge to a corner or an arc. Where two places are equally near, gradient
/// and quadratic term are those of the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clearance {
    /// The two shapes, on different bodies.
    pub shapes: [ShapeId; 2],
    /// The features of each core among which the nearest ones are.
    pub runs: [FeatureRun; 2],
}

/// Features of two cores that are nearest to each other, and the form of their distance.
#[derive(Clone, Copy, Debug)]
struct Branch {
    /// Places of the features in their cores.
    features: [usize; 2],
    form: Form,
    /// Factor of the length between the two.
    factor: f64,
    /// Factors of the radii of arcs.
    of_radii: [f64; 2],
}

/// Length from which the distance of two features follows.
#[derive(Clone, Copy, Debug)]
enum Form {
    /// From one centre to the other.
    Span,
    /// From the edge of this shape, the first or the second, to the centre of the other; the side of the
    /// edge on which it is, 1 on the left.
    Edge(usize, f64),
}

/// The nearest features of two shapes at a pose.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    branch: Branch,
    /// Distance of the cores \[m\].
    core: f64,
    /// The points from whose distance it follows, as points of their bodies.
    points: [MarkerPose; 2],
    /// Unit vector from the first point to the second.
    normal: Vector2<f64>,
    /// Length between them \[m\].
    length: f64,
}

/// Part of places by which two distances may differ that are the same: some roundings. Where a place passes
/// from an edge to its end, the two differ by less within 1e-8 of their size.
const SAME: f64 = 16.0 * f64::EPSILON;

/// Motion of a core on its body over a sub-step while parameters move, bounded.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoreMotion {
    /// Way of its places \[m\].
    pub way: f64,
    /// Second derivative of its places and of its radius along the sub-step \[m\].
    pub bend: f64,
}

impl Branch {
    /// Returns the branch of two features in one frame, and their distance; `None` for two of which other
    /// features are nearer, such as the ends of an edge.
    fn of(a: &Feature<f64>, b: &Feature<f64>) -> Option<(Form, f64, [f64; 2], f64)> {
        use FeatureKind::{Bore, Convex, Edge, Hollow, Place};
        let span = subtract(b.center, a.center);
        let length = span[0].hypot(span[1]);
        let signed = |length: f64, factor: f64, of_radii: [f64; 2], is_signed: bool| {
            let value = factor * length + of_radii[0] * a.radius + of_radii[1] * b.radius;
            let sign = if value < 0.0 && !is_signed { -1.0 } else { 1.0 };
            let of_radii = of_radii.map(|factor| sign * factor);
            (sign * factor, of_radii, sign * value)
        };
        match (a.kind, b.kind) {
            (Place | Convex { .. }, Place | Convex { .. }) => {
                let back = [-span[0], -span[1]];
                if !faces(a, span) || !faces(b, back) {
                    return None;
                }
                let (factor, of_radii, value) = signed(length, 1.0, [-1.0, -1.0], false);
                Some((Form::Span, factor, of_radii, value))
            }
            (Hollow { .. } | Bore, Place | Convex { .. }) => {
                if !faces(a, span) || !faces(b, span) {
                    return None;
                }
                let (factor, of_radii, value) = signed(length, -1.0, [1.0, -1.0], a.kind == Bore);
                Some((Form::Span, factor, of_radii, value))
            }
            (Edge, Place | Convex { .. }) => {
                let (side, height) = beside(a, b.center)?;
                let out = across(a, side);
                if !faces(b, [-out[0], -out[1]]) {
                    return None;
                }
                let (factor, of_radii, value) = signed(height, 1.0, [0.0, -1.0], false);
                Some((Form::Edge(0, side), factor, of_radii, value))
            }
            (Place | Convex { .. }, Hollow { .. } | Bore | Edge) => {
                let (form, factor, [of_b, of_a], value) = Self::of(b, a)?;
                let form = match form {
                    Form::Span => Form::Span,
                    Form::Edge(_, side) => Form::Edge(1, side),
                };
                Some((form, factor, [of_a, of_b], value))
            }
            // The ends of one of them are nearer.
            (Edge | Hollow { .. } | Bore, Edge | Hollow { .. } | Bore) => None,
        }
    }
}

/// Returns whether an arc goes through the direction from its centre; a place or a whole circle does.
fn faces(arc: &Feature<f64>, direction: [f64; 2]) -> bool {
    let (FeatureKind::Convex { is_wide } | FeatureKind::Hollow { is_wide }) = arc.kind else {
        return true;
    };
    let [from, to] = arc.ends.map(|end| subtract(end, arc.center));
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let (behind, before) = (cross(from, direction) >= 0.0, cross(direction, to) >= 0.0);
    if is_wide {
        behind || before
    } else {
        behind && before
    }
}

/// Returns the side of an edge on which a point beside it is, and its distance.
fn beside(edge: &Feature<f64>, point: [f64; 2]) -> Option<(f64, f64)> {
    let [a, b] = edge.ends;
    let (along, from) = (subtract(b, a), subtract(point, a));
    let place = dot(along, from);
    let square = dot(along, along);
    if place <= 0.0 || place >= square {
        return None;
    }
    let height = dot(quarter_turn(along), from) / square.sqrt();
    let side = if height < 0.0 { -1.0 } else { 1.0 };
    Some((side, height.abs()))
}

/// Returns the direction across an edge to one of its sides.
fn across(edge: &Feature<f64>, side: f64) -> [f64; 2] {
    let along = subtract(edge.ends[1], edge.ends[0]);
    quarter_turn(along).map(|component| side * component)
}

/// Returns a radius round a feature's centre that contains it.
fn extent(feature: &Feature<f64>) -> f64 {
    match feature.kind {
        FeatureKind::Edge => {
            let half = subtract(feature.ends[1], feature.center);
            half[0].hypot(half[1])
        }
        _ => feature.radius,
    }
}

/// Returns a feature with its points moved to a frame.
fn placed<N: Copy>(feature: &Feature<N>, point: impl Fn([N; 2]) -> [N; 2]) -> Feature<N> {
    Feature {
        center: point(feature.center),
        ends: feature.ends.map(point),
        ..*feature
    }
}

/// Returns the nearest of the features of two shapes, which `feature` gives by shape and place in one
/// frame if they count, and their distance.
fn nearest(
    counts: [usize; 2],
    feature: impl Fn(usize, usize) -> Option<Feature<f64>>,
) -> Option<(Branch, f64)> {
    let mut best: Option<(Branch, f64)> = None;
    for i in 0..counts[0] {
        let Some(a) = feature(0, i) else {
            continue;
        };
        let reach = extent(&a);
        for j in 0..counts[1] {
            let Some(b) = feature(1, j) else {
                continue;
            };
            let least = best.as_ref().map_or(f64::INFINITY, |(_, least)| *least);
            let span = subtract(b.center, a.center);
            // A feature that lies in a circle round its centre is not nearer than this circle. The wall of
            // a bore has a sign, and reaches across.
            let apart = span[0].hypot(span[1]) - reach - extent(&b);
            let is_bore = [a.kind, b.kind].contains(&FeatureKind::Bore);
            if apart >= least && !is_bore {
                continue;
            }
            let Some((form, factor, of_radii, value)) = Branch::of(&a, &b) else {
                continue;
            };
            // An edge is nearer than its ends, also where rounding says otherwise.
            let places = a.center.into_iter().chain(b.center);
            let rounding = SAME * places.fold(value.abs(), |size, x| size.max(x.abs()));
            let slack = match (form, best.as_ref().map(|(best, _)| best.form)) {
                (Form::Edge(..), Some(Form::Span)) => rounding,
                (Form::Span, Some(Form::Edge(..))) => -rounding,
                _ => 0.0,
            };
            if value < least + slack {
                let branch = Branch {
                    features: [i, j],
                    form,
                    factor,
                    of_radii,
                };
                best = Some((branch, value));
            }
        }
    }
    best
}

impl Clearance {
    /// Returns the nearest features at a pose.
    fn nearest(&self, at: &Configuration) -> Option<Nearest> {
        let cores = self.shapes.map(|shape| at.core(shape));
        let frames = cores.map(|core| *at.frame(core.body));
        let place = |frame: &BodyPose, point: [f64; 2]| {
            let point: Vector2<f64> = frame.origin + frame.rotate(point.into());
            <[f64; 2]>::from(point)
        };
        let feature = |side: usize, k: usize| {
            let own = &cores[side].core.features[k];
            placed(own, |point| place(&frames[side], point))
        };
        let counts = cores.map(|core| core.core.features.len());
        let counted = |side: usize, k: usize| {
            let position = cores[side].core.features[k].position;
            self.runs[side].has(position).then(|| feature(side, k))
        };
        let (branch, core) = nearest(counts, counted)?;
        let [a, b] = [0, 1].map(|side| feature(side, branch.features[side]));
        let centers = [a.center, b.center].map(Vector2::from);
        let (points, normal, length) = match branch.form {
            Form::Span => {
                let span = centers[1] - centers[0];
                let length = span.norm();
                let normal = if length > 0.0 {
                    span / length
                } else {
                    Vector2::x()
                };
                (centers, normal, length)
            }
            Form::Edge(on, side) => {
                let edge = if on == 0 { &a } else { &b };
                let [from, to] = edge.ends.map(Vector2::from);
                let along = (to - from).normalize();
                let center = centers[1 - on];
                let out = side * perp(along);
                let height = out.dot(&(center - from));
                let foot = center - height * out;
                match on {
                    0 => ([foot, center], out, height),
                    _ => ([center, foot], -out, height),
                }
            }
        };
        let pose = |side: usize| {
            let body = cores[side].body;
            MarkerPose {
                body,
                arm: points[side] - frames[side].origin,
                point: points[side],
                axis: Vector2::new(frames[side].cos, frames[side].sin),
                theta: frames[side].phi,
            }
        };
        Some(Nearest {
            branch,
            core,
            points: [pose(0), pose(1)],
            normal,
            length,
        })
    }

    /// Returns the nearest places of the two outlines at a pose \[m\].
    pub(in crate::kinematics) fn places(&self, at: &Configuration) -> Option<[Vector2<f64>; 2]> {
        let near = self.nearest(at)?;
        let cores = self.shapes.map(|shape| at.core(shape));
        let Nearest { branch, normal, .. } = near;
        // From a centre the outline is beyond the arc's radius, towards the other shape or away from it.
        let out = |side: usize| {
            let own = cores[side].core.features[branch.features[side]];
            let towards = if side == 0 { 1.0 } else { -1.0 };
            let is_inside = matches!(own.kind, FeatureKind::Hollow { .. } | FeatureKind::Bore);
            let other = cores[1 - side].core.features[branch.features[1 - side]];
            let is_around = matches!(other.kind, FeatureKind::Hollow { .. } | FeatureKind::Bore);
            match (is_inside, is_around) {
                (true, _) => towards * (own.radius - cores[side].core.radius),
                (_, true) => -towards * (own.radius + cores[side].core.radius),
                _ => towards * (own.radius + cores[side].core.radius),
            }
        };
        Some([0, 1].map(|side| near.points[side].point + out(side) * normal))
    }

    /// Returns whether one of the shapes lies in the other, or edges of their cores cross, so that the
    /// distance of cores does not tell that they overlap.
    pub(in crate::kinematics) fn is_crossed(
        &self,
        mechanism: &Mechanism,
        at: &Configuration,
        parameters: &[f64],
    ) -> bool {
        let cores = self.shapes.map(|shape| at.core(shape));
        let place = |side: usize, point: [f64; 2]| {
            let frame = at.frame(cores[side].body);
            frame.origin + frame.rotate(point.into())
        };
        let lies_in = |side: usize| {
            let other = &mechanism.shapes[self.shapes[1 - side].index()];
            let Some(first) = cores[side].core.features.first() else {
                return false;
            };
            let frame = at.frame(cores[1 - side].body);
            let point = place(side, first.center) - frame.origin;
            let point = Vector2::new(
                frame.cos * point.x + frame.sin * point.y,
                frame.cos * point.y - frame.sin * point.x,
            );
            other.is_plate() && mechanism.covers(other, point.into(), parameters)
        };
        let is_bore = self
            .shapes
            .iter()
            .any(|id| mechanism.shapes[id.index()].is_hole());
        if !is_bore && (lies_in(0) || lies_in(1)) {
            return true;
        }
        let edges = |side: usize| {
            let edges = cores[side].core.features.iter();
            let edges = edges.filter(|own| own.kind == FeatureKind::Edge);
            edges.map(move |edge| edge.ends.map(|end| place(side, end)))
        };
        let parts = |[a, b]: [Vector2<f64>; 2], of: [Vector2<f64>; 2]| {
            let [p, q] = of.map(|point| (b - a).perp(&(point - a)));
            p * q < 0.0
        };
        edges(0).any(|own| edges(1).any(|other| parts(own, other) && parts(other, own)))
    }

    /// Bounds how far the clearance lies below the straight line between its values at both ends of a
    /// sub-step, at whose end the bodies are. `chord` gives the change of an unknown, `off` how far it
    /// deviates from its chord, `moving` the motion of both cores on their bodies.
    ///
    /// At the instant at which two material points are the nearest ones the clearance is their distance,
    /// and at both ends it is at most that; so it lies below its chord by no more than the distance of one
    /// pair does. That of points at a distance d or more, with a relative way v, bends by at most
    /// v²/d + Σ (ω² ρ + 2 ω ṗ + p̈), where ρ is the reach of a core on its body and p its own motion there.
    pub(in crate::kinematics) fn deviation(
        &self,
        at: &Configuration,
        chord: impl Fn(usize) -> f64,
        off: impl Fn(usize) -> f64,
        moving: [CoreMotion; 2],
    ) -> f64 {
        let Some(near) = self.nearest(at) else {
            return 0.0;
        };
        let cores = self.shapes.map(|shape| at.core(shape));
        let (mut way, mut beside, mut bend) = (0.0, 0.0, 0.0);
        let mut origins = Vector2::zeros();
        for (side, (core, own)) in cores.into_iter().zip(moving).enumerate() {
            way += own.way;
            bend += own.bend;
            let Some(k) = core.body.map(|body| 3 * body.index()) else {
                continue;
            };
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let reach = core.reach + own.way;
            let turn = chord(k + 2).abs();
            origins += sign * Vector2::new(chord(k), chord(k + 1));
            way += turn * reach;
            bend += turn * turn * reach + 2.0 * turn * own.way;
            beside += off(k) + off(k + 1) + reach * off(k + 2);
        }
        way += origins.norm();
        let least = near.core.abs() - way;
        let by_way = way + beside;
        if least <= 0.0 {
            return by_way;
        }
        let by_bend = 0.125 * (way * way / least + bend) + beside;
        by_way.min(by_bend)
    }
}

impl Formula for Clearance {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let frames = self.shapes.map(|shape| at.frame(at.carrier(shape)));
        let feature = |side: usize, k: usize| {
            let (origin, axis) = frames[side];
            let own = at.feature(self.shapes[side], k);
            placed(&own, |point| add(origin, turned(axis, point)))
        };
        // Over a range of poses another feature may be nearest anywhere.
        let is_single = |(origin, axis): ([N; 2], [N; 2])| {
            origin.into_iter().chain(axis).all(Number::is_single)
        };
        if !frames.into_iter().all(is_single) {
            return N::unknown();
        }
        let counts = self.shapes.map(|shape| at.features(shape));
        let counted = |side: usize, k: usize| {
            let own = at.feature(self.shapes[side], k);
            let counts = self.runs[side].has(own.position);
            counts.then(|| feature(side, k).map(N::real))
        };
        let Some((branch, _)) = nearest(counts, counted) else {
            return N::unknown();
        };
        let [a, b] = [0, 1].map(|side| feature(side, branch.features[side]));
        let length = match branch.form {
            Form::Span => {
                let [x, y] = subtract(b.center, a.center);
                x.hypot(y)
            }
            Form::Edge(on, side) => {
                let (edge, other) = if on == 0 { (&a, &b) } else { (&b, &a) };
                let along = subtract(edge.ends[1], edge.ends[0]);
                let from = subtract(other.center, edge.ends[0]);
                dot(quarter_turn(along), from) * side / along[0].hypot(along[1])
            }
        };
        let [of_a, of_b] = branch.of_radii;
        let radii = self.shapes.map(|shape| at.core_radius(shape));
        length * branch.factor + a.radius * of_a + b.radius * of_b - radii[0] - radii[1]
    }
}

impl Constraint for Clearance {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let radii = self.shapes.map(|shape| at.core(shape).core.radius);
        let core = self.nearest(at).map_or(f64::NAN, |near| near.core);
        core - radii[0] - radii[1]
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let Some(near) = self.nearest(at) else {
            return f64::NAN;
        };
        let normal = near.branch.factor * near.normal;
        row.add_point(near.points[1], normal);
        row.add_point(near.points[0], -normal);
        let radii = self.shapes.map(|shape| at.core(shape).core.radius);
        near.core - radii[0] - radii[1]
    }

    /// Returns that of a [distance](super::Distance) between two centres, and that of a
    /// [projection](super::Projection) on the normal of an edge.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64 {
        let Some(near) = self.nearest(at) else {
            return 0.0;
        };
        let (n, [a, b]) = (near.normal, near.points);
        let d_dot = point_velocity(b, q_dot) - point_velocity(a, q_dot);
        let d_ddot = centripetal(b, q_dot) - centripetal(a, q_dot);
        let bent = match near.branch.form {
            Form::Span => {
                let across = n.perp(&d_dot);
                across * across / near.length
            }
            Form::Edge(on, _) => {
                let omega = angular_velocity(near.points[on], q_dot);
                -omega * omega * near.length + 2.0 * omega * perp(n).dot(&d_dot)
            }
        };
        near.branch.factor * (bent + n.dot(&d_ddot))
    }

    /// Returns no bound: another feature may become the nearest one. The watch over stops has
    /// `deviation`, which holds for all features at once.
    fn bend(&self, _: &Configuration, _: &Region<'_>, _: &[f64], _: &mut Gradient) -> Option<f64> {
        None
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        for shape in self.shapes {
            let shape = &mechanism.shapes[shape.index()];
            shape
                .numbers()
                .for_each(|number| incidence.expression(number));
            if let ShapeForm::Disc { marker, .. } | ShapeForm::Hole { marker, .. } = shape.form {
                incidence.point(mechanism, marker, [true, true]);
                continue;
            }
            let columns = shape
                .body
                .map(|body: BodyId| 3 * body.index()..3 * body.index() + 3);
            incidence.unknowns.extend(columns.into_iter().flatten());
            for marker in shape.markers() {
                let marker = &mechanism.markers[marker.index()];
                marker.position.iter().for_each(|s| incidence.expression(s));
            }
        }
    }
}
