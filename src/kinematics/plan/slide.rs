//! A body with a revolute to something already found and a point on a line, alone or with a
//! second body that slides.

mod certify;

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use certify::Before;

use super::anchor::{Anchor, Moving, Place, compact};
use super::reach::Miss;
use super::{Substep, Work};
use crate::kinematics::certificate::Tubes;
use crate::kinematics::configuration::{self, BodyPose, Configuration, perp};
use crate::kinematics::constraint::{Axis, Projection};
use crate::kinematics::newton::{AT_ROUNDING, Correction, MAX_ITERATIONS, Rejected, STALLED};
use crate::kinematics::system::{Target, Targets};
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of body a, and of body b if there is one. Everything follows from the angle of
/// a, for which one equation is left: with what is known gathered in κ and w, and the rest fixed
/// to body a as g,
///
/// f = e · (P_j − P_i) − target = κ + w · A_a g.
///
/// Where the axis e is known, w = e and g is the turning part of P_j − P_i; where it turns with
/// a, g = e in a's frame and w is the known part of P_j − P_i, as the rest turns with e.
#[derive(Debug)]
pub(in crate::kinematics) struct Slide {
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

/// What is known before the angle of a is.
struct Known {
    /// The revolute of a.
    point: Place,
    /// b, all but its origin if that depends on the angle; ground where there is none.
    second: BodyPose,
    /// For a parallel b: its revolute, and by how much it is turned against a.
    second_point: Place,
    second_turn: f64,
    /// The known part of P_j − P_i.
    still: Vector2<f64>,
    w: Vector2<f64>,
    /// g in a's frame.
    g: Vector2<f64>,
    kappa: f64,
    /// What the rounding of f comes from besides the angle.
    reach: f64,
}

impl Slide {
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

    pub(super) fn set_parameters(
        &mut self,
        at: &Configuration,
        targets: &Targets,
        tubes: &mut Tubes,
    ) {
        let parts = &self.parts;
        self.anchor.set_parameters(at, tubes, parts.anchor);
        self.s = at.local(parts.pin).0;
        tubes.set_pivot(parts.body, self.s);
        let mut between = BodyPose::turned(0.0);
        let mut inner = Vector2::zeros();
        if let Some(b) = &parts.second {
            let offset = at.local(b.reference).1 - at.local(b.angle).1;
            inner = at.local(b.pin).0;
            tubes.set_pivot(b.body, inner);
            match &mut self.second {
                Second::None => {}
                Second::Carried { zero, l, s, .. } => {
                    *zero = offset;
                    *l = at.local(b.partner).0 - self.s;
                    *s = inner;
                }
                Second::Parallel {
                    anchor, zero, s, ..
                } => {
                    anchor.set_parameters(at, tubes, b.partner);
                    *zero = offset;
                    *s = inner;
                    // Without whole turns, which are no part of the parameters.
                    between = BodyPose::turned(offset + b.sense * targets.constant(b.row));
                }
            }
        }
        let Projection {
            from,
            to,
            axes,
            axis,
        } = parts.projection;
        for (point, marker) in self.points.iter_mut().zip([from, to]) {
            let s = at.local(marker).0;
            match point {
                Point::Known(anchor) => anchor.set_parameters(at, tubes, marker),
                Point::First(arm) => *arm = s - self.s,
                Point::Carried(arm) => *arm = s - inner,
                Point::Parallel(arm) => *arm = between.rotate(s - inner),
            }
        }
        let u = configuration::axis(at.local(axes).1);
        let direction = match axis {
            Axis::X => u,
            Axis::Y => perp(u),
        };
        let on_second = parts.second.as_ref().is_some_and(|b| {
            at.marker(axes)
                .body
                .is_some_and(|body| body.index() == b.body)
        });
        match &mut self.axis {
            Line::Known(_, e) | Line::Carried(e) => *e = direction,
            Line::Turning(e) if on_second => *e = between.rotate(direction),
            Line::Turning(e) => *e = direction,
        }
    }

    /// Gathers what is known.
    #[inline(always)]
    fn known(&self, work: &Work<'_>) -> Known {
        let frames = work.at.frames();
        let point = self.anchor.place(frames);
        let target = |row: usize| work.system.target(row, work.targets, work.drivers);
        let held = |sense: f64, row: usize| sense * target(row);
        let mut known = Known {
            point,
            second: BodyPose::turned(0.0),
            second_point: point,
            second_turn: 0.0,
            still: Vector2::zeros(),
            w: Vector2::zeros(),
            g: Vector2::zeros(),
            kappa: 0.0,
            reach: 0.0,
        };
        let mut link = Vector2::zeros();
        if let Some(b) = &self.parts.second {
            match &self.second {
                Second::None => {}
                Second::Carried {
                    reference, zero, l, ..
                } => {
                    let reference = reference.map_or(0.0, |body| frames[body].phi);
                    known.second = BodyPose::turned(reference + held(b.sense, b.row) + zero);
                    link = *l;
                }
                Second::Parallel { anchor, zero, .. } => {
                    known.second_point = anchor.place(frames);
                    known.second_turn = held(b.sense, b.row) + zero;
                }
            }
        }
        let part = |point: &Point| match *point {
            Point::Known(anchor) => (anchor.place(frames), Vector2::zeros()),
            Point::First(arm) => (known.point, arm),
            Point::Carried(arm) => (known.point.plus(known.second.rotate(arm)), link),
            Point::Parallel(arm) => (known.second_point, arm),
        };
        let (known_i, turning_i) = part(&self.points[0]);
        let (known_j, turning_j) = part(&self.points[1]);
        let (still, turning) = (known_j.from(known_i), turning_j - turning_i);
        known.still = still;
        let held_at = target(self.parts.row);
        (known.w, known.g, known.kappa) = match self.axis {
            Line::Known(body, e) => {
                let e = body.map_or(e, |body| frames[body].rotate(e));
                (e, turning, e.dot(&still) - held_at)
            }
            Line::Carried(e) => {
                let e = known.second.rotate(e);
                (e, turning, e.dot(&still) - held_at)
            }
            Line::Turning(e) => (still, e, e.dot(&turning) - held_at),
        };
        known.reach = known_j.reach_from(known_i) + turning.norm() + held_at.abs();
        known
    }

    /// Puts both bodies where they belong for an angle of a.
    #[inline(always)]
    fn put(&self, frames: &mut [BodyPose], known: &Known, first: BodyPose) {
        let first = BodyPose {
            origin: known.point.plus(-first.rotate(self.s)).point(),
            ..first
        };
        match &self.second {
            Second::None => {}
            Second::Carried { place, l, s, .. } => {
                let arm = first.rotate(*l) - known.second.rotate(*s);
                let origin = known.point.plus(arm).point();
                frames[*place as usize] = BodyPose {
                    origin,
                    ..known.second
                };
            }
            Second::Parallel { place, s, .. } => {
                let second = BodyPose::turned(first.phi + known.second_turn);
                frames[*place as usize] = BodyPose {
                    origin: known.second_point.plus(-second.rotate(*s)).point(),
                    ..second
                };
            }
        }
        frames[self.place as usize] = first;
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

    /// ḟ and f̈ for a resting angle of a, the slope making up for them.
    pub(super) fn solve_rates(&self, work: &mut Work<'_>, drivers: &[Jet]) {
        let frames = work.at.frames();
        let (velocity, acceleration) = work.flow.both_mut();
        let driver = |row: usize| match work.system.equations()[row].target {
            Target::Constant(_) => Jet::constant(0.0),
            Target::Driver(driver) => drivers[driver.index()],
        };
        let first = &frames[self.place as usize];
        let outer = self.anchor.rates(frames, velocity, acceleration);
        // Of b: its frame, the rates of its own angle where that is known, and its revolute.
        let (mut b, mut spin, mut pinned) = (first, Spin::default(), outer);
        let mut second = self.anchor.place(frames);
        if let Some(parts) = &self.parts.second {
            let held = driver(parts.row);
            match &self.second {
                Second::None => {}
                Second::Carried {
                    place, reference, ..
                } => {
                    b = &frames[*place as usize];
                    spin = Spin::of(*reference, velocity, acceleration);
                    spin.omega += parts.sense * held.first;
                    spin.alpha += parts.sense * held.second;
                }
                Second::Parallel { place, anchor, .. } => {
                    b = &frames[*place as usize];
                    pinned = anchor.rates(frames, velocity, acceleration);
                    second = anchor.place(frames);
                }
            }
        }
        // The known part of a point; what turns with a is left out.
        let still = |point: &Point| match *point {
            Point::Known(anchor) => {
                let moving = anchor.rates(frames, velocity, acceleration);
                (anchor.place(frames), moving)
            }
            Point::First(_) => (self.anchor.place(frames), outer),
            Point::Carried(arm) => {
                let arm = b.rotate(arm);
                let moving = spin.carry(outer, arm);
                (self.anchor.place(frames).plus(arm), moving)
            }
            Point::Parallel(_) => (second, pinned),
        };
        let (point_i, moving_i) = still(&self.points[0]);
        let (point_j, moving_j) = still(&self.points[1]);
        let d = point_j.from(point_i);
        let d_dot = moving_j.velocity - moving_i.velocity;
        let d_ddot = moving_j.acceleration - moving_i.acceleration;
        let target = driver(self.parts.row);
        let (omega, alpha) = match self.axis {
            Line::Turning(_) => {
                // g is the axis: f = g · d + constant.
                let omega = (target.first - self.g.dot(&d_dot)) / self.slope;
                let bias = self.g.dot(&d_ddot) + 2.0 * omega * perp(self.g).dot(&d_dot)
                    - omega * omega * self.g.dot(&d);
                (omega, (target.second - bias) / self.slope)
            }
            Line::Known(..) | Line::Carried(_) => {
                let (e, turn) = match self.axis {
                    Line::Known(body, e) => (
                        body.map_or(e, |body| frames[body].rotate(e)),
                        Spin::of(body, velocity, acceleration),
                    ),
                    Line::Carried(e) | Line::Turning(e) => (b.rotate(e), spin),
                };
                let e_dot = perp(e) * turn.omega;
                let e_ddot = perp(e) * turn.alpha - e * (turn.omega * turn.omega);
                let whole = d + self.g;
                let rate = e_dot.dot(&whole) + e.dot(&d_dot);
                let omega = (target.first - rate) / self.slope;
                let whole_dot = d_dot + perp(self.g) * omega;
                let bias = e_ddot.dot(&whole)
                    + 2.0 * e_dot.dot(&whole_dot)
                    + e.dot(&(d_ddot - self.g * (omega * omega)));
                (omega, (target.second - bias) / self.slope)
            }
        };
        let own = Spin { omega, alpha };
        let mut write = |place: usize, spin: Spin, moving: Moving, arm: Vector2<f64>| {
            let origin = spin.carry(moving, -arm);
            let (v, a) = (origin.velocity, origin.acceleration);
            velocity[3 * place..3 * place + 3].copy_from_slice(&[v.x, v.y, spin.omega]);
            acceleration[3 * place..3 * place + 3].copy_from_slice(&[a.x, a.y, spin.alpha]);
        };
        match &self.second {
            Second::None => {}
            Second::Carried { place, l, s, .. } => {
                let inner = own.carry(outer, first.rotate(*l));
                write(*place as usize, spin, inner, b.rotate(*s));
            }
            Second::Parallel { place, s, .. } => {
                write(*place as usize, own, pinned, b.rotate(*s));
            }
        }
        write(self.place as usize, own, outer, first.rotate(self.s));
    }

    /// |∂f/∂phi| over the largest that it can be, or over the mechanism's size.
    pub(super) fn rcond(&self) -> f64 {
        let rcond = self.slope.abs() / self.scale;
        if rcond.is_finite() { rcond } else { 0.0 }
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

    /// The angles of body a at which it closes, nearest the estimates first: the minima of
    /// Ec. 3.6.9 for r → ∞, which a circle and a line have in two places. Leaves the bodies
    /// anywhere.
    ///
    /// # Errors
    ///
    /// [`Miss`] if they do not reach each other.
    pub(in crate::kinematics) fn ways(
        &self,
        work: &mut Work<'_>,
        estimate: &[f64],
    ) -> Result<[f64; 2], Miss> {
        let known = self.known(work);
        let scale = known.w.norm() * known.g.norm();
        let miss = Miss::new(known.kappa.abs() - scale, known.reach + scale);
        let ratio = -known.kappa / scale;
        if miss.certain || ratio.is_nan() {
            return Err(miss);
        }
        let size = work.at.size();
        let middle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x);
        // A gap that no one could measure is left to the corrections.
        let away = ratio.clamp(-1.0, 1.0).acos();
        let guess = estimate[3 * self.place as usize + 2];
        let ways = [middle + away, middle - away].map(|angle| {
            let phi = angle + TAU * ((guess - angle) / TAU).round();
            self.put(work.at.frames_mut(), &known, BodyPose::turned(phi));
            let columns = self.parts.columns.iter();
            let distance = columns
                .map(|&column| {
                    let off = work.at.coordinate(column) - estimate[column];
                    (off / work.system.column_scale(column, size)).powi(2)
                })
                .sum::<f64>();
            (distance, phi)
        });
        // The first of two that are equally far.
        let [first, second] = ways;
        if second.0 < first.0 * (1.0 - 1e-9) {
            Ok([second.1, first.1])
        } else {
            Ok([first.1, second.1])
        }
    }

    /// Body a, whose angle is looked for.
    pub(in crate::kinematics) fn body(&self) -> usize {
        self.parts.body
    }

    /// Puts the bodies as near to closing as they come, where the point does not reach its line.
    pub(in crate::kinematics) fn stretch(&self, work: &mut Work<'_>, estimate: &[f64]) {
        let known = self.known(work);
        let away = if known.kappa > 0.0 { PI } else { 0.0 };
        let angle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x) + away;
        let guess = estimate[3 * self.place as usize + 2];
        let phi = angle + TAU * ((guess - angle) / TAU).round();
        self.put(work.at.frames_mut(), &known, BodyPose::turned(phi));
    }
}

/// Where Newton ended.
struct Found {
    known: Known,
    correction: Correction,
    /// What is left of f, at the most.
    open: f64,
}

/// First and second derivative of an angle.
#[derive(Clone, Copy, Debug, Default)]
struct Spin {
    omega: f64,
    alpha: f64,
}

impl Spin {
    /// That of a body, none for ground.
    fn of(body: Option<usize>, velocity: &[f64], acceleration: &[f64]) -> Self {
        body.map_or_else(Self::default, |body| Self {
            omega: velocity[3 * body + 2],
            alpha: acceleration[3 * body + 2],
        })
    }

    /// The rates of a point that is `arm` away from a moving one.
    fn carry(self, from: Moving, arm: Vector2<f64>) -> Moving {
        Moving {
            velocity: from.velocity + perp(arm) * self.omega,
            acceleration: from.acceleration + perp(arm) * self.alpha
                - arm * (self.omega * self.omega),
        }
    }
}
