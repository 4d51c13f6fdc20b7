//! Shapes whose outlines do not close round an area.

use std::f64::consts::PI;
use std::fmt;

use super::chain::{Chain, Turn, cross, dot, sub};
use super::{Given, Shape, ShapeForm};

/// Shape without a proper outline for the values of its numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeFault {
    /// Name of the shape with its body's.
    pub shape: String,
    /// Kind of the fault.
    pub kind: ShapeFaultKind,
    /// Name of the marker where it is, if it is at one.
    pub marker: Option<String>,
}

/// Kind of fault in the outline of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeFaultKind {
    /// A radius, a fillet or a depth is not positive, or negative where it may be zero.
    Size,
    /// Two markers that follow each other are at one place.
    NoEdge,
    /// The outline turns back on itself.
    Back,
    /// Nothing is left of an edge between its rounded corners.
    Short,
    /// The outline crosses itself.
    Crossing,
    /// No plate is round a hole, or its rim goes beyond it.
    HoleOutside,
}

impl fmt::Display for ShapeFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shape = &self.shape;
        let marker = self.marker.as_deref().unwrap_or("its first marker");
        match self.kind {
            ShapeFaultKind::Size => {
                write!(
                    f,
                    "shape `{shape}`: its radius, fillet or depth is not positive"
                )
            }
            ShapeFaultKind::NoEdge => {
                write!(
                    f,
                    "shape `{shape}`: the next marker is at the same place as `{marker}`"
                )
            }
            ShapeFaultKind::Back => {
                write!(
                    f,
                    "shape `{shape}`: the outline turns back on itself at `{marker}`"
                )
            }
            ShapeFaultKind::Short => write!(
                f,
                "shape `{shape}`: the radius, fillet or depth leaves nothing of the edge behind `{marker}`"
            ),
            ShapeFaultKind::Crossing => write!(f, "shape `{shape}`: its outline crosses itself"),
            ShapeFaultKind::HoleOutside => write!(
                f,
                "hole `{shape}` does not lie within one of the body's discs, bars and outlines"
            ),
        }
    }
}

impl Shape {
    /// Returns what is wrong with its sizes or at one of its corners, by the place of the corner among its
    /// markers. Allocates nothing.
    pub(in crate::mechanism) fn fault(
        &self,
        given: &Given<'_, f64>,
    ) -> Option<(ShapeFaultKind, Option<usize>)> {
        let is_wrong = |size: &crate::mechanism::Expression, may_be_zero: bool| {
            let size = (given.number)(size);
            !(size > 0.0 || may_be_zero && size == 0.0)
        };
        let is_wrong = match &self.form {
            ShapeForm::Disc { radius, .. }
            | ShapeForm::Hole { radius, .. }
            | ShapeForm::Bar { radius, .. }
            | ShapeForm::Wall { depth: radius, .. } => is_wrong(radius, false),
            ShapeForm::Outline { radius, fillet, .. } => {
                radius.iter().chain(fillet).any(|size| is_wrong(size, true))
            }
        };
        if is_wrong {
            return Some((ShapeFaultKind::Size, None));
        }
        let is_bar = matches!(self.form, ShapeForm::Bar { .. });
        self.with_chain(given, |chain| {
            let (kind, corner) = chain.fault(is_bar)?;
            // Corners are counted counter-clockwise there.
            let own = self
                .markers()
                .position(|id| is_same((given.point)(id), chain.corner_at(corner)));
            Some((kind, own))
        })
        .flatten()
    }
}

impl Shape {
    /// Returns whether the boundary crosses itself. Arcs are taken as chords.
    pub(in crate::mechanism) fn crosses_itself(&self, given: &Given<'_, f64>) -> bool {
        crosses(&flattened(self, given))
    }

    /// Returns whether a disc lies within the boundary.
    pub(in crate::mechanism) fn encloses(
        &self,
        given: &Given<'_, f64>,
        center: [f64; 2],
        radius: f64,
    ) -> bool {
        self.contains(given, center) && distance(self, given, center) >= radius
    }
}

impl Chain<'_, f64> {
    /// Returns what is wrong at a corner, or along the edge behind it.
    fn fault(&self, may_turn_back: bool) -> Option<(ShapeFaultKind, usize)> {
        for k in 0..self.edges() {
            let edge = self.edge(k);
            if is_same(edge.ends[0], edge.ends[1]) {
                return Some((ShapeFaultKind::NoEdge, k));
            }
        }
        let by = self.rim.unwrap_or(0.0);
        let inwards = -self.fillet.unwrap_or(0.0);
        for k in 0..self.edges() {
            let (corner, next) = (self.corner(k), self.corner(k + 1));
            if corner.turn == Turn::Back && !may_turn_back {
                return Some((ShapeFaultKind::Back, k));
            }
            let edge = self.edge(k);
            let outer = ([corner.rim[1], next.rim[0]], by);
            let inner = ([corner.core[1], next.core[0]], inwards);
            for (ends, by) in [outer, inner] {
                let piece = self.moved_edge(&edge, ends, by);
                let is_left = match piece.arc {
                    None => dot(sub(ends[1], ends[0]), sub(edge.ends[1], edge.ends[0])) > 0.0,
                    // An arc that a fillet has turned round has become one of nearly a whole turn.
                    Some((_, radius, turn)) => {
                        radius > 0.0 && turn.abs() <= edge.turn.abs() + 1e-9 && turn.is_finite()
                    }
                };
                if !is_left {
                    return Some((ShapeFaultKind::Short, k));
                }
            }
        }
        None
    }
}

/// Returns a shape's boundary as chords; arcs lie beside theirs by 1/1000 of the radius.
fn flattened(shape: &Shape, given: &Given<'_, f64>) -> Vec<[[f64; 2]; 2]> {
    const PER_TURN: f64 = 64.0;
    let mut lines = Vec::new();
    shape.boundary(given, &mut |piece| {
        let Some((center, _, turn)) = piece.arc else {
            lines.push(piece.ends);
            return;
        };
        let count = (turn.abs() / (2.0 * PI) * PER_TURN).ceil().max(1.0);
        let arm = sub(piece.ends[0], center);
        let at = |k: f64| {
            let (sin, cos) = (turn * k / count).sin_cos();
            [
                center[0] + cos * arm[0] - sin * arm[1],
                center[1] + sin * arm[0] + cos * arm[1],
            ]
        };
        lines.extend((0..count as usize).map(|k| [at(k as f64), at(k as f64 + 1.0)]));
    });
    lines
}

/// Returns whether two lines of a closed chain cross.
fn crosses(lines: &[[[f64; 2]; 2]]) -> bool {
    let sides = |[a, b]: [[f64; 2]; 2], of: [[f64; 2]; 2]| {
        let along = sub(b, a);
        let [p, q] = of.map(|point| cross(along, sub(point, a)));
        p * q < 0.0
    };
    (0..lines.len()).any(|i| {
        let others = lines.iter().skip(i + 1);
        others
            .into_iter()
            .any(|other| sides(lines[i], *other) && sides(*other, lines[i]))
    })
}

/// Returns the distance of a point from a shape's boundary.
fn distance(shape: &Shape, given: &Given<'_, f64>, point: [f64; 2]) -> f64 {
    let mut least = f64::INFINITY;
    shape.boundary(given, &mut |piece| {
        for end in piece.ends {
            least = least.min(length(sub(end, point)));
        }
        match piece.arc {
            None => {
                let [a, b] = piece.ends;
                let (along, from) = (sub(b, a), sub(point, a));
                let part = dot(along, from) / dot(along, along);
                if (0.0..=1.0).contains(&part) {
                    least = least.min((cross(along, from) / length(along)).abs());
                }
            }
            Some((center, radius, turn)) => {
                let (arm, to) = (sub(piece.ends[0], center), sub(point, center));
                let mut place = cross(arm, to).atan2(dot(arm, to)) * turn.signum();
                if place < 0.0 {
                    place += 2.0 * PI;
                }
                if place <= turn.abs() {
                    least = least.min((radius - length(to)).abs());
                }
            }
        }
    });
    least
}

fn is_same(a: [f64; 2], b: [f64; 2]) -> bool {
    sub(a, b).iter().all(|difference| *difference == 0.0)
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
