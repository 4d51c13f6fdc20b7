//! Elements of a contact: runs of features of two cores that touch at one place.
//!
//! Two shapes touch at several places at once: a block on a floor at two corners, a disc in a groove at two
//! edges. Each element has one: it is a round place of one shape, that is a corner or convex arcs, and a
//! convex chain of edges of the other. Between two flat sides that lie on each other a corner of one of them
//! touches always, so that the elements of both directions are all.

use std::f64::consts::PI;

use super::chain::{Chain, SMOOTH, Turn, cross, dot, sub};
use super::core::position;
use super::{Given, Shape, ShapeForm};

/// FeatureRun of the features of a core along its outline, by their positions: 2 k at corner k, 2 k + 1 on the
/// edge from there to the next one. It may lead past the last corner to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FeatureRun {
    first: u16,
    last: u16,
}

impl FeatureRun {
    /// All features.
    pub const WHOLE: Self = Self {
        first: 0,
        last: u16::MAX,
    };

    /// Returns the run from one corner to another.
    fn between(first: usize, last: usize) -> Self {
        let [first, last] = [first, last].map(position);
        Self { first, last }
    }

    /// Returns whether a position is on it.
    #[must_use]
    pub fn has(self, position: u16) -> bool {
        let [behind, before] = [self.first <= position, position <= self.last];
        if self.first <= self.last {
            behind && before
        } else {
            behind || before
        }
    }
}

/// The runs of a core that have part in elements.
#[derive(Debug)]
struct Runs {
    /// Round places: corners that stand out, and convex arcs in a row.
    places: Vec<FeatureRun>,
    /// Convex chains of edges, each between two corners.
    chains: Vec<FeatureRun>,
    /// Whether all of the core is one place.
    is_disc: bool,
    /// Whether two chains have a place in common that stands out or is smooth.
    overlap: bool,
}

/// Elements of the contact of two shapes.
#[derive(Debug)]
pub(in crate::mechanism) struct Elements {
    /// The runs of their features that may touch, place against chain and then chain against place.
    pub(in crate::mechanism) runs: Vec<[FeatureRun; 2]>,
    /// Whether two elements may touch at one place, as at corners of both shapes.
    pub(in crate::mechanism) overlap: bool,
}

/// Returns the elements of the contact of two shapes.
pub(in crate::mechanism) fn elements(shapes: [&Shape; 2], given: &Given<'_, f64>) -> Elements {
    let [a, b] = shapes.map(|shape| shape.runs(given));
    let mut runs = Vec::new();
    // The chain of a disc is its place, and has been met in the other direction.
    if a.is_disc || !b.is_disc {
        let pairs = a.places.iter();
        runs.extend(pairs.flat_map(|place| b.chains.iter().map(|chain| [*place, *chain])));
    }
    if !a.is_disc {
        let pairs = b.places.iter();
        runs.extend(pairs.flat_map(|place| a.chains.iter().map(|chain| [*chain, *place])));
    }
    let overlap = a.overlap || b.overlap || !(a.is_disc || b.is_disc);
    Elements { runs, overlap }
}

impl Shape {
    fn runs(&self, given: &Given<'_, f64>) -> Runs {
        let whole = |places: &[FeatureRun]| Runs {
            places: places.to_vec(),
            chains: vec![FeatureRun::WHOLE],
            is_disc: !places.is_empty(),
            overlap: false,
        };
        match &self.form {
            ShapeForm::Disc { .. } => whole(&[FeatureRun::WHOLE]),
            ShapeForm::Hole { .. } => whole(&[]),
            ShapeForm::Bar { markers, .. } => {
                let last = markers.len() - 1;
                let point = |k: usize| (given.point)(markers[k]);
                let bends = (1..last).filter(|&k| {
                    let [one, other] = [sub(point(k), point(k - 1)), sub(point(k + 1), point(k))];
                    let (sin, cos) = (cross(one, other), dot(one, other));
                    sin.abs() > SMOOTH * cos.abs() || cos < 0.0
                });
                let corners = [0].into_iter().chain(bends).chain([last]);
                let corners: Vec<usize> = corners.collect();
                let places = corners.iter().map(|&k| FeatureRun::between(k, k));
                let chains = corners.windows(2);
                Runs {
                    places: places.collect(),
                    chains: chains
                        .map(|ends| FeatureRun::between(ends[0], ends[1]))
                        .collect(),
                    is_disc: false,
                    overlap: corners.len() > 2,
                }
            }
            ShapeForm::Outline { .. } | ShapeForm::Wall { .. } => {
                let runs = self.with_chain(given, |chain| OutlineTurns::of(chain).runs());
                runs.expect("an outline and a wall have a chain")
            }
        }
    }
}

/// The turns of an outline along its way.
struct OutlineTurns {
    is_closed: bool,
    /// The turn at each corner, and its angle, positive where the corner stands out.
    corners: Vec<(Turn, f64)>,
    /// The angle by which each edge turns, zero for a straight one.
    edges: Vec<f64>,
}

impl OutlineTurns {
    fn of(chain: &Chain<'_, f64>) -> Self {
        let corners = (0..chain.count).map(|k| {
            if !chain.is_closed && (k == 0 || k + 1 == chain.count) {
                return (Turn::Back, PI);
            }
            let [before, after] = [chain.edge(k + chain.count - 1), chain.edge(k)];
            let [from, to] = [before.normals[1], after.normals[0]];
            let turn = chain.corner(k).turn;
            let angle = match turn {
                Turn::Back => PI,
                _ => cross(from, to).atan2(dot(from, to)),
            };
            (turn, angle)
        });
        Self {
            is_closed: chain.is_closed,
            corners: corners.collect(),
            edges: (0..chain.edges()).map(|k| chain.edge(k).turn).collect(),
        }
    }

    fn runs(&self) -> Runs {
        let is_arc = |k: usize| self.edges[k] > 0.0;
        let places = self.pieces(is_arc);
        let count = self.corners.len();
        let is_beside_arc = |k: usize| {
            let before = (k > 0 || self.is_closed).then(|| (k + count - 1) % count);
            let beside = before
                .into_iter()
                .chain((k < self.edges.len()).then_some(k));
            beside.into_iter().any(is_arc)
        };
        let stands_out = |k: &usize| {
            let turn = self.corners[*k].0;
            matches!(turn, Turn::Convex | Turn::Back) && !is_beside_arc(*k)
        };
        let corners = (0..count).filter(stands_out);
        let corners = corners.map(|k| FeatureRun::between(k, k));
        let hollow = (0..self.edges.len()).filter(|&k| self.edges[k] < 0.0);
        let hollow = hollow.map(|k| FeatureRun::between(k, (k + 1) % count));
        let chains = self.pieces(|k| self.edges[k] >= 0.0).into_iter();
        let chains: Vec<FeatureRun> = chains.chain(hollow).collect();
        let parts = |run: &FeatureRun| {
            let ends = [run.first, run.last].map(|position| usize::from(position / 2));
            let is_part =
                |k: usize| !matches!(self.corners.get(k), Some((Turn::Hollow | Turn::Back, _)));
            *run != FeatureRun::WHOLE && ends.into_iter().any(is_part)
        };
        Runs {
            places: corners.chain(places).collect(),
            overlap: chains.iter().any(parts),
            chains,
            is_disc: false,
        }
    }

    /// Returns the convex pieces of the outline that edges of one kind make.
    ///
    /// They end at corners that are hollow, and where they would turn by more than half a turn: round a
    /// notch a longer one would be near to one place in two ways.
    fn pieces(&self, is_one: impl Fn(usize) -> bool) -> Vec<FeatureRun> {
        let (count, edges) = (self.corners.len(), self.edges.len());
        let is_hollow = |k: usize| self.corners[k].0 == Turn::Hollow;
        let ends = |k: usize| is_hollow(k) || !is_one(k) || !is_one((k + count - 1) % count);
        let start = if self.is_closed {
            let Some(start) = (0..count).find(|&k| ends(k)) else {
                return vec![FeatureRun::WHOLE];
            };
            start
        } else {
            0
        };
        let mut pieces = Vec::new();
        let mut begun: Option<(usize, f64)> = None;
        for edge in (start..start + edges).map(|k| k % count) {
            let next = (edge + 1) % count;
            if !is_one(edge) {
                continue;
            }
            let (first, turned) = begun.take().unwrap_or((edge, 0.0));
            let turned = turned + self.edges[edge];
            let is_last = next == (start + edges) % count;
            let after = turned + self.corners[next].1;
            let goes_on = !is_last && !is_hollow(next) && is_one(next);
            if goes_on && after <= PI + SMOOTH {
                begun = Some((first, after));
            } else {
                pieces.push(FeatureRun::between(first, next));
            }
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use crate::mechanism::{Mechanism, ShapeId, Source};

    /// Returns the number of elements between two shapes of a file of bodies.
    fn count(shapes: [&str; 2]) -> usize {
        let text = format!(
            "format = 1\nname = 'parts'\n[ground.markers]\nO = [0, 0]\n[bodies.a.markers]\n\
             O = [0, 0]\nA = [1, 0]\nB = [1, 1]\nC = [0, 1]\nM = [0.5, 0]\nH = [0.5, 0.5]\n\
             [bodies.a.shapes]\none = {}\n[bodies.b.markers]\nO = [0, 0]\nA = [1, 0]\nB = [1, 1]\n\
             C = [0, 1]\nM = [0.5, 0]\nH = [0.5, 0.5]\n[bodies.b.shapes]\nother = {}\n\
             plate = {{ disc = 'O', radius = 0.2 }}\n\
             [joints]\np = {{ type = 'revolute', markers = ['ground.O', 'a.O'] }}\n\
             r = {{ type = 'revolute', markers = ['ground.O', 'b.O'] }}\n",
            shapes[0], shapes[1]
        );
        let source = Source::new("parts.toml", &text);
        let read = Mechanism::parse(&source);
        let (mechanism, _) = read.unwrap_or_else(|p| panic!("{}", p[0].one_line(&source)));
        let parameters = mechanism.default_parameters();
        let elements = mechanism.elements([ShapeId(0), ShapeId(1)], &parameters);
        elements.runs.len()
    }

    #[test]
    fn convex_outlines_have_an_element_per_corner() {
        let disc = "{ disc = 'O', radius = 0.1 }";
        let square = "{ outline = ['O', 'A', 'B', 'C'], fillet = 0.01 }";
        let with_middle = "{ outline = ['O', 'M', 'A', 'B', 'C'], fillet = 0.01 }";
        let backwards = "{ outline = ['C', 'B', 'A', 'O'], radius = 0.01 }";
        let bar = "{ bar = ['O', 'M', 'A'], radius = 0.01 }";
        assert_eq!(count([disc, disc]), 1);
        assert_eq!(count([disc, square]), 1);
        assert_eq!(count([square, disc]), 1);
        assert_eq!(count([square, backwards]), 8);
        assert_eq!(count([with_middle, square]), 8);
        assert_eq!(count([bar, square]), 6);
        assert_eq!(count([bar, bar]), 4);
        assert_eq!(count([disc, bar]), 1);
    }

    #[test]
    fn hollow_outlines_have_a_chain_between_hollow_corners() {
        let disc = "{ disc = 'O', radius = 0.1 }";
        let hole = "{ hole = 'O', radius = 0.1 }";
        // A square with a notch in one side.
        let notch = "{ outline = ['O', 'A', 'B', 'H', 'C'], fillet = 0.01 }";
        let arm = "{ bar = ['A', 'O', 'C'], radius = 0.01 }";
        let moon = "{ outline = [{ marker = 'O', bulge = 1 }, { marker = 'A', bulge = -0.5 }] }";
        let circle = "{ outline = [{ marker = 'O', bulge = 1 }, { marker = 'A', bulge = 1 }] }";
        // From the notch to a half turn, and on to the notch.
        assert_eq!(count([disc, notch]), 3);
        assert_eq!(count([disc, arm]), 2);
        assert_eq!(count([arm, hole]), 3);
        assert_eq!(count([moon, disc]), 2);
        assert_eq!(count([circle, disc]), 1);
        assert_eq!(count([circle, circle]), 2);
    }
}
