//! The core of a shape: places, edges and arcs round which it has its radius.

use super::chain::{Chain, Turn, moved, zero};
use super::{Given, Shape, ShapeForm};
use crate::mechanism::{Expression, MarkerId, Number};

/// Core of a shape in the frame of its body, and the radius round it.
#[derive(Clone, Debug)]
pub struct Core<N> {
    /// Its features: all places at which another shape may be nearest.
    pub features: Vec<Feature<N>>,
    /// Radius round the core \[m\], zero for an outline with sharp corners.
    pub radius: N,
}

/// Part of a core.
#[derive(Clone, Copy, Debug)]
pub struct Feature<N> {
    /// Its kind.
    pub kind: FeatureKind,
    /// The place, the middle of an edge, or the centre of an arc \[m\].
    pub center: [N; 2],
    /// Both ends of an edge, or of an arc counter-clockwise \[m\].
    pub ends: [[N; 2]; 2],
    /// Radius of an arc \[m\], zero otherwise.
    pub radius: N,
    /// Position along the outline: 2 k at corner k, 2 k + 1 on the edge from there to the next one.
    pub position: u16,
}

impl<N: Copy> Feature<N> {
    /// Returns the feature on other numbers.
    pub(crate) fn map<M>(&self, of: impl Fn(N) -> M) -> Feature<M> {
        Feature {
            kind: self.kind,
            center: self.center.map(&of),
            ends: self.ends.map(|end| end.map(&of)),
            radius: of(self.radius),
            position: self.position,
        }
    }
}

/// Kind of a [`Feature`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    /// A place.
    Place,
    /// A straight edge without its ends.
    Edge,
    /// An arc that bulges towards free space.
    Convex {
        /// Whether it turns by more than half a turn.
        is_wide: bool,
    },
    /// An arc round free space.
    Hollow {
        /// Whether it turns by more than half a turn.
        is_wide: bool,
    },
    /// The wall of a bore: a whole circle round free space.
    Bore,
}

impl<N: Number> Default for Core<N> {
    fn default() -> Self {
        Self {
            features: Vec::new(),
            radius: zero(),
        }
    }
}

impl<N: Number> Core<N> {
    /// Makes the storage for a shape.
    pub(crate) fn for_shape(shape: &Shape) -> Self {
        Self {
            features: Vec::with_capacity(4 * shape.markers().count()),
            radius: zero(),
        }
    }

    /// Takes over a shape's markers and numbers. Allocates nothing in storage for this shape.
    pub(crate) fn set(
        &mut self,
        shape: &Shape,
        point: &dyn Fn(MarkerId) -> [N; 2],
        number: &dyn Fn(&Expression) -> N,
    ) {
        let given = &Given { point, number };
        self.features.clear();
        let edge = |ends: [[N; 2]; 2], k: usize| Feature {
            kind: FeatureKind::Edge,
            center: middle(ends),
            ends,
            radius: zero(),
            position: position(k) + 1,
        };
        match &shape.form {
            ShapeForm::Disc { marker, radius } => {
                self.radius = (given.number)(radius);
                self.features.push(place((given.point)(*marker), 0));
            }
            ShapeForm::Hole { marker, radius } => {
                self.radius = zero();
                self.features.push(Feature {
                    kind: FeatureKind::Bore,
                    radius: (given.number)(radius),
                    ..place((given.point)(*marker), 0)
                });
            }
            ShapeForm::Bar { markers, radius } => {
                self.radius = (given.number)(radius);
                let point = |id| (given.point)(id);
                let places = markers.iter().enumerate();
                self.features
                    .extend(places.map(|(k, id)| place(point(*id), k)));
                let pairs = markers.windows(2).enumerate();
                let edges = pairs.map(|(k, pair)| edge([point(pair[0]), point(pair[1])], k));
                self.features.extend(edges);
            }
            ShapeForm::Outline { .. } | ShapeForm::Wall { .. } => {
                let features = &mut self.features;
                let radius = shape.with_chain(given, |chain| {
                    features_of(chain, features, &edge);
                    chain.radius()
                });
                self.radius = radius.unwrap_or(zero());
            }
        }
    }
}

/// Returns the position of a corner along the outline.
pub(super) fn position(corner: usize) -> u16 {
    2 * u16::try_from(corner).expect("a shape has at most 256 corners")
}

fn place<N: Number>(at: [N; 2], corner: usize) -> Feature<N> {
    Feature {
        kind: FeatureKind::Place,
        center: at,
        ends: [at; 2],
        radius: zero(),
        position: position(corner),
    }
}

fn middle<N: Number>([a, b]: [[N; 2]; 2]) -> [N; 2] {
    [(a[0] + b[0]) * 0.5, (a[1] + b[1]) * 0.5]
}

/// Adds the features of a chain.
fn features_of<N: Number>(
    chain: &Chain<'_, N>,
    features: &mut Vec<Feature<N>>,
    edge: &impl Fn([[N; 2]; 2], usize) -> Feature<N>,
) {
    let half = std::f64::consts::PI;
    let first = chain.corner(0);
    let mut corner = first;
    for k in 0..chain.count {
        features.push(place(corner.core[0], k));
        if let (Turn::Hollow, Some(fillet)) = (corner.turn, chain.fillet) {
            features.push(place(corner.core[1], k));
            let [before, after] = corner
                .normals
                .map(|normal| moved(corner.at, normal, -fillet));
            features.push(Feature {
                kind: FeatureKind::Hollow { is_wide: false },
                center: corner.at,
                ends: [after, before],
                radius: fillet,
                position: position(k),
            });
        }
        if k == chain.edges() {
            break;
        }
        let next = if k + 1 == chain.count {
            first
        } else {
            chain.corner(k + 1)
        };
        let own = chain.edge(k);
        let ends = [corner.core[1], next.core[0]];
        let inwards = chain.fillet.map_or(zero(), |fillet| -fillet);
        features.push(match chain.moved_edge(&own, ends, inwards).arc {
            None => edge(ends, k),
            Some((center, radius, turn)) => {
                let is_wide = turn.real().abs() > half;
                let (kind, ends) = if turn.real() > 0.0 {
                    (FeatureKind::Convex { is_wide }, ends)
                } else {
                    (FeatureKind::Hollow { is_wide }, [ends[1], ends[0]])
                };
                Feature {
                    kind,
                    center,
                    ends,
                    radius,
                    position: position(k) + 1,
                }
            }
        });
        corner = next;
    }
}
