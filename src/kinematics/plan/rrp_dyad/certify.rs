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
//!
//! An uncertain point opens f by e · δP only. Where it is the pivot of a body that slides along a
//! line on ground with direction d, δP = τ d, or where its body turns by an uncertain angle ρ,
//! δP = ρ perp(arm), this is less than |δP|. The pivot of b, which slides along t ⊥ e, deviates by
//!
//! > t · δP − κ e · δP, κ = t · perp(A_a l) / (e · perp(A_a l)),
//!
//! the cotangent of an angle that runs straight, so that κ lies between its values at the ends. A
//! row of sliders passes an uncertainty on as it passes on a motion, with its sign.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::moved::Moved;
use super::{Found, Line, Point, RrpDyad, Second};
use crate::kinematics::certificate::{ChordBound, Gap, Pivots, Slide, StepBounds, sagitta};
use crate::kinematics::constraint::configuration::{BodyPose, perp, rotate};
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::anchor::Anchor;
use crate::kinematics::plan::step::{BlockState, Step};
use crate::kinematics::system::EquationTarget;
use crate::kinematics::tolerances::WITHOUT_DIRECTION;

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

/// All that is known around a block: the bodies at the end of the sub-step, its start, and the
/// bounds of the blocks before it.
struct Surroundings<'a> {
    frames: &'a [BodyPose],
    before: &'a Before,
    bounds: &'a StepBounds,
    pivots: &'a Pivots,
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
        step: &mut Step<'_>,
        before: &Before,
        found: &Found,
    ) -> Result<(), Rejected> {
        let Step { bounds, pivots, .. } = step;
        let Found { known, open, .. } = found;
        let frames = state.at.frames();
        let turn = frames[self.body as usize].phi - before.first.phi;
        let second_turn = match &self.second {
            Second::None => 0.0,
            Second::Carried { body, .. } | Second::Parallel { body, .. } => {
                frames[*body as usize].phi - before.second.phi
            }
        };
        let reach = before.still.norm().max(known.still.norm());
        let still_moved = (known.still - before.still).norm();
        let moved = if bounds.parameters.moving {
            self.moved(state, bounds, [turn, second_turn], [reach, still_moved])
        } else {
            Moved::default()
        };
        // The deviation of b, if it is carried.
        let second_deviation = self.second_deviation(state, bounds) + moved.second_angle;

        let own = self.anchor.deviation(bounds, frames);
        let [i, j] = self.points.map(|point| {
            let arm = match point {
                Point::Carried(arm) => arm.norm() * (sagitta(second_turn) + second_deviation),
                _ => 0.0,
            };
            let base = match point {
                Point::Known(anchor) => anchor.deviation(bounds, frames),
                Point::First(_) | Point::Carried(_) => own,
                Point::Parallel(_) => self.second_point_deviation(bounds, frames),
            };
            (base, arm)
        });
        let turns = self.points.map(|point| !matches!(point, Point::Known(_)));
        let parallel = self.points.map(|point| matches!(point, Point::Parallel(_)));
        // A common base does not move the points against each other.
        let shared = turns == [true; 2] && parallel[0] == parallel[1];
        let bases = if shared { 0.0 } else { i.0 + j.0 };
        let deviations = bases + i.1 + j.1;

        let g = known.g.norm();
        let reach = reach + moved.points;
        let still_moved = still_moved + 2.0 * moved.points;
        let off = moved.off;
        let least = before.slope.abs().min(self.slope.abs()) - off;
        if !(before.slope * self.slope > 0.0 && least > 0.0) {
            return Err(bounds.reject());
        }
        let target = match state.system.equations()[self.parts.row].target {
            EquationTarget::Driver(driver) => bounds.drivers[driver.index()],
            EquationTarget::Constant(_) => 0.0,
        };
        let outside = 2.0 * open + target + i.1 + j.1 + moved.open;

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
            let bend = sagitta(axis_turn) * reach
                + 0.25 * axis_turn.abs() * still_moved
                + sagitta(spread) * g;
            let open = outside + bend + axis_deviation * (reach + g + deviations);
            let open = self.opened(
                open,
                bases,
                axis_turn,
                &Surroundings {
                    frames,
                    before,
                    bounds,
                    pivots,
                },
            );
            let inverse = 1.0 / least;
            let linear = (g * axis_deviation + off) * inverse;
            (Gap::new(open, linear, g * inverse * inverse), least)
        } else {
            let bend = sagitta(turn) * reach + 0.25 * turn.abs() * still_moved;
            // At most half of the slope may be lost on the way.
            bounds.require(2.0 * bend / least)?;
            let slope = least - bend;
            let inverse = 1.0 / slope;
            let linear = (deviations + off) * inverse;
            let open = self.opened(
                outside + bend,
                bases,
                turn,
                &Surroundings {
                    frames,
                    before,
                    bounds,
                    pivots,
                },
            );
            (Gap::new(open, linear, reach * inverse * inverse), slope)
        };
        bounds.require(gap.step_ratio)?;

        let angle_deviation = gap.value / slope;
        let second_deviation = match &self.second {
            Second::Parallel { .. } => angle_deviation + moved.second_angle,
            Second::Carried { .. } | Second::None => second_deviation,
        };
        let pivot = if bounds.parameters.moving {
            self.moved_pivots(
                bounds,
                [turn, second_turn],
                [angle_deviation, second_deviation],
            )
        } else {
            [0.0; 2]
        };
        let point_deviation = own + pivot[0];
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
                let mut inner =
                    point_deviation + l.norm() * (sagitta(turn) + angle_deviation) + pivot[1];
                let slides = self.slide_is_read && self.slides_on_ground();
                if slides && !bounds.parameters.moving {
                    let mut slide =
                        self.slide(before, frames, bounds, [gap.value, angle_deviation]);
                    slide.along = slide.along.min(inner);
                    slide.across = outside;
                    inner = inner.min(slide.along + slide.across);
                    bounds.set_slide(*body as usize, slide);
                }
                *bounds.body_mut(*body as usize) =
                    bound(before.second, second_turn, second_deviation, inner);
            }
            Second::Parallel { body, .. } => {
                let point_deviation = self.second_point_deviation(bounds, frames) + pivot[1];
                *bounds.body_mut(*body as usize) = bound(
                    before.second,
                    second_turn,
                    second_deviation,
                    point_deviation,
                );
            }
        }
        *bounds.body_mut(self.body as usize) =
            bound(before.first, turn, angle_deviation, point_deviation);
        Ok(())
    }

    /// Adds to the gap in f that of the bases of the points, which deviate by no more than `bases`.
    /// Where this is noticeable their directions count.
    #[inline(always)]
    fn opened(&self, open: f64, bases: f64, axis_turn: f64, known: &Surroundings<'_>) -> f64 {
        let mut uncertain = self.anchor.uncertainty(known.bounds);
        for point in &self.points {
            if let Point::Known(anchor) = point {
                uncertain += anchor.uncertainty(known.bounds);
            }
        }
        if bases == 0.0 || uncertain <= WITHOUT_DIRECTION * open {
            open + bases
        } else {
            open + bases.min(self.deviation_along_axis(axis_turn, known))
        }
    }

    /// Bounds the deviations of the bases along the axis, which turns by `axis_turn` \[m\].
    #[inline(never)]
    fn deviation_along_axis(&self, axis_turn: f64, known: &Surroundings<'_>) -> f64 {
        let &Surroundings {
            frames,
            before,
            bounds,
            pivots,
        } = known;
        let ends = match (self.axis, &self.second) {
            (Line::Known(None, e), _) => [e; 2],
            (Line::Known(Some(body), e), _) => {
                let bound = bounds.body(body);
                [rotate(bound.cos, bound.sin, e), frames[body].rotate(e)]
            }
            (Line::Carried(e), Second::Carried { body, .. }) => {
                [before.second.rotate(e), frames[*body as usize].rotate(e)]
            }
            (Line::Carried(e) | Line::Turning(e), _) => {
                [before.first.rotate(e), frames[self.body as usize].rotate(e)]
            }
        };
        let along =
            |anchor: &Anchor| anchor.deviation_along((ends, axis_turn), (bounds, pivots), frames);
        let bases = self.points.iter().map(|point| match point {
            Point::Known(anchor) => along(anchor),
            Point::First(_) | Point::Carried(_) => along(&self.anchor),
            Point::Parallel(_) => self.second_point_deviation(bounds, frames),
        });
        bases.sum()
    }

    /// Returns whether the line rests on ground, and b slides along it.
    fn slides_on_ground(&self) -> bool {
        let on_ground = |point: &Point| matches!(point, Point::Known(anchor) if anchor.is_ground());
        let slides = match &self.points {
            [i, Point::Carried(_)] => on_ground(i),
            [Point::Carried(_), j] => on_ground(j),
            _ => false,
        };
        slides && matches!(self.axis, Line::Known(None, _))
    }

    /// Bounds the deviation of the pivot of a b that slides on ground along its line, for bounds of
    /// the gap in f and of the deviation of the angle of a.
    #[inline(never)]
    fn slide(
        &self,
        before: &Before,
        frames: &[BodyPose],
        bounds: &StepBounds,
        [gap, angle_deviation]: [f64; 2],
    ) -> Slide {
        let (Line::Known(None, e), Second::Carried { l, .. }) = (self.axis, &self.second) else {
            return Slide::default();
        };
        let first = &frames[self.body as usize];
        let t = perp(e);
        let ratios = [&before.first, first].map(|frame| {
            let moved = perp(frame.rotate(*l));
            t.dot(&moved) / e.dot(&moved)
        });
        let (pivot, rest) = self.anchor.pivot_slide(bounds, frames);
        let parts = ratios.map(|ratio| (t - e * ratio).dot(&pivot.direction).abs());
        let ratio = ratios[0].abs().max(ratios[1].abs());
        // The part of the gap that the slide of the anchor's body does not explain.
        let gap = gap - pivot.along * e.dot(&pivot.direction).abs();
        let turned =
            sagitta(first.phi - before.first.phi) + 0.5 * angle_deviation * angle_deviation;
        Slide {
            direction: t,
            along: pivot.along * parts[0].max(parts[1]) + rest + ratio * gap + l.norm() * turned,
            across: 0.0,
        }
    }

    /// Returns the deviation of the revolute of a parallel b from its chord.
    fn second_point_deviation(&self, bounds: &StepBounds, frames: &[BodyPose]) -> f64 {
        match &self.second {
            Second::Parallel { anchor, .. } => anchor.deviation(bounds, frames),
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
            EquationTarget::Driver(driver) => bounds.drivers[driver.index()],
            EquationTarget::Constant(_) => 0.0,
        };
        rounding + known + held
    }
}
