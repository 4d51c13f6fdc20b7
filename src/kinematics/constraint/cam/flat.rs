//! A flat-faced follower.

use nalgebra::Vector2;

use super::super::definition::{
    Axis, Constraint, Dimension, Formula, Incidence, JointUnknown, axis_components,
};
use super::super::gradient::Gradient;
use super::super::point::angular_velocity;
use super::super::region::{Region, centripetal_bound, speed_bound};
use super::contour::{AT_THE_POLE, Contour, Shape};
use crate::kinematics::constraint::configuration::{Configuration, MarkerPose, perp};
use crate::kinematics::constraint::moving_configuration::{
    Moving, VariedMechanism, add, dot, quarter_turn, subtract,
};
use crate::mechanism::{MarkerId, Mechanism};

/// The contour's tangent is parallel to the face: c = sin δ with the angle δ from the face, the
/// x-axis of the follower's marker, to the tangent at the contact. Its target is zero.
///
/// The sine does not tell on which side of the face the cam is; the estimates decide.
#[derive(Clone, Copy, Debug)]
pub struct FlatContact {
    /// The cam's contour.
    pub contour: Contour,
    /// The marker whose x-axis is the face.
    pub follower: MarkerId,
}

/// The contact lies in the face: c = n · g with the y-axis n of the follower's marker and the
/// vector g from that marker to the contact. Its target is zero.
#[derive(Clone, Copy, Debug)]
pub struct FlatFace {
    /// The cam's contour.
    pub contour: Contour,
    /// The marker whose x-axis is the face.
    pub follower: MarkerId,
}

/// Returns sine and cosine of δ.
fn lean(follower: MarkerPose, contact: &Shape) -> (f64, f64) {
    (
        follower.axis.perp(&contact.tangent),
        follower.axis.dot(&contact.tangent),
    )
}

impl Formula for FlatContact {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let (_, _, [x, y]) = self.contour.along(at);
        let face = at.marker(self.follower).axis;
        face[0] * y - face[1] * x
    }
}

impl Constraint for FlatContact {
    fn dimension(&self) -> Dimension {
        Dimension::Angle
    }

    fn value(&self, at: &Configuration) -> f64 {
        lean(at.marker(self.follower), &self.contour.at(at).1).0
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let follower = at.marker(self.follower);
        let (cam, contact) = self.contour.at(at);
        let (sine, cosine) = lean(follower, &contact);
        row.add_direction(cam, cosine);
        row.add_direction(follower, -cosine);
        row.add_joint_unknown(self.contour.column(at), cosine * contact.turn[0]);
        sine
    }

    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let follower = at.marker(self.follower);
        let (cam, contact) = self.contour.at(at);
        let (sine, _) = lean(follower, &contact);
        let bounds = self.contour.bounds(at, region)?;
        // |cos(δ + a) − cos δ| ≤ |sin δ| |a| + a²/2, at most two; of second order while the contour
        // touches the face.
        let pair = ((cam, &contact), (follower, true));
        let [angle, _] = self.contour.changes(at, region, &bounds, pair.0, pair.1);
        let cosine = (sine.abs() * angle + 0.5 * angle * angle).min(2.0);
        row.add_direction(cam, cosine);
        row.add_direction(follower, cosine);
        let column = self.contour.column(at);
        let turn =
            contact.turn[0].abs() * cosine + bounds.turn[1] * bounds.slide + bounds.turn_jump;
        row.add_joint_unknown(column, turn);
        let [_, _, rate, bend] = bounds.motion(angular_velocity(cam, v), v[column]);
        let rate = rate + angular_velocity(follower, v).abs();
        // A jump of the slope bends a chord as much as twice its size in second derivatives.
        let jump = 2.0 * bounds.turn_jump * v[column].abs();
        Some(bend + rate * rate + jump)
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.direction(mechanism, self.contour.cam);
        incidence.direction(mechanism, self.follower);
        incidence.joint_unknown(mechanism, self.contour.contact);
    }
}

/// The face at one pose.
struct Face {
    cam: MarkerPose,
    follower: MarkerPose,
    contact: Shape,
    /// Vector from the follower's marker to the contact.
    g: Vector2<f64>,
    normal: Vector2<f64>,
}

impl FlatFace {
    fn face(&self, at: &Configuration) -> Face {
        let (cam, contact) = self.contour.at(at);
        let follower = at.marker(self.follower);
        Face {
            cam,
            follower,
            g: cam.point + contact.arm - follower.point,
            normal: perp(follower.axis),
            contact,
        }
    }
}

impl Formula for FlatFace {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let (cam, arm, _) = self.contour.along(at);
        let follower = at.marker(self.follower);
        let g = subtract(add(cam.point, arm), follower.point);
        dot(g, quarter_turn(follower.axis))
    }
}

impl Constraint for FlatFace {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let face = self.face(at);
        face.g.dot(&face.normal)
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let Face {
            cam,
            follower,
            contact,
            g,
            normal,
        } = self.face(at);
        row.add_point(cam, normal);
        row.add_point(follower, -normal);
        row.add_direction(cam, perp(contact.arm).dot(&normal));
        row.add_direction(follower, -g.dot(&follower.axis));
        let along = contact.speed[0] * contact.tangent.dot(&normal);
        row.add_joint_unknown(self.contour.column(at), along);
        g.dot(&normal)
    }

    /// Bounds each factor in the terms of gradient and quadratic term.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let Face {
            cam,
            follower,
            contact,
            g,
            ..
        } = self.face(at);
        let bounds = self.contour.bounds(at, region)?;
        let sway = region.sway(follower);
        for marker in [cam, follower] {
            let swing = marker.arm.norm() * (sway + region.sway(marker));
            row.add_point_bound(marker, sway, swing);
        }
        let pair = ((cam, &contact), (follower, true));
        let [turn, moved] = self.contour.changes(at, region, &bounds, pair.0, pair.1);
        row.add_direction(cam, bounds.arm + contact.arm.norm() * sway);
        row.add_direction(follower, moved + g.norm() * sway);
        let column = self.contour.column(at);
        let leaned = turn.min(2.0);
        let along = bounds.speed[1] * bounds.slide + contact.speed[0] * leaned;
        row.add_joint_unknown(column, along);

        let omega = angular_velocity(follower, v).abs();
        let [arm_speed, arm_bend, ..] = bounds.motion(angular_velocity(cam, v), v[column]);
        let speed = speed_bound(cam, follower, v) + arm_speed;
        let bend = centripetal_bound(cam, follower, v) + arm_bend;
        Some(bend + 2.0 * omega * speed + omega * omega * (g.norm() + moved))
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        let components = axis_components(mechanism, self.follower, Axis::Y);
        self.contour.incidence(mechanism, components, incidence);
        incidence.point(mechanism, self.follower, components);
        incidence.direction(mechanism, self.follower);
    }
}

impl JointUnknown for FlatContact {
    /// Returns the polar angle of the contour's point that is farthest towards the face. A face
    /// through the pole is on the side to which its normal points.
    fn estimate(&self, at: &Configuration) -> f64 {
        let (cam, follower) = (at.marker(self.contour.cam), at.marker(self.follower));
        let normal = perp(follower.axis);
        let side = normal.dot(&(follower.point - cam.point));
        let profile = at.profile(self.contour.profile);
        let towards = if side < -AT_THE_POLE * profile.radius(0.0).value {
            -normal
        } else {
            normal
        };
        profile.angle_of_least(|theta, radius| -Contour::arm(cam, theta, radius).dot(&towards))
    }
}
