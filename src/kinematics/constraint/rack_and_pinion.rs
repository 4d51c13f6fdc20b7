//! A pinion that rolls on a rack.

use super::configuration::{CoefficientId, Configuration};
use super::definition::{Axis, Constraint, Dimension, Formula, Incidence, TurnEffect};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism};
use super::projection::Projection;
use super::region::Region;
use crate::mechanism::{MarkerId, Mechanism, RackSide};

/// c = s + σ r (theta_p − theta_r) with the coordinate s of the pinion's centre along the rack
/// marker's x-axis, and σ = +1 for a pinion above the rack, −1 below.
#[derive(Clone, Debug)]
pub struct RackAndPinion {
    /// Marker p at the pinion's centre.
    pub pinion: MarkerId,
    /// Marker r on the rack, its x-axis along the teeth.
    pub rack: MarkerId,
    /// The pinion's radius \[m\].
    pub radius: CoefficientId,
    /// The side of the rack on which the pinion is.
    pub side: RackSide,
}

impl RackAndPinion {
    /// Returns the relation s.
    fn travel(&self) -> Projection {
        Projection {
            from: self.rack,
            to: self.pinion,
            axes: self.rack,
            axis: Axis::X,
        }
    }

    /// Returns σ r.
    fn arc(&self, at: &Configuration) -> f64 {
        let radius = at.coefficient(self.radius);
        match self.side {
            RackSide::Above => radius,
            RackSide::Below => -radius,
        }
    }
}

impl Formula for RackAndPinion {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let turn = at.marker(self.pinion).theta - at.marker(self.rack).theta;
        let arc = at.coefficient(self.radius) * turn;
        match self.side {
            RackSide::Above => self.travel().evaluate(at) + arc,
            RackSide::Below => self.travel().evaluate(at) - arc,
        }
    }
}

impl Constraint for RackAndPinion {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value(&self, at: &Configuration) -> f64 {
        let turn = at.marker(self.pinion).theta - at.marker(self.rack).theta;
        self.travel().value(at) + self.arc(at) * turn
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        self.travel().gradient(at, row);
        row.add_direction(at.marker(self.pinion), self.arc(at));
        row.add_direction(at.marker(self.rack), -self.arc(at));
        self.value(at)
    }

    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::Proportional
    }

    /// Returns the bound of s: the arc is linear in q.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        self.travel().bend(at, region, v, row)
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        self.travel().incidence(mechanism, incidence);
        incidence.direction(mechanism, self.pinion);
    }
}
