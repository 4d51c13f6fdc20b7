//! How outputs change with inputs and parameters.

use super::variables::Order;
use super::{MechanismModel, Quantity, failed};
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::state::Phase;
use crate::kinematics::{Direction, Sensitivity};
use crate::mechanism::Jet;

impl MechanismModel {
    /// The derivatives of outputs and calculated parameters along a direction.
    ///
    /// Value, velocity and acceleration of a driver count as independent of each other, wherever
    /// the velocity and acceleration in force come from: an estimate is not differentiated.
    ///
    /// # Errors
    ///
    /// The pose is singular, or there is none for the values set.
    pub(super) fn derivatives_along(
        &mut self,
        unknowns: &[Quantity],
        knowns: &[(Quantity, f64)],
        phase: Phase,
        log: &Logger,
    ) -> Result<Vec<f64>, Failure> {
        if unknowns.is_empty() {
            return Ok(Vec::new());
        }
        self.refresh_rates(phase, log)?;
        let mut direction = Direction {
            drivers: vec![Jet::constant(0.0); self.inputs.len()],
            parameters: vec![0.0; self.settings.parameters.len()],
        };
        for &(known, change) in knowns {
            match known {
                Quantity::Input(driver, order) => {
                    let driver = &mut direction.drivers[driver.index()];
                    *match order {
                        Order::Position => &mut driver.value,
                        Order::Velocity => &mut driver.derivatives[0],
                        Order::Acceleration => &mut driver.derivatives[1],
                    } += change;
                }
                Quantity::Parameter(parameter) => {
                    direction.parameters[parameter.index()] += change;
                }
                _ => unreachable!("inputs and parameters are all that is known"),
            }
        }
        let sensitivity = self
            .solver
            .sensitivity(&self.rates, &self.driver_rates, &direction)
            .map_err(failed)?;
        let change = |&unknown: &Quantity| unknown.change(&sensitivity);
        Ok(unknowns.iter().map(change).collect())
    }
}

impl Quantity {
    /// The change of an output or a parameter.
    fn change(self, sensitivity: &Sensitivity<'_>) -> f64 {
        match self {
            Self::Body(body, component, order) => {
                order.of(sensitivity.coordinate(3 * body.index() + component))
            }
            Self::Marker(marker, component, order) => {
                order.of(sensitivity.marker(marker)[component])
            }
            Self::Measure(measure, order) => order.of(sensitivity.measure(measure)),
            Self::Motion(driver, order) => order.of(sensitivity.driver(driver)),
            Self::Parameter(parameter) => sensitivity.parameter(parameter),
            _ => unreachable!("outputs and parameters are all that is unknown"),
        }
    }
}
