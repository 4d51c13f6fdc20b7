//! The angle between two markers.

use super::configuration::Configuration;
use super::definition::{Constraint, Dimension, Formula, Incidence, TurnEffect};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism};
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

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        row.add_direction(at.marker(self.to), 1.0);
        row.add_direction(at.marker(self.from), -1.0);
        self.value(at)
    }

    fn is_affine(&self) -> bool {
        true
    }

    fn is_linear(&self, _mechanism: &Mechanism) -> bool {
        true
    }

    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::Whole
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.direction(mechanism, self.from);
        incidence.direction(mechanism, self.to);
    }
}
