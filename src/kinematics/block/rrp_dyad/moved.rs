//! The changes of the block's numbers while parameters move.
//!
//! The certificate follows the chord with the numbers in force at its end. With the numbers on the
//! way f differs from that by Δ = e · ω + ε · (w + ω), with the changes ω of w = P_j − P_i and ε of
//! the axis e. As f closes at both ends, an eighth of the bound of Δ″ opens it on the way.

use std::ops::Add;

use super::{Line, Point, RrpDyad, Second};
use crate::kinematics::block::step::BlockState;
use crate::kinematics::certificate::{Change, StepBounds};
use crate::mechanism::{BodyId, MarkerId};

/// The changes of the numbers.
#[derive(Default)]
pub(super) struct Moved {
    /// w \[m\].
    w: Change,
    /// ω \[m\].
    pub(super) points: Change,
    /// Change of the axis' angle from its body, or from a if it turns with a \[rad\].
    axis: Change,
    /// Deviation of the target from its chord \[m\].
    target: f64,
    /// Part of ω that turns with uncertain angles of known bodies \[m\].
    uncertain: f64,
    /// The further deviations of the pivots of a and b.
    pub(super) pivots: [Pivot; 2],
    /// Deviation of the angle of b from its reference \[rad\].
    pub(super) second_angle: f64,
}

/// Bounds of the further deviation of a pivot.
#[derive(Clone, Copy, Default)]
pub(super) struct Pivot {
    /// Known part \[m\].
    known: f64,
    /// Further part per radian of uncertainty of the angles of a and b \[m\].
    turned: [f64; 2],
}

impl Pivot {
    /// Returns the deviation for these uncertain angles of a and b \[m\].
    pub(super) fn deviation(&self, angles: [f64; 2]) -> f64 {
        self.known + self.turned[0] * angles[0] + self.turned[1] * angles[1]
    }
}

impl Moved {
    /// Bounds f's opening by the numbers that move, where the axis turns by `axis_turn` \[m\].
    pub(super) fn open(&self, axis_turn: f64) -> f64 {
        let axis = self.axis.of_direction(axis_turn);
        let w = self.w + self.points;
        let bend = axis.second * w.value + 2.0 * axis.first * w.first + axis.value * w.second;
        self.points.deviation(axis_turn) + 0.125 * bend + self.uncertain + self.target
    }

    /// Bounds the change of f's slope \[m/rad\].
    pub(super) fn off(&self) -> f64 {
        self.points.value + self.axis.value * (self.w.value + self.points.value)
    }
}

impl RrpDyad {
    /// Returns the changes where a and b turn by `turns`; `still` bounds the known part of w.
    #[inline(never)]
    pub(super) fn moved(
        &self,
        state: &BlockState<'_>,
        bounds: &StepBounds,
        turns: [f64; 2],
        still: Change,
    ) -> Moved {
        let parameters = &bounds.parameters;
        let parts = &self.parts;
        let markers = &state.system.mechanism().markers;
        let own = |body: usize| {
            let second = parts.second.as_ref();
            let bodies = [Some(parts.body), second.map(|second| second.body)];
            bodies.iter().position(|&own| own == Some(body))
        };
        let arm = |length: f64, turn: f64| Change {
            value: length,
            first: length * turn.abs(),
            second: length * turn * turn,
        };
        let link = match &self.second {
            Second::Carried { l, .. } => l.norm(),
            Second::None | Second::Parallel { .. } => 0.0,
        };
        let arms = self.points.iter().map(|point| match point {
            Point::Known(_) => Change::default(),
            Point::First(s) | Point::Parallel(s) => arm(s.norm(), turns[0]),
            Point::Carried(s) => arm(link, turns[0]) + arm(s.norm(), turns[1]),
        });
        let mut moved = Moved {
            w: arms.fold(still, Change::add),
            axis: parameters.angle(parts.projection.axes),
            target: parameters.target(parts.row).deviation(0.0),
            ..Moved::default()
        };
        // Adds the change of a marker to that of the points, and returns it as that of a pivot.
        let mut add = |marker: MarkerId| {
            let change = parameters.position(marker);
            let mut pivot = Pivot::default();
            let body = markers[marker.index()].body.map(BodyId::index);
            let turn = match body.map(|body| (body, own(body))) {
                None => 0.0,
                Some((_, Some(k))) => {
                    pivot.turned[k] = change.value;
                    turns[k]
                }
                Some((body, None)) => {
                    let bound = bounds.body(body);
                    pivot.known = change.value * bound.angle_deviation;
                    moved.uncertain += pivot.known;
                    bound.turn
                }
            };
            moved.points = moved.points + change.turning(turn);
            pivot.known += change.deviation(turn);
            pivot
        };
        add(parts.projection.from);
        add(parts.projection.to);
        let first = [add(parts.pin), add(parts.anchor)];
        let second = parts.second.as_ref().map(|b| [add(b.pin), add(b.partner)]);
        moved.pivots = [Some(first), second].map(|ends| {
            ends.map_or_else(Pivot::default, |[a, b]| Pivot {
                known: a.known + b.known,
                turned: [0, 1].map(|k| a.turned[k] + b.turned[k]),
            })
        });
        if let Some(b) = &parts.second {
            let turned = parameters.angle(b.angle)
                + parameters.angle(b.reference)
                + parameters.target(b.row);
            moved.second_angle = turned.deviation(0.0);
            if matches!(self.second, Second::Parallel { .. }) {
                // All that is fixed to b turns against a.
                moved.points = moved.points + turned.of_direction(turns[0]).scaled(moved.w.value);
                if matches!(self.axis, Line::Turning(_)) {
                    moved.axis = moved.axis + turned;
                }
            }
        }
        moved
    }
}
