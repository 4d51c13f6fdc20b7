//! A body with a revolute to a body found before and a point on a line, alone or with a second
//! body that slides.

mod branches;
mod certify;
mod equation;
mod forces;
mod moved;
mod parameters;
mod rates;

use nalgebra::Vector2;

use certify::Before;
use equation::Known;

use super::anchor::{Anchor, compact};
use super::revolute::Revolute;
use super::solve::{BlockBranches, SolveBlock};
use super::step::{BlockState, Step};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::Projection;
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::error::Proof;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{System, Targets};
use crate::kinematics::tolerances::STALLED;
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of body a, and of body b if there is one. All follow from the angle of a, for
/// which one equation is left: with κ and w known, and g fixed to body a,
///
/// f = e · (P_j − P_i) − target = κ + w · A_a g.
///
/// With a known axis e, w = e and g is the turning part of P_j − P_i; where it turns with
/// a, g = e in a's frame and w is the known part of P_j − P_i, as the rest turns with e.
#[derive(Debug)]
pub(in crate::kinematics) struct RrpDyad {
    body: u32,
    anchor: Anchor,
    /// s of a's point in the revolute.
    s: Vector2<f64>,
    second: Second,
    /// The points i and j.
    points: [Point; 2],
    axis: Line,
    /// A_a g at the pose last factorised, ∂f/∂phi, and the known part of P_j − P_i.
    g: Vector2<f64>,
    slope: f64,
    still: Vector2<f64>,
    /// |w| |g|, or the size of the part of the mechanism if that is larger: the scale of the slope.
    scale: f64,
    /// The size of the block's part of the mechanism \[m\].
    size: f64,
    /// Whether a later block of this kind has a point on b.
    slide_is_read: bool,
    parts: Box<Parts>,
}

/// The second body, b.
#[derive(Debug)]
enum Second {
    None,
    /// Pinned to a, its angle measured from a body found before.
    Carried {
        body: u32,
        /// The body that its angle is measured from, `None` for ground.
        reference: Option<usize>,
        /// phi_b where that body's angle and the target are zero.
        zero: f64,
        /// l, from a's outer to its inner point, and the inner point in b's frame.
        l: Vector2<f64>,
        s: Vector2<f64>,
    },
    /// Pinned to a body found before, its angle measured from a.
    Parallel {
        body: u32,
        anchor: Anchor,
        zero: f64,
        s: Vector2<f64>,
    },
}

/// A point as the sum of a known part and a part that turns with a.
#[derive(Clone, Copy, Debug)]
enum Point {
    Known(Anchor),
    /// On a: from its outer point, in a's frame.
    First(Vector2<f64>),
    /// On b that is carried: from its inner point, in b's frame.
    Carried(Vector2<f64>),
    /// On b that is parallel to a: from its outer point, in a's frame.
    Parallel(Vector2<f64>),
}

/// The axis of the line.
#[derive(Clone, Copy, Debug)]
enum Line {
    /// On a body found before (`None` for ground), in its frame.
    Known(Option<usize>, Vector2<f64>),
    /// On b, which is carried.
    Carried(Vector2<f64>),
    /// On a, or on b that is parallel to a, in the frame of a.
    Turning(Vector2<f64>),
}

/// The rows, unknowns and markers of the block.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    /// Body a, its point in the revolute, and the partner of that point.
    pub(super) body: usize,
    pub(super) pin: MarkerId,
    pub(super) anchor: MarkerId,
    pub(super) outer: Revolute,
    pub(super) second: Option<SecondParts>,
    /// The row of the projection, and its relation.
    pub(super) row: usize,
    pub(super) projection: Projection,
    /// The size of its part of the mechanism, as a part of the mechanism's size.
    pub(super) part: f64,
}

/// The row and markers of the second body.
#[derive(Debug)]
pub(super) struct SecondParts {
    pub(super) body: usize,
    /// Whether its revolute is to body a; otherwise it is to a body found before.
    pub(super) carried: bool,
    /// Its point in that revolute, and the partner of that point.
    pub(super) pin: MarkerId,
    pub(super) partner: MarkerId,
    pub(super) revolute: Revolute,
    /// The row of the angle, its marker on body b, its other marker, and +1 where the angle counts
    /// from the other marker to b, otherwise −1.
    pub(super) row: usize,
    pub(super) angle: MarkerId,
    pub(super) reference: MarkerId,
    pub(super) sense: f64,
}

impl RrpDyad {
    pub(super) fn new(mechanism: &Mechanism, parts: Parts, slide_is_read: bool) -> Self {
        let zero = Vector2::zeros();
        let body_of = |marker: MarkerId| {
            let body = mechanism.markers[marker.index()].body;
            body.map(|body| body.index())
        };
        let second = match &parts.second {
            None => Second::None,
            Some(b) if b.carried => Second::Carried {
                body: compact(b.body),
                reference: body_of(b.reference),
                zero: 0.0,
                l: zero,
                s: zero,
            },
            Some(b) => Second::Parallel {
                body: compact(b.body),
                anchor: Anchor::new(mechanism, b.partner),
                zero: 0.0,
                s: zero,
            },
        };
        let on = |marker| match (body_of(marker), &parts.second) {
            (Some(body), _) if body == parts.body => Point::First(zero),
            (Some(body), Some(b)) if body == b.body && b.carried => Point::Carried(zero),
            (Some(body), Some(b)) if body == b.body => Point::Parallel(zero),
            _ => Point::Known(Anchor::new(mechanism, marker)),
        };
        let axes = parts.projection.axes;
        let axis = match on(axes) {
            Point::Known(_) => Line::Known(body_of(axes), zero),
            Point::Carried(_) => Line::Carried(zero),
            Point::First(_) | Point::Parallel(_) => Line::Turning(zero),
        };
        Self {
            body: compact(parts.body),
            anchor: Anchor::new(mechanism, parts.anchor),
            s: zero,
            points: [on(parts.projection.from), on(parts.projection.to)],
            axis,
            second,
            g: zero,
            slope: 0.0,
            still: zero,
            scale: 0.0,
            size: 1.0,
            slide_is_read,
            parts: Box::new(parts),
        }
    }

    /// Solves for the angle of a by Newton–Raphson.
    fn correct(
        &mut self,
        state: &mut BlockState<'_>,
        mut phi: f64,
        limits: Limits,
    ) -> Result<Found, Rejected> {
        let known = self.known(state);
        let scale = known.w.norm() * known.g.norm();
        let mut correction = Correction::default();
        let mut last_gap = f64::INFINITY;
        loop {
            let frame = BodyPose::turned(phi);
            let g = frame.rotate(known.g);
            let f = known.kappa + known.w.dot(&g);
            let slope = known.w.dot(&perp(g));
            let rounding = f64::EPSILON * (known.reach + scale * (1.0 + phi.abs()));
            let open = f.abs();
            if open <= limits.residual * rounding
                || (open <= STALLED * rounding && open >= 0.5 * last_gap)
            {
                self.put(state.at.frames_mut(), &known, frame);
                // Next to the pin |w| |g| goes to zero: a line through the pin turns freely.
                (self.g, self.slope, self.still) = (g, slope, known.still);
                self.scale = scale.max(self.size);
                return Ok(Found {
                    known,
                    correction,
                    open: open + rounding,
                });
            }
            let step = -f / slope;
            if correction.iterations == limits.iterations || !step.is_finite() {
                return Err(Rejected);
            }
            phi += step;
            last_gap = open;
            correction.iterations += 1;
        }
    }
}

impl SolveBlock for RrpDyad {
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
        targets: &Targets,
        pivots: &mut Pivots,
    ) {
        self.take_over_parameters(at, targets, pivots);
        self.size = at.size() * self.parts.part;
    }

    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        let column = 3 * self.body as usize + 2;
        let before = Before::new(self, state);
        let predicted = step
            .extrapolation
            .predict(column, before.first.phi, state.tangent);
        let found = self.correct(state, predicted, Limits::STEP);
        let found = found.map_err(|_| step.bounds.reject())?;
        self.certify(state, step, &before, &found)?;
        Ok(Correction {
            regularity: self.regularity(),
            ..found.correction
        })
    }

    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        let phi = state.at.frames()[self.body as usize].phi;
        self.close_from(state, [phi, 0.0], limits)
    }

    /// Closes from an angle of body a, the first one.
    fn close_from(
        &mut self,
        state: &mut BlockState<'_>,
        angles: [f64; 2],
        limits: Limits,
    ) -> Result<Correction, Rejected> {
        Ok(self.correct(state, angles[0], limits)?.correction)
    }

    /// Returns the two angles of body a at which the block closes: the minima of Eq. 3.6.9 for
    /// r → ∞, where a circle intersects a line.
    fn branches(&self, state: &mut BlockState<'_>, estimate: &[f64]) -> BlockBranches {
        match self.angles(state, estimate) {
            Ok(angles) => BlockBranches::Two(angles.map(|angle| [angle, 0.0])),
            Err(gap) => BlockBranches::None(gap),
        }
    }

    fn stretch(&self, state: &mut BlockState<'_>, estimate: &[f64]) {
        self.stretch_to_line(state, estimate);
    }

    fn proof(&self, state: &BlockState<'_>) -> Option<Proof> {
        let body = &state.system.mechanism().bodies[self.parts.body];
        Some(Proof::Line {
            body: body.name.clone(),
        })
    }

    /// Notes the slope.
    fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        let known = self.known(state);
        self.g = state.at.frames()[self.body as usize].rotate(known.g);
        self.slope = known.w.dot(&perp(self.g));
        self.still = known.still;
        self.scale = (known.w.norm() * known.g.norm()).max(self.size);
        if self.slope == 0.0 || !self.slope.is_finite() {
            return Err(Rejected);
        }
        Ok(())
    }

    fn solve_transposed(
        &self,
        system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> bool {
        forces::solve_transposed(self, system, at, side, multipliers);
        true
    }

    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        self.solve_angles(state, drivers);
    }

    /// Returns |∂f/∂phi| over its scale.
    fn rcond(&mut self) -> f64 {
        let rcond = self.regularity();
        if rcond.is_finite() { rcond } else { 0.0 }
    }

    fn regularity(&self) -> f64 {
        self.slope.abs() / self.scale
    }
}

/// The result of Newton–Raphson.
struct Found {
    known: Known,
    correction: Correction,
    /// Bound of the remainder of f.
    open: f64,
}
