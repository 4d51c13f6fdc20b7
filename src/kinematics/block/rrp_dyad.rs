//! A body with a revolute to something already found and a point on a line, alone or with a
//! second body that slides.

mod certify;
mod equation;
mod parameters;
mod rates;
mod ways;

use nalgebra::Vector2;

use certify::Before;
use equation::Known;

use super::anchor::{Anchor, compact};
use super::work::{Substep, Work};
use crate::kinematics::configuration::{BodyPose, perp};
use crate::kinematics::constraint::Projection;
use crate::kinematics::newton::{AT_ROUNDING, Correction, MAX_ITERATIONS, Rejected, STALLED};
use crate::mechanism::{MarkerId, Mechanism};

/// x, y and phi of body a, and of body b if there is one. Everything follows from the angle of
/// a, for which one equation is left: with what is known gathered in κ and w, and the rest fixed
/// to body a as g,
///
/// f = e · (P_j − P_i) − target = κ + w · A_a g.
///
/// Where the axis e is known, w = e and g is the turning part of P_j − P_i; where it turns with
/// a, g = e in a's frame and w is the known part of P_j − P_i, as the rest turns with e.
#[derive(Debug)]
pub(in crate::kinematics) struct RrpDyad {
    place: u32,
    anchor: Anchor,
    /// s of a's point in the revolute.
    s: Vector2<f64>,
    second: Second,
    /// Of i and j.
    points: [Point; 2],
    axis: Line,
    /// A_a g at the pose last factorised, ∂f/∂phi, and the known part of P_j − P_i.
    g: Vector2<f64>,
    slope: f64,
    still: Vector2<f64>,
    /// |w| |g|, what the slope is measured against.
    scale: f64,
    parts: Box<Parts>,
}

/// The second body, b.
#[derive(Debug)]
enum Second {
    None,
    /// Pinned to a, its angle held against something known.
    Carried {
        place: u32,
        /// The body that its angle is held against, `None` for ground.
        reference: Option<usize>,
        /// phi_b less that body's angle and the target.
        zero: f64,
        /// l, from a's outer to its inner point, and the inner point in b's frame.
        l: Vector2<f64>,
        s: Vector2<f64>,
    },
    /// Pinned to something known, its angle held against a.
    Parallel {
        place: u32,
        anchor: Anchor,
        zero: f64,
        s: Vector2<f64>,
    },
}

/// Where a point stands: a part that is known and one that turns with a.
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

/// Where the axis is.
#[derive(Clone, Copy, Debug)]
enum Line {
    /// On a body found before (`None` for ground), in its frame.
    Known(Option<usize>, Vector2<f64>),
    /// On b, which is carried.
    Carried(Vector2<f64>),
    /// Turning with a, in its frame.
    Turning(Vector2<f64>),
}

/// What a slide is made of.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    /// Body a with its point in the revolute, and that point's partner.
    pub(super) body: usize,
    pub(super) pin: MarkerId,
    pub(super) anchor: MarkerId,
    pub(super) second: Option<SecondParts>,
    /// The row of the projection, and what it is.
    pub(super) row: usize,
    pub(super) projection: Projection,
}

/// What the second body is made of.
#[derive(Debug)]
pub(super) struct SecondParts {
    pub(super) body: usize,
    /// Whether its revolute is to body a; else it is to something known.
    pub(super) carried: bool,
    /// Its point in that revolute, and that point's partner.
    pub(super) pin: MarkerId,
    pub(super) partner: MarkerId,
    /// The row of the angle: its marker of body b, the other, and +1 where the angle counts from
    /// the other to b, else −1.
    pub(super) row: usize,
    pub(super) angle: MarkerId,
    pub(super) reference: MarkerId,
    pub(super) sense: f64,
}

impl RrpDyad {
    pub(super) fn new(mechanism: &Mechanism, parts: Parts) -> Self {
        let zero = Vector2::zeros();
        let body_of = |marker: MarkerId| {
            let body = mechanism.markers[marker.index()].body;
            body.map(|body| body.index())
        };
        let second = match &parts.second {
            None => Second::None,
            Some(b) if b.carried => Second::Carried {
                place: compact(b.body),
                reference: body_of(b.reference),
                zero: 0.0,
                l: zero,
                s: zero,
            },
            Some(b) => Second::Parallel {
                place: compact(b.body),
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
            place: compact(parts.body),
            anchor: Anchor::new(mechanism, parts.anchor),
            s: zero,
            points: [on(parts.projection.from), on(parts.projection.to)],
            axis,
            second,
            g: zero,
            slope: 0.0,
            still: zero,
            scale: 0.0,
            parts: Box::new(parts),
        }
    }

    pub(super) fn rows(&self) -> &[usize] {
        &self.parts.rows
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.parts.columns
    }

    /// Body a, whose angle is looked for.
    pub(in crate::kinematics) fn body(&self) -> usize {
        self.parts.body
    }

    /// Predicts the angle of a, corrects it until the point is on its line to rounding, and proves
    /// that the motion leads there.
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<Correction, Rejected> {
        let column = 3 * self.place as usize + 2;
        let before = Before::new(self, work);
        let predicted = substep.advance.predict(column, before.first.phi, work.flow);
        let found = self.correct(work, predicted, MAX_ITERATIONS);
        let found = found.map_err(|_| substep.tubes.break_off())?;
        self.certify(work, substep.tubes, &before, &found)?;
        Ok(Correction {
            regularity: self.regularity(),
            ..found.correction
        })
    }

    /// The slope of the equation in the angle, as part of what it can be.
    pub(super) fn regularity(&self) -> f64 {
        self.slope.abs() / self.scale
    }

    /// Newton–Raphson on the angle of a.
    fn correct(
        &mut self,
        work: &mut Work<'_>,
        mut phi: f64,
        max_iterations: u32,
    ) -> Result<Found, Rejected> {
        let known = self.known(work);
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
            if open <= AT_ROUNDING * rounding
                || (open <= STALLED * rounding && open >= 0.5 * last_gap)
            {
                self.put(work.at.frames_mut(), &known, frame);
                // A line that turns about a point which the pin has reached turns freely.
                (self.g, self.slope, self.still) = (g, slope, known.still);
                self.scale = scale.max(work.at.size());
                return Ok(Found {
                    known,
                    correction,
                    open: open + rounding,
                });
            }
            let step = -f / slope;
            if correction.iterations == max_iterations || !step.is_finite() {
                return Err(Rejected);
            }
            phi += step;
            last_gap = open;
            correction.iterations += 1;
        }
    }

    /// Closes from where body a is.
    pub(in crate::kinematics) fn close(
        &mut self,
        work: &mut Work<'_>,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        let phi = work.at.frames()[self.place as usize].phi;
        self.close_from(work, phi, max_iterations)
    }

    /// Closes from this angle of body a.
    pub(in crate::kinematics) fn close_from(
        &mut self,
        work: &mut Work<'_>,
        phi: f64,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        Ok(self.correct(work, phi, max_iterations)?.correction)
    }

    /// Notes the slope at the pose.
    pub(super) fn factorise(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        let known = self.known(work);
        self.g = work.at.frames()[self.place as usize].rotate(known.g);
        self.slope = known.w.dot(&perp(self.g));
        self.still = known.still;
        self.scale = (known.w.norm() * known.g.norm()).max(work.at.size());
        if self.slope == 0.0 || !self.slope.is_finite() {
            return Err(Rejected);
        }
        Ok(())
    }

    /// |∂f/∂phi| over the largest that it can be, or over the mechanism's size.
    pub(super) fn rcond(&self) -> f64 {
        let rcond = self.slope.abs() / self.scale;
        if rcond.is_finite() { rcond } else { 0.0 }
    }
}

/// Where Newton ended.
struct Found {
    known: Known,
    correction: Correction,
    /// What is left of f, at the most.
    open: f64,
}
