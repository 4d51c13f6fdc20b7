//! The equation in the angle of a, and the poses of the bodies for an angle.

use nalgebra::Vector2;

use super::{Line, Point, RrpDyad, Second};
use crate::kinematics::constraint::configuration::BodyPose;
use crate::kinematics::plan::anchor::SplitPoint;
use crate::kinematics::plan::step::BlockState;

/// The numbers that are known before the angle of a.
pub(super) struct Known {
    /// The revolute of a.
    pub(super) point: SplitPoint,
    /// The frame of b without its origin if that depends on the angle; ground if there is no b.
    pub(super) second: BodyPose,
    /// Revolute of a parallel b, and its angle from a.
    pub(super) second_point: SplitPoint,
    pub(super) second_turn: f64,
    /// The known part of P_j − P_i.
    pub(super) still: Vector2<f64>,
    pub(super) w: Vector2<f64>,
    /// g in a's frame.
    pub(super) g: Vector2<f64>,
    pub(super) kappa: f64,
    /// Magnitude of the numbers in f besides the angle: its rounding is some eps of it.
    pub(super) reach: f64,
}

impl RrpDyad {
    /// Gathers the known numbers.
    #[inline(always)]
    pub(super) fn known(&self, state: &BlockState<'_>) -> Known {
        let frames = state.at.frames();
        let point = self.anchor.split_point(frames);
        let target = |row: usize| state.system.target(row, state.targets, state.drivers);
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
                    known.second_point = anchor.split_point(frames);
                    known.second_turn = held(b.sense, b.row) + zero;
                }
            }
        }
        let part = |point: &Point| match *point {
            Point::Known(anchor) => (anchor.split_point(frames), Vector2::zeros()),
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

    /// Puts both bodies at their poses for an angle of a.
    #[inline(always)]
    pub(super) fn put(&self, frames: &mut [BodyPose], known: &Known, first: BodyPose) {
        let first = BodyPose {
            origin: known.point.plus(-first.rotate(self.s)).point(),
            ..first
        };
        match &self.second {
            Second::None => {}
            Second::Carried { body, l, s, .. } => {
                let arm = first.rotate(*l) - known.second.rotate(*s);
                let origin = known.point.plus(arm).point();
                frames[*body as usize] = BodyPose {
                    origin,
                    ..known.second
                };
            }
            Second::Parallel { body, s, .. } => {
                let second = BodyPose::turned(first.phi + known.second_turn);
                frames[*body as usize] = BodyPose {
                    origin: known.second_point.plus(-second.rotate(*s)).point(),
                    ..second
                };
            }
        }
        frames[self.body as usize] = first;
    }
}
