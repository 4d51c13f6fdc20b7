//! The angle between two markers.

use super::configuration::Configuration;
use super::definition::{Constraint, Dimension, Formula, Incidence, TurnEffect};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism};
use super::region::Region;
use crate::mechanism::{MarkerId, Mechanism};

/// c = theta_j − theta_i, with whole turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Angle {
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
}

impl Formula for Angle {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        at.marker(self.to).theta - at.marker(self.from).theta
    }
}

impl Constraint for Angle {
    fn dimension(&self) -> Dimension {
        Dimension::Angle
    }

    fn value(&self, at: &Configuration) -> f64 {
        at.marker(self.to).theta - at.marker(self.from).theta
    }

    fn gradient(&self, at: &Configuration, row: &mut Gradient) {
        row.add_direction(at.marker(self.to), 1.0);
        row.add_direction(at.marker(self.from), -1.0);
    }

    /// Returns zero: the angle is linear in q.
    fn quadratic(&self, _at: &Configuration, _q_dot: &[f64]) -> f64 {
        0.0
    }

    fn is_linear(&self, _mechanism: &Mechanism) -> bool {
        true
    }

    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::Whole
    }

    /// Returns zero: the angle is linear in q.
    fn bend(
        &self,
        _at: &Configuration,
        _region: &Region<'_>,
        _v: &[f64],
        _row: &mut Gradient,
    ) -> Option<f64> {
        Some(0.0)
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.direction(mechanism, self.from);
        incidence.direction(mechanism, self.to);
    }
}
