//! Bounds of points and directions in a neighbourhood of a pose.

use nalgebra::Vector2;

use super::configuration::MarkerPose;
use super::point::angular_velocity;

/// A neighbourhood of a pose: each unknown differs by at most its radius from the pose, or else
/// from one place, the same for all unknowns, on a line through it.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// One radius per unknown: \[m, m, rad\] for each body, then the joint unknowns.
    pub radii: &'a [f64],
    /// The line from one end to the other, with the pose in its middle.
    pub line: Option<&'a [f64]>,
}

impl<'a> Region<'a> {
    /// Makes the region of these radii around the pose.
    pub fn around(radii: &'a [f64]) -> Self {
        Self { radii, line: None }
    }

    /// Returns the region of the same radii around the pose alone.
    pub(super) fn off_line(self) -> Self {
        Self::around(self.radii)
    }

    /// Returns the largest change of an unknown.
    pub(super) fn radius(&self, column: usize) -> f64 {
        let half = self.line.map_or(0.0, |line| 0.5 * line[column].abs());
        self.radii[column] + half
    }

    /// Returns the largest turn of a marker \[rad\].
    pub(super) fn turn(&self, marker: MarkerPose) -> f64 {
        marker
            .body
            .map_or(0.0, |body| self.radius(3 * body.index() + 2))
    }

    /// Returns the largest move of a unit vector fixed to a marker's body: the chord of the turn.
    pub(super) fn sway(&self, marker: MarkerPose) -> f64 {
        chord(self.turn(marker))
    }

    /// Returns a bound of the move of one marker's point relative to the point of another \[m\].
    pub(super) fn reach(&self, from: MarkerPose, to: MarkerPose) -> f64 {
        let mut origins = of_origin(self.radii, from) + of_origin(self.radii, to);
        if let Some(line) = self.line {
            origins += 0.5 * (of_origin(line, to) - of_origin(line, from)).abs();
        }
        let swing = |marker: MarkerPose| marker.arm.norm() * self.sway(marker);
        origins.norm() + swing(from) + swing(to)
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

/// Returns the x and y of a marker's body in a list with an entry per unknown, zero for ground.
fn of_origin(list: &[f64], marker: MarkerPose) -> Vector2<f64> {
    marker.body.map_or_else(Vector2::zeros, |body| {
        let k = 3 * body.index();
        Vector2::new(list[k], list[k + 1])
    })
}

/// Returns an upper bound of the speed of one marker's point relative to the point of another for
/// the rates `v`, at any angles of their bodies.
pub(super) fn speed_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let swing = |marker: MarkerPose| angular_velocity(marker, v).abs() * marker.arm.norm();
    (of_origin(v, to) - of_origin(v, from)).norm() + swing(to) + swing(from)
}

/// Returns an upper bound of the centripetal acceleration of P_j − P_i for the rates `v`.
pub(super) fn centripetal_bound(from: MarkerPose, to: MarkerPose, v: &[f64]) -> f64 {
    let part = |marker: MarkerPose| angular_velocity(marker, v).powi(2) * marker.arm.norm();
    part(from) + part(to)
}
