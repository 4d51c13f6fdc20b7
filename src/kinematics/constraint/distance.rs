//! The distance between two points.

use nalgebra::Vector2;

use super::configuration::Configuration;
use super::definition::{Constraint, Dimension, Formula, Incidence};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism, subtract};
use super::point::{centripetal, point_velocity};
use super::region::{Region, centripetal_bound, chord, speed_bound};
use crate::mechanism::{MarkerId, Mechanism};

/// c = ‖P_j − P_i‖.
///
/// It is not smooth where the points coincide. There the gradient is taken along the x-axis, so
/// that an assembly can move coincident points apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Distance {
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
}

impl Distance {
    /// Returns the vector from i to j, its length and its direction.
    fn span(&self, at: &Configuration) -> (f64, Vector2<f64>) {
        let d = at.marker(self.to).point - at.marker(self.from).point;
        let length = d.norm();
        if length > 0.0 {
            (length, d / length)
        } else {
            (0.0, Vector2::x())
        }
    }
}

impl Formula for Distance {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let [x, y] = subtract(at.point(self.to), at.point(self.from));
        x.hypot(y)
    }
}

impl Constraint for Distance {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        self.span(at).0
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let (length, e) = self.span(at);
        row.add_point(at.marker(self.to), e);
        row.add_point(at.marker(self.from), -e);
        length
    }

    /// Returns (|ḋ|² − (e · ḋ)²) / ‖d‖ + e · d̈ with e = d / ‖d‖.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64 {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        let (length, e) = self.span(at);
        let d_dot = point_velocity(j, q_dot) - point_velocity(i, q_dot);
        let d_ddot = centripetal(j, q_dot) - centripetal(i, q_dot);
        // The square of the component of ḋ across e, without cancellation.
        let across = e.perp(&d_dot);
        across * across / length + e.dot(&d_ddot)
    }

    fn admits(&self, value: f64) -> bool {
        value > 0.0
    }

    /// Bounds the turn of d by asin(reach / ‖d‖):
    /// |c″| ≤ |ḋ|² / (‖d‖ − reach) + omega_i² |s_i| + omega_j² |s_j|.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        let (length, _) = self.span(at);
        let reach = region.reach(i, j);
        if reach >= length {
            return None;
        }
        let direction = chord((reach / length).asin());
        for marker in [i, j] {
            let swing = marker.arm.norm() * (direction + region.sway(marker));
            row.add_point_bound(marker, direction, swing);
        }
        let speed = speed_bound(i, j, v);
        Some(speed * speed / (length - reach) + centripetal_bound(i, j, v))
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.point(mechanism, self.from, [true, true]);
        incidence.point(mechanism, self.to, [true, true]);
    }
}
