//! Corners and edges of a shape.
//!
//! The corners V of an outline are taken counter-clockwise round its area, so that the normals n of edges
//! point outwards, to the right of the way. At a distance δ from an edge of curvature κ (positive where it
//! bulges outwards) is each point V + w with
//!
//! > n · w − δ + κ/2 (‖w‖² − δ²) = 0
//!
//! where n is the edge's normal at V. Two such equations give the place where the edges meet that are moved
//! out by δ.

use std::f64::consts::TAU;

use super::{Given, Shape, ShapeForm};
use crate::mechanism::Number;

/// Sine of the turn at a corner up to which the two edges count as one smooth line.
///
/// Far above the rounding of places, far below any corner that is meant. A marker in the middle of an edge
/// makes no corner.
pub(super) const SMOOTH: f64 = 1e-9;

/// Steps of Newton–Raphson to the meeting place of two moved edges of which one is an arc. It converges
/// quadratically; a fillet as large as half the radius of the arc takes five.
const STEPS: usize = 8;

/// Piece of the boundary of a shape, in the frame of its body \[m\].
#[derive(Clone, Copy, Debug)]
pub struct Piece<N> {
    /// Both ends.
    pub ends: [[N; 2]; 2],
    /// Centre, radius \[m\] and turn \[rad\] of an arc, positive counter-clockwise; `None` for a line.
    pub arc: Option<([N; 2], N, N)>,
}

/// Place of each corner.
type Corners<'a, N> = &'a dyn Fn(usize) -> [N; 2];

/// Bulge of the edge from each corner to the next, `None` for a straight one.
type Bulges<'a, N> = &'a dyn Fn(usize) -> Option<N>;

/// Corners and edges of a shape, with the numbers that round them.
pub(super) struct Chain<'a, N> {
    corner: Corners<'a, N>,
    bulge: Bulges<'a, N>,
    pub(super) count: usize,
    pub(super) is_closed: bool,
    /// Radius that rounds convex corners from inside, `None` for sharp ones.
    pub(super) fillet: Option<N>,
    /// Radius by which it grows besides, `None` for zero.
    pub(super) rim: Option<N>,
}

/// Edge from one corner to the next.
#[derive(Clone, Copy)]
pub(super) struct Edge<N> {
    pub(super) ends: [[N; 2]; 2],
    /// Outward normals at both ends.
    pub(super) normals: [[N; 2]; 2],
    /// κ, positive where it bulges outwards; `None` for a line.
    pub(super) curvature: Option<N>,
    /// Angle by which an arc turns, positive where it bulges outwards.
    pub(super) turn: N,
}

/// The way in which the outline turns at a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    Smooth,
    Convex,
    Hollow,
    /// Back on itself.
    Back,
}

/// Corner with what a fillet and a rim make of it.
#[derive(Clone, Copy)]
pub(super) struct Corner<N> {
    pub(super) at: [N; 2],
    pub(super) turn: Turn,
    /// Ends of the adjacent edges that are moved in by the fillet; one place but at a hollow corner.
    pub(super) core: [[N; 2]; 2],
    /// Ends of the adjacent edges of the boundary; one place but at a convex corner.
    pub(super) rim: [[N; 2]; 2],
    /// Normals of the adjacent edges there.
    pub(super) normals: [[N; 2]; 2],
}

impl<N: Number> Chain<'_, N> {
    pub(super) fn corner_at(&self, k: usize) -> [N; 2] {
        (self.corner)(k % self.count)
    }

    /// Returns the number of edges.
    pub(super) fn edges(&self) -> usize {
        self.count - usize::from(!self.is_closed)
    }

    /// Returns the radius round the core: fillet and rim.
    pub(super) fn radius(&self) -> N {
        self.fillet.unwrap_or(zero()) + self.rim.unwrap_or(zero())
    }

    /// Returns the edge from corner k to the next.
    pub(super) fn edge(&self, k: usize) -> Edge<N> {
        let ends = [self.corner_at(k), self.corner_at(k + 1)];
        let chord = sub(ends[1], ends[0]);
        let length = chord[0].norm(chord[1]);
        let along = [chord[0] / length, chord[1] / length];
        let Some(bulge) = (self.bulge)(k % self.count) else {
            return Edge {
                ends,
                normals: [right(along); 2],
                curvature: None,
                turn: zero(),
            };
        };
        // Cosine and sine of half the arc's angle.
        let square = bulge * bulge;
        let one = N::constant(1.0);
        let cos = (one - square) / (one + square);
        let sin = bulge * 2.0 / (one + square);
        let [x, y] = along;
        Edge {
            ends,
            normals: [
                right([x * cos + y * sin, y * cos - x * sin]),
                right([x * cos - y * sin, y * cos + x * sin]),
            ],
            curvature: Some(bulge * 4.0 / (length * (one + square))),
            turn: bulge.atan() * 4.0,
        }
    }

    /// Returns corner k of a closed chain, or an inner one of an open chain.
    pub(super) fn corner(&self, k: usize) -> Corner<N> {
        let at = self.corner_at(k);
        if !self.is_closed && (k == 0 || k + 1 == self.count) {
            let edge = self.edge(k.min(self.count - 2));
            let normal = edge.normals[usize::from(k > 0)];
            let core = match self.fillet {
                Some(fillet) => moved(at, normal, -fillet),
                None => at,
            };
            return Corner {
                at,
                turn: Turn::Smooth,
                core: [core; 2],
                rim: [moved(core, normal, self.radius()); 2],
                normals: [normal; 2],
            };
        }
        let edges = [self.edge(k + self.count - 1), self.edge(k)];
        let normals = [edges[0].normals[1], edges[1].normals[0]];
        let curvatures = [edges[0].curvature, edges[1].curvature];
        let turn = turn(normals);
        let places = |by: N| normals.map(|normal| moved(at, normal, by));
        let core = match (self.fillet, turn) {
            (None, _) => [at; 2],
            (Some(fillet), Turn::Hollow) => places(-fillet),
            (Some(fillet), Turn::Smooth) => [places(-fillet)[0]; 2],
            (Some(fillet), _) => [meet(at, normals, curvatures, -fillet); 2],
        };
        let radius = self.radius();
        match turn {
            Turn::Hollow => {
                let rim = self
                    .rim
                    .map_or(at, |rim| meet(at, normals, curvatures, rim));
                Corner {
                    at,
                    turn,
                    core,
                    rim: [rim; 2],
                    normals,
                }
            }
            Turn::Smooth => {
                let rim = self.rim.map_or(at, |rim| moved(at, normals[0], rim));
                Corner {
                    at,
                    turn,
                    core,
                    rim: [rim; 2],
                    normals: [normals[0]; 2],
                }
            }
            Turn::Convex | Turn::Back => {
                let normals = match self.fillet {
                    Some(fillet) => {
                        let w = sub(core[0], at);
                        [0, 1].map(|side| normal_at(normals[side], curvatures[side], w, -fillet))
                    }
                    None => normals,
                };
                Corner {
                    at,
                    turn,
                    core,
                    rim: normals.map(|normal| moved(core[0], normal, radius)),
                    normals,
                }
            }
        }
    }

    /// Returns an edge that is moved out by `by`, between two ends.
    pub(super) fn moved_edge(&self, edge: &Edge<N>, ends: [[N; 2]; 2], by: N) -> Piece<N> {
        let arc = edge.curvature.map(|curvature| {
            let [x, y] = edge.normals[0];
            let center = sub(edge.ends[0], [x / curvature, y / curvature]);
            let sign = curvature.real().signum();
            let radius = (N::constant(1.0) / curvature + by) * sign;
            let [from, to] = ends.map(|end| sub(end, center));
            let mut turn = cross(from, to).atan2(dot(from, to));
            // From rounding, a turn of zero may be a whole one.
            if turn.real() * sign < -1e-12 {
                turn += N::constant(sign * TAU);
            }
            (center, radius, turn)
        });
        Piece { ends, arc }
    }

    /// Shows `visit` the pieces of the boundary of a closed chain in order.
    pub(super) fn boundary(&self, visit: &mut dyn FnMut(Piece<N>)) {
        let by = self.rim.unwrap_or(zero());
        let mut corner = self.corner(0);
        for k in 0..self.edges() {
            if matches!(corner.turn, Turn::Convex | Turn::Back) && !self.radius().is_zero() {
                let [from, to] = corner.normals;
                let mut turn = cross(from, to).atan2(dot(from, to));
                if corner.turn == Turn::Back && turn.real() < 0.0 {
                    turn += N::constant(TAU);
                }
                visit(Piece {
                    ends: corner.rim,
                    arc: Some((corner.core[0], self.radius(), turn)),
                });
            }
            let next = self.corner(k + 1);
            visit(self.moved_edge(&self.edge(k), [corner.rim[1], next.rim[0]], by));
            corner = next;
        }
    }
}

impl Shape {
    /// Shows `look` the chain of a shape that has one; a bar is the way along it and back.
    pub(super) fn with_chain<N: Number, T>(
        &self,
        given: &Given<'_, N>,
        look: impl FnOnce(&Chain<'_, N>) -> T,
    ) -> Option<T> {
        let straight = |_| None;
        match &self.form {
            ShapeForm::Disc { .. } | ShapeForm::Hole { .. } => None,
            ShapeForm::Bar { markers, radius } => {
                let last = markers.len() - 1;
                let corner =
                    |k: usize| (given.point)(markers[if k > last { 2 * last - k } else { k }]);
                Some(look(&Chain {
                    corner: &corner,
                    bulge: &straight,
                    count: 2 * last,
                    is_closed: true,
                    fillet: None,
                    rim: Some((given.number)(radius)),
                }))
            }
            ShapeForm::Wall { markers, depth } => {
                let corner = |k: usize| (given.point)(markers[k]);
                Some(look(&Chain {
                    corner: &corner,
                    bulge: &straight,
                    count: markers.len(),
                    is_closed: false,
                    fillet: Some((given.number)(depth)),
                    rim: None,
                }))
            }
            ShapeForm::Outline {
                corners,
                radius,
                fillet,
            } => {
                let count = corners.len();
                let point = |k: usize| (given.point)(corners[k].marker);
                let bulge = |k: usize| corners[k].bulge.as_ref().map(|bulge| (given.number)(bulge));
                let number = |size: &Option<crate::mechanism::Expression>| {
                    let size = size.as_ref().map(|size| (given.number)(size));
                    size.filter(|size| !size.is_zero())
                };
                let (fillet, rim) = (number(fillet), number(radius));
                // The last edge leads to the first corner.
                let backwards = |k: usize| point(count - 1 - k);
                let back_bulge = |k: usize| bulge((2 * count - 2 - k) % count).map(|bulge| -bulge);
                let is_backwards = doubled_area(count, &point, &bulge) < 0.0;
                let (corner, bulge): (Corners<'_, N>, Bulges<'_, N>) = if is_backwards {
                    (&backwards, &back_bulge)
                } else {
                    (&point, &bulge)
                };
                Some(look(&Chain {
                    corner,
                    bulge,
                    count,
                    is_closed: true,
                    fillet,
                    rim,
                }))
            }
        }
    }

    /// Shows `visit` the pieces of the boundary, counter-clockwise round the area. A wall has its surface
    /// and the way back at its depth.
    pub(in crate::mechanism) fn boundary<N: Number>(
        &self,
        given: &Given<'_, N>,
        visit: &mut dyn FnMut(Piece<N>),
    ) {
        match &self.form {
            ShapeForm::Disc { marker, radius } | ShapeForm::Hole { marker, radius } => {
                let (center, radius) = ((given.point)(*marker), (given.number)(radius));
                let end = [center[0] + radius, center[1]];
                visit(Piece {
                    ends: [end; 2],
                    arc: Some((center, radius, N::constant(TAU))),
                });
            }
            ShapeForm::Wall { .. } => {
                self.with_chain(given, |chain| chain.around_wall(visit));
            }
            ShapeForm::Bar { .. } | ShapeForm::Outline { .. } => {
                self.with_chain(given, |chain| chain.boundary(visit));
            }
        }
    }
}

impl<N: Number> Chain<'_, N> {
    /// Shows `visit` the surface of an open chain, and the way back along its core.
    fn around_wall(&self, visit: &mut dyn FnMut(Piece<N>)) {
        let line = |from, to| Piece {
            ends: [from, to],
            arc: None,
        };
        let last = self.count - 1;
        for k in 0..last {
            let (corner, next) = (self.corner(k), self.corner(k + 1));
            if corner.turn == Turn::Convex {
                let [from, to] = corner.normals;
                visit(Piece {
                    ends: corner.rim,
                    arc: Some((
                        corner.core[0],
                        self.radius(),
                        cross(from, to).atan2(dot(from, to)),
                    )),
                });
            }
            visit(line(corner.rim[1], next.rim[0]));
        }
        visit(line(self.corner(last).rim[1], self.corner(last).core[0]));
        for k in (0..last).rev() {
            let (corner, next) = (self.corner(k), self.corner(k + 1));
            visit(line(next.core[0], corner.core[1]));
            if corner.turn == Turn::Hollow {
                visit(line(corner.core[1], corner.core[0]));
            }
        }
        visit(line(self.corner(0).core[0], self.corner(0).rim[0]));
    }
}

/// Returns twice the area within corners and arcs, positive counter-clockwise.
pub(super) fn doubled_area<N: Number>(
    count: usize,
    corner: &impl Fn(usize) -> [N; 2],
    bulge: &impl Fn(usize) -> Option<N>,
) -> f64 {
    let place = |k: usize| corner(k % count).map(Number::real);
    let origin = place(0);
    let areas = (0..count).map(|k| {
        let [a, b] = [k, k + 1].map(|k| sub(place(k), origin));
        let chord = sub(b, a);
        // The segment of a circle on the chord: R² (τ − sin τ), on the right of the way.
        let segment = bulge(k).map_or(0.0, |bulge| {
            let bulge = bulge.real();
            let turn = 4.0 * bulge.atan();
            let radius = chord[0].hypot(chord[1]) * (1.0 + bulge * bulge) / (4.0 * bulge);
            if radius.is_finite() {
                radius * radius * (turn - turn.sin())
            } else {
                0.0
            }
        });
        cross(a, b) + segment
    });
    areas.sum()
}

/// Returns the turn between two normals.
fn turn<N: Number>(normals: [[N; 2]; 2]) -> Turn {
    let [from, to] = normals.map(|normal| normal.map(Number::real));
    let (sin, cos) = (cross(from, to), dot(from, to));
    if sin.abs() > SMOOTH {
        if sin > 0.0 {
            Turn::Convex
        } else {
            Turn::Hollow
        }
    } else if cos < 0.0 {
        Turn::Back
    } else {
        Turn::Smooth
    }
}

/// Returns the place where two edges through `at` meet that are moved out by `by`.
fn meet<N: Number>(at: [N; 2], normals: [[N; 2]; 2], curvatures: [Option<N>; 2], by: N) -> [N; 2] {
    let [a, b] = normals;
    let factor = by / (N::constant(1.0) + dot(a, b));
    let mut w = [(a[0] + b[0]) * factor, (a[1] + b[1]) * factor];
    if curvatures.iter().any(Option::is_some) {
        for _ in 0..STEPS {
            let rows = [0, 1].map(|side| {
                let (normal, curvature) = (normals[side], curvatures[side].unwrap_or(zero()));
                let open = dot(normal, w) - by + curvature * (dot(w, w) - by * by) * 0.5;
                let slope = [normal[0] + curvature * w[0], normal[1] + curvature * w[1]];
                (slope, open)
            });
            let [(first, open_first), (second, open_second)] = rows;
            let determinant = cross(first, second);
            w = [
                w[0] - (open_first * second[1] - open_second * first[1]) / determinant,
                w[1] - (open_second * first[0] - open_first * second[0]) / determinant,
            ];
        }
    }
    [at[0] + w[0], at[1] + w[1]]
}

/// Returns the normal of an edge at a place that is `w` from its end and at the distance `by`.
fn normal_at<N: Number>(normal: [N; 2], curvature: Option<N>, w: [N; 2], by: N) -> [N; 2] {
    let Some(curvature) = curvature else {
        return normal;
    };
    let scale = N::constant(1.0) + curvature * by;
    [0, 1].map(|k| (normal[k] + curvature * w[k]) / scale)
}

pub(super) fn zero<N: Number>() -> N {
    N::constant(0.0)
}

pub(super) fn sub<N: Number>(a: [N; 2], b: [N; 2]) -> [N; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn moved<N: Number>(at: [N; 2], normal: [N; 2], by: N) -> [N; 2] {
    [at[0] + normal[0] * by, at[1] + normal[1] * by]
}

pub(super) fn dot<N: Number>(a: [N; 2], b: [N; 2]) -> N {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross<N: Number>(a: [N; 2], b: [N; 2]) -> N {
    a[0] * b[1] - a[1] * b[0]
}

fn right<N: Number>([x, y]: [N; 2]) -> [N; 2] {
    [y, -x]
}
