//! The rounding error of efforts.

use super::applied::{ActsAt, on_body};
use super::inertial::by_body;
use super::solve::Forces;
use crate::kinematics::constraint::Gradient;
use crate::kinematics::path::Rates;
use crate::kinematics::state::State;
use crate::mechanism::DriverId;

impl Forces {
    /// Returns the rounding error of a driver's effort, n ε Σ |f ∂q/∂u| over the n products, other
    /// than zero, of the forces f of each mass, spring, damper and load with the rates ∂q/∂u. Half of it is the bound
    /// for the sum of exact products (Higham, Accuracy and Stability of Numerical Algorithms,
    /// Eq. 3.5), the other half one rounding of each factor. The efforts must be up to date.
    pub(in crate::kinematics) fn effort_rounding(
        &self,
        state: &State,
        rates: &Rates,
        driver: DriverId,
    ) -> f64 {
        let unit = self.unit(state, driver);
        let (mut sum, mut products) = (0.0, 0_u32);
        let mut add = |column: usize, force: f64| {
            let product = force * unit[column];
            if product != 0.0 {
                sum += product.abs();
                products += 1;
            }
        };
        let mut gradient = Gradient::new();
        for (applied, size) in self.applied.list.iter().zip(&self.results.sizes) {
            match &applied.place {
                ActsAt::Coordinate(relation) => {
                    gradient.clear();
                    relation.gradient(&state.at, &mut gradient);
                    for (column, partial) in gradient.entries() {
                        add(column, size[0] * partial);
                    }
                }
                ActsAt::Marker(marker, axes) => {
                    if let Some((body, force)) = on_body(*size, &state.at, *marker, *axes) {
                        (0..3).for_each(|k| add(3 * body.index() + k, force[k]));
                    }
                }
            }
        }
        let [velocities, accelerations] = [rates.velocity(), rates.acceleration()].map(by_body);
        for (body, of_body) in self.masses.bodies.iter().enumerate() {
            let [_, _, omega] = velocities[body];
            let force = of_body.demand(omega, accelerations[body], self.masses.gravity);
            (0..3).for_each(|k| add(3 * body + k, force[k]));
        }
        f64::from(products) * f64::EPSILON * sum
    }
}
