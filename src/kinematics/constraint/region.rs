//! Bounds of points and directions in a neighbourhood of a pose.

use nalgebra::Vector2;

use super::point::angular_velocity;
use crate::kinematics::configuration::MarkerPose;

/// A neighbourhood of a pose: each unknown differs from the pose by at most its radius.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// One radius per unknown: \[m, m, rad\] for each body, then the joint unknowns.
    pub radii: &'a [f64],
}

impl Region<'_> {
    /// Returns the largest turn of a marker \[rad\].
    pub(super) fn turn(&self, marker: MarkerPose) -> f64 {
        marker
            .body
            .map_or(0.0, |body| self.radii[3 * body.index() + 2])
    }

    /// Returns the largest move of a unit vector fixed to a marker's body: the chord of the turn.
    pub(super) fn sway(&self, marker: MarkerPose) -> f64 {
        chord(self.turn(marker))
    }

    /// Returns a bound of the move of a marker's point \[m\].
    pub(super) fn reach(&self, marker: MarkerPose) -> f64 {
        marker.body.map_or(0.0, |body| {
            let k = 3 * body.index();
            self.radii[k].hypot(self.radii[k + 1]) + marker.arm.norm() * self.sway(marker)
        })
    }
}

/// Returns the chord of an angle on the unit circle, at most two.
pub(super) fn chord(angle: f64) -> f64 {
    if angle < std::f64::consts::PI {
        2.0 * (0.5 * angle).sin()
    } else {
        2.0
    }
}

/// Returns an upper bound of the speed of one marker's point relative to the point of another for
/// the rates `v`, at any angles of their bodies.
pub(super) fn speed_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let origin = |marker: MarkerPose| {
        marker.body.map_or_else(Vector2::zeros, |body| {
            let k = 3 * body.index();
            Vector2::new(v[k], v[k + 1])
        })
    };
    let swing = |marker: MarkerPose| angular_velocity(marker, v).abs() * marker.arm.norm();
    (origin(to) - origin(from)).norm() + swing(to) + swing(from)
}

/// Returns an upper bound of the centripetal acceleration of P_j − P_i for the rates `v`.
pub(super) fn centripetal_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let part = |marker: MarkerPose| angular_velocity(marker, v).powi(2) * marker.arm.norm();
    part(from) + part(to)
}
