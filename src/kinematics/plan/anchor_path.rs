//! The way between the two anchors of a dyad.

use nalgebra::Vector2;

use super::anchor::compact;
use crate::kinematics::certificate::{Change, ChordBound, ParameterBounds, Pivots, StepBounds};
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, rotate};
use crate::mechanism::{MarkerId, Mechanism};

/// The vector from the anchor of side b to the anchor of side a, as a sum of arms fixed to bodies
/// found before. It depends on the angles of these bodies alone: what the two anchors have in
/// common cancels, however long the chain of bodies that carries both of them.
#[derive(Debug)]
pub(super) struct AnchorPath {
    pub(super) kind: PathKind,
    arms: Box<[Arm]>,
    /// Sum of the legs on ground.
    fixed: Vector2<f64>,
    /// Indices of the first arms of pairs whose two bodies are the sides of one dyad.
    pairs: Box<[usize]>,
    /// The legs of the arms, in the same order, then those on ground.
    legs: Box<[Leg]>,
    /// The bodies whose pivots the arms begin and end at, where no chain of revolutes joins the
    /// anchors: the move of these pivots is not part of the arms.
    loose: Box<[u32]>,
}

/// The kind of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathKind {
    /// One body joins the anchors, or ground alone.
    Short,
    /// Several bodies do.
    Chain,
    /// No chain of revolutes joins the anchors.
    ByPivots,
}

/// A vector fixed to a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arm {
    pub(super) body: u32,
    /// Whether the arm belongs to a pair.
    pub(super) paired: bool,
    /// The arm in the body's frame \[m\], and its length.
    vector: Vector2<f64>,
    pub(super) length: f64,
}

/// The ends of an arm; `None` is the pivot of the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) body: Option<usize>,
    pub(super) from: Option<MarkerId>,
    pub(super) to: Option<MarkerId>,
}

impl AnchorPath {
    /// Makes a path of legs in the order of the way; `is_pair` tells whether two bodies are the
    /// sides of one dyad.
    pub(super) fn new(legs: &[Leg], mut is_pair: impl FnMut(usize, usize) -> bool) -> Self {
        let bodies: Vec<_> = legs.iter().filter_map(|leg| leg.body).collect();
        let mut arms: Vec<_> = bodies
            .iter()
            .map(|&body| Arm {
                body: compact(body),
                paired: false,
                vector: Vector2::zeros(),
                length: 0.0,
            })
            .collect();
        let mut pairs = Vec::new();
        for first in 1..arms.len() {
            let first = first - 1;
            if !arms[first].paired && is_pair(bodies[first], bodies[first + 1]) {
                arms[first].paired = true;
                arms[first + 1].paired = true;
                pairs.push(first);
            }
        }
        let (mut moving, ground): (Vec<Leg>, Vec<Leg>) =
            legs.iter().partition(|leg| leg.body.is_some());
        moving.extend(ground);
        let kind = if arms.len() > 1 {
            PathKind::Chain
        } else {
            PathKind::Short
        };
        Self {
            kind,
            arms: arms.into(),
            fixed: Vector2::zeros(),
            pairs: pairs.into(),
            legs: moving.into(),
            loose: Box::default(),
        }
    }

    /// Makes the path by way of the pivots of the bodies that carry the anchors, where nothing
    /// joins these.
    pub(super) fn by_pivots(mechanism: &Mechanism, [a, b]: [MarkerId; 2]) -> Self {
        let body = |marker: MarkerId| mechanism.markers[marker.index()].body.map(|b| b.index());
        let legs = [
            Leg {
                body: body(b),
                from: Some(b),
                to: None,
            },
            Leg {
                body: body(a),
                from: None,
                to: Some(a),
            },
        ];
        let moving: Vec<_> = legs.into_iter().filter(|leg| leg.body.is_some()).collect();
        let loose = moving.iter().filter_map(|leg| leg.body).map(compact);
        Self {
            kind: PathKind::ByPivots,
            loose: loose.collect(),
            ..Self::new(&moving, |_, _| false)
        }
    }

    /// Takes over the points of the markers, and the pivots.
    pub(super) fn set_parameters(&mut self, at: &Configuration, pivots: &Pivots) {
        let vector = |leg: &Leg| {
            let end = |end: Option<MarkerId>| match (end, leg.body) {
                (Some(marker), _) => at.local(marker).0,
                (None, Some(body)) => pivots.or_origin(body),
                (None, None) => Vector2::zeros(),
            };
            end(leg.to) - end(leg.from)
        };
        let (moving, ground) = self.legs.split_at(self.arms.len());
        for (arm, leg) in self.arms.iter_mut().zip(moving) {
            arm.vector = vector(leg);
            arm.length = arm.vector.norm();
        }
        self.fixed = ground.iter().map(vector).sum();
    }

    /// Returns the arms.
    #[inline(always)]
    pub(super) fn arms(&self) -> &[Arm] {
        &self.arms
    }

    /// Returns whether the path has pairs.
    #[inline(always)]
    pub(super) fn has_pairs(&self) -> bool {
        !self.pairs.is_empty()
    }

    /// Returns the pairs of arms whose bodies are the sides of one dyad.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [&Arm; 2]> {
        let pairs = self.pairs.iter();
        pairs.map(|&first| [&self.arms[first], &self.arms[first + 1]])
    }

    /// Returns the vector from the anchor of side b to the anchor of side a, at the start of the
    /// sub-step and at the end.
    pub(super) fn ends(&self, bounds: &StepBounds, frames: &[BodyPose]) -> [Vector2<f64>; 2] {
        let arms = self.arms.iter();
        arms.fold([self.fixed; 2], |[start, end], arm| {
            let [a, b] = arm.ends(bounds.body(arm.body as usize), frames);
            [start + a, end + b]
        })
    }

    /// Bounds the deviation of the pivots that are not part of the arms \[m\].
    pub(super) fn loose(&self, bounds: &StepBounds) -> f64 {
        let loose = self.loose.iter();
        loose
            .map(|&body| bounds.body(body as usize).point_deviation)
            .sum()
    }

    /// Bounds the deviation of the path from its chord by moving parameters \[m\].
    pub(super) fn moved(&self, bounds: &StepBounds, parameters: &ParameterBounds) -> f64 {
        let deviation = |leg: &Leg| {
            let ends = [leg.from, leg.to].into_iter().flatten();
            let change = ends.fold(Change::default(), |sum, marker| {
                sum + parameters.position(marker)
            });
            leg.body.map_or_else(
                || change.deviation(0.0),
                |body| bounds.body(body).deviation_of(change),
            )
        };
        self.legs.iter().map(deviation).sum()
    }

    /// Returns the path at the start of the sub-step, less what it is there for the numbers at the
    /// end \[m\].
    pub(super) fn start(&self, bounds: &StepBounds, parameters: &ParameterBounds) -> Vector2<f64> {
        let start = |leg: &Leg| {
            let [from, to] = [leg.from, leg.to]
                .map(|end| end.map_or_else(Vector2::zeros, |marker| parameters.start(marker)));
            leg.body.map_or(to - from, |body| {
                let bound = bounds.body(body);
                rotate(bound.cos, bound.sin, to - from)
            })
        };
        self.legs.iter().map(start).sum()
    }
}

impl Arm {
    /// Returns the arm at the start of the sub-step and at the end.
    #[inline(always)]
    pub(super) fn ends(&self, bound: &ChordBound, frames: &[BodyPose]) -> [Vector2<f64>; 2] {
        [
            rotate(bound.cos, bound.sin, self.vector),
            frames[self.body as usize].rotate(self.vector),
        ]
    }
}
