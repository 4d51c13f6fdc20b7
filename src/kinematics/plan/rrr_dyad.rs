//! Two bodies with a revolute between them and a revolute each to a body found before.

mod branches;
mod certify;

use nalgebra::Vector2;

use super::anchor::{Anchor, Moving, compact, larger, largest};
use super::anchor_path::AnchorPath;
use super::load::load_about;
use super::reach::Reach;
use super::solve::{BlockBranches, SolveBlock};
use super::step::{BlockState, Extrapolation, Step};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::error::Proof;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{System, Targets};
use crate::kinematics::tolerances::STALLED;
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of two bodies: P_a + A_a l_a = P_b + A_b l_b, both P found before. Newton–Raphson
/// solves for the two angles; x and y follow.
///
/// With d = A l of each side the Jacobian in the angles is \[perp(d_a), −perp(d_b)\] and its
/// determinant d_a × d_b, so that solving takes two dot products.
#[derive(Debug)]
pub(in crate::kinematics) struct RrrDyad {
    sides: [Side; 2],
    /// The way from the anchor of b to that of a.
    path: AnchorPath,
    /// d_a × d_b at the pose last factorised.
    determinant: f64,
    /// Whether a later block asks for the deviation of the angle between the two bodies.
    spread_is_read: bool,
    /// Numbers that no step needs.
    parts: Box<Parts>,
}

/// One of the two bodies of a dyad.
#[derive(Debug)]
struct Side {
    /// Index of the body.
    body: u32,
    /// The partner of its outer point, on a body found before.
    anchor: Anchor,
    /// s of the outer point.
    s: Vector2<f64>,
    /// l, from the outer to the inner point in the body's frame, and its length.
    l: Vector2<f64>,
    length: f64,
    /// d = A l at the pose last factorised.
    link: Vector2<f64>,
}

/// The rows, unknowns and markers of a dyad.
#[derive(Debug)]
pub(super) struct Parts {
    /// The rows of the first side's outer revolute, of the second side's, and of the inner one.
    pub(super) rows: [usize; 6],
    pub(super) columns: [usize; 6],
    pub(super) sides: [SideParts; 2],
    /// For each pair of rows, +1 where it counts from the anchor to the side or from the second side
    /// to the first, otherwise −1.
    pub(super) senses: [f64; 3],
}

/// The body and markers of one side of a dyad.
#[derive(Debug)]
pub(super) struct SideParts {
    pub(super) body: usize,
    /// Its point in the revolute to a body found before, and the partner of that point.
    pub(super) outer: MarkerId,
    pub(super) anchor: MarkerId,
    /// Its point in the revolute to the other side.
    pub(super) inner: MarkerId,
}

/// Turns up to this one update the sine and cosine at hand by their series \[rad\].
const SHORT_TURN: f64 = 0.1;
/// Largest last correction \[rad\]. After a larger one Newton–Raphson goes on even where the gap
/// is within rounding: the error left, about its square, has the same sign in every loop of a
/// chain and would add up. The sines in between need not be exact to the last bit.
const LARGEST_LAST: f64 = 4e-9;

/// Returns a frame turned on to the angle phi, to some eps; a short turn takes no sine.
#[inline(always)]
fn turned_on(frame: &BodyPose, turn: f64, phi: f64) -> BodyPose {
    if turn.abs() > SHORT_TURN {
        return BodyPose::turned(phi);
    }
    let square = turn * turn;
    // Up to the tenth power: the rest of the series is below 3e-19.
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
            body: compact(parts.body),
            anchor: Anchor::new(mechanism, parts.anchor),
            s: Vector2::zeros(),
            l: Vector2::zeros(),
            length: 0.0,
            link: Vector2::zeros(),
        }
    }

    fn set_parameters(&mut self, at: &Configuration, pivots: &mut Pivots, parts: &SideParts) {
        self.anchor.set_parameters(at, pivots, parts.anchor);
        self.s = at.local(parts.outer).0;
        pivots.set(self.body as usize, self.s);
        self.l = at.local(parts.inner).0 - self.s;
        self.length = self.l.norm();
    }

    /// Returns the turn that the tangent predicts.
    #[inline(always)]
    fn turn(&self, state: &BlockState<'_>, by: Extrapolation) -> f64 {
        let phi = 3 * self.body as usize + 2;
        by.first * state.tangent.velocity()[phi] + by.second * state.tangent.acceleration()[phi]
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
        let body = self.body as usize;
        let arm = frames[body].rotate(self.s);
        let turned = perp(arm);
        let v = outer.velocity - turned * omega;
        let a = outer.acceleration - turned * alpha + arm * (omega * omega);
        velocity[3 * body..3 * body + 3].copy_from_slice(&[v.x, v.y, omega]);
        acceleration[3 * body..3 * body + 3].copy_from_slice(&[a.x, a.y, alpha]);
    }
}

impl RrrDyad {
    pub(super) fn new(
        mechanism: &Mechanism,
        parts: Parts,
        path: AnchorPath,
        spread_is_read: bool,
    ) -> Self {
        Self {
            sides: [
                Side::new(mechanism, &parts.sides[0]),
                Side::new(mechanism, &parts.sides[1]),
            ],
            path,
            determinant: 0.0,
            spread_is_read,
            parts: Box::new(parts),
        }
    }

    /// Solves for the two angles by Newton–Raphson. The accepted sines and cosines are those of the
    /// accepted angles, so that the result does not depend on the way there.
    #[inline(always)]
    fn correct(
        &mut self,
        state: &mut BlockState<'_>,
        mut now: Turned,
        limits: Limits,
    ) -> Result<Found, Rejected> {
        let [a, b] = &mut self.sides;
        let frames = state.at.frames_mut();
        let (outer_a, outer_b) = (a.anchor.split_point(frames), b.anchor.split_point(frames));
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
            let closed = open <= limits.residual * rounding
                || (open <= STALLED * rounding && open >= 0.5 * last_gap);
            if closed && now.exact {
                frames[a.body as usize] = BodyPose {
                    origin: outer_a.origin + (outer_a.arm - frame_a.rotate(a.s)),
                    ..*frame_a
                };
                frames[b.body as usize] = BodyPose {
                    origin: outer_b.origin + (outer_b.arm - frame_b.rotate(b.s)),
                    ..*frame_b
                };
                [a.link, b.link] = links;
                self.determinant = determinant;
                return Ok(Found {
                    correction,
                    open,
                    rounding,
                });
            }
            if correction.iterations == limits.iterations {
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

    /// Returns the sine of the angle between the links.
    #[inline(always)]
    fn sine(&self) -> f64 {
        let [a, b] = &self.sides;
        self.determinant.abs() / (a.length * b.length)
    }

    /// Returns the distance of the anchors and the distances that the links can span.
    fn reach(&self, state: &BlockState<'_>) -> Reach {
        let [a, b] = &self.sides;
        let frames = state.at.frames();
        Reach {
            distance: b
                .anchor
                .split_point(frames)
                .from(a.anchor.split_point(frames))
                .norm(),
            shortest: (a.length - b.length).abs(),
            longest: a.length + b.length,
        }
    }
}

impl SolveBlock for RrrDyad {
    fn rows(&self) -> &[usize] {
        &self.parts.rows
    }

    fn columns(&self) -> &[usize] {
        &self.parts.columns
    }

    fn set_parameters(
        &mut self,
        _system: &System,
        at: &Configuration,
        _targets: &Targets,
        pivots: &mut Pivots,
    ) {
        for (side, parts) in self.sides.iter_mut().zip(&self.parts.sides) {
            side.set_parameters(at, pivots, parts);
        }
        self.path.set_parameters(at, pivots);
    }

    #[inline(always)]
    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        let [a, b] = &self.sides;
        let frames = state.at.frames();
        let (frame_a, frame_b) = (&frames[a.body as usize], &frames[b.body as usize]);
        for (side, frame) in [(a, frame_a), (b, frame_b)] {
            let bound = step.bounds.body_mut(side.body as usize);
            (bound.cos, bound.sin) = (frame.cos, frame.sin);
        }
        let (turn_a, turn_b) = (
            a.turn(state, step.extrapolation),
            b.turn(state, step.extrapolation),
        );
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
        let found = self.correct(state, start, Limits::STEP);
        let found = found.map_err(|_| step.bounds.reject())?;
        self.certify(state, step.bounds, &before, &found)?;
        Ok(Correction {
            regularity: self.sine(),
            ..found.correction
        })
    }

    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        let phi = [0, 1].map(|k| state.at.frames()[self.sides[k].body as usize].phi);
        self.close_from(state, phi, limits)
    }

    fn close_from(
        &mut self,
        state: &mut BlockState<'_>,
        angles: [f64; 2],
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        let start = Turned {
            frames: angles.map(BodyPose::turned),
            exact: true,
        };
        Ok(self.correct(state, start, limits)?.correction)
    }

    fn branches(&self, state: &mut BlockState<'_>, estimate: &[f64]) -> BlockBranches {
        self.angles(state, estimate)
            .map_or_else(BlockBranches::None, BlockBranches::Two)
    }

    fn stretch(&self, state: &mut BlockState<'_>, estimate: &[f64]) {
        self.put_in_line(state, estimate);
    }

    /// Returns the distances that the links span and the distance that they have to.
    fn proof(&self, state: &BlockState<'_>) -> Option<Proof> {
        let mechanism = state.system.mechanism();
        let reach = self.reach(state);
        let mut sides = [0, 1].map(|k| (self.parts.sides[k].body, self.parts.sides[k].anchor));
        sides.sort_unstable_by_key(|(body, _)| *body);
        Some(Proof::Reach {
            bodies: sides.map(|(body, _)| mechanism.bodies[body].name.clone()),
            points: sides.map(|(_, anchor)| mechanism.marker_path(anchor)),
            distance: reach.distance,
            span: [reach.shortest, reach.longest],
        })
    }

    /// Notes the links and the determinant.
    fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        for side in &mut self.sides {
            side.link = state.at.frames()[side.body as usize].rotate(side.l);
        }
        self.determinant = self.sides[0].link.perp(&self.sides[1].link);
        if self.determinant == 0.0 || !self.determinant.is_finite() {
            return Err(Rejected);
        }
        Ok(())
    }

    /// The moments of each side about its outer point give the force in the inner revolute; the
    /// outer ones bear the rest.
    fn solve_transposed(
        &self,
        _system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> bool {
        let frames = at.frames();
        let [a, b] = &self.sides;
        let loads = [a, b].map(|own| {
            let body = own.body as usize;
            load_about(side, body, frames[body].rotate(own.s))
        });
        let [(force_a, moment_a), (force_b, moment_b)] = loads;
        // F on the first side: d_a × F is the one moment, d_b × F the negative of the other.
        let inner = (b.link * moment_a + a.link * moment_b) / self.determinant;
        let outer = [force_a - inner, force_b + inner];
        let Parts { rows, senses, .. } = &*self.parts;
        let forces = [outer[0], outer[1], inner];
        for ((rows, sense), force) in rows.chunks_exact(2).zip(senses).zip(forces) {
            multipliers[rows[0]] = sense * force.x;
            multipliers[rows[1]] = sense * force.y;
        }
        a.anchor.load(frames, outer[0], side);
        b.anchor.load(frames, outer[1], side);
        true
    }

    /// Solves Ṗ_a + omega_a perp(d_a) = Ṗ_b + omega_b perp(d_b) and its derivative in time.
    #[inline(always)]
    fn solve_rates(&mut self, state: &mut BlockState<'_>, _drivers: &[Jet]) {
        let [a, b] = &self.sides;
        let frames = state.at.frames();
        let (velocity, acceleration) = state.tangent.both_mut();
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

    /// Returns 1 / (‖J‖₁ ‖J⁻¹‖₁), each column of J divided by its link's length: it depends on the
    /// angle between the links alone.
    fn rcond(&mut self) -> f64 {
        let [a, b] = [0, 1].map(|k| self.sides[k].link / self.sides[k].length);
        let norm = a.lp_norm(1).max(b.lp_norm(1));
        let determinant = a.perp(&b).abs();
        // The inverse has the rows d_b and d_a over the determinant.
        let inverse = (a.x.abs() + b.x.abs()).max(a.y.abs() + b.y.abs());
        let rcond = determinant / (norm * inverse);
        if rcond.is_finite() { rcond } else { 0.0 }
    }

    fn regularity(&self) -> f64 {
        self.sine()
    }
}

/// Two frames at their angles; their origins are not set.
struct Turned {
    frames: [BodyPose; 2],
    /// Whether sines and cosines are exact.
    exact: bool,
}

/// The result of Newton–Raphson.
struct Found {
    correction: Correction,
    /// The gap that is left, and its rounding \[m\].
    open: f64,
    rounding: f64,
}

/// The start of a sub-step; the chord bounds hold its sines and cosines.
struct Before {
    phi: [f64; 2],
    links: [Vector2<f64>; 2],
    determinant: f64,
}
