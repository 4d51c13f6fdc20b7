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
//! An anchor whose body's angle is uncertain by ρ, with the lever a from the body's pivot, opens
//! the loop in a known direction, which makes r_a = ρ |a × d_b| / det. Along the chord this is a
//! quotient of two sines of angles that run straight, with values R at the ends, and nowhere
//! above
//!
//! > max R + (|a| l_b Δψ² + max R · l_a l_b Δμ²) / (8 det),
//!
//! ψ and μ being those angles. A parallelogram, where a and d_b are parallel to each other,
//! passes an uncertainty on unchanged, however long the row of parallelograms; without the
//! direction each of them would enlarge it.
//!
//! While parameters move, the chord is that of the links in force at the end. The links on the way
//! differ from them by the parameter bounds, which count twice: on the way and at the start.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Before, Found, RrrDyad};
use crate::kinematics::block::anchor::larger;
use crate::kinematics::block::step::BlockState;
use crate::kinematics::certificate::{Gap, StepBounds, sagitta};
use crate::kinematics::configuration::rotate;
use crate::kinematics::newton::Rejected;

/// An uncertain angle that adds no more than this part to the gap is added without its direction.
const NEGLIGIBLE: f64 = 0.01;

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
        let mut gap = 2.0 * found.open;
        let mut deviations = [0.0; 2];
        // Bounds of the change of the links by moving parameters.
        let mut slack = [0.0; 2];
        if let Some(parameters) = bounds.moving_parameters() {
            // The loop at the start with the lengths in force now.
            before_links = [a, b].map(|side| {
                let bound = bounds.body(side.body as usize);
                rotate(bound.cos, bound.sin, side.l)
            });
            before_determinant = before_links[0].perp(&before_links[1]);
            for (k, parts) in self.parts.sides.iter().enumerate() {
                let [outer, inner] = [parts.outer, parts.inner].map(|m| parameters.position(m));
                deviations[k] = 2.0 * (outer + parameters.position(parts.anchor));
                slack[k] = outer + inner;
                gap += deviations[k] + 2.0 * inner;
            }
        }
        let spread = turns[1] - turns[0];
        if !(before_determinant * self.determinant > 0.0 && spread.abs() < PI) {
            return Err(bounds.reject());
        }
        let inverses = [before_determinant, self.determinant].map(|det| 1.0 / det.abs());
        let inverse = larger(inverses[0], inverses[1]);

        let links = [before_links, [a.link, b.link]];
        let lengths = [a.length, b.length];
        let product = a.length * b.length;
        // The gap in the middle.
        let mut middle =
            bulge(links[0][0], links[1][0], turns[0]) - bulge(links[0][1], links[1][1], turns[1]);
        gap += beyond_parabola(a.length, turns[0]) + beyond_parabola(b.length, turns[1]);
        // The effect of the uncertain angles of the bodies that carry the anchors.
        let mut turned = [0.0; 2];
        for (k, side) in self.sides.iter().enumerate() {
            let Some((bound, length)) = side.anchor.carrier(bounds) else {
                continue;
            };
            let levers = side.anchor.levers(bound, frames);
            let lever = bulge(levers[0], levers[1], bound.turn);
            middle += if k == 0 { lever } else { -lever };
            let swung = length * bound.angle_deviation;
            let pivot = bound.point_deviation + side.anchor.rounding(frames);
            deviations[k] += pivot + length * sagitta(bound.turn) + swung;
            gap += pivot + beyond_parabola(length, bound.turn);
            if swung <= NEGLIGIBLE * gap {
                gap += swung;
                continue;
            }
            gap += 0.5 * swung * bound.angle_deviation;
            for (k, turned) in turned.iter_mut().enumerate() {
                let other = 1 - k;
                let ratios =
                    [0, 1].map(|end| levers[end].perp(&links[end][other]).abs() * inverses[end]);
                let ratio = larger(ratios[0], ratios[1]);
                let bend = length * lengths[other] * sagitta(turns[other] - bound.turn)
                    + ratio * product * sagitta(spread);
                *turned += (ratio + bend * inverse) * bound.angle_deviation;
            }
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
        for (k, side) in self.sides.iter().enumerate() {
            let bound = bounds.body_mut(side.body as usize);
            bound.turn = turns[k];
            bound.angle_deviation = turned[k] + reach[k] * gap.value;
            bound.point_deviation = deviations[k];
        }
        Ok(())
    }
}
