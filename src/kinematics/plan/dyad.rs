//! Two bodies joined to each other and each to something already found, by revolutes.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::anchor::Anchor;
use super::{Advance, Work};
use crate::kinematics::configuration::{BodyPose, Configuration, perp, rotate};
use crate::kinematics::newton::{
    AT_ROUNDING, CONTRACTION, Correction, LARGEST_CORRECTION, MAX_ITERATIONS, Rejected, SINGULAR,
    SMALL, STALLED,
};
use crate::mechanism::{MarkerId, Mechanism};

/// One of the two bodies of a dyad.
#[derive(Debug)]
struct Side {
    place: usize,
    /// First of its unknowns.
    column: usize,
    /// Its point in the revolute to what is already found, and that point's partner.
    outer: MarkerId,
    anchor: Anchor,
    /// Its point in the revolute to the other side.
    inner: MarkerId,
    /// s of the outer point.
    s: Vector2<f64>,
    /// From the outer to the inner point, in the body's frame, and its length.
    l: Vector2<f64>,
    length: f64,
    /// A s and A l at the pose last located.
    arm: Vector2<f64>,
    link: Vector2<f64>,
}

/// x, y and phi of two bodies: P_a + A_a l_a = P_b + A_b l_b with both P already found. The two
/// angles are solved for; x and y follow.
///
/// With d = A l of each side the Jacobian in the angles is \[perp(d_a), −perp(d_b)\], its
/// determinant d_a × d_b, so that solving takes two dot products.
#[derive(Debug)]
pub(in crate::kinematics) struct Dyad {
    rows: [usize; 6],
    columns: [usize; 6],
    sides: [Side; 2],
    /// d_a × d_b at the pose last factorised.
    determinant: f64,
}

/// What one side of a dyad is made of.
pub(super) struct SideParts {
    pub(super) body: usize,
    pub(super) outer: MarkerId,
    pub(super) anchor: MarkerId,
    pub(super) inner: MarkerId,
}

impl Side {
    fn new(mechanism: &Mechanism, parts: &SideParts) -> Self {
        Self {
            place: parts.body,
            column: 3 * parts.body,
            outer: parts.outer,
            anchor: Anchor::new(mechanism, parts.anchor),
            inner: parts.inner,
            s: Vector2::zeros(),
            l: Vector2::zeros(),
            length: 0.0,
            arm: Vector2::zeros(),
            link: Vector2::zeros(),
        }
    }

    fn set_parameters(&mut self, at: &Configuration) {
        self.anchor.set_parameters(at);
        self.s = at.local(self.outer).0;
        self.l = at.local(self.inner).0 - self.s;
        self.length = self.l.norm();
    }

    /// Where its angle is expected to go.
    #[inline]
    fn predict(&self, work: &Work<'_>, advance: Advance) -> f64 {
        let [v, a] = work.flow.body(self.column);
        work.at.frame(self.place).phi + (advance.first * v[2] + advance.second * a[2])
    }

    /// Puts the body at the angle with this cosine and sine, its outer point at `point`.
    #[inline]
    fn put(&mut self, at: &mut Configuration, point: Vector2<f64>, phi: f64, [sin, cos]: [f64; 2]) {
        self.arm = rotate(cos, sin, self.s);
        let origin = point - self.arm;
        at.set_frame(
            self.place,
            BodyPose {
                origin,
                phi,
                cos,
                sin,
            },
        );
    }

    /// Writes its rates, given those of its outer point and of its angle.
    #[inline]
    fn set_rates(
        &self,
        work: &mut Work<'_>,
        [velocity, acceleration]: [Vector2<f64>; 2],
        [omega, alpha]: [f64; 2],
    ) {
        let turned = perp(self.arm);
        let v = velocity - turned * omega;
        let a = acceleration - turned * alpha + self.arm * (omega * omega);
        work.flow
            .set_body(self.column, [[v.x, v.y, omega], [a.x, a.y, alpha]]);
    }
}

impl Dyad {
    /// `rows` are those of the first side's outer revolute, the second's, and the inner one's.
    pub(super) fn new(mechanism: &Mechanism, rows: [usize; 6], sides: &[SideParts; 2]) -> Self {
        let [a, b] = [sides[0].body, sides[1].body].map(|body| 3 * body);
        Self {
            rows,
            columns: [a, a + 1, a + 2, b, b + 1, b + 2],
            sides: [
                Side::new(mechanism, &sides[0]),
                Side::new(mechanism, &sides[1]),
            ],
            determinant: 0.0,
        }
    }

    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.columns
    }

    pub(super) fn set_parameters(&mut self, at: &Configuration) {
        for side in &mut self.sides {
            side.set_parameters(at);
        }
    }

    /// Predicts both angles and corrects them until the loop closes to rounding.
    #[inline]
    pub(in crate::kinematics) fn advance(
        &mut self,
        work: &mut Work<'_>,
        advance: Advance,
    ) -> Result<Correction, Rejected> {
        let predicted = [
            self.sides[0].predict(work, advance),
            self.sides[1].predict(work, advance),
        ];
        let before = self.determinant;
        let found = self.correct(work, predicted, MAX_ITERATIONS)?;
        let moved = [0, 1].map(|k| (found.phi[k] - predicted[k]).abs());
        // An angle that is not a number fails all of these.
        let kept = found.correction.contraction <= CONTRACTION
            && moved[0] <= LARGEST_CORRECTION
            && moved[1] <= LARGEST_CORRECTION
            && self.determinant * before > 0.0
            && !self.is_singular();
        if kept {
            Ok(found.correction)
        } else {
            Err(Rejected)
        }
    }

    /// Newton–Raphson on the two angles from `phi`.
    #[inline]
    fn correct(
        &mut self,
        work: &mut Work<'_>,
        mut phi: [f64; 2],
        max_iterations: u32,
    ) -> Result<Found, Rejected> {
        let [a, b] = &mut self.sides;
        let points = [a.anchor.locate(work.at), b.anchor.locate(work.at)];
        let base = points[0] - points[1];
        let reach = points[0].amax() + points[1].amax();
        let mut correction = Correction::default();
        let mut last = f64::INFINITY;
        let mut last_gap = f64::INFINITY;
        loop {
            let turns = [phi[0].sin_cos(), phi[1].sin_cos()];
            a.link = rotate(turns[0].1, turns[0].0, a.l);
            b.link = rotate(turns[1].1, turns[1].0, b.l);
            let gap = base + a.link - b.link;
            self.determinant = a.link.perp(&b.link);
            // The rounding of the points, and that of the angles times the links.
            let rounding = f64::EPSILON
                * (reach + a.length * (1.0 + phi[0].abs()) + b.length * (1.0 + phi[1].abs()));
            let open = gap.amax();
            let stalled = open <= STALLED * rounding && open >= 0.5 * last_gap;
            if open <= AT_ROUNDING * rounding || stalled {
                let [turn_a, turn_b] = turns.map(|(sin, cos)| [sin, cos]);
                a.put(work.at, points[0], phi[0], turn_a);
                b.put(work.at, points[1], phi[1], turn_b);
                return Ok(Found { phi, correction });
            }
            if correction.iterations == max_iterations {
                return Err(Rejected);
            }
            let step = [
                -gap.dot(&b.link) / self.determinant,
                -gap.dot(&a.link) / self.determinant,
            ];
            phi[0] += step[0];
            phi[1] += step[1];
            let size = step[0].abs().max(step[1].abs());
            if !(step[0] + step[1]).is_finite() {
                return Err(Rejected);
            }
            correction.contraction = correction.contraction.max(size / last);
            last = size.max(SMALL);
            last_gap = open;
            correction.iterations += 1;
        }
    }

    /// Closes the loop from where its bodies are.
    pub(in crate::kinematics) fn close(
        &mut self,
        work: &mut Work<'_>,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        let phi = [0, 1].map(|k| work.at.frame(self.sides[k].place).phi);
        Ok(self.correct(work, phi, max_iterations)?.correction)
    }

    /// Notes the arms and the determinant at the pose.
    pub(super) fn factorise(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        for side in &mut self.sides {
            let frame = work.at.frame(side.place);
            side.anchor.locate(work.at);
            side.arm = frame.rotate(side.s);
            side.link = frame.rotate(side.l);
        }
        self.determinant = self.sides[0].link.perp(&self.sides[1].link);
        if self.determinant == 0.0 || !self.determinant.is_finite() {
            return Err(Rejected);
        }
        Ok(())
    }

    /// Ṗ_a + omega_a perp(d_a) = Ṗ_b + omega_b perp(d_b), and the same once more derived.
    #[inline]
    pub(super) fn solve_rates(&self, work: &mut Work<'_>) {
        let [a, b] = &self.sides;
        let (outer_a, outer_b) = (a.anchor.rates(work.flow), b.anchor.rates(work.flow));
        let inverse = -1.0 / self.determinant;
        let velocity = outer_a[0] - outer_b[0];
        let omega = [
            velocity.dot(&b.link) * inverse,
            velocity.dot(&a.link) * inverse,
        ];
        let acceleration = outer_a[1] - outer_b[1] - a.link * (omega[0] * omega[0])
            + b.link * (omega[1] * omega[1]);
        let alpha = [
            acceleration.dot(&b.link) * inverse,
            acceleration.dot(&a.link) * inverse,
        ];
        a.set_rates(work, outer_a, [omega[0], alpha[0]]);
        b.set_rates(work, outer_b, [omega[1], alpha[1]]);
    }

    /// Whether the links are in line, to what makes a position singular. Cheaper than
    /// [`rcond`](Self::rcond), from which it differs by a factor of two at most.
    fn is_singular(&self) -> bool {
        let [a, b] = &self.sides;
        self.determinant.abs() < SINGULAR * a.length * b.length
    }

    /// 1 / (‖J‖₁ ‖J⁻¹‖₁), each column of J divided by its link's length: it depends on the angle
    /// between the links only.
    pub(super) fn rcond(&self) -> f64 {
        let [a, b] = [0, 1].map(|k| self.sides[k].link / self.sides[k].length);
        let norm = a.lp_norm(1).max(b.lp_norm(1));
        let determinant = a.perp(&b).abs();
        // The inverse has the rows d_b and d_a over the determinant.
        let inverse = (a.x.abs() + b.x.abs()).max(a.y.abs() + b.y.abs());
        let rcond = determinant / (norm * inverse);
        if rcond.is_finite() { rcond } else { 0.0 }
    }

    /// Closes the loop the way that is nearest the estimates: the minimum of Ec. 3.6.9 for
    /// r → ∞, which two circles have in two places. Leaves `work` at it.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if the links do not reach each other.
    pub(in crate::kinematics) fn assemble(
        &mut self,
        work: &mut Work<'_>,
        estimate: &[f64],
    ) -> Result<Correction, Rejected> {
        let size = work.at.size();
        let mut best: Option<(f64, [f64; 2])> = None;
        for side in [1.0, -1.0] {
            let Some(links) = self.meet(work, estimate, side) else {
                return Err(Rejected);
            };
            let mut phi = [0.0; 2];
            let mut distance = 0.0;
            for (k, side) in self.sides.iter_mut().enumerate() {
                let guess = &estimate[side.column..side.column + 3];
                let angle = links[k].y.atan2(links[k].x) - side.l.y.atan2(side.l.x);
                phi[k] = angle + TAU * ((guess[2] - angle) / TAU).round();
                let point = side.anchor.locate(work.at);
                let (sin, cos) = phi[k].sin_cos();
                let origin = point - rotate(cos, sin, side.s);
                distance += ((origin.x - guess[0]) / size).powi(2)
                    + ((origin.y - guess[1]) / size).powi(2)
                    + (phi[k] - guess[2]).powi(2);
            }
            // The first of two that are equally far.
            if best.is_none_or(|(least, _)| distance < least * (1.0 - 1e-9)) {
                best = Some((distance, phi));
            }
        }
        let (_, phi) = best.ok_or(Rejected)?;
        Ok(self.correct(work, phi, MAX_ITERATIONS)?.correction)
    }

    /// d_a and d_b where the links meet, on one side of the line between the anchors.
    fn meet(&mut self, work: &Work<'_>, estimate: &[f64], side: f64) -> Option<[Vector2<f64>; 2]> {
        let [a, b] = &mut self.sides;
        let span = b.anchor.locate(work.at) - a.anchor.locate(work.at);
        let distance = span.norm();
        let along = 0.5 * (distance + (a.length - b.length) * (a.length + b.length) / distance);
        let across = (a.length - along) * (a.length + along);
        // A gap that no one could measure is left to the corrections.
        let reach = a.length.max(b.length);
        if across < -1e-12 * reach * reach {
            return None;
        }
        let link = if distance > 0.0 {
            let e = span / distance;
            e * along + perp(e) * (side * across.max(0.0).sqrt())
        } else {
            // Any direction will do where the anchors coincide.
            let (sin, cos) = estimate[a.column + 2].sin_cos();
            rotate(cos, sin, a.l)
        };
        let links = [link, link - span];
        links.iter().all(|l| l.sum().is_finite()).then_some(links)
    }
}

/// Where Newton ended.
struct Found {
    phi: [f64; 2],
    correction: Correction,
}
