//! The contour of a cam at its contact with a roller or a flat face.

use nalgebra::{Rotation2, Vector2};

use super::super::definition::Incidence;
use super::super::point::{angular_velocity, point_velocity};
use super::super::region::{Region, centripetal_bound};
use crate::kinematics::constraint::configuration::{
    Configuration, JointUnknownId, MarkerPose, ProfileId, perp,
};
use crate::kinematics::constraint::moving_configuration::{
    Moving, VariedMarker, VariedMechanism, quarter_turn, rotate,
};
use crate::mechanism::{
    Interval, Jet3, MarkerId, Mechanism, Number, ProfileBounds, ProfileInForce,
};

/// A follower nearer to the pole than this part of the radius is at it: estimates are rounded.
pub(super) const AT_THE_POLE: f64 = 1e-9;

/// A cam's contour with a contact on it.
#[derive(Clone, Copy, Debug)]
pub struct Contour {
    /// The cam's marker: its point is the pole, its x-axis the polar axis.
    pub cam: MarkerId,
    /// R(θ).
    pub profile: ProfileId,
    /// The polar angle θ of the contact \[rad\].
    pub contact: JointUnknownId,
}

/// A contour at one polar angle.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Shape {
    /// Vector from the pole to the contact \[m\].
    pub(in crate::kinematics) arm: Vector2<f64>,
    /// Unit tangent, counter-clockwise round the cam.
    pub(in crate::kinematics) tangent: Vector2<f64>,
    /// Arc length per angle, v = √(R² + R′²), and its derivative \[m/rad, m/rad²\].
    pub(in crate::kinematics) speed: [f64; 2],
    /// First and second derivative of the tangent's direction: v times the curvature, positive
    /// where the contour is convex.
    pub(in crate::kinematics) turn: [f64; 2],
}

/// Upper bounds of the magnitudes over the part of the contour in a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourBounds {
    pub(super) radius: f64,
    pub(super) speed: [f64; 2],
    pub(super) turn: [f64; 2],
    /// Bound of the change of the contact's polar angle \[rad\].
    pub(super) slide: f64,
    /// Bound of the change of the vector from the pole to the contact \[m\].
    pub(super) arm: f64,
    /// Bound of the turn of the tangent \[rad\].
    pub(super) tangent: f64,
    /// The same for places off the line of the region only.
    pub(super) off_line: [f64; 2],
    /// Bound of the jumps in the first derivative of the tangent's direction.
    pub(super) turn_jump: f64,
}

impl Contour {
    /// Returns the vector from the pole to the contour's point at the polar angle `theta`.
    pub(super) fn arm(cam: MarkerPose, theta: f64, radius: f64) -> Vector2<f64> {
        radius * (Rotation2::new(theta) * cam.axis)
    }

    /// Returns the outward normal at a tangent.
    pub(in crate::kinematics) fn normal(tangent: Vector2<f64>) -> Vector2<f64> {
        -perp(tangent)
    }

    /// Returns the contour at the polar angle `theta` from the polar axis `axis`.
    pub(in crate::kinematics) fn shape(
        profile: &ProfileInForce,
        theta: f64,
        axis: Vector2<f64>,
    ) -> Shape {
        let point = profile.point(theta);
        let global = |[x, y]: [f64; 2]| x * axis + y * perp(axis);
        Shape {
            arm: global(point.arm),
            tangent: global(point.tangent),
            speed: point.speed,
            turn: point.turn,
        }
    }

    /// Returns the cam's marker and the contour at the contact.
    pub(super) fn at(&self, at: &Configuration) -> (MarkerPose, Shape) {
        let cam = at.marker(self.cam);
        let theta = at.joint_unknown(self.contact);
        (cam, Self::shape(at.profile(self.profile), theta, cam.axis))
    }

    /// Returns the moving cam's marker, the vector from its point to the contact, and the tangent.
    pub(in crate::kinematics::constraint) fn along<N: Moving>(
        &self,
        at: &VariedMechanism<'_, '_, N>,
    ) -> (VariedMarker<N>, [N; 2], [N; 2]) {
        let cam = at.marker(self.cam);
        let theta = at.joint_unknown(self.contact);
        let [radius, slope] = at.radius(self.profile, theta);
        let radial = rotate(theta, cam.axis);
        let across = quarter_turn(radial);
        let speed = radius.hypot(slope);
        let arm = radial.map(|component| radius * component);
        let tangent = [0, 1].map(|k| (slope * radial[k] + radius * across[k]) / speed);
        (cam, arm, tangent)
    }

    /// Returns the index in q of the contact's polar angle.
    pub(super) fn column(&self, at: &Configuration) -> usize {
        at.joint_unknown_column(self.contact)
    }

    /// Returns the bounds in a region, `None` if the contour is not smooth there.
    pub(super) fn bounds(&self, at: &Configuration, region: &Region<'_>) -> Option<ContourBounds> {
        let theta = at.joint_unknown(self.contact);
        let slide = region.radius(self.column(at));
        let ProfileBounds { radius, jumps } = at.profile(self.profile).bounds(theta, slide)?;
        let lowest = radius.value.low;
        if lowest <= 0.0 {
            return None;
        }
        let turn_jump = if jumps { turn_change(radius) } else { 0.0 };
        let (r1, r2, r3) = (
            radius.first().magnitude(),
            radius.second().magnitude(),
            radius.third().magnitude(),
        );
        let radius = radius.value.magnitude();
        let square = radius * radius + r1 * r1;
        let least_square = lowest * lowest;
        let v = square.sqrt();
        let v1 = r1 * (radius + r2) / lowest;
        let turn = (square + r1 * r1 + radius * r2) / least_square;
        let numerator_rate = 2.0 * radius * r1 + 3.0 * r1 * r2 + radius * r3;
        let turn_rate = (numerator_rate + 2.0 * turn * r1 * (radius + r2)) / least_square;
        let cam = at.marker(self.cam);
        let changes = |region: &Region<'_>| {
            let slide = region.radius(self.column(at));
            [
                radius * region.sway(cam) + v * slide,
                region.turn(cam) + turn * slide,
            ]
        };
        let [arm, tangent] = changes(region);
        Some(ContourBounds {
            radius,
            speed: [v, v1],
            turn: [turn, turn_rate],
            slide,
            arm,
            tangent,
            off_line: changes(&region.off_line()),
            turn_jump,
        })
    }

    /// Bounds the turn of the tangent relative to the follower, or to ground if this does not
    /// turn `with` it, and the change of the vector from the contact to the follower's point, for a
    /// contact of this `shape`.
    ///
    /// On a line both change by the rates in its middle, whose terms cancel where the contact goes
    /// round the cam as this turns, and by an eighth of the bound of the second derivatives.
    pub(super) fn changes(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        bounds: &ContourBounds,
        (cam, shape): (MarkerPose, &Shape),
        (follower, with): (MarkerPose, bool),
    ) -> [f64; 2] {
        let anywhere = |region: &Region<'_>, [arm, tangent]: [f64; 2]| {
            let turn = if with { region.turn(follower) } else { 0.0 };
            [tangent + turn, region.reach(cam, follower) + arm]
        };
        let [turn, gap] = anywhere(region, [bounds.arm, bounds.tangent]);
        let Some(line) = region.line else {
            return [turn, gap];
        };
        let (omega, rate) = (angular_velocity(cam, line), line[self.column(at)]);
        let (arm, tangent) = shape.rates(omega, rate);
        let [_, arm_bend, _, turn_bend] = bounds.motion(omega, rate);
        let bend = centripetal_bound(cam, follower, line) + arm_bend;
        let swing = if with {
            angular_velocity(follower, line)
        } else {
            0.0
        };
        let velocity = point_velocity(follower, line) - point_velocity(cam, line) - arm;
        let turning = (tangent - swing).abs() + bounds.turn_jump * rate.abs();
        let [off_turn, off_gap] = anywhere(&region.off_line(), bounds.off_line);
        // Without a third derivative some of these are not finite.
        [
            turn.min(0.5 * turning + 0.125 * turn_bend + off_turn),
            gap.min(0.5 * velocity.norm() + 0.125 * bend + off_gap),
        ]
    }

    /// Notes the unknowns in the components of the contact's point that `components` selects, and
    /// in its tangent.
    pub(super) fn incidence(
        &self,
        mechanism: &Mechanism,
        components: [bool; 2],
        incidence: &mut Incidence,
    ) {
        incidence.point(mechanism, self.cam, components);
        incidence.direction(mechanism, self.cam);
        incidence.joint_unknown(mechanism, self.contact);
    }
}

/// Returns the width of the range of the first derivative of the tangent's direction,
/// (R² + 2R′² − R R″)/(R² + R′²).
fn turn_change(radius: Jet3<Interval>) -> f64 {
    let (r, r1, r2) = (radius.value, radius.first(), radius.second());
    let (r_square, r1_square) = (r.square(), r1.square());
    let turn = (r_square + r1_square * 2.0 - r * r2) / (r_square + r1_square);
    turn.high - turn.low
}

impl Shape {
    /// Returns the outward normal.
    pub(super) fn normal(&self) -> Vector2<f64> {
        Contour::normal(self.tangent)
    }

    /// Returns the velocity of the contact relative to the pole and the rate of the tangent's direction
    /// on a cam that turns at `omega`: the derivative of the contact with respect to θ is v times the
    /// tangent, that of the tangent's direction `turn`.
    fn rates(&self, omega: f64, contact_rate: f64) -> (Vector2<f64>, f64) {
        let slip = self.speed[0] * contact_rate * self.tangent;
        (
            omega * perp(self.arm) + slip,
            omega + self.turn[0] * contact_rate,
        )
    }
}

impl ContourBounds {
    /// Bounds the magnitudes of velocity and acceleration of the contact relative to the pole, then of
    /// first and second derivative of the tangent's direction, for q̈ = 0.
    pub(super) fn motion(&self, omega: f64, contact_rate: f64) -> [f64; 4] {
        let (omega, contact_rate) = (omega.abs(), contact_rate.abs());
        let ([v, v1], [turn, turn_rate]) = (self.speed, self.turn);
        [
            omega * self.radius + v * contact_rate,
            omega * omega * self.radius
                + 2.0 * omega * v * contact_rate
                + contact_rate * contact_rate * (v1 + v * turn),
            omega + turn * contact_rate,
            turn_rate * contact_rate * contact_rate,
        ]
    }
}
