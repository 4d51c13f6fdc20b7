//! A roller follower.

use nalgebra::Vector2;

use super::super::definition::{Axis, Constraint, Dimension, Formula, Incidence, JointUnknown};
use super::super::gradient::Gradient;
use super::super::point::angular_velocity;
use super::super::region::{Region, centripetal_bound, chord, speed_bound};
use super::contour::{AT_THE_POLE, Contour, Shape};
use crate::kinematics::constraint::configuration::{Configuration, MarkerPose, perp};
use crate::kinematics::constraint::moving_configuration::{
    Moving, VariedMechanism, add, dot, quarter_turn, subtract,
};
use crate::mechanism::{MarkerId, Mechanism};

/// c = e · w with the vector e from the contact to the roller's centre, and the contour's tangent
/// (axis X) or outward normal (axis Y) w at the contact. The target is zero for the tangent, the
/// roller's radius for the normal.
#[derive(Clone, Copy, Debug)]
pub struct Roller {
    /// The cam's contour.
    pub contour: Contour,
    /// The marker at the roller's centre.
    pub follower: MarkerId,
    /// The axis of the contact's frame.
    pub axis: Axis,
}

/// The contact of a roller, for assembly.
#[derive(Clone, Copy, Debug)]
pub struct RollerContact {
    /// The cam's contour.
    pub contour: Contour,
    /// The marker at the roller's centre.
    pub follower: MarkerId,
}

/// The contact at one pose.
struct Touch {
    cam: MarkerPose,
    follower: MarkerPose,
    contact: Shape,
    /// Vector from the contact to the roller's centre.
    e: Vector2<f64>,
    w: Vector2<f64>,
    /// w turned by a quarter turn.
    across: Vector2<f64>,
}

impl Roller {
    fn touch(&self, at: &Configuration) -> Touch {
        let (cam, contact) = self.contour.at(at);
        let follower = at.marker(self.follower);
        let w = match self.axis {
            Axis::X => contact.tangent,
            Axis::Y => contact.normal(),
        };
        Touch {
            cam,
            follower,
            e: follower.point - cam.point - contact.arm,
            w,
            across: perp(w),
            contact,
        }
    }
}

impl Formula for Roller {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let (cam, arm, tangent) = self.contour.along(at);
        let centre = at.point(self.follower);
        let e = subtract(centre, add(cam.point, arm));
        match self.axis {
            Axis::X => dot(e, tangent),
            // The outward normal is a quarter turn back.
            Axis::Y => -dot(e, quarter_turn(tangent)),
        }
    }
}

impl Constraint for Roller {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let touch = self.touch(at);
        touch.e.dot(&touch.w)
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let Touch {
            cam,
            follower,
            contact,
            e,
            w,
            across,
        } = self.touch(at);
        row.add_point(follower, w);
        row.add_point(cam, -w);
        row.add_direction(cam, e.dot(&across) - perp(contact.arm).dot(&w));
        let along = e.dot(&across) * contact.turn[0] - contact.speed[0] * contact.tangent.dot(&w);
        row.add_joint_unknown(self.contour.column(at), along);
        e.dot(&w)
    }

    /// Returns whether a roller's radius is positive.
    fn admits(&self, value: f64) -> bool {
        match self.axis {
            Axis::X => true,
            Axis::Y => value > 0.0,
        }
    }

    /// Bounds each factor in the terms of gradient and quadratic term.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let Touch {
            cam,
            follower,
            contact,
            e,
            ..
        } = self.touch(at);
        let bounds = self.contour.bounds(at, region)?;
        let pair = ((cam, &contact), (follower, false));
        let [turn, moved] = self.contour.changes(at, region, &bounds, pair.0, pair.1);
        let turned = chord(turn);
        for marker in [follower, cam] {
            let swing = marker.arm.norm() * (turned + region.sway(marker));
            row.add_point_bound(marker, turned, swing);
        }
        let e_change = moved + e.norm() * turned;
        let arm_change = bounds.arm + contact.arm.norm() * turned;
        row.add_direction(cam, e_change + arm_change);
        let furthest = e.norm() + moved;
        let along = bounds.speed[1] * bounds.slide
            + (bounds.turn[1] * bounds.slide + bounds.turn_jump) * furthest
            + contact.turn[0].abs() * e_change;
        row.add_joint_unknown(self.contour.column(at), along);

        let omega = angular_velocity(cam, v);
        let [arm_speed, arm_bend, turn, turn_rate] =
            bounds.motion(omega, v[self.contour.column(at)]);
        let speed = speed_bound(cam, follower, v) + arm_speed;
        let bend = centripetal_bound(cam, follower, v) + arm_bend;
        // A jump of the slope bends a chord as much as twice its size in second derivatives.
        let jump = 2.0 * bounds.turn_jump * v[self.contour.column(at)].abs();
        Some(bend + 2.0 * turn * speed + (turn_rate + turn * turn + jump) * furthest)
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        self.contour.incidence(mechanism, [true, true], incidence);
        incidence.point(mechanism, self.follower, [true, true]);
    }
}

impl JointUnknown for RollerContact {
    /// Returns the polar angle of the contour's point that is nearest the roller's centre. For a
    /// centre inside the contour it is the centre's own polar angle, zero at the pole.
    fn estimate(&self, at: &Configuration) -> f64 {
        let cam = at.marker(self.contour.cam);
        let centre = at.marker(self.follower).point - cam.point;
        let profile = at.profile(self.contour.profile);
        if centre.norm() <= AT_THE_POLE * profile.radius(0.0).value {
            return 0.0;
        }
        let direction = cam.axis.perp(&centre).atan2(cam.axis.dot(&centre));
        if centre.norm() < profile.radius(direction).value {
            return direction;
        }
        profile.angle_of_least(|theta, radius| (Contour::arm(cam, theta, radius) - centre).norm())
    }
}
