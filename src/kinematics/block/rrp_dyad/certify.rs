//! The certificate of a slide; see [`crate::kinematics::certificate`].
//!
//! The one unknown is the angle of a, the equation f = e · (D + A_a g) − target with D the known
//! part of P_j − P_i, or, where the axis turns with a, f = e · D + constant.
//!
//! - Where the axis is known its angle runs straight along the chord, as that of a does. So the
//!   slope ∂f/∂phi is |g| times the sine of an angle that runs straight, least at one of the ends;
//!   off the chord it changes by |g| (r + ρ_e), ρ_e being the uncertainty of the axis' angle.
//! - Where it turns with a the slope is perp(e) · D, which the chord's second derivative M lets
//!   fall by M/8 below the lesser of its ends; off the chord it changes by |D| r + ρ_D.
//!
//! The chord leaves f open by M/8, M being |e″ · D| + 2 |e′ · D′| and, for a known axis, the
//! second derivative of the cosine in e · A_a g; besides by what the points, the axis and the
//! target are off their own chords.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Found, Line, Point, RrpDyad, Second, Work};
use crate::kinematics::certificate::{Gap, Tube, Tubes, sagitta};
use crate::kinematics::configuration::BodyPose;
use crate::kinematics::newton::Rejected;
use crate::kinematics::system::Target;

/// Where a sub-step started.
pub(super) struct Before {
    pub(super) first: BodyPose,
    /// Of body b; that of a where there is none.
    second: BodyPose,
    slope: f64,
    still: Vector2<f64>,
}

impl Before {
    pub(super) fn new(slide: &RrpDyad, work: &Work<'_>) -> Self {
        let frames = work.at.frames();
        let first = frames[slide.place as usize];
        let second = match &slide.second {
            Second::None => first,
            Second::Carried { place, .. } | Second::Parallel { place, .. } => {
                frames[*place as usize]
            }
        };
        Self {
            first,
            second,
            slope: slide.slope,
            still: slide.still,
        }
    }
}

/// What the numbers in a slide's equations may differ from those in force.
#[derive(Default)]
struct Slack {
    /// Of all points together \[m\].
    points: f64,
    /// Of the axis, and of b against what its angle is held against \[rad\].
    axis: f64,
    second: f64,
    /// Of what f is held at \[m\].
    target: f64,
}

impl RrpDyad {
    /// Proves that one motion joins the two ends of a sub-step, and writes its tube.
    ///
    /// # Errors
    ///
    /// There is no such proof.
    pub(super) fn certify(
        &self,
        work: &Work<'_>,
        tubes: &mut Tubes,
        before: &Before,
        found: &Found,
    ) -> Result<(), Rejected> {
        let Found { known, open, .. } = found;
        let frames = work.at.frames();
        let turn = frames[self.place as usize].phi - before.first.phi;
        let slack = self.slack(tubes);
        // Body b, if it is carried: how far it turns, and how far it may be off that.
        let second_turn = known.second.phi - before.second.phi;
        let second_radius = self.second_radius(work, tubes) + 2.0 * slack.second;

        let own = self.anchor.strays(tubes);
        let [i, j] = self.points.map(|point| {
            let arm = match point {
                Point::Carried(arm) => arm.norm() * (sagitta(second_turn) + second_radius),
                _ => 0.0,
            };
            let base = match point {
                Point::Known(anchor) => anchor.strays(tubes),
                Point::First(_) | Point::Carried(_) => own,
                Point::Parallel(_) => self.second_strays(tubes),
            };
            (base, arm)
        });
        let turns = self.points.map(|point| !matches!(point, Point::Known(_)));
        let parallel = self.points.map(|point| matches!(point, Point::Parallel(_)));
        // What both points hang on moves neither against the other.
        let shared = turns == [true; 2] && parallel[0] == parallel[1];
        let bases = if shared { 0.0 } else { i.0 + j.0 };
        let strays = bases + i.1 + j.1;

        let reach = before.still.norm().max(known.still.norm()) + slack.points;
        let moved = (known.still - before.still).norm() + 2.0 * slack.points;
        let g = known.g.norm();
        let off = slack.points + (slack.axis + slack.second) * (reach + g);
        let least = before.slope.abs().min(self.slope.abs()) - off;
        if !(before.slope * self.slope > 0.0 && least > 0.0) {
            return Err(tubes.break_off());
        }
        let target = match work.system.equations()[self.parts.row].target {
            Target::Driver(driver) => tubes.drivers[driver.index()],
            Target::Constant(_) => 2.0 * slack.target,
        };
        let outside = 2.0 * (open + off) + strays + target;

        let axis = match self.axis {
            Line::Known(None, _) => Some((0.0, 0.0)),
            Line::Known(Some(body), _) => {
                let tube = tubes.body(body);
                Some((tube.turn, tube.radius))
            }
            Line::Carried(_) => Some((second_turn, second_radius)),
            Line::Turning(_) => None,
        };
        let (gap, slope) = if let Some((axis_turn, axis_radius)) = axis {
            let spread = turn - axis_turn;
            if spread.abs() >= PI {
                return Err(tubes.break_off());
            }
            let bend =
                sagitta(axis_turn) * reach + 0.25 * axis_turn.abs() * moved + sagitta(spread) * g;
            let open = outside + bend + axis_radius * (reach + g);
            let inverse = 1.0 / least;
            let linear = (g * axis_radius + off) * inverse;
            (Gap::new(open, linear, g * inverse * inverse), least)
        } else {
            let bend = sagitta(turn) * reach + 0.25 * turn.abs() * moved;
            // At most half of the slope may be lost on the way.
            tubes.bear(2.0 * bend / least)?;
            let slope = least - bend;
            let inverse = 1.0 / slope;
            let linear = (strays + off) * inverse;
            (
                Gap::new(outside + bend, linear, reach * inverse * inverse),
                slope,
            )
        };
        tubes.bear(gap.load)?;

        let radius = gap.value / slope;
        let stray = own + 2.0 * slack.points;
        let tube = |frame: BodyPose, turn, radius, stray| Tube {
            cos: frame.cos,
            sin: frame.sin,
            turn,
            radius,
            stray,
        };
        match &self.second {
            Second::None => {}
            Second::Carried { place, l, .. } => {
                let inner = stray + l.norm() * (sagitta(turn) + radius);
                *tubes.body_mut(*place as usize) =
                    tube(before.second, second_turn, second_radius, inner);
            }
            Second::Parallel { place, .. } => {
                let place = *place as usize;
                let turn = frames[place].phi - before.second.phi;
                let radius = radius + 2.0 * slack.second;
                let stray = self.second_strays(tubes) + 2.0 * slack.points;
                *tubes.body_mut(place) = tube(before.second, turn, radius, stray);
            }
        }
        *tubes.body_mut(self.place as usize) = tube(before.first, turn, radius, stray);
        Ok(())
    }

    /// How far the revolute of a parallel b is off its chord.
    fn second_strays(&self, tubes: &Tubes) -> f64 {
        match &self.second {
            Second::Parallel { anchor, .. } => anchor.strays(tubes),
            Second::None | Second::Carried { .. } => 0.0,
        }
    }

    /// How far the angle of a carried b may be off its chord.
    fn second_radius(&self, work: &Work<'_>, tubes: &Tubes) -> f64 {
        let (
            Some(parts),
            Second::Carried {
                place, reference, ..
            },
        ) = (&self.parts.second, &self.second)
        else {
            return 0.0;
        };
        let rounding = f64::EPSILON * (1.0 + work.at.frames()[*place as usize].phi.abs());
        let known = reference.map_or(0.0, |body| tubes.body(body).radius);
        let held = match work.system.equations()[parts.row].target {
            Target::Driver(driver) => tubes.drivers[driver.index()],
            Target::Constant(_) => 0.0,
        };
        rounding + known + held
    }

    fn slack(&self, tubes: &Tubes) -> Slack {
        let Some(slips) = tubes.slips() else {
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
            points: ends.into_iter().map(|marker| slips.position(marker)).sum(),
            axis: slips.angle(parts.projection.axes),
            second: 0.0,
            target: slips.constant(parts.row),
        };
        if let Some(b) = &parts.second {
            slack.points += slips.position(b.pin) + slips.position(b.partner);
            slack.second = slips.angle(b.angle) + slips.angle(b.reference) + slips.constant(b.row);
        }
        slack
    }
}
