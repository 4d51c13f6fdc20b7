//! The position of one marker on the axes of another.

use nalgebra::Vector2;

use super::configuration::{Configuration, perp};
use super::definition::{
    Axis, Constraint, Dimension, Formula, Incidence, axis_components, is_origin_or_ground,
};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism, dot, subtract};
use super::point::{angular_velocity, centripetal, point_velocity};
use super::region::{Region, centripetal_bound, speed_bound};
use crate::mechanism::{MarkerId, Mechanism};

/// c = e · (P_j − P_i) with the x- or y-axis e of marker k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Projection {
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
    /// Marker k, to which the axis belongs.
    pub axes: MarkerId,
    /// The axis of marker k.
    pub axis: Axis,
}

impl Projection {
    fn direction(&self, at: &Configuration) -> Vector2<f64> {
        self.axis.of(at.marker(self.axes).axis)
    }
}

impl Formula for Projection {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let d = subtract(at.point(self.to), at.point(self.from));
        dot(self.axis.of_varied(at.marker(self.axes).axis), d)
    }
}

impl Constraint for Projection {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let d = at.marker(self.to).point - at.marker(self.from).point;
        self.direction(at).dot(&d)
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let (i, j, k) = (
            at.marker(self.from),
            at.marker(self.to),
            at.marker(self.axes),
        );
        let e = self.axis.of(k.axis);
        let d = j.point - i.point;
        row.add_point(j, e);
        row.add_point(i, -e);
        row.add_direction(k, perp(e).dot(&d));
        e.dot(&d)
    }

    /// Returns ë · d + 2 ė · ḋ + e · d̈ with ė = omega_k perp(e) and, for q̈ = 0, ë = −omega_k² e.
    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64 {
        let (i, j, k) = (
            at.marker(self.from),
            at.marker(self.to),
            at.marker(self.axes),
        );
        let e = self.direction(at);
        let omega = angular_velocity(k, q_dot);
        let d = j.point - i.point;
        let d_dot = point_velocity(j, q_dot) - point_velocity(i, q_dot);
        let d_ddot = centripetal(j, q_dot) - centripetal(i, q_dot);
        -omega * omega * e.dot(&d) + 2.0 * omega * perp(e).dot(&d_dot) + e.dot(&d_ddot)
    }

    /// Returns true for points that no angle moves on an axis at rest with literal components.
    fn is_linear(&self, mechanism: &Mechanism) -> bool {
        let axes = &mechanism.markers[self.axes.index()];
        let rests = axes.body.is_none() && axes.angle.literal().is_some();
        rests
            && [self.from, self.to].map(|marker| is_origin_or_ground(mechanism, marker))
                == [true; 2]
    }

    /// Bounds the turns of the axis and of the arms, and the growth of d by the reach of both
    /// points: |c″| ≤ omega_k² |d| + 2 |omega_k| |ḋ| + omega_i² |s_i| + omega_j² |s_j|.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let (i, j, k) = (
            at.marker(self.from),
            at.marker(self.to),
            at.marker(self.axes),
        );
        let axis = region.sway(k);
        for marker in [i, j] {
            let swing = marker.arm.norm() * (axis + region.sway(marker));
            row.add_point_bound(marker, axis, swing);
        }
        let d = (j.point - i.point).norm();
        let reach = region.reach(i, j);
        row.add_direction(k, d * axis + reach);
        let omega = angular_velocity(k, v).abs();
        Some(
            omega * omega * (d + reach)
                + 2.0 * omega * speed_bound(i, j, v)
                + centripetal_bound(i, j, v),
        )
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        let components = axis_components(mechanism, self.axes, self.axis);
        incidence.direction(mechanism, self.axes);
        incidence.point(mechanism, self.from, components);
        incidence.point(mechanism, self.to, components);
    }
}
