//! A knife-edge follower.

use nalgebra::Vector2;

use super::super::definition::{Constraint, Dimension, Formula, Incidence};
use super::super::gradient::Gradient;
use super::super::point::angular_velocity;
use super::super::region::{Region, centripetal_bound, chord, speed_bound};
use crate::kinematics::constraint::configuration::{Configuration, ProfileId, perp};
use crate::kinematics::constraint::moving_configuration::{
    Moving, VariedMechanism, direction, subtract,
};
use crate::mechanism::{Jet3, MarkerId, Mechanism};

/// c = ρ − R(θ) with the polar coordinates ρ and θ of the edge in the cam marker's frame.
///
/// It is not smooth where the edge is at the pole; there the gradient is taken along the x-axis.
#[derive(Clone, Copy, Debug)]
pub struct KnifeEdge {
    /// The cam's marker: its point is the pole, its x-axis the polar axis.
    pub cam: MarkerId,
    /// The marker at the edge.
    pub follower: MarkerId,
    /// R(θ).
    pub profile: ProfileId,
}

/// The edge in polar coordinates, and the contour there.
struct Polar {
    distance: f64,
    /// Unit vector from the pole to the edge.
    radial: Vector2<f64>,
    /// θ \[rad\].
    angle: f64,
    /// R and its derivatives at θ.
    contour: Jet3,
}

impl Polar {
    /// Returns the derivative of c with respect to the edge's point: radial − R′/ρ across.
    fn direction(&self) -> Vector2<f64> {
        self.radial - self.steepness() * perp(self.radial)
    }

    /// Returns R′/ρ.
    fn steepness(&self) -> f64 {
        if self.distance > 0.0 {
            self.contour.first() / self.distance
        } else {
            0.0
        }
    }
}

impl KnifeEdge {
    fn polar(&self, at: &Configuration) -> Polar {
        let (cam, follower) = (at.marker(self.cam), at.marker(self.follower));
        let d = follower.point - cam.point;
        let distance = d.norm();
        let radial = if distance > 0.0 {
            d / distance
        } else {
            Vector2::x()
        };
        let angle = cam.axis.perp(&radial).atan2(cam.axis.dot(&radial));
        Polar {
            distance,
            radial,
            angle,
            contour: at.profile(self.profile).radius(angle),
        }
    }
}

/// Returns the angle of a point that may pass the half-line on which `atan2` jumps: an enclosed
/// point is turned away from there.
fn angle<N: Moving>(x: N, y: N) -> N {
    if !y.angle_jumps(x) {
        return y.atan2(x);
    }
    let turn = y.real().atan2(x.real());
    let [cos, sin] = direction(N::constant(turn));
    (cos * y - sin * x).atan2(cos * x + sin * y) + N::constant(turn)
}

impl Formula for KnifeEdge {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let cam = at.marker(self.cam);
        let [x, y] = subtract(at.point(self.follower), cam.point);
        let theta = angle(x, y) - cam.theta;
        let [radius, _] = at.radius(self.profile, theta);
        x.hypot(y) - radius
    }
}

impl Constraint for KnifeEdge {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let polar = self.polar(at);
        polar.distance - polar.contour.value
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let polar = self.polar(at);
        let direction = polar.direction();
        row.add_point(at.marker(self.follower), direction);
        row.add_point(at.marker(self.cam), -direction);
        row.add_direction(at.marker(self.cam), polar.contour.first());
        polar.distance - polar.contour.value
    }

    /// Bounds each factor in the terms of gradient and quadratic term: ρ shrinks by at most the
    /// reach of both points, and the radial direction turns by at most asin(reach/ρ).
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let polar = self.polar(at);
        let (cam, follower) = (at.marker(self.cam), at.marker(self.follower));
        let reach = region.reach(cam, follower);
        if reach >= polar.distance {
            return None;
        }
        let least = polar.distance - reach;
        let swung = (reach / polar.distance).asin();
        let off = swung + region.turn(cam);
        let radius = at.profile(self.profile).bounds(polar.angle, off)?.radius;
        let (r1, r2) = (radius.first().magnitude(), radius.second().magnitude());

        let steepness = polar.steepness().abs();
        let steepened = (r2 * off + steepness * reach) / least;
        let direction = chord(swung) * (1.0 + steepness) + steepened;
        let longest = polar.direction().norm() + direction;
        for marker in [follower, cam] {
            let swing = marker.arm.norm() * (direction + longest * region.sway(marker));
            row.add_point_bound(marker, direction, swing);
        }
        row.add_direction(cam, r2 * off);

        let speed = speed_bound(cam, follower, v);
        let bend = centripetal_bound(cam, follower, v);
        let swing = speed / least;
        let rate = swing + angular_velocity(cam, v).abs();
        let angular = (bend + 2.0 * speed * swing) / least;
        Some(speed * swing + bend + r2 * rate * rate + r1 * angular)
    }

    fn has_given_function(&self) -> bool {
        true
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.point(mechanism, self.cam, [true, true]);
        incidence.direction(mechanism, self.cam);
        incidence.point(mechanism, self.follower, [true, true]);
    }
}
