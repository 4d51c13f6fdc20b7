//! The certificate of a dyad; see [`crate::kinematics::certificate`].
//!
//! F is the gap of the loop, P_a + d_a − P_b − d_b, and J = \[perp(d_a), −perp(d_b)\]. Along the
//! chord both angles run straight, so A(s) = J(z̄(s))⁻¹ is known everywhere: it has the rows
//! d_b and −d_a over det = d_a × d_b, which is least at one of the ends as the angle between the
//! links runs straight, too. With z off the chord by r, J changes by l_a r_a and l_b r_b.
//!
//! A gap within G, whatever its direction, makes r_a = l_b G / det and r_b = l_a G / det, and
//! the test is
//!
//! > g + l_a r_a² + l_b r_b² < G,
//!
//! g being how far the chord leaves the loop open. It closes at both ends; in the middle each
//! vector that turns by Δ is longer than the mean of its ends by (1 / cos(Δ/2) − 1) of it. These
//! add up with their directions, so that links that turn alike leave nothing. Elsewhere the gap
//! is at most the one in the middle plus the effect of the third derivative on a parabola.
//!
//! The loop runs from one anchor to the other over arms fixed to bodies found before
//! ([`AnchorPath`]), so that F depends on their angles alone. A body whose angle is uncertain by ρ
//! opens the loop with its arm t in a known direction, which makes r_a = ρ |t × d_b| / det. Along
//! the chord this is a quotient of two sines of angles that run straight, with values R at the
//! ends; det being concave, it is nowhere above
//!
//! > max R + |t| l_b Δψ² / (8 det),
//!
//! ψ being the angle from t to d_b. A parallelogram, where t and d_b are parallel to each other,
//! passes an uncertainty on unchanged, however long the row of parallelograms; without the
//! direction each of them would enlarge it.
//!
//! Two bodies that follow each other on the way and are the sides of one dyad have uncertain angles
//! δ₁ and δ₂ that differ by no more than σ, the uncertainty of the angle between them. With the
//! factors T of their effects,
//!
//! > T₁ δ₁ + T₂ δ₂ = (T₁ + T₂) δ₁ + T₂ (δ₂ − δ₁) = (T₁ + T₂) δ₂ − T₁ (δ₂ − δ₁),
//!
//! of which the least bound counts. If both turn alike, the dyad turns with them: from cell to cell
//! of a scissor lift σ depends on σ alone, and the angles grow by a multiple of it.
//!
//! While parameters move, the arms and links of the chord are those in force at the end. The rest
//! of each arm, which turns with its body too, deviates from its own chord by an eighth of the
//! bound of its second derivative; with it the loop closes at both ends.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Before, Found, RrrDyad};
use crate::kinematics::certificate::{Gap, StepBounds, sagitta};
use crate::kinematics::constraint::configuration::{BodyPose, rotate};
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::anchor::larger;
use crate::kinematics::plan::anchor_path::{AnchorPath, Arm, PathKind};
use crate::kinematics::plan::step::BlockState;
use crate::kinematics::tolerances::WITHOUT_DIRECTION;

/// Rounding of an arm at both ends, as a part of its length.
const ARM_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Returns the distance of a vector that turns by `turn` from `from` to `to` from the middle
/// between them, up to terms of fourth order.
#[inline(always)]
fn bulge(from: Vector2<f64>, to: Vector2<f64>, turn: f64) -> Vector2<f64> {
    (from + to) * (0.5 * sagitta(turn))
}

/// Bounds the distance of such a vector of this length from the parabola through its ends and its
/// middle: the third derivative, divided by six, times the largest s (s − ½) (s − 1), which is
/// √3/36; and the terms that [`bulge`] leaves out, l (1 − cos x (1 + x²/2)) ≤ l x⁴/4 with x = Δ/2.
#[inline(always)]
fn beyond_parabola(length: f64, turn: f64) -> f64 {
    const PARABOLA: f64 = 0.008_02;
    let turn = turn.abs();
    length * (turn * turn * turn) * (PARABOLA + turn * (1.0 / 64.0))
}

impl RrrDyad {
    /// Proves that one motion joins the two ends of a sub-step, and writes its chord bounds.
    ///
    /// # Errors
    ///
    /// [`Rejected`] without such a proof.
    #[inline(always)]
    pub(super) fn certify(
        &self,
        state: &BlockState<'_>,
        bounds: &mut StepBounds,
        before: &Before,
        found: &Found,
    ) -> Result<(), Rejected> {
        let [a, b] = &self.sides;
        let frames = state.at.frames();
        let turns = [
            frames[a.body as usize].phi - before.phi[0],
            frames[b.body as usize].phi - before.phi[1],
        ];
        let (mut before_links, mut before_determinant) = (before.links, before.determinant);
        let mut gap = 2.0 * found.rounding;
        let mut deviations = [a, b].map(|side| side.anchor.deviation(bounds, frames));
        // Bounds of the change of the links by moving parameters.
        let mut slack = [0.0; 2];
        if bounds.parameters.moving {
            let moved = self.moved(bounds, turns);
            // The loop at the start with the lengths in force now.
            before_links = moved.links;
            before_determinant = before_links[0].perp(&before_links[1]);
            slack = moved.slack;
            gap += moved.gap;
            deviations[0] += moved.points[0];
            deviations[1] += moved.points[1];
        }
        let spread = turns[1] - turns[0];
        if !(before_determinant * self.determinant > 0.0 && spread.abs() < PI) {
            return Err(bounds.reject());
        }
        let links = [before_links, [a.link, b.link]];
        let lengths = [a.length, b.length];
        let inverses = [before_determinant, self.determinant].map(|det| 1.0 / det.abs());
        let inverse = larger(inverses[0], inverses[1]);

        let loop_of = || Loop {
            links,
            lengths,
            turns,
            inverses,
        };
        // The gap at both ends.
        gap += match self.path.kind {
            PathKind::Short => 2.0 * found.open + self.roundings(frames),
            PathKind::Chain => loop_of().gap_at_ends(&self.path, before, bounds, frames),
            PathKind::ByPivots => {
                2.0 * found.open + self.roundings(frames) + self.path.loose(bounds)
            }
        };
        // The gap in the middle.
        let mut middle =
            bulge(links[0][0], links[1][0], turns[0]) - bulge(links[0][1], links[1][1], turns[1]);
        gap += beyond_parabola(a.length, turns[0]) + beyond_parabola(b.length, turns[1]);
        // The effect of the uncertain angles of the bodies on the way between the anchors.
        let mut turned = [0.0; 2];
        for arm in self.path.arms() {
            let bound = bounds.body(arm.body as usize);
            let levers = arm.ends(bound, frames);
            middle += bulge(levers[0], levers[1], bound.turn);
            let swung = arm.length * bound.angle_deviation;
            gap += beyond_parabola(arm.length, bound.turn);
            if arm.paired {
                gap += 0.5 * swung * bound.angle_deviation;
                continue;
            }
            if swung <= WITHOUT_DIRECTION * gap {
                gap += swung;
                continue;
            }
            gap += 0.5 * swung * bound.angle_deviation;
            for (k, turned) in turned.iter_mut().enumerate() {
                let other = 1 - k;
                let bend = arm.length * lengths[other] * sagitta(turns[other] - bound.turn);
                let ratios = [0, 1]
                    .map(|end: usize| levers[end].perp(&links[end][other]).abs() * inverses[end]);
                let ratio = larger(ratios[0], ratios[1]) + bend * inverse;
                *turned += ratio * bound.angle_deviation;
            }
        }
        if self.path.has_pairs() {
            let by_pairs = loop_of().turned_by_pairs(&self.path, bounds, frames);
            turned[0] += by_pairs[0];
            turned[1] += by_pairs[1];
        }

        gap += middle.x.abs() + middle.y.abs();

        // r = turned + reach · G, with the squares multiplied out.
        let reach = [b.length * inverse, a.length * inverse];
        let (mut linear, mut square) = (0.0, 0.0);
        for k in 0..2 {
            gap += (lengths[k] * turned[k] + slack[k]) * turned[k];
            linear += (2.0 * lengths[k] * turned[k] + slack[k]) * reach[k];
            square += lengths[k] * reach[k] * reach[k];
        }
        let gap = Gap::new(gap, linear, square);
        bounds.require(gap.step_ratio)?;
        if self.spread_is_read {
            let deviation = loop_of().spread(&self.path, gap.value, bounds, frames);
            for side in &self.sides {
                bounds.set_spread(side.body as usize, deviation);
            }
        }
        for (k, side) in self.sides.iter().enumerate() {
            let bound = bounds.body_mut(side.body as usize);
            bound.turn = turns[k];
            bound.angle_deviation = turned[k] + reach[k] * gap.value;
            bound.point_deviation = deviations[k];
        }
        if bounds.parameters.moving {
            self.turn_outer_points(bounds);
        }
        Ok(())
    }

    /// Returns what moving parameters do to the loop, where the sides turn by `turns`.
    #[cold]
    fn moved(&self, bounds: &StepBounds, turns: [f64; 2]) -> Moved {
        let parameters = &bounds.parameters;
        let mut moved = Moved {
            gap: self.path.moved(bounds, parameters),
            ..Moved::default()
        };
        for (k, (side, parts)) in self.sides.iter().zip(&self.parts.sides).enumerate() {
            let [outer, inner, anchor] =
                [parts.outer, parts.inner, parts.anchor].map(|m| parameters.position(m));
            let bound = bounds.body(side.body as usize);
            moved.links[k] = rotate(bound.cos, bound.sin, side.l);
            moved.gap += (outer + inner).deviation(turns[k]);
            moved.slack[k] = outer.value + inner.value;
            moved.points[k] = side.anchor.moved(anchor, bounds) + outer.deviation(turns[k]);
        }
        moved
    }

    /// Adds the effect of the uncertain angles of the sides on outer points that move.
    #[cold]
    fn turn_outer_points(&self, bounds: &mut StepBounds) {
        for parts in &self.parts.sides {
            let moved = bounds.parameters.position(parts.outer).value;
            let bound = bounds.body_mut(parts.body);
            bound.point_deviation += moved * bound.angle_deviation;
        }
    }

    /// Returns the rounding of the stored origins of the bodies that carry the anchors \[m\].
    #[inline(always)]
    fn roundings(&self, frames: &[BodyPose]) -> f64 {
        let [a, b] = &self.sides;
        a.anchor.rounding(frames) + b.anchor.rounding(frames)
    }
}

/// The effect of moving parameters.
#[derive(Default)]
struct Moved {
    /// The links at the start with the lengths in force at the end.
    links: [Vector2<f64>; 2],
    /// Bounds of their changes \[m\].
    slack: [f64; 2],
    /// Bound of the further gap \[m\].
    gap: f64,
    /// Bounds of the further deviations of the outer points \[m\].
    points: [f64; 2],
}

/// The links of a dyad over a sub-step.
struct Loop {
    /// The links at the start, then at the end.
    links: [[Vector2<f64>; 2]; 2],
    lengths: [f64; 2],
    turns: [f64; 2],
    /// 1 / |det| at the start and at the end.
    inverses: [f64; 2],
}

/// An angle that an uncertain arm turns.
#[derive(Clone, Copy)]
enum UncertainTurn {
    /// The angle of a link.
    Link(usize),
    /// The angle between the links.
    Spread,
}

impl Loop {
    /// Bounds |t × d| / |det| along the chord for a vector t with these ends, d being `others`, if
    /// t × d deviates from its chord by no more than `bend`.
    fn quotient(&self, levers: [Vector2<f64>; 2], others: [Vector2<f64>; 2], bend: f64) -> f64 {
        let ratios =
            [0, 1].map(|end: usize| levers[end].perp(&others[end]).abs() * self.inverses[end]);
        larger(ratios[0], ratios[1]) + bend * larger(self.inverses[0], self.inverses[1])
    }

    /// Returns the larger of the gaps that the loop has at its ends, with its rounding \[m\].
    #[inline(never)]
    fn gap_at_ends(
        &self,
        path: &AnchorPath,
        before: &Before,
        bounds: &StepBounds,
        frames: &[BodyPose],
    ) -> f64 {
        let mut between = path.ends(bounds, frames);
        if let Some(parameters) = bounds.moving_parameters() {
            between[0] += path.start(bounds, parameters);
        }
        let lengths: f64 = path.arms().iter().map(|arm| arm.length).sum();
        let links = [before.links, self.links[1]];
        let [start, end] = [0, 1].map(|end: usize| {
            let gap = between[end] + links[end][0] - links[end][1];
            gap.x.abs() + gap.y.abs()
        });
        larger(start, end) + ARM_ROUNDING * lengths
    }

    /// Bounds the effect of the uncertain angles of pairs on the angles of both links \[rad\].
    #[inline(never)]
    fn turned_by_pairs(
        &self,
        path: &AnchorPath,
        bounds: &StepBounds,
        frames: &[BodyPose],
    ) -> [f64; 2] {
        [0, 1].map(|k| {
            let pairs = path.pairs();
            pairs
                .map(|pair| self.turn_by_pair(pair, UncertainTurn::Link(k), bounds, frames))
                .sum()
        })
    }

    /// Bounds the deviation of the angle between the links, the loop being open by `gap`
    /// \[rad\].
    #[inline(never)]
    fn spread(&self, path: &AnchorPath, gap: f64, bounds: &StepBounds, frames: &[BodyPose]) -> f64 {
        let single = path.arms().iter().filter(|arm| !arm.paired);
        let single = single.map(|arm| {
            let bound = bounds.body(arm.body as usize);
            let bend = self.bend(arm, bound.turn, UncertainTurn::Spread);
            let others = self.others(UncertainTurn::Spread);
            self.quotient(arm.ends(bound, frames), others, bend) * bound.angle_deviation
        });
        let pairs = path.pairs();
        let pairs =
            pairs.map(|pair| self.turn_by_pair(pair, UncertainTurn::Spread, bounds, frames));
        let inverse = larger(self.inverses[0], self.inverses[1]);
        single.chain(pairs).sum::<f64>() + gap * self.widest() * inverse
    }

    /// Returns d of an angle, at the start and at the end: the other link, or d_a − d_b.
    fn others(&self, target: UncertainTurn) -> [Vector2<f64>; 2] {
        self.links.map(|links| match target {
            UncertainTurn::Link(k) => links[1 - k],
            UncertainTurn::Spread => links[0] - links[1],
        })
    }

    /// Bounds the deviation of t × d from its chord for an arm t that turns by `turn`.
    fn bend(&self, arm: &Arm, turn: f64, target: UncertainTurn) -> f64 {
        let bend =
            |other: usize| arm.length * self.lengths[other] * sagitta(self.turns[other] - turn);
        match target {
            UncertainTurn::Link(k) => bend(1 - k),
            UncertainTurn::Spread => bend(0) + bend(1),
        }
    }

    /// Returns the largest length of d_a − d_b. The angle between the links runs straight, so that
    /// it is the length at one of the ends.
    fn widest(&self) -> f64 {
        let [start, end] = self.others(UncertainTurn::Spread).map(|d| d.norm());
        larger(start, end)
    }

    /// Bounds the effect of the uncertain angles of the two sides of an earlier dyad.
    fn turn_by_pair(
        &self,
        pair: [&Arm; 2],
        target: UncertainTurn,
        bounds: &StepBounds,
        frames: &[BodyPose],
    ) -> f64 {
        let [first, second] = pair.map(|arm| bounds.body(arm.body as usize));
        let others = self.others(target);
        let levers = [pair[0].ends(first, frames), pair[1].ends(second, frames)];
        let together = [0, 1].map(|end: usize| levers[0][end] + levers[1][end]);
        let bends = [
            self.bend(pair[0], first.turn, target),
            self.bend(pair[1], second.turn, target),
        ];
        let alone = [0, 1].map(|k: usize| self.quotient(levers[k], others, bends[k]));
        let both = self.quotient(together, others, bends[0] + bends[1]);
        let apart = bounds.spread(pair[0].body as usize);
        let [r1, r2] = [first.angle_deviation, second.angle_deviation];
        // `f64::min` passes over the product of zero and a spread without bound.
        (alone[0] * r1 + alone[1] * r2)
            .min(both * r1 + alone[1] * apart)
            .min(both * r2 + alone[0] * apart)
    }
}
