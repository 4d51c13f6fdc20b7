//! Two bodies joined to each other and each to something already found, by revolutes.

mod certify;

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::anchor::{Anchor, Moving, compact, larger, largest};
use super::reach::{Miss, Reach};
use super::work::{Advance, Substep, Work};
use crate::kinematics::certificate::Tubes;
use crate::kinematics::configuration::{BodyPose, Configuration, perp, rotate};
use crate::kinematics::newton::{AT_ROUNDING, Correction, MAX_ITERATIONS, Rejected, STALLED};
use crate::mechanism::{MarkerId, Mechanism};

/// x, y and phi of two bodies: P_a + A_a l_a = P_b + A_b l_b with both P already found. The two
/// angles are solved for; x and y follow.
///
/// With d = A l of each side the Jacobian in the angles is \[perp(d_a), −perp(d_b)\], its
/// determinant d_a × d_b, so that solving takes two dot products.
#[derive(Debug)]
pub(in crate::kinematics) struct RrrDyad {
    sides: [Side; 2],
    /// d_a × d_b at the pose last factorised.
    determinant: f64,
    /// What no step needs.
    parts: Box<Parts>,
}

/// One of the two bodies of a dyad.
#[derive(Debug)]
struct Side {
    /// Place of the body.
    place: u32,
    /// The point that its outer point coincides with, on what is already found.
    anchor: Anchor,
    /// s of the outer point.
    s: Vector2<f64>,
    /// l, from the outer to the inner point in the body's frame, and its length.
    l: Vector2<f64>,
    length: f64,
    /// d = A l at the pose last factorised.
    link: Vector2<f64>,
}

/// What a dyad is made of.
#[derive(Debug)]
pub(super) struct Parts {
    /// The rows of the first side's outer revolute, the second's, and the inner one's.
    pub(super) rows: [usize; 6],
    pub(super) columns: [usize; 6],
    pub(super) sides: [SideParts; 2],
}

/// What one side of a dyad is made of.
#[derive(Debug)]
pub(super) struct SideParts {
    pub(super) body: usize,
    /// Its point in the revolute to what is already found, and that point's partner there.
    pub(super) outer: MarkerId,
    pub(super) anchor: MarkerId,
    /// Its point in the revolute to the other side.
    pub(super) inner: MarkerId,
}

/// Turns of up to this are taken from the sine and cosine at hand by their series.
const SHORT_TURN: f64 = 0.1;
/// A correction of more than this is followed by another one, even where the gap is then within
/// rounding: what it leaves, its square or so, has the same sign in every loop of a chain and would
/// add up. The sines in between need not be exact to the last bit.
const LARGEST_LAST: f64 = 4e-9;

/// A frame turned on to the angle phi: to some eps, for a short turn without a sine.
#[inline(always)]
fn turned_on(frame: &BodyPose, turn: f64, phi: f64) -> BodyPose {
    if turn.abs() > SHORT_TURN {
        return BodyPose::turned(phi);
    }
    let square = turn * turn;
    // Up to the tenth power: what is left of the series is below 3e-19.
    let cos = 1.0
        - square
            * (1.0 / 2.0
                - square
                    * (1.0 / 24.0
                        - square
                            * (1.0 / 720.0
                                - square * (1.0 / 40_320.0 - square * (1.0 / 3_628_800.0)))));
    let sin = turn
        * (1.0
            - square
                * (1.0 / 6.0
                    - square
                        * (1.0 / 120.0 - square * (1.0 / 5_040.0 - square * (1.0 / 362_880.0)))));
    BodyPose {
        phi,
        cos: frame.cos * cos - frame.sin * sin,
        sin: frame.sin * cos + frame.cos * sin,
        ..*frame
    }
}

impl Side {
    fn new(mechanism: &Mechanism, parts: &SideParts) -> Self {
        Self {
            place: compact(parts.body),
            anchor: Anchor::new(mechanism, parts.anchor),
            s: Vector2::zeros(),
            l: Vector2::zeros(),
            length: 0.0,
            link: Vector2::zeros(),
        }
    }

    fn set_parameters(&mut self, at: &Configuration, tubes: &mut Tubes, parts: &SideParts) {
        self.anchor.set_parameters(at, tubes, parts.anchor);
        self.s = at.local(parts.outer).0;
        tubes.set_pivot(self.place as usize, self.s);
        self.l = at.local(parts.inner).0 - self.s;
        self.length = self.l.norm();
    }

    /// The angle at which its link points along `direction`, on the turn nearest to `guess`.
    fn turned_along(&self, direction: Vector2<f64>, guess: f64) -> f64 {
        let angle = direction.y.atan2(direction.x) - self.l.y.atan2(self.l.x);
        angle + TAU * ((guess - angle) / TAU).round()
    }

    /// How far its angle is expected to turn.
    #[inline(always)]
    fn turn(&self, work: &Work<'_>, advance: Advance) -> f64 {
        let phi = 3 * self.place as usize + 2;
        advance.first * work.flow.velocity()[phi] + advance.second * work.flow.acceleration()[phi]
    }

    /// Writes its rates, given those of its outer point and of its angle.
    #[inline(always)]
    fn set_rates(
        &self,
        frames: &[BodyPose],
        velocity: &mut [f64],
        acceleration: &mut [f64],
        outer: Moving,
        omega: f64,
        alpha: f64,
    ) {
        let place = self.place as usize;
        let arm = frames[place].rotate(self.s);
        let turned = perp(arm);
        let v = outer.velocity - turned * omega;
        let a = outer.acceleration - turned * alpha + arm * (omega * omega);
        velocity[3 * place..3 * place + 3].copy_from_slice(&[v.x, v.y, omega]);
        acceleration[3 * place..3 * place + 3].copy_from_slice(&[a.x, a.y, alpha]);
    }
}

impl RrrDyad {
    pub(super) fn new(mechanism: &Mechanism, parts: Parts) -> Self {
        Self {
            sides: [
                Side::new(mechanism, &parts.sides[0]),
                Side::new(mechanism, &parts.sides[1]),
            ],
            determinant: 0.0,
            parts: Box::new(parts),
        }
    }

    pub(super) fn rows(&self) -> &[usize] {
        &self.parts.rows
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.parts.columns
    }

    pub(super) fn set_parameters(&mut self, at: &Configuration, tubes: &mut Tubes) {
        for (side, parts) in self.sides.iter_mut().zip(&self.parts.sides) {
            side.set_parameters(at, tubes, parts);
        }
    }

    /// Predicts both angles, corrects them until the loop closes to rounding, and proves that the
    /// motion leads there.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<Correction, Rejected> {
        let [a, b] = &self.sides;
        let frames = work.at.frames();
        let (frame_a, frame_b) = (&frames[a.place as usize], &frames[b.place as usize]);
        for (side, frame) in [(a, frame_a), (b, frame_b)] {
            let tube = substep.tubes.body_mut(side.place as usize);
            (tube.cos, tube.sin) = (frame.cos, frame.sin);
        }
        let (turn_a, turn_b) = (a.turn(work, substep.advance), b.turn(work, substep.advance));
        let start = Turned {
            frames: [
                turned_on(frame_a, turn_a, frame_a.phi + turn_a),
                turned_on(frame_b, turn_b, frame_b.phi + turn_b),
            ],
            exact: turn_a == 0.0 && turn_b == 0.0,
        };
        let before = Before {
            phi: [frame_a.phi, frame_b.phi],
            links: [a.link, b.link],
            determinant: self.determinant,
        };
        let found = self.correct(work, start, MAX_ITERATIONS);
        let found = found.map_err(|_| substep.tubes.break_off())?;
        self.certify(work, substep.tubes, &before, &found)?;
        Ok(Correction {
            regularity: self.regularity(),
            ..found.correction
        })
    }

    /// Newton–Raphson on the two angles. The angles accepted are those of exact sines and
    /// cosines, so that nothing depends on how they were reached.
    #[inline(always)]
    fn correct(
        &mut self,
        work: &mut Work<'_>,
        mut now: Turned,
        max_iterations: u32,
    ) -> Result<Found, Rejected> {
        let [a, b] = &mut self.sides;
        let frames = work.at.frames_mut();
        let (outer_a, outer_b) = (a.anchor.place(frames), b.anchor.place(frames));
        let base = outer_a.from(outer_b);
        let reach = outer_a.reach_from(outer_b);
        let mut correction = Correction::default();
        let mut last_gap = f64::INFINITY;
        loop {
            let [frame_a, frame_b] = &now.frames;
            let links = [frame_a.rotate(a.l), frame_b.rotate(b.l)];
            let gap = base + links[0] - links[1];
            let determinant = links[0].perp(&links[1]);
            // The rounding of the points, and that of the angles times the links.
            let rounding = f64::EPSILON
                * (reach
                    + a.length * (1.0 + frame_a.phi.abs())
                    + b.length * (1.0 + frame_b.phi.abs()));
            let open = largest(gap);
            let closed = open <= AT_ROUNDING * rounding
                || (open <= STALLED * rounding && open >= 0.5 * last_gap);
            if closed && now.exact {
                frames[a.place as usize] = BodyPose {
                    origin: outer_a.origin + (outer_a.arm - frame_a.rotate(a.s)),
                    ..*frame_a
                };
                frames[b.place as usize] = BodyPose {
                    origin: outer_b.origin + (outer_b.arm - frame_b.rotate(b.s)),
                    ..*frame_b
                };
                [a.link, b.link] = links;
                self.determinant = determinant;
                return Ok(Found {
                    correction,
                    open: open + rounding,
                });
            }
            if correction.iterations == max_iterations {
                return Err(Rejected);
            }
            let inverse = -1.0 / determinant;
            let step_a = gap.dot(&links[1]) * inverse;
            let step_b = gap.dot(&links[0]) * inverse;
            if !(step_a + step_b).is_finite() {
                return Err(Rejected);
            }
            let (phi_a, phi_b) = (frame_a.phi + step_a, frame_b.phi + step_b);
            last_gap = open;
            correction.iterations += 1;
            now = if larger(step_a.abs(), step_b.abs()) > LARGEST_LAST {
                Turned {
                    frames: [
                        turned_on(frame_a, step_a, phi_a),
                        turned_on(frame_b, step_b, phi_b),
                    ],
                    exact: false,
                }
            } else {
                Turned {
                    frames: [BodyPose::turned(phi_a), BodyPose::turned(phi_b)],
                    exact: true,
                }
            };
        }
    }

    /// Closes the loop from these angles.
    pub(in crate::kinematics) fn close_from(
        &mut self,
        work: &mut Work<'_>,
        phi: [f64; 2],
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        let start = Turned {
            frames: phi.map(BodyPose::turned),
            exact: true,
        };
        Ok(self.correct(work, start, max_iterations)?.correction)
    }

    /// Closes the loop from where its bodies are.
    pub(in crate::kinematics) fn close(
        &mut self,
        work: &mut Work<'_>,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        let phi = [0, 1].map(|k| work.at.frames()[self.sides[k].place as usize].phi);
        self.close_from(work, phi, max_iterations)
    }

    /// Notes the links and the determinant at the pose.
    pub(super) fn factorise(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        for side in &mut self.sides {
            side.link = work.at.frames()[side.place as usize].rotate(side.l);
        }
        self.determinant = self.sides[0].link.perp(&self.sides[1].link);
        if self.determinant == 0.0 || !self.determinant.is_finite() {
            return Err(Rejected);
        }
        Ok(())
    }

    /// Ṗ_a + omega_a perp(d_a) = Ṗ_b + omega_b perp(d_b), and the same once more derived.
    #[inline(always)]
    pub(super) fn solve_rates(&self, work: &mut Work<'_>) {
        let [a, b] = &self.sides;
        let frames = work.at.frames();
        let (velocity, acceleration) = work.flow.both_mut();
        let outer_a = a.anchor.rates(frames, velocity, acceleration);
        let outer_b = b.anchor.rates(frames, velocity, acceleration);
        let inverse = -1.0 / self.determinant;
        let v = outer_a.velocity - outer_b.velocity;
        let omega_a = v.dot(&b.link) * inverse;
        let omega_b = v.dot(&a.link) * inverse;
        let w = outer_a.acceleration - outer_b.acceleration - a.link * (omega_a * omega_a)
            + b.link * (omega_b * omega_b);
        let alpha_a = w.dot(&b.link) * inverse;
        let alpha_b = w.dot(&a.link) * inverse;
        a.set_rates(frames, velocity, acceleration, outer_a, omega_a, alpha_a);
        b.set_rates(frames, velocity, acceleration, outer_b, omega_b, alpha_b);
    }

    /// The sine of the angle between the links.
    #[inline(always)]
    pub(super) fn regularity(&self) -> f64 {
        let [a, b] = &self.sides;
        self.determinant.abs() / (a.length * b.length)
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

    /// The pairs of angles at which the loop closes, nearest the estimates first: the minima of
    /// Ec. 3.6.9 for r → ∞, which two circles have in two places.
    ///
    /// # Errors
    ///
    /// [`Miss`] if the links do not reach each other.
    pub(in crate::kinematics) fn ways(
        &self,
        work: &Work<'_>,
        estimate: &[f64],
    ) -> Result<[[f64; 2]; 2], Miss> {
        let reach = self.reach(work);
        let miss = Miss::new(reach.gap(), reach.distance + reach.longest);
        if miss.certain {
            return Err(miss);
        }
        let size = work.at.size();
        let mut ways = [(0.0, [0.0; 2]); 2];
        for (way, side) in ways.iter_mut().zip([1.0, -1.0]) {
            let links = self.meet(work, estimate, side).ok_or(miss)?;
            for (k, side) in self.sides.iter().enumerate() {
                let column = 3 * side.place as usize;
                let guess = &estimate[column..column + 3];
                let phi = side.turned_along(links[k], guess[2]);
                let point = side.anchor.point(work.at.frames());
                let (sin, cos) = phi.sin_cos();
                let origin = point - rotate(cos, sin, side.s);
                way.0 += ((origin.x - guess[0]) / size).powi(2)
                    + ((origin.y - guess[1]) / size).powi(2)
                    + (phi - guess[2]).powi(2);
                way.1[k] = phi;
            }
        }
        // The first of two that are equally far.
        if ways[1].0 < ways[0].0 * (1.0 - 1e-9) {
            ways.swap(0, 1);
        }
        Ok(ways.map(|(_, phi)| phi))
    }

    /// How far apart the anchors are and what the links can span.
    pub(in crate::kinematics) fn reach(&self, work: &Work<'_>) -> Reach {
        let [a, b] = &self.sides;
        let frames = work.at.frames();
        Reach {
            distance: b.anchor.place(frames).from(a.anchor.place(frames)).norm(),
            shortest: (a.length - b.length).abs(),
            longest: a.length + b.length,
        }
    }

    /// Its bodies, and for each the point on what is already found that it is pinned to.
    pub(in crate::kinematics) fn ends(&self) -> [(usize, MarkerId); 2] {
        [0, 1].map(|k| (self.parts.sides[k].body, self.parts.sides[k].anchor))
    }

    /// Puts the bodies as near to closing as they come, where the links do not reach each other:
    /// in line, all of the gap in the joint declared last.
    pub(in crate::kinematics) fn stretch(&self, work: &mut Work<'_>, estimate: &[f64]) {
        let [a, b] = &self.sides;
        let frames = work.at.frames_mut();
        let (point_a, point_b) = (a.anchor.point(frames), b.anchor.point(frames));
        let span = point_b - point_a;
        let distance = span.norm();
        let e = if distance > 0.0 {
            span / distance
        } else {
            let (sin, cos) = estimate[3 * a.place as usize + 2].sin_cos();
            Vector2::new(cos, sin)
        };
        // Too long a way is spanned by both; in too short a one the longer link overshoots.
        let (along_a, along_b) = if distance > a.length + b.length {
            (e, -e)
        } else if a.length > b.length {
            (e, e)
        } else {
            (-e, -e)
        };
        let turned = |side: &Side, along| {
            let guess = estimate[3 * side.place as usize + 2];
            BodyPose::turned(side.turned_along(along, guess))
        };
        let (frame_a, frame_b) = (turned(a, along_a), turned(b, along_b));
        let rows = &self.parts.rows;
        let last = (0..6).max_by_key(|&k| rows[k]).map_or(0, |k| k / 2);
        let (end_a, end_b) = (frame_a.rotate(a.l), frame_b.rotate(b.l));
        let outer_a = if last == 0 {
            point_b + end_b - end_a
        } else {
            point_a
        };
        let outer_b = if last == 1 {
            point_a + end_a - end_b
        } else {
            point_b
        };
        frames[a.place as usize] = BodyPose {
            origin: outer_a - frame_a.rotate(a.s),
            ..frame_a
        };
        frames[b.place as usize] = BodyPose {
            origin: outer_b - frame_b.rotate(b.s),
            ..frame_b
        };
    }

    /// d_a and d_b where the links meet, on one side of the line between the anchors.
    fn meet(&self, work: &Work<'_>, estimate: &[f64], side: f64) -> Option<[Vector2<f64>; 2]> {
        let [a, b] = &self.sides;
        let frames = work.at.frames();
        let span = b.anchor.place(frames).from(a.anchor.place(frames));
        let distance = span.norm();
        let along = 0.5 * (distance + (a.length - b.length) * (a.length + b.length) / distance);
        // Negative where the links do not quite reach: that is left to the corrections.
        let across = (a.length - along) * (a.length + along);
        let link = if distance > 0.0 {
            let e = span / distance;
            e * along + perp(e) * (side * across.max(0.0).sqrt())
        } else {
            // Any direction will do where the anchors coincide.
            let (sin, cos) = estimate[3 * a.place as usize + 2].sin_cos();
            rotate(cos, sin, a.l)
        };
        let links = [link, link - span];
        links.iter().all(|l| l.sum().is_finite()).then_some(links)
    }
}

/// Two bodies at their angles, origins apart.
struct Turned {
    frames: [BodyPose; 2],
    /// Whether sines and cosines are exact.
    exact: bool,
}

/// Where Newton ended.
struct Found {
    correction: Correction,
    /// What the loop is left open by, at the most \[m\].
    open: f64,
}

/// Where a sub-step started; the tubes have cosines and sines.
struct Before {
    phi: [f64; 2],
    links: [Vector2<f64>; 2],
    determinant: f64,
}
