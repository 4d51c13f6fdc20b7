//! The changes of the block's numbers while parameters move.
//!
//! The certificate follows the chord with the numbers in force at its end. With the numbers on the
//! way f differs from that by Δ = e · ω + ε · (w + ω), with the changes ω of w = P_j − P_i and ε of
//! the axis e. As f closes at both ends, an eighth of the bound of Δ″ opens it on the way.

use super::{Line, Point, RrpDyad, Second};
use crate::kinematics::certificate::{Change, StepBounds};
use crate::kinematics::plan::anchor::Anchor;
use crate::kinematics::plan::step::BlockState;
use crate::mechanism::{BodyId, MarkerId};

/// Bounds of the effect of moving parameters.
#[derive(Default)]
pub(super) struct Moved {
    /// Change of w \[m\].
    pub(super) points: f64,
    /// Further value of f on the way \[m\].
    pub(super) open: f64,
    /// Change of the slope of f \[m/rad\].
    pub(super) off: f64,
    /// Deviation of the angle of b from its reference \[rad\].
    pub(super) second_angle: f64,
}

impl RrpDyad {
    /// Bounds the effect of moving parameters, where a and b turn by `turns`; `still` bounds the
    /// length and the change of the known part of w.
    #[cold]
    pub(super) fn moved(
        &self,
        state: &BlockState<'_>,
        bounds: &StepBounds,
        turns: [f64; 2],
        still: [f64; 2],
    ) -> Moved {
        let parameters = &bounds.parameters;
        let parts = &self.parts;
        let mechanism = state.system.mechanism();
        let mut w = Change {
            value: still[0],
            first: still[1],
            second: 0.0,
        };
        let arm = |length: f64, turn: f64| {
            let fixed = Change {
                value: length,
                ..Change::default()
            };
            fixed.turning(turn)
        };
        for point in &self.points {
            w = w + match point {
                Point::Known(_) => Change::default(),
                Point::First(s) | Point::Parallel(s) => arm(s.norm(), turns[0]),
                Point::Carried(s) => arm(self.link(), turns[0]) + arm(s.norm(), turns[1]),
            };
        }
        let ends = [parts.projection.from, parts.projection.to];
        let pins = [parts.pin, parts.anchor];
        let second_pins = parts.second.iter().flat_map(|b| [b.pin, b.partner]);
        let (mut points, mut uncertain) = (Change::default(), 0.0);
        for marker in ends.into_iter().chain(pins).chain(second_pins) {
            let change = parameters.position(marker);
            let body = mechanism.markers[marker.index()].body.map(BodyId::index);
            let own = body.and_then(|body| self.own(body));
            let turn = match (body, own) {
                (None, _) => 0.0,
                (_, Some(own)) => turns[own],
                (Some(body), None) => {
                    let bound = bounds.body(body);
                    uncertain += change.value * bound.angle_deviation;
                    bound.turn
                }
            };
            points = points + change.turning(turn);
        }
        let mut axis = parameters.angle(parts.projection.axes);
        let mut second_angle = 0.0;
        if let Some(b) = &parts.second {
            let turned = parameters.angle(b.angle)
                + parameters.angle(b.reference)
                + parameters.target(b.row);
            second_angle = turned.deviation(0.0);
            if !b.carried {
                // All that is fixed to b turns against a.
                points = points + turned.of_direction(turns[0]).scaled(w.value);
                if matches!(self.axis, Line::Turning(_)) {
                    axis = axis + turned;
                }
            }
        }
        let axis_turn = match self.axis {
            Line::Known(body, _) => body.map_or(0.0, |body| bounds.body(body).turn),
            Line::Carried(_) => turns[1],
            Line::Turning(_) => turns[0],
        };
        let epsilon = axis.of_direction(axis_turn);
        let w = w + points;
        let bend =
            epsilon.second * w.value + 2.0 * epsilon.first * w.first + epsilon.value * w.second;
        let target = parameters.target(parts.row);
        Moved {
            points: points.value,
            open: points.deviation(axis_turn) + 0.125 * bend + uncertain + target.deviation(0.0),
            off: points.value + axis.value * w.value,
            second_angle,
        }
    }

    /// Bounds the further deviations of the pivots of a and b while parameters move, for these turns
    /// and uncertain angles of a and b \[m\].
    #[cold]
    pub(super) fn moved_pivots(
        &self,
        bounds: &StepBounds,
        turns: [f64; 2],
        uncertain: [f64; 2],
    ) -> [f64; 2] {
        let parameters = &bounds.parameters;
        let on = |own: usize, marker: MarkerId| {
            let change = parameters.position(marker);
            change.deviation(turns[own]) + change.value * uncertain[own]
        };
        let partner =
            |anchor: &Anchor, marker: MarkerId| anchor.moved(parameters.position(marker), bounds);
        let parts = &self.parts;
        let first = on(0, parts.pin) + partner(&self.anchor, parts.anchor);
        let second = match (&parts.second, &self.second) {
            (Some(b), Second::Parallel { anchor, .. }) => on(1, b.pin) + partner(anchor, b.partner),
            (Some(b), _) => on(1, b.pin) + on(0, b.partner),
            (None, _) => 0.0,
        };
        [first, second]
    }

    /// Returns 0 for a, 1 for b; `None` for another body.
    fn own(&self, body: usize) -> Option<usize> {
        let second = self.parts.second.as_ref().map(|second| second.body);
        let bodies = [Some(self.parts.body), second];
        bodies.iter().position(|&own| own == Some(body))
    }

    /// Returns the length of the link between a's pins, zero without a carried b \[m\].
    fn link(&self) -> f64 {
        match &self.second {
            Second::Carried { l, .. } => l.norm(),
            Second::None | Second::Parallel { .. } => 0.0,
        }
    }
}
