//! One of the two equations of coincident points.

use nalgebra::Vector2;

use super::configuration::Configuration;
use super::definition::{Axis, Constraint, Dimension, Formula, Incidence, is_origin_or_ground};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism};
use super::point::centripetal;
use super::region::{Region, centripetal_bound};
use crate::mechanism::{MarkerId, Mechanism};

/// c = the x or y component of P_j − P_i in ground axes.
///
/// If both components are zero, they are zero on any axes; on ground axes the coefficients of x and
/// y are ±1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coincidence {
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
    /// The component.
    pub axis: Axis,
}

impl Coincidence {
    fn direction(&self) -> Vector2<f64> {
        match self.axis {
            Axis::X => Vector2::x(),
            Axis::Y => Vector2::y(),
        }
    }
}

impl Formula for Coincidence {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let component = self.axis as usize;
        at.point(self.to)[component] - at.point(self.from)[component]
    }
}

impl Constraint for Coincidence {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let d = at.marker(self.to).point - at.marker(self.from).point;
        self.direction().dot(&d)
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        let e = self.direction();
        row.add_point(j, e);
        row.add_point(i, -e);
        e.dot(&(j.point - i.point))
    }

    fn quadratic(&self, at: &Configuration, q_dot: &[f64]) -> f64 {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        self.direction()
            .dot(&(centripetal(j, q_dot) - centripetal(i, q_dot)))
    }

    fn is_linear(&self, mechanism: &Mechanism) -> bool {
        [self.from, self.to].map(|marker| is_origin_or_ground(mechanism, marker)) == [true; 2]
    }

    /// Bounds the turn of the arms: e · perp(A s) changes by at most the chord of the turn times
    /// the arm.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let (i, j) = (at.marker(self.from), at.marker(self.to));
        for marker in [i, j] {
            row.add_point_bound(marker, 0.0, marker.arm.norm() * region.sway(marker));
        }
        Some(centripetal_bound(i, j, v))
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        let components = [self.axis == Axis::X, self.axis == Axis::Y];
        incidence.point(mechanism, self.from, components);
        incidence.point(mechanism, self.to, components);
    }
}
