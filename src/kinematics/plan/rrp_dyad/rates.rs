//! Velocities and accelerations of the block.

use nalgebra::Vector2;

use super::{Line, Point, RrpDyad, Second};
use crate::kinematics::constraint::configuration::perp;
use crate::kinematics::plan::anchor::Moving;
use crate::kinematics::plan::step::BlockState;
use crate::mechanism::Jet;

impl RrpDyad {
    /// Solves omega and alpha of body a from ḟ = 0 and f̈ = 0, and writes the rates of both bodies.
    pub(super) fn solve_angles(&self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        let frames = state.at.frames();
        let (velocity, acceleration) = state.tangent.both_mut();
        let driver = |row: usize| state.system.equations()[row].target_rates(drivers);
        let first = &frames[self.body as usize];
        let outer = self.anchor.rates(frames, velocity, acceleration);
        // The frame of b, the rates of its angle where that is known, and its revolute.
        let (mut b, mut spin, mut pinned) = (first, Spin::default(), outer);
        let mut second = self.anchor.split_point(frames);
        if let Some(parts) = &self.parts.second {
            let held = driver(parts.row);
            match &self.second {
                Second::None => {}
                Second::Carried {
                    body, reference, ..
                } => {
                    b = &frames[*body as usize];
                    spin = Spin::of(*reference, velocity, acceleration);
                    spin.omega += parts.sense * held.first();
                    spin.alpha += parts.sense * held.second();
                }
                Second::Parallel { body, anchor, .. } => {
                    b = &frames[*body as usize];
                    pinned = anchor.rates(frames, velocity, acceleration);
                    second = anchor.split_point(frames);
                }
            }
        }
        // The known part of a point, without the part that turns with a.
        let still = |point: &Point| match *point {
            Point::Known(anchor) => {
                let moving = anchor.rates(frames, velocity, acceleration);
                (anchor.split_point(frames), moving)
            }
            Point::First(_) => (self.anchor.split_point(frames), outer),
            Point::Carried(arm) => {
                let arm = b.rotate(arm);
                let moving = spin.carry(outer, arm);
                (self.anchor.split_point(frames).plus(arm), moving)
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
                let omega = (target.first() - self.g.dot(&d_dot)) / self.slope;
                let bias = self.g.dot(&d_ddot) + 2.0 * omega * perp(self.g).dot(&d_dot)
                    - omega * omega * self.g.dot(&d);
                (omega, (target.second() - bias) / self.slope)
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
                let omega = (target.first() - rate) / self.slope;
                let whole_dot = d_dot + perp(self.g) * omega;
                let bias = e_ddot.dot(&whole)
                    + 2.0 * e_dot.dot(&whole_dot)
                    + e.dot(&(d_ddot - self.g * (omega * omega)));
                (omega, (target.second() - bias) / self.slope)
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
            Second::Carried { body, l, s, .. } => {
                let inner = own.carry(outer, first.rotate(*l));
                write(*body as usize, spin, inner, b.rotate(*s));
            }
            Second::Parallel { body, s, .. } => {
                write(*body as usize, own, pinned, b.rotate(*s));
            }
        }
        write(self.body as usize, own, outer, first.rotate(self.s));
    }
}

/// First and second derivative of an angle.
#[derive(Clone, Copy, Debug, Default)]
struct Spin {
    omega: f64,
    alpha: f64,
}

impl Spin {
    /// Returns the spin of a body, zero for ground.
    fn of(body: Option<usize>, velocity: &[f64], acceleration: &[f64]) -> Self {
        body.map_or_else(Self::default, |body| Self {
            omega: velocity[3 * body + 2],
            alpha: acceleration[3 * body + 2],
        })
    }

    /// Returns the rates of a point at the distance `arm` from a moving point.
    fn carry(self, from: Moving, arm: Vector2<f64>) -> Moving {
        Moving {
            velocity: from.velocity + perp(arm) * self.omega,
            acceleration: from.acceleration + perp(arm) * self.alpha
                - arm * (self.omega * self.omega),
        }
    }
}
