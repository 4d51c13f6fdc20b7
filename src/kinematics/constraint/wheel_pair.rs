//! Two wheels that turn in a fixed ratio: gears, and wheels on a belt.

use super::configuration::{CoefficientId, Configuration};
use super::definition::{Constraint, Dimension, Formula, Incidence, TurnEffect};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism};
use crate::mechanism::{BodyId, MarkerId, Mechanism};

/// c = (theta_j − phi_c) − k (theta_i − phi_c), with k = ±r_i / r_j and whole turns.
///
/// It is linear in q, so that the phase keeps its accuracy over any number of turns.
#[derive(Clone, Debug)]
pub struct WheelPair {
    /// Marker i, on the first wheel.
    pub from: MarkerId,
    /// Marker j, on the second wheel.
    pub to: MarkerId,
    /// Body c that carries the wheels' centres, `None` for ground.
    pub carrier: Option<BodyId>,
    /// r_i and r_j, in metres or teeth.
    pub sizes: [CoefficientId; 2],
    /// Whether the wheels turn in opposite senses relative to their carrier.
    pub opposite: bool,
}

impl WheelPair {
    fn ratio(&self, at: &Configuration) -> f64 {
        let [first, second] = self.sizes.map(|size| at.coefficient(size));
        let ratio = first / second;
        if self.opposite { -ratio } else { ratio }
    }
}

impl Formula for WheelPair {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let phi = at.phi(self.carrier);
        let [first, second] = [self.from, self.to].map(|marker| at.marker(marker).theta - phi);
        let [i, j] = self.sizes.map(|size| at.coefficient(size));
        let turned = i / j * first;
        if self.opposite {
            second + turned
        } else {
            second - turned
        }
    }
}

impl Constraint for WheelPair {
    fn dimension(&self) -> Dimension {
        Dimension::Angle
    }

    fn value(&self, at: &Configuration) -> f64 {
        let phi = at.phi(self.carrier);
        let [first, second] = [self.from, self.to].map(|marker| at.marker(marker).theta - phi);
        second - self.ratio(at) * first
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let k = self.ratio(at);
        row.add_direction(at.marker(self.to), 1.0);
        row.add_direction(at.marker(self.from), -k);
        row.add_turn(self.carrier, k - 1.0);
        self.value(at)
    }

    fn is_affine(&self) -> bool {
        true
    }

    fn turn_effect(&self) -> TurnEffect {
        TurnEffect::Proportional
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        incidence.direction(mechanism, self.from);
        incidence.direction(mechanism, self.to);
        incidence
            .unknowns
            .extend(self.carrier.map(|body| 3 * body.index() + 2));
    }
}
