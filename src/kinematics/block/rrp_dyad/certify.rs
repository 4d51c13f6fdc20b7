//! The certificate of the block; see [`crate::kinematics::certificate`].
//!
//! The one unknown is the angle of a, the equation f = e · (D + A_a g) − target with D the known
//! part of P_j − P_i, or, where the axis turns with a, f = e · D + constant.
//!
//! - Where the axis is known its angle runs straight along the chord, as that of a does. So the
//!   slope ∂f/∂phi is |g| times the sine of an angle that runs straight, least at one of the ends;
//!   off the chord it changes by |g| (r + ρ_e), with the uncertainty ρ_e of the axis' angle.
//! - Where it turns with a the slope is perp(e) · D, which the chord's second derivative M lets
//!   fall by M/8 below the lesser of its ends; off the chord it changes by |D| r + ρ_D.
//!
//! The chord leaves f open by M/8, with M = |e″ · D| + 2 |e′ · D′| and, for a known axis, the
//! second derivative of the cosine in e · A_a g; and by the deviations of the points, the axis and
//! the target from their own chords.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Found, Line, Point, RrpDyad, Second};
use crate::kinematics::block::step::BlockState;
use crate::kinematics::certificate::{ChordBound, Gap, StepBounds, sagitta};
use crate::kinematics::configuration::BodyPose;
use crate::kinematics::newton::Rejected;
use crate::kinematics::system::Target;

/// The start of a sub-step.
pub(super) struct Before {
    pub(super) first: BodyPose,
    /// The frame of b; the frame of a if there is no b.
    second: BodyPose,
    slope: f64,
    still: Vector2<f64>,
}

impl Before {
    pub(super) fn new(slide: &RrpDyad, state: &BlockState<'_>) -> Self {
        let frames = state.at.frames();
        let first = frames[slide.body as usize];
        let second = match &slide.second {
            Second::None => first,
            Second::Carried { body, .. } | Second::Parallel { body, .. } => frames[*body as usize],
        };
        Self {
            first,
            second,
            slope: slide.slope,
            still: slide.still,
        }
    }
}

/// Bounds of the change of the numbers in the equations by moving parameters.
#[derive(Default)]
struct Slack {
    /// Change of all points together \[m\].
    points: f64,
    /// Change of the axis, and of the angle of b from its reference \[rad\].
    axis: f64,
    second: f64,
    /// Change of the target of f \[m\].
    target: f64,
}

impl RrpDyad {
    /// Proves that one motion joins the two ends of a sub-step, and writes its chord bounds.
    ///
    /// # Errors
    ///
    /// [`Rejected`] without such a proof.
    pub(super) fn certify(
        &self,
        state: &BlockState<'_>,
        bounds: &mut StepBounds,
        before: &Before,
        found: &Found,
    ) -> Result<(), Rejected> {
        let Found { known, open, .. } = found;
        let frames = state.at.frames();
        let turn = frames[self.body as usize].phi - before.first.phi;
        let slack = self.slack(bounds);
        // The turn of b, if it is carried, and its largest deviation from that.
        let second_turn = known.second.phi - before.second.phi;
        let second_deviation = self.second_deviation(state, bounds) + 2.0 * slack.second;

        let own = self.anchor.deviation(bounds);
        let [i, j] = self.points.map(|point| {
            let arm = match point {
                Point::Carried(arm) => arm.norm() * (sagitta(second_turn) + second_deviation),
                _ => 0.0,
            };
            let base = match point {
                Point::Known(anchor) => anchor.deviation(bounds),
                Point::First(_) | Point::Carried(_) => own,
                Point::Parallel(_) => self.second_point_deviation(bounds),
            };
            (base, arm)
        });
        let turns = self.points.map(|point| !matches!(point, Point::Known(_)));
        let parallel = self.points.map(|point| matches!(point, Point::Parallel(_)));
        // A common base does not move the points against each other.
        let shared = turns == [true; 2] && parallel[0] == parallel[1];
        let bases = if shared { 0.0 } else { i.0 + j.0 };
        let deviations = bases + i.1 + j.1;

        let reach = before.still.norm().max(known.still.norm()) + slack.points;
        let moved = (known.still - before.still).norm() + 2.0 * slack.points;
        let g = known.g.norm();
        let off = slack.points + (slack.axis + slack.second) * (reach + g);
        let least = before.slope.abs().min(self.slope.abs()) - off;
        if !(before.slope * self.slope > 0.0 && least > 0.0) {
            return Err(bounds.reject());
        }
        let target = match state.system.equations()[self.parts.row].target {
            Target::Driver(driver) => bounds.drivers[driver.index()],
            Target::Constant(_) => 2.0 * slack.target,
        };
        let outside = 2.0 * (open + off) + deviations + target;

        let axis = match self.axis {
            Line::Known(None, _) => Some((0.0, 0.0)),
            Line::Known(Some(body), _) => {
                let bound = bounds.body(body);
                Some((bound.turn, bound.angle_deviation))
            }
            Line::Carried(_) => Some((second_turn, second_deviation)),
            Line::Turning(_) => None,
        };
        let (gap, slope) = if let Some((axis_turn, axis_deviation)) = axis {
            let spread = turn - axis_turn;
            if spread.abs() >= PI {
                return Err(bounds.reject());
            }
            let bend =
                sagitta(axis_turn) * reach + 0.25 * axis_turn.abs() * moved + sagitta(spread) * g;
            let open = outside + bend + axis_deviation * (reach + g);
            let inverse = 1.0 / least;
            let linear = (g * axis_deviation + off) * inverse;
            (Gap::new(open, linear, g * inverse * inverse), least)
        } else {
            let bend = sagitta(turn) * reach + 0.25 * turn.abs() * moved;
            // At most half of the slope may be lost on the way.
            bounds.require(2.0 * bend / least)?;
            let slope = least - bend;
            let inverse = 1.0 / slope;
            let linear = (deviations + off) * inverse;
            (
                Gap::new(outside + bend, linear, reach * inverse * inverse),
                slope,
            )
        };
        bounds.require(gap.step_ratio)?;

        let angle_deviation = gap.value / slope;
        let point_deviation = own + 2.0 * slack.points;
        let bound = |frame: BodyPose, turn, angle_deviation, point_deviation| ChordBound {
            cos: frame.cos,
            sin: frame.sin,
            turn,
            angle_deviation,
            point_deviation,
        };
        match &self.second {
            Second::None => {}
            Second::Carried { body, l, .. } => {
                let inner = point_deviation + l.norm() * (sagitta(turn) + angle_deviation);
                *bounds.body_mut(*body as usize) =
                    bound(before.second, second_turn, second_deviation, inner);
            }
            Second::Parallel { body, .. } => {
                let body = *body as usize;
                let turn = frames[body].phi - before.second.phi;
                let angle_deviation = angle_deviation + 2.0 * slack.second;
                let point_deviation = self.second_point_deviation(bounds) + 2.0 * slack.points;
                *bounds.body_mut(body) =
                    bound(before.second, turn, angle_deviation, point_deviation);
            }
        }
        *bounds.body_mut(self.body as usize) =
            bound(before.first, turn, angle_deviation, point_deviation);
        Ok(())
    }

    /// Returns the deviation of the revolute of a parallel b from its chord.
    fn second_point_deviation(&self, bounds: &StepBounds) -> f64 {
        match &self.second {
            Second::Parallel { anchor, .. } => anchor.deviation(bounds),
            Second::None | Second::Carried { .. } => 0.0,
        }
    }

    /// Returns the deviation of the angle of a carried b from its chord.
    fn second_deviation(&self, state: &BlockState<'_>, bounds: &StepBounds) -> f64 {
        let (
            Some(parts),
            Second::Carried {
                body, reference, ..
            },
        ) = (&self.parts.second, &self.second)
        else {
            return 0.0;
        };
        let rounding = f64::EPSILON * (1.0 + state.at.frames()[*body as usize].phi.abs());
        let known = reference.map_or(0.0, |body| bounds.body(body).angle_deviation);
        let held = match state.system.equations()[parts.row].target {
            Target::Driver(driver) => bounds.drivers[driver.index()],
            Target::Constant(_) => 0.0,
        };
        rounding + known + held
    }

    /// Returns the changes that moving parameters may make.
    fn slack(&self, bounds: &StepBounds) -> Slack {
        let Some(parameters) = bounds.moving_parameters() else {
            return Slack::default();
        };
        let parts = &self.parts;
        let ends = [
            parts.pin,
            parts.anchor,
            parts.projection.from,
            parts.projection.to,
        ];
        let mut slack = Slack {
            points: ends
                .into_iter()
                .map(|marker| parameters.position(marker))
                .sum(),
            axis: parameters.angle(parts.projection.axes),
            second: 0.0,
            target: parameters.constant(parts.row),
        };
        if let Some(b) = &parts.second {
            slack.points += parameters.position(b.pin) + parameters.position(b.partner);
            slack.second = parameters.angle(b.angle)
                + parameters.angle(b.reference)
                + parameters.constant(b.row);
        }
        slack
    }
}
