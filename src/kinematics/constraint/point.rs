//! Velocities and accelerations of markers' points.

use nalgebra::Vector2;

use super::configuration::{MarkerPose, perp};

/// Returns the velocity of a marker's point: ṙ + omega perp(A s).
#[must_use]
pub fn point_velocity(marker: MarkerPose, q_dot: &[f64]) -> Vector2<f64> {
    marker.body.map_or_else(Vector2::zeros, |body| {
        let k = 3 * body.index();
        Vector2::new(q_dot[k], q_dot[k + 1]) + q_dot[k + 2] * perp(marker.arm)
    })
}

/// Returns the acceleration of a marker's point: r̈ + alpha perp(A s) − omega² A s.
#[must_use]
pub fn point_acceleration(marker: MarkerPose, q_dot: &[f64], q_ddot: &[f64]) -> Vector2<f64> {
    point_velocity(marker, q_ddot) + centripetal(marker, q_dot)
}

/// Returns the acceleration of a marker's point for q̈ = 0: −omega² A s.
pub(super) fn centripetal(marker: MarkerPose, q_dot: &[f64]) -> Vector2<f64> {
    let omega = angular_velocity(marker, q_dot);
    -omega * omega * marker.arm
}

pub(super) fn angular_velocity(marker: MarkerPose, q_dot: &[f64]) -> f64 {
    marker.body.map_or(0.0, |body| q_dot[3 * body.index() + 2])
}
